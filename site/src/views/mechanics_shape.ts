// SPDX-License-Identifier: Apache-2.0
// The shape of what touches: radius of the object's edges, and the section of the palms. A change that
// the core refuses goes as far as the core permits, and the view shows the refusal.
import { batch, computed, signal } from "@preact/signals";
import type { Overrides } from "../shared/scene_values";
import { sceneOf, withOutline } from "../shared/scene";
import { get } from "../shared/scene_values";
import { checkShape } from "../shared/scene_shape";
import { base, core, overrides, scene, setForAll, valuesOf } from "../shared/state";

export const SHAPES = [
  { key: "object.edge_radius_m", id: "edge-radius", label: "edge radius", step: 0.5 },
  { key: "palm.thickness_m", id: "thickness", label: "palm thickness", step: 0.1 },
  { key: "palm.nose_m", id: "nose", label: "nose", step: 0.1 },
  { key: "palm.bevel_m", id: "bevel", label: "bevel", step: 0.5 },
  { key: "palm.heel_m", id: "heel", label: "heel", step: 0.5 },
] as const;
export type ShapeKey = (typeof SHAPES)[number]["key"];

const USUAL_BEVEL = 0.008; // where a nose is made thinner than a palm without a bevel [m]

// Of each key, the value on the left palm, or the largest of the radii [m].
export const shape = computed(() => {
  const radii = get(scene.value, "object.edge_radius_m") ?? 0;
  const found = Object.fromEntries(SHAPES.map(({ key }) => [key, valuesOf(key)[0] || 0])) as Record<ShapeKey, number>;
  found["object.edge_radius_m"] = Array.isArray(radii) ? Math.max(...(radii as number[])) : Number(radii);
  const thick = found["palm.thickness_m"];
  const nose = valuesOf("palm.nose_m")[0]!;
  found["palm.nose_m"] = Number.isFinite(nose) ? Math.min(nose, thick) : thick;
  return found;
});

// Why the last change was cut or refused, in one line; empty: it was not, or something changed since.
const cut = signal<{ why: string; overrides: Overrides }>({ why: "", overrides: {} });
export const refused = computed(() => (cut.value.overrides === overrides.value ? cut.value.why : ""));

// Why the core refuses the built-in scene with these overrides; empty: it does not.
function refusalWith(changes: Overrides): string {
  try {
    const merged = sceneOf(base.peek(), changes);
    checkShape("", merged);
    core.peek()?.check(withOutline(core.peek()!, merged));
  } catch (error) {
    return (error as Error).message;
  }
  return "";
}

// Takes these overrides unless the core refuses them, or there is a problem with them then.
export function setIfAllowed(next: Overrides, problem: () => string = () => ""): void {
  const before = overrides.peek();
  let why = refusalWith(next);
  if (!why) {
    overrides.value = next;
    why = problem();
  }
  if (!why) return;
  overrides.value = before;
  cut.value = { why, overrides: before };
}

function tried(key: ShapeKey, metres: number): string {
  const value = Number(metres.toFixed(6));
  const withBevel = key === "palm.nose_m" && value < shape.peek()["palm.thickness_m"] && shape.peek()["palm.bevel_m"] === 0;
  batch(() => {
    setForAll(key, value);
    if (withBevel) setForAll("palm.bevel_m", USUAL_BEVEL);
  });
  return refusalWith(overrides.peek());
}

// Sets a value for both palms, or for all edges [m].
export function setShape(key: ShapeKey, metres: number): void {
  if (!Number.isFinite(metres)) return;
  const before = overrides.peek();
  const from = shape.peek()[key];
  batch(() => {
    const attempt = (value: number) => {
      overrides.value = before;
      return tried(key, value);
    };
    const why = attempt(metres);
    if (!why) return;
    let [good, bad] = [from, metres];
    for (let k = 0; k < 24; ++k) {
      const middle = (good + bad) / 2;
      if (attempt(middle)) bad = middle;
      else good = middle;
    }
    // In whole tenths of a millimetre, towards the value that was there.
    const sense = Math.sign(metres - from);
    const tenths = sense * Math.floor(sense * good * 1e4 + 1e-3);
    const isMore = (value: number) => sense * (value - from) > 5e-5;
    if ([tenths, tenths - sense].every((n) => !isMore(n / 1e4) || attempt(n / 1e4))) overrides.value = before;
    cut.value = { why, overrides: overrides.peek() };
  });
}
