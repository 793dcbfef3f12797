// SPDX-License-Identifier: Apache-2.0
// Between the frame in which a scene states its outline and the world of a drawing.
import { PLACES } from "./core";
import { get } from "./scene_values";
import type { Scene } from "./tables";

export type Xy = [number, number];

interface ObjectTransform {
  toWorld: (point: Xy) => Xy;
  toScene: (point: Xy) => Xy;
}

export function objectTransform(scene: Scene, places: Float64Array): ObjectTransform {
  const vertices = get(scene, "object.vertices_m") as Xy[];
  const contacts = get(scene, "object.contacts") as [number, number];
  const [a, b] = [vertices[contacts[0]]!, vertices[contacts[1]]!];
  const origin: Xy = [places[PLACES.vertex]!, places[PLACES.vertex + 1]!];
  // The COM fixes the turn: it is placed by the core, and rarely lies on the contact.
  const com = get(scene, "object.com_m") as Xy;
  const inScene: Xy = [com[0] - a[0], com[1] - a[1]];
  const inWorld: Xy = [places[PLACES.com]! - origin[0], places[PLACES.com + 1]! - origin[1]];
  const size = inScene[0] ** 2 + inScene[1] ** 2 || (b[0] - a[0]) ** 2;
  const cos = (inScene[0] * inWorld[0] + inScene[1] * inWorld[1]) / size;
  const sin = (inScene[0] * inWorld[1] - inScene[1] * inWorld[0]) / size;
  return {
    toWorld: ([x, y]) => {
      const [dx, dy] = [x - a[0], y - a[1]];
      return [origin[0] + cos * dx - sin * dy, origin[1] + sin * dx + cos * dy];
    },
    toScene: ([x, y]) => {
      const [dx, dy] = [x - origin[0], y - origin[1]];
      return [a[0] + cos * dx + sin * dy, a[1] - sin * dx + cos * dy];
    },
  };
}
