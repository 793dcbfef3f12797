// SPDX-License-Identifier: Apache-2.0
// The pinned counterexamples of the model checker, as scripts/site_tables.py writes them, and at
// which times a carry is where they are.
import type { Recorded } from "./core";
import { ROW } from "./core";
import { type Json, type Scene, SIDES } from "./tables";

// A robot in one step. A model without contacts gives no position, and one without robots only a state.
export interface RobotStep {
  position?: number;
  arm?: number; // its height in cycles of motion, in the model of jobs on the floor
  case?: string;
  name?: string;
  state: string; // in the file its number
  palm?: "steep" | "shallow";
  turns?: boolean;
  drive?: "hold" | "away" | "closer";
  waits?: string;
  stands?: boolean;
  misses?: boolean;
}

// What happens between two steps: a message has a sender, anything else at most a robot.
interface ProofEvent {
  text: string;
  sender?: 0 | 1;
  name?: string;
  fate?: "" | "lost" | "copied";
  robot?: 0 | 1 | null;
}

export interface Counterexample {
  name: string;
  title: string;
  claim: string;
  meaning: string; // of the claim, as the model states it
  isShortest: boolean; // no run with fewer steps of the model shows it
  controller: string;
  steps: { before: ProofEvent[]; robots: [RobotStep, RobotStep] }[];
  after: ProofEvent[];
  loop: number | null;
  scene: Scene | null;
}

// The file: a robot has the number of its state among all states in words.
export interface CounterexampleFile {
  states: string[];
  runs: Counterexample[];
}

export function counterexamplesOf(file: CounterexampleFile): Counterexample[] {
  return file.runs.map((run) => ({
    ...run,
    steps: run.steps.map((step) => ({
      ...step,
      robots: step.robots.map((robot) => ({ ...robot, state: file.states[Number(robot.state)]! })) as [RobotStep, RobotStep],
    })),
  }));
}

export interface Flight {
  sender: 0 | 1;
  name: string;
  fate: "" | "lost" | "copied";
  from: number; // the step before which it is sent
  to: number; // the first step that can act on it; the number of steps: it is still under way
}

// What a robot waits for, as a message can end it.
function waitsFor(robot: RobotStep, name: string): boolean {
  return robot.waits === name || (robot.waits === "an answer" && name !== "TiltDown");
}

// The messages of a run. A transcript does not say when a message arrives: a robot that waits for it
// stops waiting then. Where no robot waits, it is there in the next step.
export function flightsOf(item: Counterexample): Flight[] {
  const found: Flight[] = [];
  item.steps.forEach((step, from) => {
    for (const event of step.before) {
      if (event.sender === undefined) continue;
      const receiver = (1 - event.sender) as 0 | 1;
      let to = from;
      if (event.fate !== "lost" && event.name !== "TiltUp") {
        while (to < item.steps.length && waitsFor(item.steps[to]!.robots[receiver], event.name!)) ++to;
      }
      found.push({ sender: event.sender, name: event.name!, fate: event.fate!, from, to });
    }
  });
  return found;
}

// The time of each step in a carry of the same messages: that of the newest message or reboot, and
// between them evenly spaced. If the messages differ, the steps are spread over the carry.
export function stepTimes(item: Counterexample, run: Recorded): number[] {
  const count = item.steps.length;
  const known = anchors(item, run);
  const spacing = 0.35; // s, where nothing fixes the time
  const last = known.at(-1);
  const dropped = run.outcome === 2;
  if (!last) {
    const start = run.corrections[0]?.start ?? 0;
    return item.steps.map((_, k) => start + ((run.time - start) * k) / Math.max(1, count - 1));
  }
  if (last.step < count - 1) {
    const end = dropped ? run.time : Math.min(run.time, last.time + spacing * (count - 1 - last.step));
    known.push({ step: count - 1, time: end });
  }
  const first = known[0]!;
  if (first.step > 0) known.unshift({ step: 0, time: Math.max(0, first.time - spacing * first.step) });
  return item.steps.map((_, k) => {
    const after = known.findIndex((a) => a.step >= k);
    const b = known[after]!;
    const a = known[Math.max(0, after - 1)]!;
    return b.step === a.step ? b.time : a.time + ((b.time - a.time) * (k - a.step)) / (b.step - a.step);
  });
}

function anchors(item: Counterexample, run: Recorded): { step: number; time: number }[] {
  const period = run.count > 1 ? run.rows[ROW.width]! : 0;
  const sent = SIDES.map((_, side) => run.messages.filter((m) => m.sender === side));
  const boots = ((item.scene?.faults as { [key: string]: Json })?.script ?? []) as {
    [key: string]: Json;
  }[];
  const next = [0, 0];
  const found: { step: number; time: number }[] = [];
  for (const [step, { before }] of item.steps.entries()) {
    for (const event of before) {
      let time: number | undefined;
      if (event.sender !== undefined) {
        const message = sent[event.sender]![next[event.sender]!++];
        if (message?.kind !== event.name) return [];
        time = message!.sent + period;
      } else if (event.text.endsWith("reboots")) {
        time = boots.find((f) => f.robot === SIDES[event.robot!])?.at_s as number | undefined;
      }
      const before = found.at(-1);
      if (time === undefined || (before && time < before.time)) continue;
      if (before?.step === step) before.time = time;
      else found.push({ step, time });
    }
  }
  return found;
}
