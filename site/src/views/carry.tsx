// SPDX-License-Identifier: Apache-2.0
// Carry: one carry to watch, to scrub through, to fork and to disturb.
import { signal } from "@preact/signals";
import {
  AtHome, ControllerChoice, Disturbances, Field, JobChoices, ResetButton, SceneChoice, caseWords, presentRun, setController,
} from "./parts";
import { Ends } from "./ends";
import { PlayerBar, usePlayerKeys } from "./player_bar";
import { Stages } from "./stages";
import { saveFilm, savePicture } from "./save";
import { Charts } from "./sequence";
import { Stage, offAt, pushRobot, shiftObject, showCones } from "./stage";
import { stateAt } from "../shared/activities";
import { ROW, type Recorded } from "../shared/core";
import { absentIn, failureOf, phaseAt } from "../shared/floor_job";
import { caseAt, pair, rowAt } from "../shared/row";
import { get } from "../shared/scene_values";
import {
  address, append, controller, forks, go, isJob, overrides, player, recorded, refusal, scene, seed, setExtra,
  setExtraFlag, setKey,
} from "../shared/state";
import { type Json, SIDES, controllerInfo, tables } from "../shared/tables";

const NUDGE_M = 0.012;
const UNTIL_SWITCHED_ON_S = 1000; // longer than any carry

export function outcomeText(run: Recorded): string {
  const missed = failureOf(run);
  return missed ? `${missed}; ${endText(run)}` : endText(run);
}

function endText(run: Recorded): string {
  const name = tables.outcomes[run.outcome]!;
  if (name === "dropped") return `dropped after ${run.time.toFixed(1)} s: ${tables.ends[run.reason - 1]!.meaning}`;
  if (name === "stalled") return `stalled: time limit reached at ${run.time.toFixed(1)} s`;
  const [subject, way] = run.phases.length > 0 ? ["the object moved ", run.moved] : ["", run.distance];
  return `delivered: ${subject}${way.toFixed(2)} m in ${run.time.toFixed(1)} s`;
}

// The warnings about the scene, and at the end those about the carry.
export function warningsAt(run: Recorded, time: number): string[] {
  return time >= run.time ? [...run.early, ...run.warnings] : run.early;
}

export function Warnings(props: { lines: string[] }) {
  if (props.lines.length === 0) return null;
  return (
    <ul class="warnings">
      {props.lines.map((text) => <li>warning: {text}</li>)}
    </ul>
  );
}

// Good is only a carry that ended well and in which nothing went wrong unnoticed.
export function outcomeClass(run: Recorded): string {
  return run.outcome === 1 && run.warnings.length === 0 ? "good" : "bad";
}

function Status() {
  const run = recorded.value;
  if (refusal.value) {
    return (
      <p class="status refusal" role="status">
        {refusal.value}
      </p>
    );
  }
  if (!run) return <p class="status">…</p>;
  const row = rowAt(run, player.time.value, Number(get(scene.value, "control.period_s")));
  const ended = row === run.count - 1;
  const warnings = warningsAt(run, player.time.value);
  const contact = pair(run, row, ROW.contact);
  const does = SIDES.map((side, k) => {
    if (offAt(scene.value, player.time.value)[k]) return `${side}: switched off`;
    const letter = caseAt(run, row, k);
    const mm = (1000 * contact[k]!).toFixed(1).replace("-", "−");
    const does = letter && `, ${caseWords(controller.value, letter, stateAt(run, row, k))}`;
    const phase = phaseAt(run, k, player.time.value);
    if (phase) return `${side}: ${tables.lifting[phase.state]!.meaning}${does}`;
    if (run.phases.length > 0) return `${side}: stands aside`;
    return `${side} p = ${mm} mm${does}`;
  });
  return (
    <>
      <div class="status">
        <span class="left-text">{does[0]}</span>
        <strong class={ended ? outcomeClass(run) : ""}>
          {ended ? outcomeText(run) : `${run.rows[row * ROW.width + ROW.midpoint]!.toFixed(2)} m`.replace("-", "−")}
        </strong>
        <span class="right-text">{does[1]}</span>
      </div>
      <p class="unseen" role="status">{[...(ended ? [outcomeText(run)] : []), ...warnings].join("; ")}</p>
      <Warnings lines={warnings} />
    </>
  );
}

function switchRobot(side: 0 | 1): void {
  const time = Number(player.time.peek().toFixed(2));
  const script = get(scene.peek(), "faults.script") as { [key: string]: Json }[];
  if (!offAt(scene.peek(), time)[side]) {
    append("faults.script", {
      kind: "reboot", robot: SIDES[side], at_s: time, duration_s: UNTIL_SWITCHED_ON_S,
    });
    return;
  }
  // Switch it on again now.
  const next = script.map((f) => {
    const start = Number(f.at_s);
    const covers = f.robot === SIDES[side] && time >= start && time < start + Number(f.duration_s);
    return covers ? { ...f, duration_s: Number(Math.max(0.01, time - start).toFixed(2)) } : f;
  });
  setKey("faults.script", next);
}

