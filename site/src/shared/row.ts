// SPDX-License-Identifier: Apache-2.0
// Rows of a recorded carry by time.
import { ROW, type Recorded } from "./core";

// The row in force at a time.
export function rowAt(run: Recorded, time: number, period: number): number {
  if (time >= run.time) return run.count - 1;
  return Math.min(run.count - 1, Math.max(0, Math.floor(time / period + 1e-6)));
}

export function cell(run: Recorded, row: number, column: number): number {
  return run.rows[row * ROW.width + column]!;
}

export function pair(run: Recorded, row: number, column: number): [number, number] {
  return [cell(run, row, column), cell(run, row, column + 1)];
}

// The letter of a robot's case, or "". A program may begin as if it had just assisted: nobody assists
// before its partner has asked.
export function caseAt(run: Recorded, row: number, side: number): string {
  const code = cell(run, row, ROW.name + side);
  const letter = code === 32 || code === 0 ? "" : String.fromCharCode(code);
  const time = cell(run, row, ROW.time);
  const isAsked = () =>
    run.messages.some((m) => m.sender === 1 - side && m.kind === "TiltUp" && m.sent <= time);
  const began = cell(run, 0, ROW.name + side) === code;
  return letter === "c" && began && !isAsked() ? "" : letter;
}
