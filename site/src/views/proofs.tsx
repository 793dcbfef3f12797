// SPDX-License-Identifier: Apache-2.0
// Proofs: the counterexamples that the model checker found, as sequences to play.
import { computed, signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { AtHome } from "./parts";
import { Canvas, type Surface } from "../shared/canvas";
import type { Recorded } from "../shared/core";
import { overridesOf, sceneOf } from "../shared/scene";
import {
  address, base, controller, controllerNumber, core, extra, extraNumber, forks, go, overrides, seed,
  setExtra,
} from "../shared/state";
import type { Scene } from "../shared/tables";
import { palette, reducedMotion } from "../shared/theme";

interface Robot {
  cell: number | null;
  does: string;
}

interface Counterexample {
  name: string;
  title: string;
  claim: string;
  meaning: string; // of the claim, as the model states it
  steps: { before: string[]; robots: [Robot, Robot] }[];
  after: string[];
  loop: number | null;
  scene: Scene | null;
}

const all = signal<Counterexample[]>([]);
const step = computed(() => Math.max(0, Math.floor(extraNumber("step", 0))));
const goTo = (place: number) => setExtra("step", String(place), "0");
const playing = signal(false);
const STEP_MS = 650;

function chosen(): Counterexample | undefined {
  return all.value.find((c) => c.name === extra("run", "lost-c-ack")) ?? all.value[0];
}

function useClock(): void {
  useEffect(() => {
    const timer = setInterval(() => {
      if (!playing.value || document.hidden) return;
      const item = chosen();
      if (!item) return;
      if (step.value + 1 < item.steps.length) goTo(step.value + 1);
      else if (item.loop !== null) goTo(Math.min(item.loop, item.steps.length - 1));
      else playing.value = false;
    }, STEP_MS);
    return () => clearInterval(timer);
  }, []);
}

// The same faults in the quasistatic world, where there is a scene for them.
function runOf(item: Counterexample): Recorded | null {
  const machine = core.value;
  if (!machine || !item.scene) return null;
  machine.setScene(sceneOf("paper", overridesOf(item.scene)));
  return machine.run(controllerNumber("distributed"), 0);
}

// Both palms as rows of cells with the contact on them.
function draw(surface: Surface, item: Counterexample): void {
  const now = item.steps[Math.min(step.value, item.steps.length - 1)];
  if (!now) return;
  const p = palette.value;
  const c = surface.context;
  const cells = item.steps.flatMap((s) => s.robots.map((r) => Math.abs(r.cell ?? 0)));
  const reach = Math.max(4, ...cells) + 1;
  const gap = surface.width * 0.1;
  const wide = (surface.width - gap) / 2 - 16;
  now.robots.forEach((robot, side) => {
    const x0 = side === 0 ? 6 : surface.width / 2 + gap / 2 + 6;
    const y = 46;
    const cell = wide / (2 * reach + 1);
    const colour = side === 0 ? p.left : p.right;
    const shallow = /shallow|c_tilt_up|d_|c_grant/.test(robot.does);
    const turning = robot.does.includes("…");
    const tilt = (shallow ? 5 : 15) * (side === 0 ? 1 : -1) * (Math.PI / 180);
    c.save();
    c.translate(x0 + wide / 2, y);
    c.rotate(tilt * 0.45);
    c.strokeStyle = colour;
    c.lineWidth = 5;
    c.setLineDash(turning ? [8, 5] : []);
    c.beginPath();
    c.moveTo(-wide / 2 + 6, 0);
    c.lineTo(wide / 2 - 6, 0);
    c.stroke();
    c.setLineDash([]);
    if (robot.cell !== null) {
      // Outward is to the left on the left palm.
      for (let k = -reach + 1; k < reach; ++k) {
        const x = (side === 0 ? -k : k) * cell;
        c.fillStyle = k === 0 ? p.zero : p.rule;
        c.fillRect(x - 1, -9, 2, 6);
      }
      c.beginPath();
      c.arc((side === 0 ? -1 : 1) * robot.cell * cell, -11, Math.min(9, cell * 0.7), 0, 2 * Math.PI);
      c.fillStyle = Math.abs(robot.cell) >= reach - 1 && item.claim === "FALL" ? p.drop : p.ink;
      c.fill();
    }
    c.restore();
    c.fillStyle = p.quiet;
    c.font = "12px system-ui, sans-serif";
    c.textAlign = "center";
    c.fillText(side === 0 ? "outward ←      → inward" : "inward ←      → outward", x0 + wide / 2, 92);
  });
}

export function ProofsView() {
  useEffect(() => {
    // It begins by itself, unless the URL names a step or motion is unwelcome.
    playing.value = step.peek() === 0 && !reducedMotion.matches;
    if (all.value.length > 0) return;
    void import("../generated/counterexamples.json").then((m) => {
      all.value = m.default as unknown as Counterexample[];
    });
  }, []);
  useClock();
  const item = chosen();
  if (!item) return <p class="status">…</p>;
  const place = Math.min(step.value, item.steps.length - 1);
  const now = item.steps[place];
  const isLast = place === item.steps.length - 1;
  const run = runOf(item);
  const carry = () => {
    base.value = "paper";
    overrides.value = overridesOf(item.scene!);
    controller.value = "distributed";
    seed.value = 0;
    forks.value = [];
    go(address({ view: "carry", time: false }));
  };
  return (
    <>
      <header class="lead">
        <h1>Where the algorithms fail</h1>
        <p>
          The model checker Spin explores every run of the shipped controllers in a world of cells.
          What holds is proved for that model; where a claim fails it finds the shortest run. These are
          all such runs that the project keeps.
        </p>
      </header>
      <div class="choices">
        <label class="field">
          <span>counterexample</span>
          <select id="run" value={item.name}
            onChange={(event) => {
              goTo(0);
              playing.value = !reducedMotion.matches;
              setExtra("run", event.currentTarget.value, "lost-c-ack");
            }}>
            {all.value.map((c) => <option value={c.name}>{c.name}</option>)}
          </select>
        </label>
      </div>
      <section class="panel proof" aria-label="the run">
        <p class="claim">
          <strong>{item.title}.</strong> The claim “{item.meaning}” ({item.claim}) fails.
        </p>
        <div>
          <Canvas id="proof" height={104} draw={(s) => draw(s, item)} label="contacts and palms in cells" />
        </div>
        <div class="robots">
          {now?.robots.map((robot, side) => (
            <p class={side === 0 ? "left-text" : "right-text"}>
              <strong>{side === 0 ? "left" : "right"}</strong>{" "}
              {robot.cell !== null && `p = ${String(robot.cell).replace("-", "−")}, `}
              {robot.does}
            </p>
          ))}
        </div>
        <p class="events" role="status">
          {[...(now?.before ?? []), ...(isLast ? item.after : [])].join("; ")}
          {isLast && item.loop !== null && " From here it repeats forever."}
        </p>
        <div class="player" role="group" aria-label="playback">
          <button type="button" class="round" id="play" aria-label={playing.value ? "pause" : "play"}
            onClick={() => {
              if (!playing.value && isLast && item.loop === null) goTo(0);
              playing.value = !playing.value;
            }}>
            {playing.value ? "❚❚" : "▶"}
          </button>
          <input type="range" id="scrub" aria-label="step" min={0} max={item.steps.length - 1} step={1}
            value={place}
            onInput={(event) => {
              playing.value = false;
              goTo(Number(event.currentTarget.value));
            }} />
          <output class="time">{place + 1} of {item.steps.length}</output>
        </div>
      </section>
      {item.scene && (
        <p class="row">
          <button type="button" id="carry-it" onClick={carry}>carry it with friction and geometry</button>
          <span class="note">The same messages fail in the quasistatic world.</span>
        </p>
      )}
      <AtHome
        lines={[`.venv/bin/python verify/model_check.py ${item.name}`]}
        runs={run ? [{ command: `palmbots carry verify/counterexamples/${item.name}.toml`, hash: run.hash }] : []}
        note="In a copy of the sources, after make verify."
      />
    </>
  );
}
