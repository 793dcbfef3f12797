// SPDX-License-Identifier: Apache-2.0
// The stages of a job on the floor, below its picture: where each robot is, and a click goes there.
import type { Recorded } from "../shared/core";
import { phaseAt, stagesOf } from "../shared/floor_job";
import { player } from "../shared/state";
import { SIDES, tables } from "../shared/tables";

const AFTER_RESTART = ["held", "land"];

// `seeks`: a stage is a button, and dead if the job does not reach it.
export function Stages(props: { run: Recorded | null; seeks?: boolean }) {
  const { run } = props;
  if (!run || run.phases.length === 0) return null;
  const stageOf = (state: number) => tables.lifting[state]!.stage;
  const now = [0, 1].map((side) => {
    const phase = phaseAt(run, side, player.time.value);
    return phase && stageOf(phase.state);
  });
  const first = (stage: string) => run.phases.find((one) => stageOf(one.state) === stage)?.start;
  const shown = stagesOf(run).filter((stage) => !AFTER_RESTART.includes(stage) || now.includes(stage));
  return (
    <ol class="stages" aria-label="stages of the job">
      {shown.map((stage) => {
        const here = SIDES.filter((_, k) => now[k] === stage);
        const words = (
          <>
            {stage}
            {here.map((side) => <i class={`${side}-mark`} title={`${side} robot`}>{side[0]!.toUpperCase()}</i>)}
          </>
        );
        const start = first(stage);
        return (
          <li aria-current={here.length > 0 ? "step" : undefined}>
            {props.seeks
              ? <button type="button" class="plain" disabled={start === undefined}
                  onClick={() => player.scrub(start!)}>{words}</button>
              : words}
          </li>
        );
      })}
    </ol>
  );
}
