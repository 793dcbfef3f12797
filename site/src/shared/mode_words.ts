// SPDX-License-Identifier: Apache-2.0
// The contact mode of a motion, and the inequality that decides it, in words.
import type { Statics } from "./core";
import { tables } from "./tables";

export const NOT_HELD = -1;
export const JAMMED = -2;

// How a contact of a mode moves, in the order of the core: sticks, slides up, slides down.
const MOTIONS = ["sticks", "slides up", "slides down"];

export function motionsOf(mode: number): [number, number] {
  return [Math.floor(mode / 3), mode % 3];
}

export function modeName(mode: number): string {
  if (mode === NOT_HELD) return "not held";
  if (mode === JAMMED) return "jammed";
  return tables.modes[mode]!;
}

export function modeWords(mode: number): string {
  if (mode === NOT_HELD) return "no squeeze holds the object: it slides on both palms";
  if (mode === JAMMED) return "no squeeze makes a contact slide: the object is jammed";
  const [l, r] = motionsOf(mode);
  return `the left contact ${MOTIONS[l]}, the right one ${MOTIONS[r]}`;
}

function end(value: number, digits = 3): string {
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  return value.toFixed(digits).replace("-", "−");
}

// The comparison of squeezes that decides a motion.
export function decision(found: Statics, closing: boolean): string {
  const [[leftLow, leftHigh], [rightLow, rightHigh]] = found.squeeze as [
    [number, number],
    [number, number],
  ];
  if (found.closing === NOT_HELD) {
    return `I_L = [${end(leftLow)}, ${end(leftHigh)}] and I_R = [${end(rightLow)}, ${end(rightHigh)}] have no squeeze in common.`;
  }
  const [one, two] = closing ? [leftHigh, rightHigh] : [leftLow, rightLow];
  const first = closing ? one <= two : one >= two;
  const edge = closing ? "upper" : "lower";
  const grows = closing ? "rises" : "falls";
  const relation = closing ? "≤" : "≥";
  if (Math.abs(one - two) < 1e-9) {
    return `The squeeze ${grows} until it reaches the ${edge} edges of both cones at once: H = ${end(one)}.`;
  }
  const [near, far] = first ? [one, two] : [two, one];
  // As many digits as show which of the two is smaller.
  const digits = [3, 4, 5, 6].find((n) => end(near, n) !== end(far, n)) ?? 3;
  const [nearSide, farSide] = first ? ["left", "right"] : ["right", "left"];
  return (
    `The squeeze ${grows} until it reaches the ${edge} edge of the ${nearSide} cone first: ` +
    `H = ${end(near, digits)} there ${relation} ${end(far, digits)} at the ${edge} edge of the ${farSide} cone.`
  );
}
