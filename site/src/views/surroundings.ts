// SPDX-License-Identifier: Apache-2.0
// Walls and stands of the view Mechanics: one wall on the right in place of the right palm, or one stand
// below the object. Their places count from the COM of the object at its start [m].
import { batch, computed } from "@preact/signals";
import type { Handle } from "./handles";
import { setIfAllowed } from "./mechanics_shape";
import { isAlone, touched } from "./mechanics_state";
import { senseOf, standsOf, wallsOf } from "../shared/blocks";
import type { View } from "../shared/pair_view";
import { get } from "../shared/scene_values";
import { core, overrides, scene, setExtra, setExtraFlag } from "../shared/state";
import type { Json } from "../shared/tables";

export const KINDS = ["alone", "with a wall", "on a stand"] as const;
export type Kind = (typeof KINDS)[number];

const fine = (metres: number) => Number(metres.toFixed(3));
const listed = (key: string) => (get(scene.value, key) ?? []) as { [name: string]: number }[];
const sense = () => senseOf(scene.value);
const walls = computed(() => wallsOf(scene.value));
const stands = computed(() => standsOf(scene.value));
export const kind = computed((): Kind =>
  walls.value.length > 0 ? "with a wall" : stands.value.length > 0 ? "on a stand" : "alone");

// The same list with other values of the first entry.
function change(key: string, values: { [name: string]: number }): void {
  const [first, ...rest] = listed(key);
  setIfAllowed(
    { ...overrides.peek(), [key]: [{ ...first, ...values }, ...rest] as Json }, () => touched.peek()?.problem ?? "",
  );
}

function setStand(from: number, to: number, height: number): void {
  const [low, high] = sense() > 0 ? [from, to] : [-to, -from];
  change("floor.stands", { from_m: fine(low), to_m: fine(high), height_m: Math.max(0.001, fine(height)) });
}

// A wall 5 mm beside the object, or a stand below it that is 5 mm wider on each side.
export function choose(chosen: Kind): void {
  const { vertices, com } = core.peek()!.object(scene.peek());
  const [low, high] = [Math.min, Math.max].map((most) => most(...vertices.map(([x]) => x! - com[0]))) as [number, number];
  const { "floor.walls": _walls, "floor.stands": _stands, ...next } = overrides.peek();
  if (chosen === "with a wall") next["floor.walls"] = [{ at_m: fine(sense() * (high + 0.005)), height_m: 0.12 }];
  if (chosen === "on a stand") {
    const ends = [low - 0.005, high + 0.005].map((x) => fine(sense() * x)).sort((a, b) => a - b);
    next["floor.stands"] = [{ from_m: ends[0]!, to_m: ends[1]!, height_m: 0.05 }];
  }
  batch(() => {
    overrides.value = next;
    setExtraFlag("alone", chosen === "with a wall");
    for (const name of ["dl", "dr", "up"]) setExtra(name, "", "");
  });
}

// At the upper edge of the wall, and at both upper edges of the stand.
export function surroundingHandles(at: View): Handle[] {
  const height = (y: number) => (at.y(0) - y) / at.scale;
  const corner = (id: string, label: string, x: number, y: number, move: (x: number, y: number) => void): Handle => ({
    id, label, kind: "corner", x: at.x(x), y: at.y(y), move: (px, py) => move(at.worldX(px), height(py)),
  });
  const [wall] = walls.value;
  const [stand] = stands.value;
  return [
    ...(wall && isAlone.value ? [corner("wall", "place and height of the wall", wall.from, wall.height, (x, y) =>
      change("floor.walls", { at_m: fine(sense() * x), height_m: Math.max(0.001, fine(y)) }))] : []),
    ...(stand ? [
      corner("stand-left", "left end and height of the stand", stand.from, stand.height, (x, y) => setStand(x, stand.to, y)),
      corner("stand-right", "right end and height of the stand", stand.to, stand.height, (x, y) => setStand(stand.from, x, y)),
    ] : []),
  ];
}
