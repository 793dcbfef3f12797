// SPDX-License-Identifier: Apache-2.0
// The shipped core, compiled to WebAssembly (site/core/core.cpp).
import address from "../generated/core.wasm?url";
import { type Scene, filledIn, tables } from "./tables";
import { builtInScene, entriesOf, get, short } from "./scene_values";
import { refuse } from "./scene_shape";

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  input(): number;
  length(): number;
  message_name(kind: number): number;
  rate_interval(k: number, n: number): number;
  text(): number;
  set_scene(bytes: number): void;
  problem(): number;
  answered(): number;
  refusal(): number;
  object(): number;
  set_policy(): void;
  set_forks(): void;
  scene_facts(): number;
  timing(controller: number): number;
  run(controller: number, seed: number): number;
  rows(): number;
  messages(): number;
  corrections(): number;
  contact_events(): number;
  phases(): number;
  warnings(): number;
  warnings_before(controller: number): number;
  places(): number;
  clear_tally(): void;
  add_to_tally(controller: number, first: number, n: number): number;
  statics(thetaLeft: number, thetaRight: number, pLeft: number, pRight: number): number;
  touch_palms(thetaLeft: number, thetaRight: number, pLeft: number, pRight: number): number;
  touch_floor(
    thetaLeft: number, thetaRight: number, drivenLeft: number, drivenRight: number, raised: number,
    friction: number, hasRight: number,
  ): number;
  touched_text(): number;
  touched_modes(
    xLeft: number, yLeft: number, spinLeft: number, xRight: number, yRight: number, spinRight: number,
  ): number;
  contact_mode_map(thetaLeft: number, thetaRight: number, closing: number, n: number, reach: number): number;
  com_map(
    x0: number, x1: number, y0: number, y1: number, nx: number, ny: number, shallowLeft: number,
    steepLeft: number, shallowRight: number, steepRight: number,
  ): number;
  limits(half: number): number;
  tolerance_map(
    from: number, step: number, n: number, quantity: number, most: number, half: number,
  ): number;
}

// What the core computes from a scene.
export interface SceneFacts {
  timeout: number; // [s]
  longestTimeout: number; // [s], or 0 if `timeout` is not longer
  friction: [number, number];
  isPipe: boolean;
  isJob: boolean; // it begins or ends on the floor
  floor: number; // height over the pivots [m]
}

export interface Fork {
  at: number;
  seed: number;
}

// A row of a policy: palms and drives of the left and the right robot.
export interface PolicyRow {
  palms: [string, string];
  drives: [string, string];
}

export const PALMS = tables.palms;
export const DRIVES = tables.drives;

export const ROW = {
  width: 26, time: 0, contact: 1, palm: 3, speed: 5, commanded: 7, separation: 9, midpoint: 10,
  object: 11, sign: 12, name: 14, motion: 16, lift: 18, state: 20, waits: 22,
  height: 24,
} as const;

export interface Message {
  sent: number;
  received: number; // NaN: lost
  sender: number;
  receiver: number;
  kind: string;
  number: number; // among all that the sender transmits to this receiver, from 1
  says: string; // in words, of a report or a command
  short: string; // the same, as short as a chart needs it
  isNews: boolean; // differs from the one before on its link, or is sent only once
}

export interface Correction {
  robot: number; // 2: both
  name: string;
  assistant: number; // −1: nobody
  start: number;
  end: number;
}

// What a robot does in a job on the floor, until its next phase.
export interface Phase {
  side: number;
  state: number; // its number in tables.lifting
  start: number;
}

export interface Recorded {
  outcome: number;
  reason: number;
  time: number;
  distance: number;
  rms: [number, number];
  peak: [number, number];
  sent: number;
  lost: number;
  waiting: [number, number];
  correctionCount: number;
  hash: string;
  rows: Float64Array;
  count: number;
  messages: Message[];
  corrections: Correction[];
  phases: Phase[]; // of a job on the floor; none: it is a carry
  moved: number; // the object, in such a job [m]
  early: string[]; // warnings that the command prints before the carry
  warnings: string[]; // those that it prints after it
}

