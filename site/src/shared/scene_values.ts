// SPDX-License-Identifier: Apache-2.0
// Values of a scene, by the names of their keys.
import type { Json, Scene } from "./tables";

export type Overrides = Record<string, Json>;

export function get(scene: Json, key: string): Json | undefined {
  let at: Json | undefined = scene;
  for (const part of key.split(".")) {
    if (typeof at !== "object" || Array.isArray(at)) return undefined;
    at = at[part];
  }
  return at;
}

// A key of one side: its own value, or that of both.
export function ofSide(scene: Scene, section: string, side: string, name: string): number {
  return (get(scene, `${section}.${side}.${name}`) ?? get(scene, `${section}.${name}`)) as number;
}
