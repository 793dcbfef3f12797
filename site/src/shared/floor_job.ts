// SPDX-License-Identifier: Apache-2.0
// Jobs that begin or end on the floor or on a stand: which ones the page carries, their phases, and why one failed.
import type { Phase, Recorded, SceneFacts } from "./core";
import { fromPaper } from "./scene";
import { refuse } from "./scene_shape";
import { type Overrides, get } from "./scene_values";
import { type Scene, tables } from "./tables";

const { free, checked } = tables.jobs;

const isJob = (run: Recorded) => run.phases.length > 0;

// A scene as text, without what the analysis does not depend on.
function essence(base: string, overrides: Overrides): string {
  const keys = Object.entries(fromPaper(base, overrides)).filter(([key]) => !free.includes(key));
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
  const own = Object.keys(overrides).find((one) => ![...free, "object", "palm.heel_m"].includes(one));
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

export const STAGES = [...new Set(tables.lifting.map((one) => one.stage))];

// What was not achieved, by the last phase of an attempt of the robot that got less far; "": nothing.
export function failureOf(run: Recorded): string {
  if (!isJob(run) || run.outcome === 1) return "";
  const last = [0, 1].map((side) =>
    run.phases.map((one) => ({ ...tables.lifting[one.state]!, side: one.side }))
      .filter((one) => one.side === side && !one.isRetry).at(-1)!,
  );
  return last.reduce((one, other) => (other.rank < one.rank ? other : one)).missed;
}