export interface Tally {
  carries: number;
  dropped: number;
  stalled: number;
  meanSquare: number;
  messagesPerM: number;
  corrections: number;
}

// The mechanics of one state; indices of contact modes as in tables.contactModes, −1: not held, −2: jammed.
export interface Statics {
  reaches: boolean;
  reason: number;
  squeeze: [number, number][];
  feasible: boolean[];
  closing: number;
  opening: number;
  margin: number;
  wedged: boolean[];
  objectAngle: number;
  separation: number;
  cones: { x: number; y: number; height: number }[][]; // per side: up, down
  places: Float64Array;
}

export interface Limit {
  property: number;
  shallow: number;
  holds: boolean;
  low: number;
  high: number;
  lowBy: number;
  highBy: number;
}

// The report of a robot and the command of the station (site/core/recorded_carry.hpp).
const STATION_MESSAGES = tables.controllers.find((c) => c.team === "station")!.messages;

function words(code: number, content: number): { says: string; short: string } {
  if (code === -2) {
    const short = tables.signWords[content % 3]!;
    const turns = content < 6 ? ", turning" : "";
    return { says: `${short}, palm ${PALMS[Math.floor(content / 3) % 2]}${turns}`, short };
  }
  if (code !== -3) return { says: "", short: "" };
  const short = `${PALMS[content % 2]}, ${DRIVES[Math.floor(content / 2)]}`;
  return { says: `palm ${short}`, short };
}

function pairs<T>(numbers: Float64Array, width: number, make: (row: Float64Array) => T): T[] {
  const found: T[] = [];
  for (let at = 0; at < numbers.length; at += width) {
    found.push(make(numbers.subarray(at, at + width)));
  }
  return found;
}

export class Core {
  private scene: Scene | null = null;

  private constructor(readonly wasm: Exports) {}

  static async load(): Promise<Core> {
    const [head, inlined] = address.split(";base64,");
    const { instance } = inlined
      ? await WebAssembly.instantiate(Uint8Array.from(atob(inlined), (c) => c.charCodeAt(0)))
      : await WebAssembly.instantiateStreaming(fetch(head!));
    const wasm = instance.exports as unknown as Exports;
    wasm._initialize();
    return new Core(wasm);
  }

  private put(numbers: number[]): void {
    new Float64Array(this.wasm.memory.buffer, this.wasm.input(), numbers.length).set(numbers);
  }

  // The array that a call returned: a copy, because the next call may move it.
  take(at: number): Float64Array {
    return new Float64Array(this.wasm.memory.buffer, at, this.wasm.length()).slice();
  }

  text(at: number): string {
    const bytes = new Uint8Array(this.wasm.memory.buffer, at);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }

  private lines(at: number): string[] {
    return this.text(at).split("\n").filter(Boolean);
  }

  setScene(scene: Scene): void {
    if (this.scene === scene) return;
    this.scene = scene;
    const { lines, numbers } = entriesOf(scene);
    const text = new TextEncoder().encode(lines.join("\n"));
    new Uint8Array(this.wasm.memory.buffer, this.wasm.text(), text.length).set(text);
    this.put(numbers);
    this.wasm.set_scene(text.length);
  }

  // Refuses a scene whose keys disagree.
  check(scene: Scene): void {
    this.setScene(scene);
    const [key, problem, allowed] = this.text(this.wasm.problem()).split("\n");
    if (!key) return;
    const value = Array.from(this.take(this.wasm.answered()));
    const given = get(scene, key) ?? get(builtInScene("paper"), key);
    refuse(key, value.length > 1 ? value : (value[0] ?? given), problem!, allowed!);
  }

  // Why no carry of a scene can begin although its keys agree; empty if one can.
  cannotBegin(scene: Scene): string {
    this.setScene(scene);
    return this.text(this.wasm.refusal());
  }

