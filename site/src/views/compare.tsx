// SPDX-License-Identifier: Apache-2.0
// Compare: two controllers on the same noise, and how many of 1000 carries each drops.
import { computed, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { AtHome, type Run, ControllerChoice, Disturbances, JobChoices, ResetButton, SceneChoice, controllerTitle } from "./parts";
import { PlayerBar, usePlayerKeys } from "./player_bar";
import { Warnings, outcomeClass, outcomeText, warningsAt } from "./carry";
import { Stage } from "./stage";
import { carryCommand, controllerWord, sceneWords } from "../shared/command";
import { DRIVES, PALMS, type PolicyRow, type Recorded } from "../shared/core";
import { get } from "../shared/scene_values";
import {
  OWN_ROWS, SIGN_PAIRS, TABLE_1_ROWS, address, base, controllerNumber, core, extra, isJob, overrides, player, policy,
  problem, refusalOf, scene, seed, setExtra,
} from "../shared/state";
import { controllerInfo, tables } from "../shared/tables";
import { startWorker } from "../start_worker";
import type { Report, Task } from "../worker";

const CARRIES = 1000;
const USUAL = ["centralized", tables.defaultController] as const;

const names = computed(() => [extra("a", USUAL[0]), extra("b", USUAL[1])] as [string, string]);

function runOf(place: 0 | 1): Recorded | string | null {
  const machine = core.value;
  if (!machine) return null;
  const refused = refusalOf(names.value[place]);
  if (refused) return refused;
  machine.setScene(scene.value);
  machine.setPolicy(policy.value);
  return machine.run(controllerNumber(names.value[place]), seed.value);
}
const runs = [computed(() => runOf(0)), computed(() => runOf(1))] as const;
const lengthOf = (run: Recorded | string | null) => (run && typeof run !== "string" ? run.time : 0);

const reports = signal<(Report | null)[]>([null, null]);

function useCounts(): void {
  useEffect(() => {
    const worker = startWorker();
    let number = 0;
    worker.onmessage = (event: MessageEvent<Report>) => {
      if (event.data.task !== number) return;
      const next = [...reports.value];
      next[event.data.controller] = event.data;
      reports.value = next;
    };
    const start = () => {
      number += 1;
      reports.value = [null, null];
      if (problem.value) return;
      const task: Task = {
        number, scene: scene.value, rows: policy.value, seed: seed.value, carries: CARRIES,
        controllers: names.value.map(controllerNumber),
      };
      worker.postMessage(task);
    };
    let waiting = 0;
    // Sliders change the state many times a second: count only what stays.
    const stop = computed(() => [scene.value, policy.value, seed.value, names.value]).subscribe(() => {
      clearTimeout(waiting);
      reports.value = [null, null];
      waiting = window.setTimeout(start, 250);
    });
    return () => {
      stop();
      clearTimeout(waiting);
      worker.terminate();
    };
  }, []);
}

const percent = (share: number) => `${(100 * share).toFixed(share < 0.1 ? 2 : 1)} %`;
// The same as a number of carries in a thousand.
const perThousand = (share: number) => (1000 * share).toFixed(share < 0.01 ? 1 : 0);

function Count(props: { place: 0 | 1 }) {
  const report = reports.value[props.place];
  const run = runs[props.place].value;
  const name = controllerTitle(names.value[props.place]);
  if (typeof run === "string") return <tr><th scope="row">{name}</th><td colSpan={6}>{run}</td></tr>;
  if (!report) return <tr><th scope="row">{name}</th><td colSpan={6}>counting …</td></tr>;
  const { tally, interval } = report;
  return (
    <tr data-carries={tally.carries} data-dropped={tally.dropped}>
      <th scope="row">{name}</th>
      <td>{tally.dropped} of {tally.carries}</td>
      <td>{percent(tally.dropped / tally.carries)}</td>
      <td>
        <Interval low={interval[0]} high={interval[1]} rate={tally.dropped / tally.carries} />
        <span class="ends">{perThousand(interval[0])} to {perThousand(interval[1])} of 1000</span>
      </td>
      <td>{tally.stalled}</td>
      <td>{(1000 * Math.sqrt(tally.meanSquare)).toFixed(1)} mm</td>
      <td>{controllerInfo(names.value[props.place])?.usesRadio === false ? "none" : tally.messagesPerM.toFixed(0)}</td>
    </tr>
  );
}

// An interval of rates on a scale that shows small ones: the root of the rate.
function Interval(props: { low: number; high: number; rate: number }) {
  const x = (share: number) => 4 + 152 * Math.sqrt(share);
  return (
    <svg viewBox="0 0 160 16" width="160" height="16" aria-hidden="true">
      <line x1="4" x2="156" y1="8" y2="8" stroke="var(--rule)" />
      <line x1={x(props.low)} x2={x(props.high)} y1="8" y2="8" stroke="var(--ink)" stroke-width="3" />
      <circle cx={x(props.rate)} cy="8" r="4" fill="var(--ink)" />
    </svg>
  );
}

function Rows() {
  const change = (k: number, part: "palms" | "drives", side: 0 | 1, word: string) => {
    policy.value = policy.value.map((row, at): PolicyRow => {
      if (at !== k) return row;
      const pair = [...row[part]] as [string, string];
      pair[side] = word;
      return { ...row, [part]: pair };
    });
  };
  const choice = (k: number, part: "palms" | "drives", side: 0 | 1, words: string[]) => (
    <select
      aria-label={`row ${SIGN_PAIRS[k]}, ${part === "palms" ? "palm" : "drive"} of the ${side ? "right" : "left"} robot`}
      value={policy.value[k]![part][side]}
      onChange={(event) => change(k, part, side, event.currentTarget.value)}
    >
      {words.map((word) => <option>{word}</option>)}
    </select>
  );
  return (
    <section>
      <h2>Nine rows of your own</h2>
      <p class="note">
        The table has a row for each pair of contact signs (p_L, p_R). A station reads both signs and
        commands the actions of their row. The palms turn first. Once they are at their angles, each
        robot adds its drive to the common speed.{" "}
        <button type="button" onClick={() => (policy.value = TABLE_1_ROWS)}>
          back to Table 1
        </button>
      </p>
      <div class="scroll">
        <table class="rows">
          <thead>
            <tr>
              <th>p_L p_R</th><th>left palm</th><th>right palm</th><th>left drives</th><th>right drives</th>
            </tr>
          </thead>
          <tbody>
            {SIGN_PAIRS.map((pair, k) => (
              <tr>
                <th scope="row">{[...pair].join(" ").replaceAll("-", "−")}</th>
                <td>{choice(k, "palms", 0, PALMS)}</td>
                <td>{choice(k, "palms", 1, PALMS)}</td>
                <td>{choice(k, "drives", 0, DRIVES)}</td>
                <td>{choice(k, "drives", 1, DRIVES)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}

export function CompareView() {
  useCounts();
  usePlayerKeys();
  useEffect(() => {
    const before = player.end;
    player.end = () => Math.max(...runs.map((run) => lengthOf(run.peek())), 0);
    return () => {
      player.end = before;
    };
  }, []);
  const latency = Number(get(scene.value, "radio.latency_s"));
  const without = { ...overrides.value };
  delete without["radio.latency_s"];
  const both = [...new Set(names.value.map(controllerWord))].join(",");
  const command = [
    "palmbots compare", ...sceneWords(base.value, without), "--controllers", both, "--values",
    String(latency), "--carries", String(CARRIES), "--seed", String(seed.value),
  ].join(" ");
  const carries = [...new Set(names.value)].flatMap((name): Run[] => {
    const run = runs[names.value.indexOf(name)]!.value;
    if (!run || typeof run === "string") return [];
    return [{ command: carryCommand(base.value, overrides.value, name, seed.value, []), hash: run.hash }];
  });
  const end = Math.max(...runs.map((run) => lengthOf(run.value)));
  return (
    <>
      <header class="lead">
        <h1>Which controller drops less?</h1>
        <p>
          Both pairs of robots get the same random numbers. They differ only in what their controllers
          decide, and in when each robot receives messages.
        </p>
      </header>
      <div class="choices">
        <SceneChoice />
        {([0, 1] as const).map((place) => (
          <ControllerChoice
            id={`controller-${place}`}
            label={place === 0 ? "first pair" : "second pair"}
            value={names.value[place]}
            onChange={(name) => setExtra(place === 0 ? "a" : "b", name, USUAL[place])}
          />
        ))}
        <ResetButton />
        {isJob.value && <JobChoices />}
        <Disturbances />
      </div>
      <section class="panel lanes" aria-label="the two carries">
        {([0, 1] as const).map((place) => {
          const run = runs[place].value;
          return (
            <div class="lane">
              <p class="lane-title">
                <strong>{controllerTitle(names.value[place])}</strong> <LaneEnd run={run} />
              </p>
              <Stage
                run={typeof run === "string" ? null : run}
                of={scene.value}
                name={names.value[place]}
                id={`stage-${place}`}
                low
                hasKey={place === 0}
                periodic={controllerInfo(names.value[place])?.isPeriodic}
              />
            </div>
          );
        })}
        <PlayerBar end={end} />
        {runs.map(({ value: run }) => (
          <div class="lane-warnings">
            {run && typeof run !== "string" && <Warnings lines={warningsAt(run, player.time.value)} />}
          </div>
        ))}
      </section>
      <section>
        <h2>Drops in {CARRIES} carries</h2>
        <div class="scroll" aria-live="off">
          <table id="counts">
            <thead>
              <tr>
                <th>controller</th><th>dropped</th><th>rate</th><th>95 % interval</th>
                <th>stalled</th><th>contact rms</th><th>messages/m</th>
              </tr>
            </thead>
            <tbody>
              <Count place={0} />
              <Count place={1} />
            </tbody>
          </table>
        </div>
        <p class="note" id="counted-and-proved">
          The page counts these drops; each carry has its own noise. Of 100 such intervals, about 95
          contain the rate that very many carries would show, so 0 of 1000 does not mean never.{" "}
          <a href={address({ view: "design", time: false })}>Design</a> looks at all positions of the
          contacts instead, also at those that no carry here reaches: it may say “fails” where 0 of 1000
          drop.
        </p>
      </section>
      {names.value.includes(OWN_ROWS) && <Rows />}
      <AtHome lines={[command]} runs={carries} note="The first command prints the numbers of drops that the table shows." />
    </>
  );
}

function LaneEnd(props: { run: Recorded | string | null }) {
  if (!props.run) return null;
  if (typeof props.run === "string") return <>{props.run}</>;
  if (player.time.value < props.run.time) return null;
  return <span class={outcomeClass(props.run)}>{outcomeText(props.run)}</span>;
}
