// SPDX-License-Identifier: Apache-2.0
// The sequence chart of a counterexample: a column for each step, a lane for each robot with its
// contact, palm and drive, and between the lanes the messages.
import type { Surface } from "../shared/canvas";
import { type Counterexample, type RobotStep, flightsOf } from "../shared/counterexamples";
import { line, write } from "../shared/strokes";
import { type Palette, sideColour } from "../shared/theme";

const LEFT = 44;
const LEAST_COLUMN = 30;
const LANE = 74;
const GAP = 78;
const TOP = 4;
export const PROOF_CHART_HEIGHT = TOP + 2 * LANE + GAP + 20;

const MINUS = "−";
export const positionText = (position: number) => (position > 0 ? `+${position}` : String(position).replace("-", MINUS));

interface Columns {
  width: number; // of a column
  first: number; // x of the first one, which may lie outside
}

// The columns, moved so that the present step can be seen.
function columnsOf(width: number, count: number, place: number): Columns {
  const room = width - LEFT - 6;
  const column = Math.min(90, Math.max(LEAST_COLUMN, room / count));
  const hidden = Math.max(0, column * count - room);
  const wanted = Math.max(0, (place + 0.5) * column - 0.5 * room);
  return { width: column, first: LEFT - Math.min(hidden, wanted) };
}

export function stepAt(width: number, count: number, place: number, x: number): number {
  const columns = columnsOf(width, count, place);
  const step = Math.floor((x - columns.first) / columns.width);
  return Math.min(count - 1, Math.max(0, step));
}

function arrow(c: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number): void {
  line(c, x0, y0, x1, y1);
  const turn = Math.atan2(y1 - y0, x1 - x0);
  for (const side of [-0.45, 0.45]) {
    line(c, x1, y1, x1 - 6 * Math.cos(turn + side), y1 - 6 * Math.sin(turn + side));
  }
}

const laneTop = (side: number) => TOP + side * (LANE + GAP);

// One robot in one step: position, palm, drive, from above.
function drawRobot(
  surface: Surface, p: Palette, robot: RobotStep, side: number, x: number, width: number,
): void {
  const c = surface.context;
  const y = laneTop(side);
  const colour = sideColour(p, side);
  const middle = x + width / 2;
  if (robot.case || (robot.drive && robot.drive !== "hold")) {
    c.globalAlpha = 0.16;
    c.fillStyle = colour;
    c.fillRect(x + 1, y, width - 2, LANE);
    c.globalAlpha = 1;
  }
  const position = robot.position === undefined ? "" : positionText(robot.position);
  const head = [robot.case ? `(${robot.case})` : "", position].filter(Boolean).join(width < 44 ? "" : " ");
  if (robot.arm !== undefined) {
    const [ground, unit] = [y + LANE - 8, 13];
    c.fillStyle = c.strokeStyle = colour;
    c.fillRect(middle - 6, ground - unit * robot.arm - 3, 12, 3 + unit * robot.arm);
    if (width >= 60) write(c, robot.name!.replace("_", " "), middle, y + 10, colour, { weight: 650, size: 11 });
    return;
  }
  if (!robot.palm) {
    // The model has no palms, only whether a robot hears its partner.
    c.beginPath();
    c.arc(middle, y + LANE / 2, 7, 0, 2 * Math.PI);
    c.strokeStyle = c.fillStyle = colour;
    c.lineWidth = 1.5;
    if (robot.state.endsWith("partner")) c.fill();
    c.stroke();
    return;
  }
  if (width < 44 && robot.case) {
    write(c, robot.case, middle, y + 10, colour, { weight: 700 });
    write(c, position, middle, y + 25, p.ink);
  } else {
    write(c, head, middle, y + 16, robot.case ? colour : p.ink,
      { weight: robot.case ? 650 : 400 });
  }
  const out = side === 0 ? -1 : 1;
  const reach = Math.min(15, width / 2 - 3);
  const rise = robot.palm === "steep" ? 0.5 : 0.12;
  c.strokeStyle = colour;
  c.lineWidth = 3;
  c.setLineDash(robot.turns ? [4, 3] : []);
  line(c, middle - out * reach, y + 44 + rise * reach, middle + out * reach, y + 44 - rise * reach);
  c.setLineDash([]);
  c.strokeStyle = p.ink;
  c.lineWidth = 1.5;
  const below = y + 64;
  if (robot.drive === "away") arrow(c, middle - out * 8, below, middle + out * 8, below);
  else if (robot.drive === "closer") arrow(c, middle + out * 8, below, middle - out * 8, below);
  else if (robot.stands) c.strokeRect(middle - 4, below - 4, 8, 8);
  if (robot.misses) write(c, "missed", middle, below + 1, p.drop, { weight: 650, size: 9 });
}

