// SPDX-License-Identifier: Apache-2.0
// The side view of one carry at the time of the player. On it one can drag the object or a robot.
import { type ReadonlySignal, computed, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { isWaiting } from "../shared/activities";
import { blocksOf } from "../shared/blocks";
import { Canvas, type Surface } from "../shared/canvas";
import { TOUCHES_M } from "../shared/charts";
import { PLACES, ROW, type Recorded } from "../shared/core";
import { absentIn } from "../shared/floor_job";
import { caseAt, pair, rowAt } from "../shared/row";
import { get, ofSide, tiltOf } from "../shared/scene_values";
import { type View, lowestPoint, viewOf, withoutRobot } from "../shared/pair_view";
import { type Flight, drawSide } from "../shared/side_view";
import { append, core, extraFlag, isJob, player, scene } from "../shared/state";
import { isLow, palette } from "../shared/theme";
import { SIDES, tables, type Scene } from "../shared/tables";

const PUSH_S = 0.3; // how long a push lasts

interface Drag {
  what: "object" | 0 | 1;
  from: number;
  by: number; // m, towards +x
}

export const showCones = computed(() => extraFlag("cones"));

export function zeroZone(of: Scene): { from: number; to: number } {
  const zones = get(of, "tactile.zones") as { sign: string; from_m: number; to_m: number }[] | undefined;
  const zero = zones?.find((z) => z.sign === "0");
  if (zero) return { from: zero.from_m, to: zero.to_m };
  const half = Number(get(of, "tactile.zero_half_width_m"));
  return { from: -half, to: half };
}

function flightsAt(run: Recorded, time: number, latency: number, periodic: boolean): Flight[] {
  if (periodic) return [];
  const found: Flight[] = [];
  for (const m of run.messages) {
    if (m.sent > time) break;
    if (m.sender > 1 || m.receiver > 1) continue; // a station is not in the picture
    const lost = Number.isNaN(m.received);
    const length = Math.max(lost ? latency : m.received - m.sent, 0.25); // long enough to be seen
    if (time > m.sent + length) continue;
    found.push({ from: m.sender, share: (time - m.sent) / length, name: m.kind, lost });
  }
  return found;
}

export function offAt(of: Scene, time: number): [boolean, boolean] {
  const script = get(of, "faults.script") as Record<string, unknown>[];
  const off = (side: string) =>
    script.some(
      (f) => f.kind === "reboot" && f.robot === side && time >= Number(f.at_s) &&
        time < Number(f.at_s) + Number(f.duration_s),
    );
  return [off("left"), off("right")];
}

// Whether the object touches each palm in a row of a job on the floor.
export function touchesAt(of: Scene, run: Recorded, row: number): [boolean, boolean] {
  const [lift, p] = [pair(run, row, ROW.lift), pair(run, row, ROW.contact)];
  const on = (side: 0 | 1) =>
    lift[side] < TOUCHES_M && Math.abs(p[side]) <= ofSide(of, "palm", SIDES[side], "length_m") / 2;
  return [on(0), on(1)];
}

function stageHeight(width: number): number {
  return Math.round(Math.min(isLow.value ? 218 : 400, Math.max(200, width * 0.42)));
}

function lowHeight(width: number): number {
  return Math.round(Math.min(isLow.value ? 190 : 250, Math.max(170, width * 0.36)));
}

export function Stage(props: {
  run: Recorded | null; of?: Scene; name: string; id?: string; draggable?: boolean; label?: string;
  periodic?: boolean; low?: boolean; hasKey?: boolean;
  hidesCases?: boolean; // which corrections the robots make
  time?: ReadonlySignal<number>; // of the carry, if it is not the player's
}) {
  const view = useRef<View | null>(null);
  const places = useRef<Float64Array | null>(null);
  const drag = useRef(signal<Drag | null>(null)).current;
  const box = useRef<HTMLDivElement>(null);

  useEffect(() => player.watch(box.current!), []);

  const draw = (surface: Surface) => {
    const machine = core.value;
    const { run } = props;
    if (!machine || !run || run.count === 0) return;
    const hasCones = showCones.value && run.phases.length === 0; // those of level pivots
    const of = props.of ?? scene.value;
    const period = Number(get(of, "control.period_s"));
    const time = (props.time ?? player.time).value;
    const row = rowAt(run, time, period);
    const at = machine.places(of, run, row);
    const p = palette.value;
    const facts = machine.facts(of);
    const level = facts.isJob ? facts.floor : lowestPoint(at);
    const absent = absentIn(run);
    const seen = absent === undefined ? at : withoutRobot(at, absent);
    view.current = viewOf(surface, seen, tiltOf(of), true, level);
    places.current = at;
    const held = drag.value;
    const shown = held ? moved(at, held) : at;
    const [theta, contact] = [pair(run, row, ROW.palm), pair(run, row, ROW.contact)];
    const ended = row === run.count - 1;
    drawSide(
      surface, view.current, p,
      {
        places: shown,
        blocks: facts.isJob ? blocksOf(of, tables.robot.body.top) : [],
        start: machine.places(of, run, 0)[PLACES.com],
        absent,
        touches: facts.isJob ? touchesAt(of, run, row) : undefined,
        motion: ended ? [0, 0] : pair(run, row, ROW.motion),
        tags: [0, 1].map((side) => (props.hidesCases ? "" : caseAt(run, row, side)))
          .map((c) => (c ? `(${c})` : "")) as [string, string],
        waits: [0, 1].map((side) => !props.hidesCases && isWaiting(run, row, side)) as [boolean, boolean],
        off: offAt(of, time),
        zones: zeroZone(of),
        flights: flightsAt(run, time, Number(get(of, "radio.latency_s")), props.periodic ?? false),
        cones: hasCones ? machine.statics(theta, contact).cones : undefined,
        gravity: hasCones,
        labels: surface.width > 480 && surface.height > 210,
        dropped: ended && run.outcome === 2,
      },
      level,
    );
  };

  const hit = (event: PointerEvent): Drag["what"] | null => {
    const v = view.current;
    const at = places.current;
    if (!v || !at) return null;
    const rect = (event.currentTarget as HTMLElement).getBoundingClientRect();
    const [x, y] = v.level(event.clientX - rect.left, event.clientY - rect.top);
    const { near, far } = tables.robot.body;
    for (const side of [0, 1] as const) {
      const outward = (side === 0 ? -1 : 1) * (v.worldX(x) - at[PLACES.pivot + 2 * side]!);
      if (near <= outward && outward <= far) return side;
    }
    let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
    for (let i = PLACES.outline; i < at.length; i += 2) {
      left = Math.min(left, v.x(at[i]!));
      right = Math.max(right, v.x(at[i]!));
      top = Math.min(top, v.y(at[i + 1]!));
      bottom = Math.max(bottom, v.y(at[i + 1]!));
    }
    const isOnIt = x >= left && x <= right && y >= top - 8 && y <= bottom + 8;
    return isOnIt && !isJob.peek() ? "object" : null; // a job on the floor has no bumps
  };

  return (
    <div ref={box} class="stage">
      <Canvas
        id={props.id}
        height={props.low ? lowHeight : stageHeight}
        draw={draw}
        class={props.draggable ? "drag" : undefined}
        label={props.label ?? `side view of the carry with the controller ${props.name}`}
        onPointerDown={
          props.draggable
            ? (event) => {
                const what = hit(event);
                if (what === null) return;
                player.pause();
                (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId);
                drag.value = { what, from: event.clientX, by: 0 };
              }
            : undefined
        }
        onPointerMove={(event) => {
          if (!drag.value || !view.current) return;
          const along = (event.clientX - drag.value.from) / Math.cos(view.current.tilt);
          const by = along / view.current.scale;
          drag.value = { ...drag.value, by: Math.min(0.06, Math.max(-0.06, by)) };
        }}
        onPointerUp={() => {
          const done = drag.value;
          drag.value = null;
          if (!done || Math.abs(done.by) < 0.001) return;
          if (done.what === "object") shiftObject(done.by);
          else pushRobot(done.what, done.what === 0 ? -done.by : done.by);
        }}
      />
      {props.hasKey && <PictureKey place={isJob.value ? "level" : tiltOf(props.of ?? scene.value) > 0 ? "at-right" : ""} />}
    </div>
  );
}

// What dots, arrows and wedges of the picture mean: in the upper corner that no robot reaches or, as the
// robots of a job on the floor are farther apart, in a row above them.
function PictureKey(props: { place: "" | "at-right" | "level" }) {
  return (
    <ul class={`picture-key ${props.place}`}>
      <li><i class="dot sticks" /> contact sticks</li>
      <li><i class="dot slides" /> slides along the arrow</li>
      <li><i class="dot com" /> centre of mass</li>
      <li><i class="dot hinge" /> hinge of a palm</li>
      {showCones.value && <li>wedge: friction cone</li>}
    </ul>
  );
}

// The points while something is dragged: only what the hand holds moves.
function moved(places: Float64Array, drag: Drag): Float64Array {
  const next = places.slice();
  if (drag.what === "object") {
    for (let i = PLACES.com; i < next.length; i += 2) next[i]! += drag.by;
  } else {
    for (const start of [PLACES.pivot, PLACES.inner, PLACES.outer]) {
      next[start + 2 * drag.what]! += drag.by;
    }
  }
  return next;
}

function now(): number {
  return Number(player.time.peek().toFixed(2));
}

// Millimetres are fine enough for a hand.
function rounded(metres: number): number {
  return Number(metres.toFixed(3));
}

// Moves the object along the palms: one contact outward, the other inward.
export function shiftObject(by: number): void {
  append("bumps.script", { robot: "left", at_s: now(), shift_m: rounded(-by) });
  append("bumps.script", { robot: "right", at_s: now(), shift_m: rounded(by) });
}

// Pushes a robot outward by this distance [m].
export function pushRobot(side: 0 | 1, outward: number): void {
  append("bumps.pushes", {
    robot: side === 0 ? "left" : "right", at_s: now(), duration_s: PUSH_S,
    speed_m_s: Number((outward / PUSH_S).toFixed(3)),
  });
}

