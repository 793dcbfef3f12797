// SPDX-License-Identifier: Apache-2.0
// Scenes: nested tables as in a scene file, overrides by dotted key, and the values for the core,
// which converts and checks them. Defaults and limits come from the package.
import type { Core, SceneFacts } from "./core";
import { checkShape, refuse } from "./scene_shape";
import { PAPER, type Overrides, builtInScene, get, short } from "./scene_values";
import { type Json, type Scene, tables } from "./tables";

function set(scene: Scene, key: string, value: Json): void {
  const parts = key.split(".");
  let at: { [key: string]: Json } = scene;
  for (const part of parts.slice(0, -1)) {
    const next = at[part];
    at[part] = typeof next === "object" && !Array.isArray(next) ? { ...next } : {};
    at = at[part] as { [key: string]: Json };
  }
  at[parts.at(-1)!] = value;
}

// Of a friction coefficient and a friction angle, the one that an override sets replaces the other.
const INSTEAD: Record<string, string> = {
  friction: "friction_angle_deg", friction_angle_deg: "friction",
};

// The scene of a built-in name with overrides on top. `object` may be the name of an object.
export function sceneOf(name: string, overrides: Overrides): Scene {
  const scene = structuredClone(builtInScene(name));
  for (const [key, value] of Object.entries(overrides)) {
    const named = key === "object" && tables.objects.find((o) => o.name === value)?.object;
    set(scene, key, named ? structuredClone(named) : value);
    const instead = key.startsWith("palm.") && INSTEAD[key.slice(key.lastIndexOf(".") + 1)];
    if (!instead) continue;
    const table = key.slice(0, key.lastIndexOf("."));
    if (!(`${table}.${instead}` in overrides)) delete (get(scene, table) as Scene)[instead];
  }
  return scene;
}

// What the built-in scene and the overrides set apart from the scene `paper`, which a scene file builds on.
export function fromPaper(name: string, overrides: Overrides): Overrides {
  const found: Overrides = {};
  for (const [section, keys] of Object.entries(builtInScene(name))) {
    if (section === "object" && "object" in overrides) continue;
    for (const [key, value] of Object.entries(keys as Record<string, Json>)) {
      if (JSON.stringify(get(PAPER, `${section}.${key}`)) !== JSON.stringify(value)) {
        found[`${section}.${key}`] = value;
      }
    }
  }
  return { ...found, ...overrides };
}

// All leaves of a table by dotted key; a list is one leaf.
function leaves(table: Json, prefix = ""): [string, Json][] {
  if (typeof table !== "object" || Array.isArray(table)) return [[prefix, table]];
  return Object.entries(table).flatMap(([key, value]) =>
    leaves(value, prefix ? `${prefix}.${key}` : key),
  );
}

// The parsed file as JSON has it: no whole numbers of their own kind.
function plain(value: unknown): Json {
  if (typeof value === "bigint") return Number(value);
  if (Array.isArray(value)) return value.map(plain);
  if (typeof value !== "object" || value === null) return value as Json;
  return Object.fromEntries(Object.entries(value).map(([key, entry]) => [key, plain(entry)]));
}

// A scene with the outline of its object.box_m, and without a first vertex repeated at the end: an
// outline closes itself.
function outlined(scene: Scene): Scene {
  const { box_m: box, ...object } = (scene.object ?? {}) as Scene;
  if (box !== undefined) {
    if (object.vertices_m) refuse("object.box_m", box, "is given beside vertices_m", "one of the two");
    const [length, height] = box as number[];
    object.vertices_m = [[0, 0], [length, 0], [length, height], [0, height]];
  }
  const vertices = object.vertices_m as number[][] | undefined;
  const isClosed = vertices && vertices.length > 3
    && JSON.stringify(vertices[0]) === JSON.stringify(vertices.at(-1));
  if (isClosed) object.vertices_m = vertices.slice(0, -1);
  return scene.object ? { ...scene, object } : scene;
}

// The overrides that turn the scene `paper` into the one of a scene file; `hasBigints`: its whole
// numbers are bigints. Throws an Error with one line for a person.
export function overridesOf(
  core: Core, file: Record<string, unknown>, hasBigints = false,
): Overrides {
  const { object: named, ...others } = file;
  const known = tables.objects.find((o) => o.name === named);
  if (typeof named === "string" && !known) {
    const names = tables.objects.map((o) => o.name).join(", ");
    refuse("object", named, "is no built-in object", `a table, or one of ${names}`);
  }
  checkShape("", known ? others : file, tables.rules, hasBigints);
  const given = outlined(plain(known ? { ...others, object: known.object } : file) as Scene);
  core.check(given);
  const found: Overrides = known ? { object: known.name } : {};
  if (known) delete given.object;
  else if (get(given, "object.vertices_m")) {
    const { contacts, com } = core.object(given);
    given.object = { contacts, com_m: com, ...(given.object as Scene) };
  }
  for (const [key, value] of leaves(given)) {
    if (JSON.stringify(get(PAPER, key)) !== JSON.stringify(value)) found[key] = value;
  }
  return found;
}

// Refuses what the page does not carry, a curved path and more time than it records, and a ridge that
// the package refuses in the section of its other world.
export function checkPage(scene: Scene, facts: SceneFacts): void {
  for (const [key, value] of Object.entries((get(scene, "task.path") ?? {}) as Scene)) {
    if (key === "kind" && value === "straight") continue;
    refuse(
      `task.path.${key}`, value, "does not belong to a straight path, but the page is planar",
      "a straight path here, or palmbots carry scene.toml --world mujoco on your computer",
    );
  }
  ((get(scene, "mujoco.ridges") ?? []) as Scene[]).forEach((ridge, k) => {
    const [height, length] = [ridge.height_m as number, (ridge.length_m ?? 0.05) as number];
    if (length >= 2 * height) return;
    refuse(
      `mujoco.ridges[${k}].length_m`, length, `is less than twice height_m, which is ${height}`,
      `a number in m, from ${2 * height} to 10 (a flat arc)`,
    );
  });
  const most = facts.longestTimeout;
  if (most === 0) return;
  const onPage = `the page carries for at most ${short(most)} s`;
  const given = get(scene, "task.timeout_s");
  if (given !== undefined) {
    refuse(
      "task.timeout_s", given, `is too long: ${onPage}`,
      `at most ${short(most)} s here, or palmbots carry on your computer`,
    );
  }
  const distance = get(scene, "task.distance_m") as number;
  const room = Math.floor((1000 * distance * most) / facts.timeout + 1e-6) / 1000;
  refuse(
    "task.distance_m", distance, `leads to a time limit of ${short(facts.timeout)} s, but ${onPage}`,
    `about ${short(room)} m here at this speed, a faster robot, or palmbots carry on your computer`,
  );
}