  // Outline of the scene's object; contacts and centre of mass, which follow from it if not given.
  object(scene: Scene): { contacts: [number, number]; com: [number, number]; vertices: number[][] } {
    this.setScene(scene);
    const a = this.take(this.wasm.object());
    return {
      contacts: [a[0]!, a[1]!], com: [a[2]!, a[3]!],
      vertices: pairs(a.subarray(4), 2, (vertex) => Array.from(vertex)),
    };
  }

  setPolicy(rows: PolicyRow[]): void {
    this.put(
      rows.flatMap((row) => [
        ...row.palms.map((p) => PALMS.indexOf(p)),
        ...row.drives.map((d) => DRIVES.indexOf(d)),
      ]),
    );
    this.wasm.set_policy();
  }

  facts(scene: Scene): SceneFacts {
    this.setScene(scene);
    const a = this.take(this.wasm.scene_facts());
    return {
      timeout: a[0]!, longestTimeout: a[1]!, friction: [a[2]!, a[3]!], isPipe: a[4] === 1,
      isJob: a[5] === 1, floor: a[6]!,
    };
  }

  // Why a controller refuses the scene, in the sentence of the package; empty if it does not.
  refusal(controller: number): string {
    const [problem, beacon, delay, lease, shortest, longest, room] = this.take(
      this.wasm.timing(controller),
    ) as unknown as [number, number, number, number, number, number, number];
    if (problem === 0) return "";
    const isBeacon = problem === 1;
    const text = tables.refusals[!isBeacon && shortest > longest ? 3 : problem - 1]!;
    const given = (key: string) => get(this.scene!, key) as number;
    return filledIn(text, {
      beacon: short(isBeacon ? given("radio.beacon_s") : beacon),
      period: short(given("control.period_s")),
      delay: short(delay), lease: short(lease), shortest: short(shortest),
      longest: short(Math.max(longest, 0)), room: (1000 * room).toFixed(1),
    });
  }

  // One carry of the scene.
  run(controller: number, seed: number, forks: Fork[] = []): Recorded {
    this.put([forks.length, ...forks.flatMap((f) => [f.at, f.seed])]);
    this.wasm.set_forks();
    const m = this.take(this.wasm.run(controller, seed));
    const word = (value: number) => value.toString(16).padStart(8, "0");
    const rows = this.take(this.wasm.rows());
    const phases = pairs(this.take(this.wasm.phases()), 3, (r) => ({
      side: r[0]!, state: r[1]!, start: r[2]!,
    }));
    const messages = this.messages(tables.controllers[controller]?.isPeriodic ?? false);
    return {
      outcome: m[0]!, reason: m[1]!, time: m[2]!, distance: m[3]!,
      rms: [m[4]!, m[5]!], peak: [m[6]!, m[7]!], sent: m[8]!, lost: m[9]!,
      waiting: [m[10]!, m[11]!], correctionCount: m[12]!,
      hash: word(m[14]!) + word(m[15]!),
      rows,
      count: rows.length / ROW.width,
      // In a job on the floor, two radios send beacons all the time.
      messages: phases.length > 0 ? messages.filter((m) => m.isNews) : messages,
      corrections: pairs(this.take(this.wasm.corrections()), 5, (r) => ({
        robot: r[0]!, name: String.fromCharCode(r[1]!), assistant: r[2]!, start: r[3]!, end: r[4]!,
      })),
      phases,
      moved: m[16]!,
      early: this.lines(this.wasm.warnings_before(controller)),
      warnings: this.lines(this.wasm.warnings()),
    };
  }

  private kind(k: number): string {
    if (k >= 0) return this.text(this.wasm.message_name(k));
    return k === -1 ? "Hello" : STATION_MESSAGES[-2 - k]!;
  }

