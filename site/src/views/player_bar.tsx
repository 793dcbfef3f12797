// SPDX-License-Identifier: Apache-2.0
// Play, pause, step, scrub and speed.
import { useEffect } from "preact/hooks";
import { player, recorded } from "../shared/state";

const TICK = 0.01;
const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 25, 50];

export function PlayerBar(props: { end?: number }) {
  const end = props.end ?? recorded.value?.time ?? 0;
  return (
    <div class="player" role="group" aria-label="playback">
      <button type="button" class="round" id="play" onClick={() => player.toggle()}
        aria-label={player.playing.value ? "pause" : "play"} title="space">
        {player.playing.value ? <Pause /> : <Play />}
      </button>
      <button type="button" class="plain" onClick={() => player.step(-TICK)} aria-label="one step back" title="comma">
        ‹
      </button>
      <button type="button" class="plain" onClick={() => player.step(TICK)} aria-label="one step on" title="full stop">
        ›
      </button>
      <input
        type="range"
        id="scrub"
        aria-label="time"
        min={0}
        max={end}
        step={TICK}
        value={player.time.value}
        onInput={(event) => {
          player.pause();
          // The end seldom is a whole number of steps.
          const to = Number(event.currentTarget.value);
          player.seek(to + TICK > end ? end : to);
        }}
      />
      <output class="time">{player.time.value.toFixed(2)} s</output>
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

// Keys that work wherever the focus is not in a field that takes them.
function playerKeys(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  // A slider and an answer that is already chosen do not use the space bar.
  const isFree =
    target instanceof HTMLInputElement &&
    (target.type === "range" || (target.type === "radio" && target.checked));
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName) && !isFree) return;
  if (event.key === " " && target.tagName !== "BUTTON") {
    event.preventDefault();
    player.toggle();
  }
  if (event.key === ",") player.step(-TICK);
  if (event.key === ".") player.step(TICK);
}

// A button that was clicked with a pointer keeps no focus: else the space bar would press it again.
function releaseButton(event: MouseEvent): void {
  const button = (event.target as HTMLElement).closest("button");
  if (button && event.detail > 0) button.blur();
}

// Makes the keys of the player work in a view.
export function usePlayerKeys(): void {
  useEffect(() => {
    document.addEventListener("keydown", playerKeys);
    document.addEventListener("click", releaseButton);
    return () => {
      document.removeEventListener("keydown", playerKeys);
      document.removeEventListener("click", releaseButton);
    };
  }, []);
}
