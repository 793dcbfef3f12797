// SPDX-License-Identifier: Apache-2.0
// Carries many times beside the page, and reports after every few carries.
import { Core, type PolicyRow, type Tally } from "./shared/core";
import type { Scene } from "./shared/tables";

export interface Task {
  number: number; // of the task; a newer one replaces it
  scene: Scene;
  rows: PolicyRow[];
  controllers: number[];
  seed: number;
  carries: number;
}

export interface Report {
  task: number;
  controller: number; // place in Task.controllers
  tally: Tally;
  interval: [number, number];
}

const CHUNK = 20;

let newest = 0;

const machine = Core.load();

self.onmessage = async (event: MessageEvent<Task>) => {
  const task = event.data;
  newest = task.number;
  const core = await machine;
  for (let place = 0; place < task.controllers.length; ++place) {
    core.setScene(task.scene);
    core.setPolicy(task.rows);
    core.clearTally();
    const controller = task.controllers[place]!;
    if (core.refusal(controller)) continue;
    for (let done = 0; done < task.carries; done += CHUNK) {
      const tally = core.addToTally(controller, task.seed + done, Math.min(CHUNK, task.carries - done));
      const report: Report = {
        task: task.number, controller: place, tally,
        interval: core.rateInterval(tally.dropped, tally.carries),
      };
      self.postMessage(report);
      await new Promise((resume) => setTimeout(resume)); // a newer task may be waiting
      if (newest !== task.number) return;
    }
  }
};