  private messages(isPeriodic: boolean): Message[] {
    const before = new Map<number, string>(); // what was last said, by link
    return pairs(this.take(this.wasm.messages()), 7, (r) => {
      const [code, content] = [r[4]!, r[6]!];
      const isOfTable = code >= 0 && content === 1; // of a job on the floor
      const link = 2 * (3 * r[2]! + r[3]!) + Number(isOfTable);
      const said = `${code} ${content}`;
      const isNews = (code >= -1 && !isPeriodic && !isOfTable) || before.get(link) !== said;
      before.set(link, said);
      return {
        sent: r[0]!, received: r[1]!, sender: r[2]!, receiver: r[3]!, kind: this.kind(code),
        number: r[5]!, ...words(code, content), isNews,
      };
    });
  }

  // World coordinates (PLACES) at row `k` of a carry of the scene.
  places(scene: Scene, run: Recorded, k: number): Float64Array {
    this.setScene(scene);
    const at = Math.min(Math.max(k, 0), run.count - 1) * ROW.width;
    this.put(Array.from(run.rows.subarray(at, at + ROW.width)));
    return this.take(this.wasm.places());
  }

  clearTally(): void {
    this.wasm.clear_tally();
  }

  addToTally(controller: number, first: number, n: number): Tally {
    const t = this.take(this.wasm.add_to_tally(controller, first, n));
    return {
      carries: t[0]!, dropped: t[1]!, stalled: t[2]!, meanSquare: t[3]!, messagesPerM: t[4]!,
      corrections: t[5]!,
    };
  }

  // The 95 % interval of a rate.
  rateInterval(events: number, n: number): [number, number] {
    const ends = this.take(this.wasm.rate_interval(events, n));
    return [ends[0]!, ends[1]!];
  }

  statics(theta: [number, number], p: [number, number]): Statics {
    const a = this.take(this.wasm.statics(theta[0], theta[1], p[0], p[1]));
    const edge = (at: number) => ({ x: a[at]!, y: a[at + 1]!, height: a[at + 2]! });
    return {
      reaches: a[0] === 1,
      reason: a[1]!,
      squeeze: [[a[2]!, a[3]!], [a[4]!, a[5]!]],
      feasible: Array.from(a.subarray(6, 15), (value) => value === 1),
      closing: a[15]!, opening: a[16]!, margin: a[17]!,
      wedged: [a[18] === 1, a[19] === 1],
      objectAngle: a[20]!, separation: a[21]!,
      cones: [[edge(22), edge(25)], [edge(28), edge(31)]],
      places: a.slice(34),
    };
  }

  contactModeMap(theta: [number, number], closing: boolean, n: number, reach: number): Float64Array {
    return this.take(this.wasm.contact_mode_map(theta[0], theta[1], closing ? 1 : 0, n, reach));
  }

  // `angles` of the left and the right palm: shallow, steep [rad].
  comMap(
    x: [number, number], y: [number, number], nx: number, ny: number,
    angles: [[number, number], [number, number]],
  ): Float64Array {
    const [left, right] = angles;
    return this.take(this.wasm.com_map(x[0], x[1], y[0], y[1], nx, ny, ...left, ...right));
  }

  // What limits the properties over contacts within ± half [m]; 0: anywhere on the palms.
  limits(half: number): Limit[] {
    const a = this.take(this.wasm.limits(half));
    return [0, 1, 2, 3].map((k) => ({
      property: k < 2 ? 1 : 2, shallow: k % 2, holds: a[5 * k] === 1, low: a[5 * k + 1]!,
      high: a[5 * k + 2]!, lowBy: a[5 * k + 3]!, highBy: a[5 * k + 4]!,
    }));
  }

  // Tolerance and clearance of n × n pairs of angles, alternating; shallow is the outer index.
  toleranceMap(
    from: number, step: number, n: number, quantity: number, most: number, half: number,
  ): Float64Array {
    return this.take(this.wasm.tolerance_map(from, step, n, quantity, most, half));
  }
}

// Places of the points in the array of `places`: x, y of the left one, then of the right one.
export const PLACES = { pivot: 0, inner: 4, outer: 8, contact: 12, com: 16, vertex: 18, origin: 20, plate: 22, outline: 50 } as const;
