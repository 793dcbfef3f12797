// SPDX-License-Identifier: Apache-2.0
// Everything that touches the object in one state, and the contact modes that may occur there. The core
// computes both (site/core/touched_state.hpp).
import type { Core } from "./core";
import type { Xy } from "./object_transform";
import { tables } from "./tables";

export interface Touched {
  kind: string; // as in palmbots.mechanics.Contact
  carrier: number; // 0 the left palm, 1 the right one, 2 the floor
  place: number; // on the carrier [m]
  at: Xy; // from the centre of mass [m]
  normal: Xy; // into the object
  friction: number;
}

export interface TouchedState {
  problem: string; // in one line; empty: none
  end: string; // why the palms stopped early
  refusal: string; // why they were not moved
  held: boolean; // whether the contacts hold the object if all stick
  contacts: Touched[];
  starts: Xy; // x of the pivots before the palms drive [m]; on a floor
  places: Float64Array; // PLACES, on a floor and of a pipe
}

export type Range = [number, number];

// A contact mode that is possible and in balance; forces in weights, by contact.
export interface Mode {
  motions: string[];
  normal: Range[];
  friction: Range[]; // to the left for someone who stands on the surface
  limits: string[] | null; // how the contacts are loaded where the margin ends; null: nowhere
  margin: number; // [rad]
}

// Velocities of the pivot [m/s] and rate at which the palm angle grows [rad/s], left first.
export type PalmMotions = [[number, number, number], [number, number, number]];

export interface FloorNumbers {
  driven: Xy; // how far the palms drive inward [m]
  raised: number; // how far they then rise [m]
  friction: number;
  hasRight: boolean; // whether there is a right palm
}

function taken(core: Core, at: number): TouchedState {
  const a = core.take(at);
  const [problem, end, refusal, ...kinds] =
    core.text(core.wasm.touched_text()).split("\n") as [string, string, string];
  const contacts = Array.from({ length: a[1]! }, (_, i): Touched => {
    const [carrier, place, x, y, nx, ny, friction] = a.subarray(2 + 7 * i) as unknown as number[];
    return {
      kind: (kinds as string[])[i]!, carrier: carrier!, place: place!, at: [x!, y!], normal: [nx!, ny!],
      friction: friction!,
    };
  });
  const rest = a.subarray(2 + 7 * contacts.length);
  return { problem, end, refusal, held: a[0] === 1, contacts, starts: [rest[0]!, rest[1]!], places: rest.slice(2) };
}

export function touchedOnPalms(core: Core, theta: Xy, p: Xy): TouchedState {
  return taken(core, core.wasm.touch_palms(...theta, ...p));
}

export function touchedOnFloor(core: Core, theta: Xy, floor: FloorNumbers): TouchedState {
  return taken(core, core.wasm.touch_floor(...theta, ...floor.driven, floor.raised, floor.friction, Number(floor.hasRight)));
}

// The contact modes that may occur in the state that was asked for last, while the palms move.
export function modesOf(core: Core, contacts: Touched[], palms: PalmMotions): Mode[] {
  const code = (i: number, motion: number) =>
    tables.motionCodes[contacts[i]!.carrier === 0 ? 0 : 1]![String(motion)]!;
  // A palm whose angle grows turns clockwise on the left.
  const [l, r] = palms;
  const a = core.take(core.wasm.touched_modes(l[0], l[1], -l[2], r[0], r[1], r[2]));
  const width = 6 * contacts.length + 1;
  return Array.from({ length: a.length / width }, (_, k) => {
    const own = a.subarray(width * k, width * (k + 1));
    const each = <T>(make: (at: number, i: number) => T): T[] => contacts.map((_, i) => make(6 * i, i));
    const margin = own[width - 1]!;
    return {
      motions: each((at, i) => code(i, own[at]!)),
      normal: each((at): Range => [own[at + 1]!, own[at + 2]!]),
      friction: each((at): Range => [own[at + 3]!, own[at + 4]!]),
      limits: Number.isFinite(margin) ? each((at, i) => code(i, own[at + 5]!)) : null,
      margin,
    };
  });
}
