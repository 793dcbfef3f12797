// SPDX-License-Identifier: Apache-2.0
// What each robot does over time, from the rows of a carry: it corrects, assists, or waits for a message.
import { ROW, type Recorded } from "./core";
import { caseAt, cell } from "./row";

export type Kind = "corrects" | "assists" | "waits";

export interface Activity {
  robot: number;
  kind: Kind;
  name: string; // of the case
  start: number;
  end: number;
}

// The row of a robot's table that is in force, or -1 where a station decides.
export function stateAt(run: Recorded, row: number, side: number): number {
  return cell(run, row, ROW.state + side);
}

function kindAt(run: Recorded, row: number, side: number, name: string): Kind {
  if (name === "c") return "assists";
  return cell(run, row, ROW.waits + side) === 1 ? "waits" : "corrects";
}

export function isWaiting(run: Recorded, row: number, side: number): boolean {
  const name = caseAt(run, row, side);
  return name !== "" && kindAt(run, row, side, name) === "waits";
}

function found(run: Recorded, robot: number): Activity[] {
  const list: Activity[] = [];
  let last: Activity | null = null;
  for (let row = 0; row < run.count; ++row) {
    const time = cell(run, row, ROW.time);
    if (last) last.end = time;
    const name = caseAt(run, row, robot);
    const kind = kindAt(run, row, robot, name);
    if (last && (last.name !== name || last.kind !== kind)) last = null;
    if (!last && name) list.push((last = { robot, kind, name, start: time, end: time }));
  }
  return list;
}

const known = new WeakMap<Recorded, Activity[]>();

// Robots that a station commands have no rows of their own: their corrections take the place.
function fromCorrections(run: Recorded): Activity[] {
  return run.corrections.flatMap(({ robot, assistant, name, start, end }) =>
    [0, 1].filter((side) => robot === 2 || side === robot || side === assistant).map((side): Activity => ({
      robot: side, kind: robot === 2 || side === robot ? "corrects" : "assists", name, start, end,
    })),
  );
}

export function activitiesOf(run: Recorded): Activity[] {
  let list = known.get(run);
  if (!list) {
    const hasRows = run.count > 0 && stateAt(run, 0, 0) >= 0;
    list = hasRows ? [...found(run, 0), ...found(run, 1)] : fromCorrections(run);
    known.set(run, list);
  }
  return list;
}
