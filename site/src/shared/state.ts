// SPDX-License-Identifier: Apache-2.0
// The state of the page, which the URL holds completely: view, scene, controller, seed, and what the
// views add. Everything drawn is computed from it.
import { batch, computed, effect, signal } from "@preact/signals";
import type { Core, Fork, PolicyRow, Recorded } from "./core";
import { checkJob, jobWarnings } from "./floor_job";
import { checkPage, sceneOf, withOutline } from "./scene";
import { type Overrides, builtInScene, get, ofSide } from "./scene_values";
import { checkShape } from "./scene_shape";
import { type Json, SENDERS, SIDES, type Scene, tables } from "./tables";
import { Player } from "./player";

export const VIEWS = ["carry", "compare", "mechanics", "design", "stories", "proofs"] as const;
export type ViewName = (typeof VIEWS)[number];

// The controller whose nine rows the visitor writes; the station runs them.
export const OWN_ROWS = "own-rows";

export const SIGN_PAIRS = ["++", "+0", "+-", "0+", "00", "0-", "-+", "-0", "--"];

// Table 1 as rows that hold until a sign changes.
export const TABLE_1_ROWS: PolicyRow[] = SIGN_PAIRS.map((pair) => {
  const signs = [...pair].map((s) => (s === "+" ? 1 : s === "-" ? -1 : 0));
  const row = tables.table1.find((r) => r.signs[0] === signs[0] && r.signs[1] === signs[1]);
  if (!row) return { palms: ["steep", "steep"], drives: ["hold", "hold"] };
  const drive = row.moves[0]!.startsWith("away") ? "away" : "closer";
  return { palms: [row.palms[0]!, row.palms[1]!], drives: [drive, drive] };
});

export const core = signal<Core | null>(null);
export const view = signal<ViewName>("carry");
export const base = signal("paper");
export const controller = signal(tables.defaultController);
export const seed = signal(0);
export const overrides = signal<Overrides>({});
export const forks = signal<Fork[]>([]);
export const policy = signal<PolicyRow[]>(TABLE_1_ROWS);
export const extras = signal<Record<string, string>>({}); // what a view adds
export const player = new Player();

// The scene with its overrides, and why it cannot be carried: empty if it can. Where its values are
// not of the right shape, the scene is the built-in one, so that there is something to draw.
const checked = computed(() => {
  const merged = sceneOf(base.value, overrides.value);
  try {
    checkShape("", merged);
    return { scene: core.value ? withOutline(core.value, merged) : merged, problem: "" };
  } catch (error) {
    return { scene: builtInScene(base.value), problem: (error as Error).message };
  }
});
export const scene = computed(() => checked.value.scene);

// Why no controller can carry the scene, in one line; empty if the scene is valid.
export const problem = computed(() => {
  const machine = core.value;
  if (!machine || checked.value.problem) return checked.value.problem;
  return problemOf(machine, scene.value, base.value, overrides.value);
});

// `on` and `changes`: the built-in scene and the overrides that make the scene.
function problemOf(machine: Core, of: Scene, on: string, changes: Overrides): string {
  try {
    machine.check(of);
    const facts = machine.facts(of);
    checkPage(of, facts);
    checkJob(on, changes, of, facts);
  } catch (error) {
    return (error as Error).message;
  }
  return machine.cannotBegin(of);
}

// Throws an Error with one line where a scene that differs so from `paper` cannot be carried.
export function checkCanBeCarried(changes: Overrides): void {
  const machine = core.peek();
  const found = machine ? problemOf(machine, sceneOf("paper", changes), "paper", changes) : "";
  if (found) throw new Error(found);
}

export function controllerNumber(name: string): number {
  const at = tables.controllers.findIndex((c) => c.name === name);
  return at >= 0 ? at : tables.controllers.length;
}

// Why a controller does not carry the scene; empty if it does.
export function refusalOf(name: string): string {
  const machine = core.value;
  if (!machine) return "";
  if (problem.value) return `This scene cannot be carried: ${problem.value}`;
  machine.setScene(scene.value);
  const refused = machine.refusal(controllerNumber(name));
  return refused && `${name} refuses this scene: ${refused}`;
}
export const refusal = computed(() => refusalOf(controller.value));

export const facts = computed(() => core.value?.facts(scene.value) ?? null);

// Whether the scene is a job that begins or ends on the floor.
export const isJob = computed(() => facts.value?.isJob ?? false);

