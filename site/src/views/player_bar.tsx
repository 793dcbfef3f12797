// SPDX-License-Identifier: Apache-2.0
// Play, pause, step, scrub and speed.
import { useEffect } from "preact/hooks";
import { ROW } from "../shared/core";
import { phaseAt } from "../shared/floor_job";
import { pair, rowAt } from "../shared/row";
import { get } from "../shared/scene_values";
import { player, recorded, scene } from "../shared/state";
import { SIDES, tables } from "../shared/tables";

const TICK = 0.01;
const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 25, 50];

// The moment in words, for those who do not see the picture.
function momentWords(): string {
  const run = recorded.value;
  const time = `${player.time.value.toFixed(2)} s`;
  if (!run) return time;
  const row = rowAt(run, player.time.value, Number(get(scene.value, "control.period_s")));
  if (run.phases.length > 0) {
    const does = SIDES.flatMap((side, k) => {
      const phase = phaseAt(run, k, player.time.value);
      return phase ? `${side}: ${tables.lifting[phase.state]!.name.replace("_", " ")}` : [];
    });
    return [time, ...does].join(", ");
  }
  const p = pair(run, row, ROW.contact).map((value) => (1000 * value).toFixed(1).replace("-", "−"));
  return [time, ...SIDES.map((side, k) => `${side} p = ${p[k]} mm`)].join(", ");
}

// `end`: of several carries; without it, the bar is that of the one which the state describes.
// `isHeld`: as that of the player.
export function PlayerBar(props: { end?: number; isHeld?: boolean }) {
  const end = props.end ?? recorded.value?.time ?? 0;
  return (
    <div class="player" role="group" aria-label="playback">
      <button type="button" class="round" id="play" onClick={() => player.toggle()} disabled={props.isHeld}
        aria-label={player.playing.value ? "pause" : "play"} title="space">
        {player.playing.value ? <Pause /> : <Play />}
      </button>
      <button type="button" class="plain" disabled={props.isHeld} onClick={() => player.step(-TICK)}
        aria-label="one step back" title="comma">
        ‹
      </button>
      <button type="button" class="plain" disabled={props.isHeld} onClick={() => player.step(TICK)}
        aria-label="one step on" title="full stop">
        ›
      </button>
      <input
        type="range"
        id="scrub"
        aria-label="time"
        min={0}
        max={end}
        step={TICK}
        disabled={props.isHeld}
        value={player.time.value}
        aria-valuetext={props.end === undefined ? momentWords() : `${player.time.value.toFixed(2)} s`}
        onInput={(event) => {
          // The end seldom is a whole number of steps.
          const to = Number(event.currentTarget.value);
          player.scrub(to + TICK > end ? end : to);
        }}
      />
      <output class="time" aria-live="off">{player.time.value.toFixed(2)} s</output>
      <select
        aria-label="speed"
        id="speed"
        value={player.speed.value}
        onChange={(event) => (player.speed.value = Number(event.currentTarget.value))}
      >
        {SPEEDS.map((speed) => (
          <option value={speed}>{speed}×</option>
        ))}
      </select>
    </div>
  );
}

function Play() {
  return <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true"><path d="M4 2l10 6-10 6z" fill="currentColor" /></svg>;
}

function Pause() {
  return <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true"><path d="M3 2h4v12H3zM9 2h4v12H9z" fill="currentColor" /></svg>;
}

// Where one types, all keys are text.
const isText = (target: HTMLElement) =>
  target instanceof HTMLTextAreaElement ||
  (target instanceof HTMLInputElement && /^(number|text|search)$/.test(target.type));

// The space bar is the only key that ticks a box or chooses the first answer.
const needsSpace = (target: HTMLElement) =>
  target instanceof HTMLInputElement &&
  (target.type === "checkbox" || (target.type === "radio" && !target.checked));

const isPlayKey = (event: KeyboardEvent) =>
  event.key === " " && !isText(event.target as HTMLElement) && !needsSpace(event.target as HTMLElement);

interface Clock {
  toggle(): void;
  stepBy(steps: number): void;
}

const ofCarry: Clock = { toggle: () => player.toggle(), stepBy: (steps) => player.step(steps * TICK) };

// Keys that work wherever the focus is not in a field that takes them. Enter presses buttons.
function playerKeys(clock: Clock, event: KeyboardEvent): void {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (isPlayKey(event)) {
    event.preventDefault();
    if (!event.repeat) clock.toggle();
  }
  if (isText(event.target as HTMLElement)) return;
  if (event.key === ",") clock.stepBy(-1);
  if (event.key === ".") clock.stepBy(1);
}

// Some browsers press a button when the key is released.
function releasedKey(event: KeyboardEvent): void {
  if (isPlayKey(event)) event.preventDefault();
}

// A box that was clicked with a pointer keeps no focus: else the space bar would tick it again.
function releaseBox(event: MouseEvent): void {
  const target = event.target as HTMLElement;
  if (event.detail > 0 && needsSpace(target)) target.blur();
}

// Makes the keys of the player work in a view.
export function usePlayerKeys(clock: Clock = ofCarry): void {
  useEffect(() => {
    const keys = (event: KeyboardEvent) => playerKeys(clock, event);
    document.addEventListener("keydown", keys);
    document.addEventListener("keyup", releasedKey);
    document.addEventListener("click", releaseBox);
    return () => {
      document.removeEventListener("keydown", keys);
      document.removeEventListener("keyup", releasedKey);
      document.removeEventListener("click", releaseBox);
    };
  }, []);
}
