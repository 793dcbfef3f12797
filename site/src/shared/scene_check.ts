// SPDX-License-Identifier: Apache-2.0
// Whether the keys of a scene agree with each other, as the package checks it: each refusal is one
// line with where, what and what is allowed. The numbers of the rules come from the package.
import { type Point, areaAndCentroid, crossingEdges, isInHull, lowerVertices } from "./outline";
import { get, ofSide } from "./scene_values";
import { refuse } from "./scene_shape";
import { type Json, SENDERS, SIDES, type Scene, tables } from "./tables";

type Table = { [key: string]: Json };

// What the core computes from a scene.
export interface SceneFacts {
  timeout: number; // [s]
  longestTimeout: number; // [s], or 0 if `timeout` is not longer
  friction: [number, number];
  com: [number, number, number]; // from the left and the right contact, and above their line [m]
}

const rules = tables.rules;
const DEGREE = Math.PI / 180;
const short = (value: number) => String(Number(value.toPrecision(6)));
const rows = (scene: Scene, key: string) => (get(scene, key) ?? []) as Table[];

// The key that sets a value for a side: its own or that of both.
function keyOf(scene: Scene, section: string, side: string, name: string): string {
  const own = `${section}.${side}.${name}`;
  return get(scene, own) === undefined ? `${section}.${name}` : own;
}

// A friction coefficient and a friction angle exclude each other. Takes what one source sets.
export function checkFrictionIsGivenOnce(palm: Json | undefined, key = "palm"): void {
  if (typeof palm !== "object" || Array.isArray(palm)) return;
  if (palm.friction !== undefined && palm.friction_angle_deg !== undefined) {
    refuse(
      `${key}.friction_angle_deg`, palm.friction_angle_deg,
      `is given beside friction, which is ${palm.friction}`, "one of the two",
    );
  }
  for (const side of SIDES) {
    if (key === "palm") checkFrictionIsGivenOnce(palm[side], `palm.${side}`);
  }
}

function checkObject(scene: Scene): void {
  const outline = get(scene, "object.vertices_m") as unknown as Point[];
  const contacts = get(scene, "object.contacts") as number[];
  const com = get(scene, "object.com_m") as unknown as Point;
  checkOutline(outline);
  const count = outline.length;
  const beyond = contacts.find((k) => k >= count);
  if (beyond !== undefined) {
    refuse(
      "object.contacts", contacts, `names vertex ${beyond}, but there are ${count}`,
      `two different whole numbers from 0 to ${count - 1}`,
    );
  }
  const [left, right] = contacts as [number, number];
  const [l, r] = [outline[left]!, outline[right]!];
  if ((r[0] - l[0]) ** 2 + (r[1] - l[1]) ** 2 < rules.leastWidth * rules.leastWidth) {
    refuse(
      "object.contacts", contacts, "names contacts at the same place",
      `two vertices at least ${rules.leastWidth} m apart`,
    );
  }
  const lower = lowerVertices(outline, left, right);
  contacts.forEach((k, side) => {
    if (lower.has(k)) return;
    refuse(
      "object.contacts", contacts,
      `cannot support the object: with both level and the left one on the left, vertex ${k} ` +
        `(${SIDES[side]}) is not a corner of its lower side`,
      "[left, right], two lower corners of the outline's convex hull",
    );
  });
  if (!isInHull(com, outline)) {
    refuse("object.com_m", com, "is outside the convex hull of the outline", "a point inside it");
  }
}

// Refuses an outline that is not a simple polygon.
export function checkOutline(outline: Point[]): void {
  const bad = crossingEdges(outline);
  if (!bad) return;
  const [one, two] = bad.map((k) => `the edge from vertex ${k} to ${(k + 1) % outline.length}`);
  refuse(
    "object.vertices_m", outline,
    one === two ? `repeats vertex ${bad[0]} as the next one` : `crosses itself: ${one} meets ${two}`,
    "a simple polygon, whose edges share nothing but the vertices between them",
  );
}

// Refuses an outline without a mass of its own that is too heavy or too light at the usual density.
export function checkMassOf(outline: Point[], depth: number): void {
  const mass = rules.density * areaAndCentroid(outline)[0] * depth;
  const { minimum, maximum } = rules.shape.properties!.object!.properties!.mass_kg!;
  if (mass >= minimum! && mass <= maximum!) return;
  refuse(
    "object.mass_kg", null,
    `is not set, and the outline at ${rules.density} kg/m³ has ${short(mass)} kg`,
    `a number in kg, from ${minimum} to ${maximum}`,
  );
}

