// SPDX-License-Identifier: Apache-2.0
// Values of a scene, by the names of their keys.
import type { Json, Scene } from "./tables";

export type Overrides = Record<string, Json>;

export const short = (value: number) => String(Number(value.toPrecision(6)));

// The value of a key; an index of a list stands in brackets.
export function get(scene: Json, key: string): Json | undefined {
  let at: Json | undefined = scene;
  for (const part of key.split(/\.|(?=\[)/)) {
    if (part.startsWith("[")) {
      at = (at as Json[] | undefined)?.[Number(part.slice(1, -1))];
      continue;
    }
    if (typeof at !== "object" || Array.isArray(at)) return undefined;
    at = at[part];
  }
  return at;
}

// A key of one side: its own value, or that of both.
export function ofSide(scene: Scene, section: string, side: string, name: string): number {
  return (get(scene, `${section}.${side}.${name}`) ?? get(scene, `${section}.${name}`)) as number;
}
