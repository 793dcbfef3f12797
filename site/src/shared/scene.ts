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

// Removes the keys that an override has made obsolete.
function removeObsolete(scene: Scene, overrides: Overrides): void {
  for (const [table, rules] of Object.entries(tables.supersedes)) {
    for (const [rule, others] of Object.entries(rules)) {
      const [key, value] = rule.split("=");
      const given = overrides[`${table}.${key}`];
      if (given === undefined || (value !== undefined && given !== value)) continue;
      const keys = get(scene, table) as Scene;
      for (const other of others) if (!(`${table}.${other}` in overrides)) delete keys[other];
    }
  }
}

// The scene of a built-in name with overrides on top. `object` may be the name of an object.
export function sceneOf(name: string, overrides: Overrides): Scene {
  const scene = structuredClone(builtInScene(name));
  for (const [key, value] of Object.entries(overrides)) {
    const named = key === "object" && tables.objects.find((o) => o.name === value)?.object;
    set(scene, key, named ? structuredClone(named) : value);
  }
  removeObsolete(scene, overrides);
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

// The scene with the outline, the contacts and the centre of mass of its object. The core finds them
// where the scene leaves some of them out.
export function withOutline(core: Core, scene: Scene): Scene {
  const { box_m: box, ...given } = (scene.object ?? {}) as Scene;
  const { vertices_m: vertices, contacts, com_m: com } = given;
  if ((!box && !vertices) || (vertices && contacts && com)) return scene;
  if (box && vertices) core.check(scene); // refuses it
  const found = core.object(scene);
  const object = { contacts: found.contacts, com_m: found.com, ...given, vertices_m: found.vertices };
  return { ...scene, object };
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
  const whole = plain(known ? { ...others, object: known.object } : file) as Scene;
  core.check(whole);
  const found: Overrides = known ? { object: known.name } : {};
  const given = withOutline(core, whole);
  if (known) delete given.object;
  for (const [key, value] of leaves(given)) {
    if (JSON.stringify(get(PAPER, key)) !== JSON.stringify(value)) found[key] = value;
  }
  return found;
}

// Refuses what the page does not carry: walls and stands, a curved path and more time than it records.
export function checkPage(scene: Scene, facts: SceneFacts): void {
  for (const key of facts.isJob ? [] : ["floor.walls", "floor.stands"]) {
    const given = (get(scene, key) ?? []) as Json[];
    if (given.length === 0) continue;
    refuse(
      key, given, "are on a floor, but this carry has none", "none, or a job on the floor",
    );
  }
  for (const [key, value] of Object.entries((get(scene, "task.path") ?? {}) as Scene)) {
    if (key === "kind" && value === "straight") continue;
    refuse(
      `task.path.${key}`, value, "does not belong to a straight path, but the page is planar",
      "a straight path here, or palmbots carry scene.toml --world mujoco on your computer",
    );
  }
  for (const [key, value] of leaves(scene)) {
    if (!key.endsWith("trace")) continue;
    refuse(
      key, value, "is a recording, but the page reads no files",
      "no recording here, or palmbots carry scene.toml on your computer",
    );
  }
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