function checkPalms(scene: Scene): void {
  for (const side of SIDES) {
    const steep = ofSide(scene, "palm", side, "steep_deg");
    const shallow = ofSide(scene, "palm", side, "shallow_deg");
    if (steep <= shallow) {
      refuse(
        keyOf(scene, "palm", side, "steep_deg"), steep,
        `is not more than shallow_deg, which is ${shallow}`,
        `a number in degrees, more than ${shallow} and less than 80`,
      );
    }
  }
}

function checkRobots(scene: Scene): void {
  const tick = get(scene, "control.period_s") as number;
  const watchdog = get(scene, "control.watchdog_s") as number;
  for (const side of SIDES) {
    const most = ofSide(scene, "robot", side, "max_speed_m_s");
    const speed = ofSide(scene, "robot", side, "speed_m_s");
    if (speed > most) {
      refuse(
        keyOf(scene, "robot", side, "speed_m_s"), speed, "is more than max_speed_m_s",
        `a number in m/s, from 0 to ${most}`,
      );
    }
    const own = ofSide(scene, "robot", side, "period_s") as number | undefined;
    if (own === undefined) continue;
    const ratio = own / tick;
    const isWhole = ratio > 0.5 && Math.abs(ratio - Math.round(ratio)) < 1e-6;
    if (isWhole && own <= watchdog * (1 + 1e-9)) continue;
    refuse(
      keyOf(scene, "robot", side, "period_s"), own,
      isWhole
        ? `is longer than control.watchdog_s, which is ${watchdog}`
        : `is not a whole multiple of control.period_s, which is ${tick}`,
      `whole multiples of ${tick} s up to ${watchdog} s`,
    );
  }
}

function checkZones(scene: Scene): void {
  const zones = rows(scene, "tactile.zones");
  const from = (z: Table) => z.from_m as number;
  const to = (z: Table) => z.to_m as number;
  zones.forEach((z, k) => {
    if (to(z) > from(z)) return;
    refuse(
      `tactile.zones[${k}].to_m`, z.to_m, `is not more than from_m, which is ${z.from_m}`,
      `a number in m, more than ${z.from_m} and at most 10`,
    );
  });
  for (const minus of zones.filter((z) => z.sign === "-")) {
    zones.forEach((plus, k) => {
      if (plus.sign !== "+" || to(minus) <= from(plus) || to(plus) <= from(minus)) return;
      refuse(
        `tactile.zones[${k}]`, plus,
        `overlaps the zone - from ${minus.from_m} to ${minus.to_m}`,
        "zones + and - that do not overlap each other",
      );
    });
  }
}

function checkRadio(scene: Scene): void {
  const tick = get(scene, "control.period_s") as number;
  for (const sender of SENDERS) {
    const latency = ofSide(scene, "radio", sender, "latency_s");
    const jitter = ofSide(scene, "radio", sender, "jitter_s");
    if ((latency + jitter) / tick <= rules.mostDelayTicks) continue;
    refuse(
      keyOf(scene, "radio", sender, "latency_s"), latency,
      `and a jitter_s of ${jitter} are too long for control periods of ${tick} s`,
      `latency_s + jitter_s at most ${short(rules.mostDelayTicks * tick)} ` +
        `(${rules.mostDelayTicks} periods)`,
    );
  }
  rows(scene, "radio.outages").forEach((o, k) => {
    if (o.end_s! > o.start_s!) return;
    refuse(
      `radio.outages[${k}].end_s`, o.end_s, `is not more than start_s, which is ${o.start_s}`,
      `a number in s, more than ${o.start_s}`,
    );
  });
  rows(scene, "radio.script").forEach((m, k) => {
    const ofStation = m.sender === "station";
    if ((m.receiver !== undefined) !== ofStation) {
      refuse(
        `radio.script[${k}]`, m, ofStation ? "has no receiver" : "has a receiver",
        'receiver = "left" or "right" with the sender station, not with a robot',
      );
    }
    if ((m.delay_s === undefined) !== (m.effect === "lost")) {
      refuse(
        `radio.script[${k}]`, m, m.effect === "lost" ? "has a delay" : "has no delay",
        "delay_s with the effect delayed or duplicated, not with lost",
      );
    }
  });
}

