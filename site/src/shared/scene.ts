// SPDX-License-Identifier: Apache-2.0
// Scenes: nested tables as in a scene file, overrides by dotted key, and the numbers for the core.
//
// The core converts the numbers (site/core/scene_stream.hpp reads them in this order). Defaults and
// limits come from the package.
import { type Point, areaAndCentroid } from "./outline";
import { checkFrictionIsGivenOnce, checkMassOf, checkOutline } from "./scene_check";
import { checkShape, refuse } from "./scene_shape";
import { type Overrides, get, ofSide } from "./scene_values";
import { type Json, SENDERS, type Scene, SIDES, tables } from "./tables";

const PAPER = tables.scenes.find((s) => s.name === "paper")!.scene;

export function builtInScene(name: string): Scene {
  return tables.scenes.find((s) => s.name === name)?.scene ?? PAPER;
}

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

function number(scene: Json, key: string): number {
  return get(scene, key) as number;
}

function list(scene: Json, key: string): { [key: string]: Json }[] {
  return (get(scene, key) ?? []) as { [key: string]: Json }[];
}

const EFFECTS = ["lost", "delayed", "duplicated"];
const SIGNS: Record<string, number> = { "-": -1, "0": 0, "+": 1 };
const PALM = ["shallow_deg", "steep_deg", "rate_deg_s"];
const ROBOT = [
  "speed_m_s", "correction_m_s", "acceleration_m_s2", "max_speed_m_s", "noise_m_s", "noise_tau_s",
  "bias_m_s", "clock_ppm",
];

const LINK = ["latency_s", "jitter_s", "loss"];

// The control periods of the scene between two steps of a robot's program.
function stride(scene: Scene, side: string): number {
  const own = ofSide(scene, "robot", side, "period_s") as number | undefined;
  return own === undefined ? 1 : Math.round(own / number(scene, "control.period_s"));
}

// The last two numbers of a fault: its probability, rate, jump or angle, and what a reboot does besides.
function faultValue(fault: { [key: string]: Json }): number[] {
  const jump = fault.kind === "clock-jump" ? fault.duration_s : 0;
  const value = fault.probability ?? fault.ppm ?? fault.limp_deg ?? jump;
  const marks = (fault.loses_boot_counter ? 1 : 0) + (fault.limp_deg === undefined ? 0 : 2);
  return [value as number, marks];
}

// The friction coefficient of a palm, and the angle in its place or NaN; the core takes its tangent.
function friction(scene: Scene, side: string): number[] {
  const own = get(scene, `palm.${side}.friction`) as number | undefined;
  const ownAngle = get(scene, `palm.${side}.friction_angle_deg`) as number | undefined;
  const angle = ownAngle ?? (own === undefined ? get(scene, "palm.friction_angle_deg") : undefined);
  return [own ?? number(scene, "palm.friction") ?? NaN, (angle as number | undefined) ?? NaN];
}

const place = (side: Json | undefined) => Math.max(0, SENDERS.indexOf(side as "station"));
// A link, as the core numbers them: from each robot, then from the station to each robot.
const link = (m: { [key: string]: Json }) =>
  m.sender === "station" ? 2 + place(m.receiver) : place(m.sender);
const counted = (rows: number[][]) => [rows.length, ...rows.flat()];

function zones(scene: Scene): number[] {
  const given = get(scene, "tactile.zones") as { [key: string]: Json }[] | undefined;
  if (given) {
    return counted(
      given.map((z) => [SIGNS[z.sign as string]!, z.from_m as number, z.to_m as number]),
    );
  }
  const half = number(scene, "tactile.zero_half_width_m");
  return counted([
    [-1, -Infinity, -half],
    [0, -half, half],
    [1, half, Infinity],
  ]);
}

