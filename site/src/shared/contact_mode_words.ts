// SPDX-License-Identifier: Apache-2.0
// The contact mode of a motion, and the inequality that decides it, in the words of the package
// (src/palmbots/mechanics/contact_mode_words.py).
import type { Statics } from "./core";
import { filledIn, tables } from "./tables";
import type { Mode } from "./touched";

export const NOT_HELD = -1;
export const JAMMED = -2;

const TIE = 1e-9; // ends that are closer than this are the same one

// How a contact moves in a contact mode, in the order of the core.
const MOTIONS = ["sticks", "up", "down"];

function filled(name: string, values: Record<string, string> = {}): string {
  return filledIn(tables.contactModeSentences[name]!, values);
}

export function motionsOf(mode: number): [number, number] {
  return [Math.floor(mode / 3), mode % 3];
}

export function contactModeName(mode: number): string {
  if (mode === NOT_HELD) return "not held";
  if (mode === JAMMED) return "jammed";
  return tables.contactModes[mode]!;
}

export function contactModeWords(mode: number): string {
  if (mode === NOT_HELD) return filled("not_held");
  if (mode === JAMMED) return filled("jammed");
  const [left, right] = motionsOf(mode).map((motion) => filled(MOTIONS[motion]!)) as [string, string];
  return filled("mode", { left, right });
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
    return filled("apart", {
      left_low: end(leftLow), left_high: end(leftHigh),
      right_low: end(rightLow), right_high: end(rightHigh),
    });
  }
  const [left, right] = closing ? [leftHigh, rightHigh] : [leftLow, rightLow];
  const isLeft = closing ? left <= right : left >= right;
  const [first, second] = isLeft ? [left, right] : [right, left];
  if (!Number.isFinite(first)) return filled("endless");
  const name = closing ? "closing" : "opening";
  if (Math.abs(first - second) < TIE) return filled(`${name}_tie`, { first: end(first) });
  // As many digits as show which of the two is smaller.
  const digits = [3, 4, 5, 6].find((n) => end(first, n) !== end(second, n)) ?? 3;
  const [near, far] = isLeft ? ["left", "right"] : ["right", "left"];
  return filled(name, { near, far, first: end(first, digits), second: end(second, digits) });
}

export function marginWords(margin: number): string {
  const angle = `${Math.abs((margin * 180) / Math.PI).toFixed(2)}°`;
  return filled(margin >= 0 ? "margin" : "no_margin", { angle });
}

export function modeMarginWords({ margin }: Mode): string {
  if (!Number.isFinite(margin)) return filled("endless_margin");
  return filled("mode_margin", { angle: `${((margin * 180) / Math.PI).toFixed(2)}°` });
}

// The inequality of a contact that becomes an equation where the margin of a mode ends.
export function limitWords({ motions, limits }: Mode, i: number): string {
  if (!limits || motions[i] === limits[i]) return "";
  return limits[i] === "BR" ? filled("carries_nothing") : filled("at_cone", { motion: limits[i]! });
}