function drawMessages(surface: Surface, p: Palette, item: Counterexample, columns: Columns): void {
  const c = surface.context;
  const at = (step: number) => columns.first + step * columns.width;
  const until = [-1e9, -1e9];
  for (const flight of flightsOf(item)) {
    const [from, to] = flight.sender === 0
      ? [TOP + LANE + 2, TOP + LANE + GAP - 2] : [TOP + LANE + GAP - 2, TOP + LANE + 2];
    const x0 = at(flight.from);
    const x1 = at(Math.max(flight.from, flight.to)) + 10;
    const lost = flight.fate === "lost";
    const underWay = flight.to >= item.steps.length;
    c.strokeStyle = lost ? p.drop : p.ink;
    c.lineWidth = 1.5;
    if (lost) {
      const [x, y] = [(x0 + x1) / 2, (from + to) / 2];
      line(c, x0, from, x, y);
      line(c, x - 5, y - 5, x + 5, y + 5);
      line(c, x - 5, y + 5, x + 5, y - 5);
    } else {
      if (underWay) c.setLineDash([4, 3]);
      arrow(c, x0, from, x1, to);
      c.setLineDash([]);
    }
    const y = flight.sender === 0 ? from + 16 : from - 16;
    const x = Math.max(x0 + (lost ? 8 : 6), until[flight.sender]! + 6);
    const words = flight.name + (flight.fate ? `, ${flight.fate}` : "");
    write(c, words, x, y, lost ? p.drop : p.ink, { align: "left", size: 11 });
    until[flight.sender] = x + c.measureText(words).width;
  }
}

// Bumps and reboots: a mark above the column in which they show.
function drawEvents(surface: Surface, p: Palette, item: Counterexample, columns: Columns): void {
  const c = surface.context;
  const mark = (step: number, side: 0 | 1, words: string) => {
    const x = columns.first + step * columns.width;
    const y = side === 0 ? TOP + LANE + 8 : TOP + LANE + GAP - 8;
    c.fillStyle = p.both;
    c.beginPath();
    c.moveTo(x, y - 5);
    c.lineTo(x + 5, y);
    c.lineTo(x, y + 5);
    c.lineTo(x - 5, y);
    c.fill();
    if (columns.width > 40) write(c, words, x + 8, y, p.quiet, { align: "left", size: 11 });
  };
  item.steps.forEach((step, k) => {
    for (const event of step.before) {
      if (event.sender !== undefined || event.robot == null) continue;
      const words = event.text.startsWith("a bump") ? "bump" : event.text.replace(/^(left|right) /, "");
      mark(k, event.robot, words.startsWith("the copy") ? "copy" : words);
    }
  });
}

export function drawProofChart(
  surface: Surface, p: Palette, item: Counterexample, place: number,
): void {
  const c = surface.context;
  const columns = columnsOf(surface.width, item.steps.length, place);
  const bottom = TOP + 2 * LANE + GAP;
  c.save();
  c.beginPath();
  c.rect(LEFT - 1, 0, surface.width - LEFT + 1, surface.height);
  c.clip();
  item.steps.forEach((step, k) => {
    const x = columns.first + k * columns.width;
    if (x + columns.width < LEFT || x > surface.width) return;
    if (k === place) {
      c.fillStyle = p.zeroPale;
      c.fillRect(x, 0, columns.width, bottom);
    }
    c.strokeStyle = p.rule;
    c.lineWidth = 1;
    line(c, Math.round(x) + 0.5, 0, Math.round(x) + 0.5, bottom);
    step.robots.forEach((robot, side) => drawRobot(surface, p, robot, side, x, columns.width));
    write(c, String(k + 1), x + columns.width / 2, bottom + 11, k === place ? p.ink : p.quiet,
      { weight: k === place ? 700 : 400, size: 11 });
  });
  for (const side of [0, 1]) {
    c.strokeStyle = sideColour(p, side);
    c.lineWidth = 1.5;
    const y = side === 0 ? TOP + LANE : TOP + LANE + GAP;
    const end = columns.first + item.steps.length * columns.width;
    line(c, Math.max(LEFT, columns.first), y, Math.min(surface.width, end), y);
  }
  drawMessages(surface, p, item, columns);
  drawEvents(surface, p, item, columns);
  if (item.loop !== null) {
    const x = columns.first + item.loop * columns.width;
    c.strokeStyle = p.drop;
    c.lineWidth = 2;
    line(c, x + 2, bottom + 1, columns.first + item.steps.length * columns.width - 2, bottom + 1);
  }
  c.restore();
  for (const side of [0, 1]) {
    write(c, side === 0 ? "left" : "right", LEFT - 8, laneTop(side) + LANE / 2, sideColour(p, side),
      { align: "right", weight: 650 });
  }
}
