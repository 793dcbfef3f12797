// SPDX-License-Identifier: Apache-2.0
// Values of a scene, by the names of their keys.
import { type Json, SENDERS, type Scene, tables } from "./tables";

export type Overrides = Record<string, Json>;

export const PAPER = tables.scenes.find((s) => s.name === "paper")!.scene;

export function builtInScene(name: string): Scene {
  return tables.scenes.find((s) => s.name === name)?.scene ?? PAPER;
}

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

// The tilt of the floor: > 0 rises to the right, towards +x [rad]. The scene counts uphill in travel.
export function tiltOf(scene: Scene): number {
  const uphill = (Number(get(scene, "task.slope_deg")) * Math.PI) / 180;
  return get(scene, "task.direction") === "backward" ? -uphill : uphill;
}

// The values of a scene for the core, by key: a line for each value, and two numbers, its place and
// the value (site/core/page_scene.cpp reads them).
export function entriesOf(scene: Scene): { lines: string[]; numbers: number[] } {
  const lines: string[] = [];
  const numbers: number[] = [];
  const put = (line: string, place: number, value: number) => {
    lines.push(line);
    numbers.push(place, value);
  };
  const walk = (value: Json, path: string, place: number): void => {
    if (Array.isArray(value)) {
      put(`${path}#`, 0, value.length);
      value.forEach((item, k) => {
        if (typeof item === "object") walk(item, `${path}[]`, k);
        else walk(item, `${path}[${k}]`, place);
      });
    } else if (typeof value === "object") {
      for (const [key, inner] of Object.entries(value)) {
        const holder = SENDERS.indexOf(key as "station");
        if (holder >= 0 && typeof inner === "object") walk(inner, path, 1 + holder);
        else walk(inner, path ? `${path}.${key}` : key, place);
      }
    } else if (typeof value === "string") {
      put(`${path}=${value}`, place, 0);
    } else {
      put(path, place, Number(value));
    }
  };
  for (const [section, table] of Object.entries(scene)) walk(table, section, 0);
  return { lines, numbers };
}
