// SPDX-License-Identifier: Apache-2.0
// Handles of the view Mechanics for the shape of what touches: the arc at the highest corner on the
// right, the section of the left palm, and where palms on a floor are.
import type { Handle } from "./handles";
import { isAlone, raised, setDriven, setRaised } from "./mechanics_state";
import { setShape, shape } from "./mechanics_shape";
import { PLACES } from "../shared/core";
import type { Xy } from "../shared/object_transform";
import type { View } from "../shared/pair_view";
import { SIDES } from "../shared/tables";

const APART = 15; // of a handle from what it changes [px]
const FINE = 4; // how far a handle of a thickness moves for a millimetre [px]

const unit = ([x, y]: Xy): Xy => [x / Math.hypot(x, y), y / Math.hypot(x, y)];
const dot = (a: Xy, b: Xy) => a[0] * b[0] + a[1] * b[1];

// The radius of the edges: at the centre of an arc, which lies on the bisector of a corner. `corners`
// are those of the object as edges without arcs meet, in pixels.
export function radiusHandle(at: View, corners: Xy[]): Handle[] {
  const k = corners.reduce((best, [x, y], i) => (x - y > corners[best]![0] - corners[best]![1] ? i : best), 0);
  const corner = corners[k]!;
  const toward = (other: Xy) => unit([other[0] - corner[0], other[1] - corner[1]]);
  const [a, b] = [corners[(k + corners.length - 1) % corners.length]!, corners[(k + 1) % corners.length]!].map(toward) as [Xy, Xy];
  const inside = unit([a[0] + b[0], a[1] + b[1]]);
  const sine = Math.abs(a[0] * inside[1] - a[1] * inside[0]); // of half the angle of the corner
  const away = (shape.value["object.edge_radius_m"] * at.scale) / sine + 1.6 * APART;
  return [{
    id: "edge-radius", kind: "shape", label: "radius of the object's edges",
    x: corner[0] + inside[0] * away, y: corner[1] + inside[1] * away,
    move: (x, y) => {
      const along = dot([x - corner[0], y - corner[1]], inside) - 1.6 * APART;
      setShape("object.edge_radius_m", Math.round((2000 * Math.max(0, along) * sine) / at.scale) / 2000);
    },
  }];
}

// Thickness, nose, bevel and heel of both palms, at the left one.
export function palmHandles(at: View, places: Float64Array): Handle[] {
  const point = (start: number): Xy => [at.x(places[start]!), at.y(places[start + 1]!)];
  const [inner, outer] = [point(PLACES.inner), point(PLACES.outer)];
  const out = unit([outer[0] - inner[0], outer[1] - inner[1]]);
  const down: Xy = [out[1], -out[0]]; // on the screen, below the left palm
  const s = shape.value;
  const handle = (
    id: string, label: string, from: Xy, along: number, below: number, change: (along: number, below: number) => void,
  ): Handle => ({
    id, kind: "shape", label: `${label}, of both palms`,
    x: from[0] + out[0] * along + down[0] * below, y: from[1] + out[1] * along + down[1] * below,
    move: (x, y) => {
      const by: Xy = [x - from[0], y - from[1]];
      change(dot(by, out), dot(by, down));
    },
  });
  const pixels = 1000 * FINE;
  const fine = (px: number) => Math.round((10 * Math.max(0, px)) / FINE) / 1e4;
  const half = (px: number) => Math.round((2000 * Math.max(0, px)) / at.scale) / 2000;
  const thick = APART + s["palm.thickness_m"] * pixels;
  const length = Math.hypot(outer[0] - inner[0], outer[1] - inner[1]);
  const list = [
    handle("thickness", "thickness", inner, 0.7 * length, thick,
      (_, below) => setShape("palm.thickness_m", fine(below - APART))),
    handle("heel", "height of the heel", outer, 2, -APART - s["palm.heel_m"] * at.scale,
      (_, below) => setShape("palm.heel_m", half(-below - APART))),
  ];
  if (s["palm.thickness_m"] === 0) return list;
  return [
    ...list,
    handle("nose", "thickness of the nose", inner, -APART, s["palm.nose_m"] * pixels,
      (_, below) => setShape("palm.nose_m", fine(below))),
    handle("bevel", "length of the bevel", inner, 10 + s["palm.bevel_m"] * at.scale, thick,
      (along) => setShape("palm.bevel_m", half(along - 10))),
  ];
}

// At each pivot, one that drives its palm along the floor; above the left one, one that raises both.
export function driveHandles(at: View, places: Float64Array, starts: Xy): Handle[] {
  const pivot = (side: 0 | 1): Xy => [places[PLACES.pivot + 2 * side]!, places[PLACES.pivot + 2 * side + 1]!];
  const drives = (isAlone.value ? [0] as const : [0, 1] as const).map((side): Handle => {
    const inward = side === 0 ? 1 : -1;
    const [x, y] = pivot(side);
    return {
      id: `drive-${SIDES[side]}`, kind: "contact", label: `drive of the ${SIDES[side]} palm along the floor`,
      x: at.x(x), y: at.y(y),
      move: (px) => setDriven(side, 1000 * inward * (at.worldX(px) - starts[side]!)),
    };
  });
  const [x, y] = pivot(0);
  const from = at.y(y) - 26;
  return [...drives, {
    id: "raise", kind: "shape", label: isAlone.value ? "rise of the palm" : "rise of both palms", x: at.x(x), y: from,
    move: (_, py) => setRaised(raised.peek() + (1000 * (from - py)) / at.scale),
  }];
}