// The numbers of a scene for the core.
export function sceneNumbers(scene: Scene): number[] {
  const vertices = get(scene, "object.vertices_m") as number[][];
  const n = (key: string) => number(scene, key);
  const flag = (key: string) => (get(scene, key) ? 1 : 0);
  return [
    ...counted(vertices),
    ...(get(scene, "object.contacts") as number[]),
    ...(get(scene, "object.com_m") as number[]),
    ...SIDES.flatMap((side) => [
      ofSide(scene, "palm", side, "length_m"), ofSide(scene, "palm", side, "pivot_offset_m"),
      ...friction(scene, side), ...PALM.map((name) => ofSide(scene, "palm", side, name)),
    ]),
    ...SIDES.flatMap((side) => [
      ...ROBOT.map((name) => ofSide(scene, "robot", side, name)), stride(scene, side),
    ]),
    ...zones(scene),
    n("tactile.false_rate"),
    n("control.period_s"),
    flag("control.brake"),
    get(scene, "control.start") === "touch" ? 1 : 0,
    n("control.watchdog_s"),
    n("radio.latency_s"), n("radio.jitter_s"), n("radio.loss"), n("radio.duplicate"),
    n("radio.corruption"),
    flag("radio.reorder"),
    flag("radio.sessions"),
    n("radio.burst_fraction"), n("radio.burst_s"), n("radio.airtime_s"), n("radio.beacon_s"),
    (get(scene, "radio.lease_s") as number | undefined) ?? 0,
    ...counted(
      list(scene, "radio.outages").map((o) => [
        place(o.sender), o.start_s as number, o.end_s as number,
      ]),
    ),
    ...counted(
      list(scene, "radio.script").map((m) => [
        link(m), m.message as number, EFFECTS.indexOf(m.effect as string),
        (m.delay_s as number | undefined) ?? 0,
      ]),
    ),
    ...SENDERS.flatMap((sender) =>
      LINK.map((name) => (get(scene, `radio.${sender}.${name}`) as number | undefined) ?? -1),
    ),
    n("radio.replay"), n("radio.replay_within_s"),
    ...counted(
      list(scene, "faults.script").map((f) => [
        tables.faultKinds.indexOf(f.kind as string), place(f.robot), f.at_s as number,
        f.duration_s as number, SIGNS[(f.stuck_at as string | undefined) ?? "0"]!,
        ...faultValue(f),
      ]),
    ),
    n("faults.random_reboots"),
    n("faults.reboot_s"),
    ...counted(
      list(scene, "bumps.script").map((b) => [
        place(b.robot), b.at_s === undefined ? 0 : 1, (b.at_s ?? b.at_m ?? 0) as number,
        b.shift_m as number,
      ]),
    ),
    ...counted(
      list(scene, "bumps.pushes").map((p) => [
        place(p.robot), p.at_s as number, p.duration_s as number, p.speed_m_s as number,
      ]),
    ),
    n("bumps.rate_per_m"), n("bumps.max_shift_m"),
    n("start.left_m"), n("start.right_m"),
    n("task.distance_m"),
    get(scene, "task.direction") === "backward" ? -1 : 1,
    n("task.slope_deg"),
    flag("task.inertia"),
    n("task.inertia_tau_s"),
    (get(scene, "task.timeout_s") as number | undefined) ?? NaN,
  ];
}

// All leaves of a table by dotted key; a list is one leaf.
function leaves(table: Json, prefix = ""): [string, Json][] {
  if (typeof table !== "object" || Array.isArray(table)) return [[prefix, table]];
  return Object.entries(table).flatMap(([key, value]) =>
    leaves(value, prefix ? `${prefix}.${key}` : key),
  );
}

// What an outline without contacts or COM has: the ends of its level lower side, and its centroid.
function completed(object: { [key: string]: Json }): { [key: string]: Json } {
  const outline = object.vertices_m as unknown as Point[] | undefined;
  if (!outline) return object;
  checkOutline(outline);
  const filled = { ...object };
  if (!filled.contacts) {
    const low = Math.min(...outline.map((v) => v[1])) + tables.rules.levelWithin;
    const lowest = outline.map((_, k) => k).filter((k) => outline[k]![1] <= low);
    if (lowest.length < 2) {
      refuse(
        "object.contacts", null,
        `is not set, and the outline has no level lower side: vertex ${lowest[0]} alone is lowest`,
        "[left, right], two indices into object.vertices_m",
      );
    }
    lowest.sort((a, b) => outline[a]![0] - outline[b]![0]);
    filled.contacts = [lowest[0]!, lowest.at(-1)!];
  }
  if (!filled.com_m) {
    filled.com_m = areaAndCentroid(outline)[1].map((value) => Number(value.toFixed(12)));
  }
  if (!filled.mass_kg) checkMassOf(outline, number({ object }, "object.depth_m") ?? DEPTH);
  return filled;
}

const DEPTH = number(PAPER, "object.depth_m");

// The parsed file as JSON has it: no whole numbers of their own kind.
function plain(value: unknown): Json {
  if (typeof value === "bigint") return Number(value);
  if (Array.isArray(value)) return value.map(plain);
  if (typeof value !== "object" || value === null) return value as Json;
  return Object.fromEntries(Object.entries(value).map(([key, entry]) => [key, plain(entry)]));
}

// The overrides that turn the scene `paper` into the one of a scene file; `hasBigints`: its whole
// numbers are bigints. Throws an Error with one line for a person.
export function overridesOf(file: Record<string, unknown>, hasBigints = false): Overrides {
  const { object: named, ...others } = file;
  if (typeof named === "string") {
    if (!tables.objects.some((o) => o.name === named)) {
      const names = tables.objects.map((o) => o.name).join(", ");
      refuse("object", named, "is no built-in object", `a table, or one of ${names}`);
    }
    checkShape("", others, tables.rules.shape, hasBigints);
  } else {
    checkShape("", file, tables.rules.shape, hasBigints);
  }
  const given = plain(file) as Scene;
  checkFrictionIsGivenOnce(given.palm);
  const found: Overrides = typeof named === "string" ? { object: named } : {};
  if (typeof named === "string") delete given.object;
  else if (given.object) given.object = completed(given.object as { [key: string]: Json });
  for (const [key, value] of leaves(given)) {
    if (JSON.stringify(get(PAPER, key)) !== JSON.stringify(value)) found[key] = value;
  }
  return found;
}
