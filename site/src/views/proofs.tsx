// SPDX-License-Identifier: Apache-2.0
// Proofs: the counterexamples that the model checker found, as sequences to play, beside a carry in
// with the same failure.
import { computed, signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect } from "preact/hooks";
import { AtHome } from "./parts";
import { usePlayerKeys } from "./player_bar";
import { PROOF_CHART_HEIGHT, positionText, drawProofChart, stepAt } from "./proof_chart";
import { Stage } from "./stage";
import { Canvas, type Surface } from "../shared/canvas";
import type { Recorded } from "../shared/core";
import {
  type Counterexample, type CounterexampleFile, type RobotStep, counterexamplesOf, stepTimes,
} from "../shared/counterexamples";
import { overridesOf, sceneOf } from "../shared/scene";
import {
  address, base, controller, controllerNumber, core, extra, extraNumber, extras, forks, go,
  overrides, seed, setExtra,
} from "../shared/state";
import { SIDES, type Scene } from "../shared/tables";
import { palette, reducedMotion } from "../shared/theme";

const all = signal<Counterexample[]>([]);
const playing = signal(false);
const phase = signal(0); // how much of the present step has passed, for the carry
const STEP_MS = 650;
const USUAL = "lost-c-ack";

const chosen = computed(() => {
  void extras.value;
  return all.value.find((c) => c.name === extra("run", USUAL)) ?? all.value[0];
});
const step = computed(() => {
  const asked = Math.max(0, Math.floor(extraNumber("step", 0)));
  return Math.min(asked, (chosen.value?.steps.length ?? 1) - 1);
});

function goTo(place: number): void {
  phase.value = 0;
  setExtra("step", String(place), "0");
}

// By hand: a step back or on, or to a place.
function stepTo(place: number): void {
  playing.value = false;
  goTo(Math.min(Math.max(place, 0), chosen.value!.steps.length - 1));
}

// The same faults in the quasistatic world, where there is a scene for them.
const carry = computed<{ run: Recorded; of: Scene; times: number[] } | null>(() => {
  const machine = core.value;
  const item = chosen.value;
  if (!machine || !item?.scene) return null;
  const of = sceneOf("paper", overridesOf(machine, item.scene));
  machine.setScene(of);
  const run = machine.run(controllerNumber(item.controller), 0);
  return { run, of, times: stepTimes(item, run) };
});
const carryTime = computed(() => {
  const times = carry.value?.times;
  if (!times) return 0;
  const now = times[step.value]!;
  return now + phase.value * ((times[step.value + 1] ?? now) - now);
});

function advance(): void {
  const item = chosen.value!;
  if (step.value + 1 < item.steps.length) goTo(step.value + 1);
  else if (item.loop !== null) goTo(Math.min(item.loop, item.steps.length - 1));
  else playing.value = false;
}

function useClock(): void {
  useEffect(() => {
    let last = 0;
    let request = requestAnimationFrame(function next(now) {
      const passed = last ? Math.min(now - last, 200) : 0;
      last = now;
      if (playing.value && !document.hidden && chosen.value) {
        const share = phase.value + passed / STEP_MS;
        if (share < 1) phase.value = share;
        else advance();
      }
      request = requestAnimationFrame(next);
    });
    return () => cancelAnimationFrame(request);
  }, []);
}

// Both palms as rows of units with the contact on them.
function drawPalms(surface: Surface, item: Counterexample, place: number): void {
  const now = item.steps[place];
  if (!now) return;
  const p = palette.value;
  const c = surface.context;
  const positions = item.steps.flatMap((s) => s.robots.map((r) => Math.abs(r.position ?? 0)));
  const reach = Math.max(4, ...positions) + 1;
  const gap = surface.width * 0.1;
  const wide = (surface.width - gap) / 2 - 16;
  now.robots.forEach((robot, side) => {
    if (!robot.palm) return;
    const x0 = side === 0 ? 6 : surface.width / 2 + gap / 2 + 6;
    const unit = wide / (2 * reach + 1);
    const tilt = (robot.palm === "shallow" ? 5 : 15) * (side === 0 ? 1 : -1) * (Math.PI / 180);
    c.save();
    c.translate(x0 + wide / 2, 46);
    c.rotate(tilt * 0.45);
    c.strokeStyle = side === 0 ? p.left : p.right;
    c.lineWidth = 5;
    c.setLineDash(robot.turns ? [8, 5] : []);
    c.beginPath();
    c.moveTo(-wide / 2 + 6, 0);
    c.lineTo(wide / 2 - 6, 0);
    c.stroke();
    c.setLineDash([]);
    if (robot.position !== undefined) {
      // Outward is to the left on the left palm.
      for (let k = -reach + 1; k < reach; ++k) {
        const x = (side === 0 ? -k : k) * unit;
        c.fillStyle = k === 0 ? p.zero : p.rule;
        c.fillRect(x - 1, -9, 2, 6);
      }
      c.beginPath();
      c.arc((side === 0 ? -1 : 1) * robot.position * unit, -11, Math.min(9, unit * 0.7), 0, 2 * Math.PI);
      c.fillStyle = Math.abs(robot.position) >= reach - 1 && item.claim === "FALL" ? p.drop : p.ink;
      c.fill();
    }
    c.restore();
    c.fillStyle = p.quiet;
    c.font = "12px system-ui, sans-serif";
    c.textAlign = "center";
    c.fillText(side === 0 ? "outward ←      → inward" : "inward ←      → outward", x0 + wide / 2, 92);
  });
}

