// SPDX-License-Identifier: Apache-2.0
// Jobs that begin or end on the floor or on a stand: which ones the page carries, their phases, and why one failed.
import type { Phase, Recorded, SceneFacts } from "./core";
import { fromPaper } from "./scene";
import { refuse } from "./scene_shape";
import { type Overrides, get } from "./scene_values";
import { type Scene, tables } from "./tables";

const { checked } = tables.jobs;

// The keys on which the analysis of a built-in scene's job does not depend.
export const freeIn = (base: string): string[] => tables.jobs.free[base]!;

const isJob = (run: Recorded) => run.phases.length > 0;

// A scene as text, without what the analysis does not depend on.
function essence(base: string, overrides: Overrides): string {
  const keys = Object.entries(fromPaper(base, overrides)).filter(([key]) => !freeIn(base).includes(key));
  return JSON.stringify(keys.sort());
}

const known = new Map(checked.map((one) => [essence(one.scene, one.changes), one]));

// What the analysis of the package finds for the scene; undefined: the page has no answer.
const analysed = (base: string, overrides: Overrides) => known.get(essence(base, overrides));

// Refuses a job that cannot work, and one of which the page cannot say whether it can.
export function checkJob(base: string, overrides: Overrides, scene: Scene, facts: SceneFacts): void {
  if (!facts.isJob) return;
  const found = analysed(base, overrides);
  if (found?.refusal) throw new Error(found.refusal);
  if (found) return;
  const isBuiltIn = checked.some((one) => one.scene === base);
  const own = Object.keys(overrides).find((one) => ![...freeIn(base), "object", "palm.heel_m"].includes(one));
  const key = isBuiltIn ? (own ?? "palm.heel_m") : (get(scene, "task.from") ?? "palms") !== "palms" ? "task.from" : "task.to";
  refuse(
    key, get(scene, key), "may make the job on the floor impossible, and the page cannot check that",
    "that of a built-in scene here, or palmbots carry scene.toml on your computer",
  );
}

// The warnings about a job that the page carries.
export function jobWarnings(base: string, overrides: Overrides, facts: SceneFacts): string[] {
  return facts.isJob ? (analysed(base, overrides)?.warnings ?? []) : [];
}

// The phase of a robot at a time.
export function phaseAt(run: Recorded, side: number, time: number): Phase | undefined {
  return run.phases.filter((one) => one.side === side && one.start <= time + 1e-9).at(-1);
}

const TABLE_SIZE = 32; // of the numbers of phases that one table has

// The stages of the table of phases that a job follows, in their order.
export function stagesOf(run: Recorded): string[] {
  const table = Math.floor(run.phases[0]!.state / TABLE_SIZE);
  const own = Object.entries(tables.lifting).filter(([number]) => Math.floor(Number(number) / TABLE_SIZE) === table);
  return [...new Set(own.map(([, one]) => one).sort((a, b) => a.rank - b.rank).map((one) => one.stage))];
}

// The robot that takes no part in a job; undefined: both do, or it is a carry.
export function absentIn(run: Recorded): number | undefined {
  return isJob(run) ? [0, 1].find((side) => !phaseAt(run, side, run.time)) : undefined;
}

// What was not achieved, by the last phase of an attempt of the robot that got less far; "": nothing.
export function failureOf(run: Recorded): string {
  if (!isJob(run) || run.outcome === 1) return "";
  const last = [0, 1].flatMap((side) =>
    run.phases.map((one) => ({ ...tables.lifting[one.state]!, side: one.side }))
      .filter((one) => one.side === side && !one.isRetry).at(-1) ?? [],
  );
  return last.reduce((one, other) => (other.rank < one.rank ? other : one)).missed;
}