// The carry that the state describes.
export const recorded = computed<Recorded | null>(() => {
  const machine = core.value;
  if (!machine || refusal.value) return null;
  machine.setScene(scene.value);
  machine.setPolicy(policy.value);
  const found = machine.run(controllerNumber(controller.value), seed.value, forks.value);
  found.early.push(...jobWarnings(base.value, overrides.value, machine.facts(scene.value)));
  return found;
});

// The same carry with other values of the scene.
export function runWith(changes: Overrides): Recorded | null {
  const machine = core.peek();
  if (!machine || refusal.peek()) return null;
  machine.setScene(sceneOf(base.value, { ...overrides.value, ...changes }));
  machine.setPolicy(policy.value);
  return machine.run(controllerNumber(controller.value), seed.value, forks.value);
}

// The same without the last fork: what would have happened.
export const before = computed<Recorded | null>(() => {
  const machine = core.value;
  if (!machine || forks.value.length === 0 || !recorded.value) return null;
  machine.setScene(scene.value);
  machine.setPolicy(policy.value);
  return machine.run(controllerNumber(controller.value), seed.value, forks.value.slice(0, -1));
});

player.end = () => recorded.peek()?.time ?? 0;

export function setKey(key: string, value: Json | undefined): void {
  const next = { ...overrides.peek() };
  if (value === undefined) delete next[key];
  else next[key] = value;
  overrides.value = next;
}

const SIDED = /^(palm|robot|arm|radio)\.([^.]+)$/;
const OF_ONE_SIDE = /^(palm|robot|arm)\.(left|right)\.([^.]+)$/;

// The values of a key on the left and on the right (of the radio, of the station, too), as carried.
export function valuesOf(key: string): number[] {
  const one = OF_ONE_SIDE.exec(key);
  if (one) return [valuesOf(`${one[1]}.${one[3]}`)[one[2] === "left" ? 0 : 1]!];
  const [, section, name] = SIDED.exec(key) ?? [];
  if (!section) return [Number(get(scene.value, key))];
  if (key === "palm.friction" && core.value) return core.value.facts(scene.value).friction;
  const who = section === "radio" ? SENDERS : SIDES;
  return who.map((side) => Number(ofSide(scene.value, section, side, name!)));
}

// Sets a key; one that both sides have, for both: what one side has of its own is gone.
export function setForAll(key: string, value: Json): void {
  const [, section, name] = SIDED.exec(key) ?? [];
  const next = { ...overrides.peek() };
  for (const side of section ? ["", ...SENDERS.map((s) => `${s}.`)] : []) {
    delete next[`${section}.${side}${name}`];
    if (key === "palm.friction") delete next[`palm.${side}friction_angle_deg`];
  }
  const { [key]: _, ...without } = next;
  const [, table, side, own] = OF_ONE_SIDE.exec(key) ?? [];
  const rest = sceneOf(base.peek(), without);
  const usual = side ? ofSide(rest, table!, side, own!) : get(rest, key);
  if (value === usual) delete next[key];
  else next[key] = value;
  overrides.value = next;
}

// Appends an entry to a list of the scene.
export function append(key: string, entry: { [key: string]: Json }): void {
  const [section, name] = key.split(".") as [string, string];
  const list = (scene.peek()[section] as Record<string, Json>)[name] as Json[];
  setKey(key, [...list, entry]);
}

export function extra(name: string, usual: string): string {
  return extras.value[name] ?? usual;
}

export function setExtra(name: string, value: string, usual: string): void {
  const next = { ...extras.peek() };
  if (value === usual) delete next[name];
  else next[name] = value;
  extras.value = next;
}

// A switch of a view, off by default.
export function extraFlag(name: string): boolean {
  return extras.value[name] === "1";
}

export function setExtraFlag(name: string, on: boolean): void {
  setExtra(name, on ? "1" : "", "");
}

export function extraNumber(name: string, usual: number): number {
  const value = Number(extras.value[name] ?? usual);
  return Number.isFinite(value) ? value : usual;
}

function policyText(rows: PolicyRow[]): string {
  const letters = (pair: [string, string]) => pair.map((word) => word[0] === "s" ? word[1] : word[0]).join("");
  return rows.map((row) => letters(row.palms) + letters(row.drives)).join(".");
}

