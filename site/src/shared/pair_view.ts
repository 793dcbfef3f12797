// SPDX-License-Identifier: Apache-2.0
// From the world to the screen: a view that shows the whole pair on its floor.
//
// World coordinates are in metres, x along the floor and y away from it. A sloping floor turns the
// whole picture, so that gravity points down on the screen.
import type { Surface } from "./canvas";
import { PLACES } from "./core";
import { tables } from "./tables";

const { body, pivotHeight } = tables.robot;

export interface View {
  scale: number; // pixels per metre
  x: (worldX: number) => number;
  y: (worldY: number) => number;
  worldX: (pixel: number) => number;
  tilt: number; // of the floor: > 0 rises to the right [rad]
  turned: (x: number, y: number) => [number, number]; // to the screen, from pixels of a level floor
  level: (x: number, y: number) => [number, number]; // and back
}

export function lowestPoint(places: Float64Array): number {
  let low = -pivotHeight;
  for (let i = PLACES.outline + 1; i < places.length; i += 2) low = Math.min(low, places[i]! - 0.05);
  return low;
}

// The places of a job that one robot does alone: the other one counts as being at the object.
export function withoutRobot(places: Float64Array, side: number): Float64Array {
  const found = places.slice();
  const corners = (PLACES.outline - PLACES.plate) / 4;
  const points = [PLACES.pivot, PLACES.inner, PLACES.outer, PLACES.contact].map((start) => start + 2 * side);
  for (let k = 0; k < corners; ++k) points.push(PLACES.plate + 2 * (side * corners + k));
  for (const at of points) found.set(places.subarray(PLACES.com, PLACES.com + 2), at);
  return found;
}

// A view that shows the whole pair, centred on it, on a floor with this tilt and height.
export function viewOf(
  surface: Surface, places: Float64Array, tilt = 0, robots = true, level = lowestPoint(places),
): View {
  const middle = (places[PLACES.pivot]! + places[PLACES.pivot + 2]!) / 2;
  let half = 0;
  let top = 0;
  for (let i = 0; i < places.length; i += 2) {
    half = Math.max(half, Math.abs(places[i]! - middle));
    top = Math.max(top, places[i + 1]!);
  }
  const margin = robots ? body.far + 0.1 : 0.06;
  const bottom = robots ? level : -0.1;
  const wide = 2 * (half + (robots ? Math.max(0, margin - 0.075) : margin));
  const tall = top - bottom + (robots ? 0.1 : 0.12);
  const [sine, cosine] = [Math.sin(tilt), Math.cos(tilt)];
  const lean = Math.abs(sine);
  const scale = Math.min(
    surface.width / (wide * cosine + tall * lean), surface.height / (tall * cosine + wide * lean),
  );
  const base = surface.height - (robots ? 26 : 20) - (wide / 2) * scale * lean;
  const centre = surface.width / 2;
  const turn = (x: number, y: number, s: number): [number, number] => [
    centre + (x - centre) * cosine + (y - base) * s, base - (x - centre) * s + (y - base) * cosine,
  ];
  return {
    scale,
    x: (worldX) => centre + (worldX - middle) * scale,
    y: (worldY) => base - (worldY - bottom) * scale,
    worldX: (pixel) => middle + (pixel - centre) / scale,
    tilt,
    turned: (x, y) => turn(x, y, sine),
    level: (x, y) => turn(x, y, -sine),
  };
}

// Draws in pixels of a level floor, and turns them as the floor is tilted.
export function onFloor(surface: Surface, view: View, draw: () => void): void {
  const c = surface.context;
  const [x, y] = view.turned(0, 0);
  c.save();
  c.translate(x, y);
  c.rotate(-view.tilt);
  draw();
  c.restore();
}