function checkDisturbances(scene: Scene): void {
  rows(scene, "faults.script").forEach((fault, k) => {
    const { needs, never } = rules.faultKeys[fault.kind as string]!;
    if (needs.every((n) => fault[n] !== undefined) && never.every((n) => fault[n] === undefined)) {
      return;
    }
    refuse(
      `faults.script[${k}]`, fault, "has the wrong keys",
      `with kind ${fault.kind}, besides at_s and duration_s: ` +
        (needs.join(", ") || "none of robot, stuck_at and probability"),
    );
  });
  rows(scene, "bumps.script").forEach((bump, k) => {
    const [byPlace, byTime] = [bump.at_m !== undefined, bump.at_s !== undefined];
    if (byPlace !== byTime) return;
    refuse(
      `bumps.script[${k}]`, bump,
      byPlace ? "has a place and a time" : "has no place and no time",
      "exactly one of at_m and at_s",
    );
  });
  rows(scene, "mujoco.ridges").forEach((ridge, k) => {
    const [height, length] = [ridge.height_m as number, (ridge.length_m ?? 0.05) as number];
    if (length >= 2 * height) return;
    refuse(
      `mujoco.ridges[${k}].length_m`, length, `is less than twice height_m, which is ${height}`,
      `a number in m, from ${2 * height} to 10 (a flat arc)`,
    );
  });
}

// The object must reach from palm to palm at the start.
function checkStart(scene: Scene): void {
  const heights = SIDES.map((side) => {
    const place = get(scene, `start.${side}_m`) as number;
    const half = ofSide(scene, "palm", side, "length_m") / 2;
    if (Math.abs(place) > half) {
      refuse(
        `start.${side}_m`, place, "is not on the palm",
        `a number in m, from ${short(-half)} to ${short(half)}`,
      );
    }
    const angle = ofSide(scene, "palm", side, "steep_deg") * DEGREE;
    const offset = ofSide(scene, "palm", side, "pivot_offset_m");
    return place * Math.sin(angle) + offset * Math.cos(angle);
  }) as [number, number];
  const vertices = get(scene, "object.vertices_m") as number[][];
  const [l, r] = (get(scene, "object.contacts") as number[]).map((k) => vertices[k]!) as [
    number[], number[],
  ];
  const width = Math.hypot(r[0]! - l[0]!, r[1]! - l[1]!);
  if (Math.abs(heights[1] - heights[0]) <= rules.mostLean * width) return;
  refuse(
    "start", [get(scene, "start.left_m")!, get(scene, "start.right_m")!],
    `puts the contacts at heights ${short(heights[0])} and ${short(heights[1])} m, too far apart ` +
      `for an object that is ${short(width)} m wide between them`,
    "left_m and right_m at more equal heights",
  );
}

// The page has the planar core only.
function checkPath(scene: Scene): void {
  for (const [key, value] of Object.entries((get(scene, "task.path") ?? {}) as Table)) {
    if (key === "kind" && value === "straight") continue;
    refuse(
      `task.path.${key}`, value, "does not belong to a straight path, but the page is planar",
      "a straight path here, or palmbots carry scene.toml --world mujoco on your computer",
    );
  }
}

// Refuses a scene, all of whose values have the right shape, because of keys that disagree.
export function checkRelations(scene: Scene): void {
  checkPath(scene);
  checkObject(scene);
  checkPalms(scene);
  checkRobots(scene);
  checkZones(scene);
  checkRadio(scene);
  checkDisturbances(scene);
  checkStart(scene);
}

// Refuses a scene because of what the core computes from it.
export function checkFacts(scene: Scene, facts: SceneFacts): void {
  if (!facts.com.every((distance) => distance > 0)) {
    refuse(
      "object.com_m", get(scene, "object.com_m"),
      "is not above the line between the contact vertices",
      "a point above that line and between its ends",
    );
  }
  SIDES.forEach((side, k) => {
    const angles = ["steep_deg", "shallow_deg"].map((n) => Math.abs(ofSide(scene, "palm", side, n)));
    const steepest = Math.max(...angles);
    const most = steepest > 0 ? 1 / Math.tan(steepest * DEGREE) : Infinity;
    if (facts.friction[k]! < most) return;
    refuse(
      keyOf(scene, "palm", side, "friction"), facts.friction[k],
      `is too large for a palm at ${short(steepest)} degrees`,
      `less than ${short(most)} (friction angle + palm angle below 90 degrees)`,
    );
  });
  checkTimeout(scene, facts);
}

function checkTimeout(scene: Scene, facts: SceneFacts): void {
  const most = facts.longestTimeout;
  if (facts.timeout === Infinity) {
    const speeds = SIDES.map((side) => ofSide(scene, "robot", side, "speed_m_s"));
    const slower = SIDES[speeds[0]! <= speeds[1]! ? 0 : 1];
    refuse(
      keyOf(scene, "robot", slower, "speed_m_s"), 0, "sets no time limit",
      "a speed above 0, or a task.timeout_s",
    );
  }
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