function policyOf(text: string): PolicyRow[] | null {
  const palm: Record<string, string> = { t: "steep", h: "shallow" };
  const drive: Record<string, string> = { h: "hold", a: "away", c: "closer" };
  const rows = text.split(".").map((word) => ({
    palms: [palm[word[0]!], palm[word[1]!]],
    drives: [drive[word[2]!], drive[word[3]!]],
  }));
  const whole = rows.length === 9 && rows.every((r) => [...r.palms, ...r.drives].every(Boolean));
  return whole ? (rows as PolicyRow[]) : null;
}

// The hash of the URL for the present state.
export function address(changes: { view?: ViewName; time?: boolean } = {}): string {
  const query = new URLSearchParams();
  if (base.value !== "paper") query.set("scene", base.value);
  if (controller.value !== tables.defaultController) query.set("controller", controller.value);
  if (seed.value !== 0) query.set("seed", String(seed.value));
  for (const [key, value] of Object.entries(overrides.value)) {
    query.append("set", `${key}=${JSON.stringify(value)}`);
  }
  for (const fork of forks.value) query.append("fork", `${fork.at}:${fork.seed}`);
  if (controller.value === OWN_ROWS || policy.value !== TABLE_1_ROWS) {
    query.set("rows", policyText(policy.value));
  }
  for (const [name, value] of Object.entries(extras.value)) query.set(`v.${name}`, value);
  if (changes.time !== false && player.time.value > 0) {
    // The end is seldom a whole number of hundredths: rounded down, it would be before the end.
    const time = player.time.value;
    query.set("t", (time < player.end() ? time : Math.ceil(100 * time) / 100).toFixed(2));
  }
  if (player.speed.value !== 1) query.set("speed", String(player.speed.value));
  const text = query.toString();
  return `#${changes.view ?? view.value}${text ? `?${text}` : ""}`;
}

// Takes the state from a hash. What it does not name gets its default. Returns the time, if any.
export function readAddress(hash: string): number | null {
  const [name, text] = hash.replace(/^#/, "").split("?") as [string, string | undefined];
  const query = new URLSearchParams(text ?? "");
  const found: Overrides = {};
  for (const item of query.getAll("set")) {
    const cut = item.indexOf("=");
    try {
      found[item.slice(0, cut)] = JSON.parse(item.slice(cut + 1)) as Json;
    } catch {
      // not a value: as if it were not there
    }
  }
  const known = [...tables.controllers.map((c) => c.name), OWN_ROWS];
  const whole = (value: string | null) => {
    const seen = Math.floor(Number(value));
    return Number.isFinite(seen) && seen >= 0 ? seen : 0;
  };
  batch(() => {
    view.value = (VIEWS as readonly string[]).includes(name) ? (name as ViewName) : "carry";
    base.value = tables.scenes.some((s) => s.name === query.get("scene"))
      ? query.get("scene")!
      : "paper";
    const asked = query.get("controller");
    controller.value = asked && known.includes(asked) ? asked : tables.defaultController;
    seed.value = whole(query.get("seed"));
    overrides.value = found;
    forks.value = query
      .getAll("fork")
      .map((item) => item.split(":"))
      .map(([at, own]) => ({ at: Number(at), seed: whole(own ?? null) }))
      .filter((fork) => fork.at >= 0);
    policy.value = policyOf(query.get("rows") ?? "") ?? TABLE_1_ROWS;
    extras.value = Object.fromEntries(
      [...query].filter(([key]) => key.startsWith("v.")).map(([key, v]) => [key.slice(2), v]),
    );
    player.speed.value = Number(query.get("speed") ?? 1) || 1;
  });
  return query.has("t") ? Number(query.get("t")) : null;
}

// Keeps the URL up to date without filling the history: twice a second while the carry plays,
// because browsers limit how often an address may change, else as soon as the state rests.
export function followState(): void {
  let waiting = 0;
  const write = () => {
    waiting = 0;
    const next = address();
    if (location.hash !== next) history.replaceState(null, "", next);
  };
  effect(() => {
    address(); // what the effect depends on
    const isPlaying = player.playing.value;
    if (isPlaying && waiting) return;
    clearTimeout(waiting);
    waiting = window.setTimeout(write, isPlaying ? 500 : 150);
  });
}

// Opens another view at its top.
export function go(hash: string): void {
  history.pushState(null, "", hash);
  const time = readAddress(hash);
  player.seek(time ?? 0);
  window.scrollTo(0, 0);
}