function palmWords(robot: RobotStep): string {
  return robot.palm ? `${robot.palm}${robot.turns ? ", turning" : ""}` : "";
}

function driveWords(robot: RobotStep): string {
  if (!robot.drive) return "";
  const notes = [robot.stands ? "stands" : "", robot.misses ? "misses this step" : ""];
  return [robot.drive, ...notes].filter(Boolean).join(", ");
}

function stateWords(robot: RobotStep) {
  const letter = robot.case ? `(${robot.case}) ` : "";
  const words = `${letter}${robot.state}${robot.waits ? `; waits for ${robot.waits}` : ""}`;
  return robot.name ? <>{words} <code>{robot.name}</code></> : words;
}

// What both robots do in a step, line by line. A line that the model does not have is left out.
function Robots(props: { robots: [RobotStep, RobotStep] }) {
  const rows: [string, (robot: RobotStep) => ComponentChildren][] = [
    ["contact p", (r) => (r.position === undefined ? "" : positionText(r.position))],
    ["arm", (r) => (r.arm === undefined ? "" : r.arm === 0 ? "on the floor" : `${r.arm} up`)],
    ["state", stateWords],
    ["palm", palmWords],
    ["drive", driveWords],
  ];
  return (
    <table class="robots">
      <thead>
        <tr>
          <td />
          {SIDES.map((side) => <th scope="col" class={`${side}-text`}>{side}</th>)}
        </tr>
      </thead>
      <tbody>
        {rows.map(([name, words]) => {
          const both = props.robots.map(words);
          if (!both.some(Boolean)) return null;
          return (
            <tr>
              <th scope="row">{name}</th>
              {both.map((said) => <td>{said}</td>)}
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

function Chart(props: { item: Counterexample; place: number }) {
  const { item, place } = props;
  const count = item.steps.length;
  const pick = (event: PointerEvent) => {
    if (event.buttons === 0) return;
    const rect = (event.currentTarget as HTMLElement).getBoundingClientRect();
    stepTo(stepAt(rect.width, count, place, event.clientX - rect.left));
  };
  const keys = (event: KeyboardEvent) => {
    const to = { ArrowLeft: place - 1, ArrowRight: place + 1, Home: 0, End: count - 1 }[event.key];
    if (to === undefined) return;
    stepTo(to);
    event.preventDefault();
  };
  return (
    <Canvas
      id="proof-chart"
      height={PROOF_CHART_HEIGHT}
      draw={(s) => drawProofChart(s, palette.value, item, place)}
      label="sequence chart: contact, palm and drive of both robots in each step, and the messages between them; the arrow keys move the cursor"
      onPointerDown={pick}
      onKeyDown={keys}
    />
  );
}

// Plays or pauses. A run that does not return begins again after its end.
function toggle(): void {
  const item = chosen.value;
  if (!item) return;
  if (!playing.value && step.value === item.steps.length - 1 && item.loop === null) goTo(0);
  playing.value = !playing.value;
}

const clock = { toggle, stepBy: (steps: number) => chosen.value && stepTo(step.value + steps) };

function Player(props: { item: Counterexample; place: number }) {
  const { item, place } = props;
  const last = item.steps.length - 1;
  return (
    <div class="player" role="group" aria-label="playback">
      <button type="button" class="round" id="play" aria-label={playing.value ? "pause" : "play"}
        onClick={toggle} title="space">
        {playing.value ? "❚❚" : "▶"}
      </button>
      <button type="button" class="plain" id="step-back" aria-label="one step back" onClick={() => stepTo(place - 1)}>
        ‹
      </button>
      <button type="button" class="plain" id="step-on" aria-label="one step on" onClick={() => stepTo(place + 1)}>
        ›
      </button>
      <input type="range" id="scrub" aria-label="step" min={0} max={last} step={1} value={place}
        onInput={(event) => stepTo(Number(event.currentTarget.value))} />
      <output class="time" aria-live="off">{place + 1} of {last + 1}</output>
    </div>
  );
}

function openInCarry(item: Counterexample): void {
  base.value = "paper";
  overrides.value = overridesOf(core.peek()!, item.scene!);
  controller.value = item.controller;
  seed.value = 0;
  forks.value = [];
  go(address({ view: "carry", time: false }));
}

export function ProofsView() {
  useEffect(() => {
    // It begins by itself, unless the URL names a step or motion is unwelcome.
    playing.value = step.peek() === 0 && !("step" in extras.peek()) && !reducedMotion.matches;
    if (all.value.length > 0) return;
    void import("../generated/counterexamples.json").then((m) => {
      all.value = counterexamplesOf(m.default as unknown as CounterexampleFile);
    });
  }, []);
  useClock();
  usePlayerKeys(clock);
  const item = chosen.value;
  if (!item) return <p class="status">…</p>;
  const place = step.value;
  const now = item.steps[place]!;
  const isLast = place === item.steps.length - 1;
  const carried = carry.value;
  const hasPalms = now.robots[0].palm !== undefined;
  return (
    <>
      <header class="lead">
        <h1>Where the algorithms fail</h1>
        <p>
          The model checker Spin explores every run of the built-in controllers, and of the table of phases
          that lifts, in a simplified world, in which positions are whole numbers of units. A claim that holds is proved for that
          world. If a claim fails, Spin finds a run in which it fails. This view shows all such runs that
          the project keeps.
        </p>
      </header>
      <div class="choices">
        <label class="field">
          <span>counterexample</span>
          <select id="run" value={item.name}
            onChange={(event) => {
              goTo(0);
              playing.value = !reducedMotion.matches;
              setExtra("run", event.currentTarget.value, USUAL);
            }}>
            {all.value.map((c) => <option value={c.name}>{c.name}</option>)}
          </select>
        </label>
        <span class="note">
          {item.controller === "lifting" ? "table of phases of jobs on the floor" : `controller: ${item.controller}`}
        </span>
      </div>
      <section class="panel proof" aria-label="the run">
        <p class="claim">
          <strong>{item.title[0]!.toUpperCase() + item.title.slice(1)}.</strong> The claim “{item.meaning}” ({item.claim}) fails.{" "}
          <span id="search">
            {item.isShortest
              ? "A breadth-first search found this run: no run with fewer steps of the model shows it."
              : "A depth-first search found this run: a shorter one may exist."}
          </span>
        </p>
        <Player item={item} place={place} />
        <p class="events" role="status">
          {[...now.before, ...(isLast ? item.after : [])].map((event) => event.text).join("; ")}
          {isLast && item.loop !== null && ` The run then returns to step ${item.loop + 1}, and repeats forever.`}
        </p>
        <div class={carried ? "columns" : ""}>
          <div>
            {hasPalms && (
              <Canvas id="proof" height={104} draw={(s) => drawPalms(s, item, place)} label="contacts and palms in units" />
            )}
            <Chart item={item} place={place} />
          </div>
          {carried && (
            <div>
              <Stage run={carried.run} of={carried.of} name={item.controller} id="proof-carry" low time={carryTime}
                label="side view of a carry with the same failure" />
              <p class="note">
                The same failure occurs in a carry with friction and geometry, shown at{" "}
                <output id="carry-time" aria-live="off">{carried.times[place]!.toFixed(2)}&nbsp;s</output>.{" "}
                <button type="button" id="carry-it" onClick={() => openInCarry(item)}>open this carry</button>
              </p>
              <Robots robots={now.robots} />
            </div>
          )}
        </div>
        <p class="note">
          {hasPalms
            ? "Number: contact coordinate p in units, outward > 0. Line: the palm, dashed while it turns. Arrow: the drive, away or closer. Diamond: a bump or a reboot."
            : now.robots[0].arm !== undefined
              ? "Bar: the arm, in cycles of its motion above the floor. Diamond: a reboot."
              : "This model has no contacts. Filled circle: the robot hears its partner."}
        </p>
        {!carried && <div><Robots robots={now.robots} /></div>}
      </section>
      <AtHome
        lines={[`.venv/bin/python verify/model_check.py ${item.name}`]}
        runs={carried ? [{ command: `palmbots carry verify/counterexamples/${item.name}.toml`, hash: carried.run.hash }] : []}
        note="Run this in a copy of the sources, after make verify."
      />
    </>
  );
}