function fork(): void {
  const at = Number(player.time.peek().toFixed(2));
  const last = forks.peek().at(-1);
  const others = forks.peek().filter((f) => f.at < at);
  const next = last && last.at >= at ? last.seed + 1 : (forks.peek().at(-1)?.seed ?? seed.peek()) + 1;
  forks.value = [...others, { at, seed: next }];
}

// Opens this moment in Mechanics.
function examine(): void {
  const run = recorded.peek();
  if (!run) return;
  const row = rowAt(run, player.time.peek(), Number(get(scene.peek(), "control.period_s")));
  const state = { t: pair(run, row, ROW.palm), p: pair(run, row, ROW.contact) };
  SIDES.forEach((side, k) => {
    setExtra(`t${side[0]}`, String(Number(((state.t[k]! * 180) / Math.PI).toFixed(3))), "");
    setExtra(`p${side[0]}`, String(Number((1000 * state.p[k]!).toFixed(3))), "");
  });
  go(address({ view: "mechanics" }));
}

function Hands() {
  const off = offAt(scene.value, player.time.value);
  const absent = recorded.value ? absentIn(recorded.value) : undefined;
  const changed = ["bumps.script", "bumps.pushes", "faults.script", "radio.script"].filter(
    (key) => key in overrides.value,
  );
  return (
    <div class="hands" role="group" aria-label="disturb the carry at this moment">
      <span class="hint">Now:</span>
      {!isJob.value && (
        <>
          <button type="button" id="fork" onClick={fork} title="Continue from here with other random numbers">
            fork the future
          </button>
          <button type="button" id="nudge-left" onClick={() => shiftObject(-NUDGE_M)} title="Move the object 12 mm to the left; you can also drag it">
            ← object
          </button>
          <button type="button" id="nudge-right" onClick={() => shiftObject(NUDGE_M)} title="Move the object 12 mm to the right; you can also drag it">
            object →
          </button>
        </>
      )}
      {SIDES.map((side, k) => k !== absent && (
        <>
          <button type="button" id={`push-${side}`} onClick={() => pushRobot(k as 0 | 1, NUDGE_M)} title="Pull this robot 12 mm outward; you can also drag it">
            pull {side}
          </button>
          <button type="button" id={`switch-${side}`} aria-pressed={off[k]} onClick={() => switchRobot(k as 0 | 1)}>
            {off[k] ? `${side} on` : `${side} off`}
          </button>
        </>
      ))}
      {!isJob.value && (
        <button type="button" id="examine" onClick={examine} title="Show contact modes, cones and forces at this moment">
          why does it slide?
        </button>
      )}
      {(changed.length > 0 || forks.value.length > 0) && (
        <button
          type="button"
          id="undo"
          onClick={() => {
            for (const key of changed) setKey(key, undefined);
            forks.value = [];
          }}
        >
          undo all
        </button>
      )}
    </div>
  );
}

const busy = signal("");

export function CarryView() {
  const run = recorded.value;
  const info = controllerInfo(controller.value);
  usePlayerKeys();
  return (
    <>
      <header class="lead">
        <h1>Two robots, no gripper, one box</h1>
        <p>
          The box merely rests on two palms. When the robots drift apart or together, one contact
          slides. By tilting a palm, the robots choose <em>which</em> one, and so keep the box on the
          palms. New here?{" "}
          <a
            href="#stories"
            onClick={(event) => {
              event.preventDefault();
              go("#stories");
            }}
          >
            Begin with the stories.
          </a>
        </p>
      </header>
      <div class="choices">
        <SceneChoice />
        <ControllerChoice id="controller" value={controller.value} onChange={setController} />
        <Field label="seed">
          <input
            type="number"
            id="seed"
            min={0}
            step={1}
            value={seed.value}
            onChange={(event) => {
              seed.value = Math.max(0, Math.floor(Number(event.currentTarget.value) || 0));
              forks.value = [];
            }}
          />
        </Field>
        {isJob.value
          ? <JobChoices />
          : <label class="check">
              <input
                type="checkbox"
                id="cones"
                checked={showCones.value}
                onChange={(event) => setExtraFlag("cones", event.currentTarget.checked)}
              />
              friction cones
            </label>}
        <ResetButton />
        <Disturbances />
      </div>
      <section class="panel beside" aria-label="the carry">
        <div class="scene">
          <Stage run={run} name={controller.value} id="stage" draggable hasKey periodic={info?.isPeriodic} />
          <Stages run={run} seeks />
          <PlayerBar />
          <Hands />
          <Status />
        </div>
        <Charts showsWholePalms={isJob.value} />
      </section>
      <Ends reason={run?.reason ?? 0} />
      <AtHome runs={presentRun()} />
      <p class="row save">
        <button type="button" id="save-picture" onClick={() => savePicture("stage")}>
          save a picture
        </button>
        <button
          type="button"
          id="save-film"
          disabled={busy.value !== ""}
          onClick={async () => {
            busy.value = "filming";
            await saveFilm("stage").finally(() => (busy.value = ""));
          }}
        >
          {busy.value || "save a film"}
        </button>
      </p>
    </>
  );
}
