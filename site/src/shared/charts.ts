// SPDX-License-Identifier: Apache-2.0
// Charts over time: contacts, palms, and the sequence of messages. All share one time axis.
import { type Activity, activitiesOf } from "./activities";
import type { Message, Recorded } from "./core";
import { ROW } from "./core";
import type { Surface } from "./canvas";
import { type Lettering, line, write } from "./strokes";
import { type Palette, sideColour } from "./theme";

export const LEFT_MARGIN = 46;
export const RIGHT_MARGIN = 10;

const AT_AXIS: Lettering = { align: "right", size: 11 };
const LANE_NAME: Lettering = { align: "right", weight: 600, size: 11 };

export interface TimeAxis {
  from: number;
  to: number;
  width: number;
}

function timeX(axis: TimeAxis, time: number): number {
  const inner = axis.width - LEFT_MARGIN - RIGHT_MARGIN;
  return LEFT_MARGIN + ((time - axis.from) / (axis.to - axis.from)) * inner;
}

export function timeAt(axis: TimeAxis, x: number): number {
  const inner = axis.width - LEFT_MARGIN - RIGHT_MARGIN;
  return axis.from + ((x - LEFT_MARGIN) / inner) * (axis.to - axis.from);
}

function niceStep(span: number, most: number): number {
  const raw = span / most;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * ([1, 2, 5, 10].find((k) => k * power >= raw) ?? 10);
}

// Keeps the lines behind a label away from it.
function halo(c: CanvasRenderingContext2D, p: Palette, words: string, x: number, y: number): void {
  c.font = "650 11px system-ui, sans-serif";
  c.strokeStyle = p.background;
  c.lineWidth = 4;
  c.lineJoin = "round";
  c.textAlign = "left";
  c.textBaseline = "middle";
  c.strokeText(words, x, y);
}

// Draws inside the plot only: the axis may show a part of the carry.
function clipped(surface: Surface, draw: () => void): void {
  const c = surface.context;
  c.save();
  c.beginPath();
  c.rect(LEFT_MARGIN, 0, surface.width - LEFT_MARGIN - RIGHT_MARGIN, surface.height);
  c.clip();
  draw();
  c.restore();
}

function drawTimeTicks(surface: Surface, p: Palette, axis: TimeAxis, labels: boolean): void {
  const c = surface.context;
  const step = niceStep(axis.to - axis.from, Math.max(3, surface.width / 110));
  const base = labels ? surface.height - 18 : surface.height;
  c.lineWidth = 1;
  for (let t = Math.ceil(axis.from / step) * step; t <= axis.to + 1e-9; t += step) {
    const x = Math.round(timeX(axis, t)) + 0.5;
    c.strokeStyle = p.rule;
    line(c, x, 0, x, base);
    if (labels) write(c, `${Number(t.toFixed(3))} s`, x, base + 10, p.quiet, { size: 11 });
  }
}

// A curve of the rows: column `at`, in those rows that `shows`, which begin at these places.
function curve(
  surface: Surface, axis: TimeAxis, rows: Float64Array, at: number, y: (value: number) => number,
  shows: (row: number) => boolean = () => true,
): void {
  const c = surface.context;
  const count = rows.length / ROW.width;
  // At most about two points a pixel.
  const period = count > 1 ? rows[ROW.width]! - rows[0]! : 1;
  const first = Math.max(0, Math.floor(axis.from / period) - 1);
  const until = Math.min(count, Math.ceil(axis.to / period) + 2);
  const skip = Math.max(1, Math.floor((until - first) / (2 * surface.width)));
  c.beginPath();
  let isDown = false;
  for (let k = first; k < until; k += skip) {
    const row = k * ROW.width;
    const px = timeX(axis, rows[row]!);
    const py = y(rows[row + at]!);
    if (isDown) c.lineTo(px, py);
    else c.moveTo(px, py);
    isDown = shows(row);
  }
  if (until < count) {
    c.stroke();
    return;
  }
  const last = (count - 1) * ROW.width;
  if (isDown) c.lineTo(timeX(axis, rows[last]!), y(rows[last + at]!));
  c.stroke();
}

const DASHES = [[], [6, 3]];

interface Band {
  from: number;
  to: number;
}

export const TOUCHES_M = 1e-4; // how far above a palm the object touches it

// Contacts in mm: both palms, the zero zone, the ends of the palms. `isWhole`: the axis is as long as
// the palms. In a job on the floor, only while the object touches the palm.
export function drawContacts(
  surface: Surface, p: Palette, axis: TimeAxis, run: Recorded, ghost: Recorded | null, zero: Band,
  half: number, isWhole: boolean,
): void {
  const c = surface.context;
  const largest = Math.max(0.02, 1.15 * Math.max(...run.peak, ...(ghost?.peak ?? [0])));
  const reach = isWhole ? 1.12 * half : Math.min(largest, 1.12 * half);
  const y = (value: number) => surface.height / 2 - (value / reach) * (surface.height / 2 - 6);
  c.fillStyle = p.zeroPale;
  c.fillRect(LEFT_MARGIN, y(zero.to), surface.width - LEFT_MARGIN - RIGHT_MARGIN, y(zero.from) - y(zero.to));
  drawTimeTicks(surface, p, axis, false);
  const step = niceStep(2000 * reach, 5);
  for (let mm = -Math.floor((1000 * reach) / step) * step; mm <= 1000 * reach; mm += step) {
    c.strokeStyle = p.rule;
    c.lineWidth = 1;
    line(c, LEFT_MARGIN, y(mm / 1000), surface.width - RIGHT_MARGIN, y(mm / 1000));
    write(c, `${mm > 0 ? "+" : ""}${mm}`.replace("-", "−"), LEFT_MARGIN - 6, y(mm / 1000), p.quiet, AT_AXIS);
  }
  if (reach >= half) {
    c.strokeStyle = p.drop;
    c.setLineDash([2, 3]);
    for (const end of [-half, half]) line(c, LEFT_MARGIN, y(end), surface.width - RIGHT_MARGIN, y(end));
    c.setLineDash([]);
  }
  for (const [rows, alpha] of [[ghost?.rows, 0.3], [run.rows, 1]] as const) {
    if (!rows) continue;
    for (const side of [0, 1]) {
      c.globalAlpha = alpha;
      c.strokeStyle = sideColour(p, side);
      c.lineWidth = 1.6;
      c.setLineDash(DASHES[side]!);
      const touches = (row: number) => rows[row + ROW.lift + side]! < TOUCHES_M;
      const shows = run.phases.length > 0 ? touches : undefined;
      clipped(surface, () => curve(surface, axis, rows, ROW.contact + side, y, shows));
    }
  }
  c.setLineDash([]);
  c.globalAlpha = 1;
}

export function drawPalms(surface: Surface, p: Palette, axis: TimeAxis, run: Recorded, angles: Band): void {
  const c = surface.context;
  const degrees = 180 / Math.PI;
  const margin = Math.max(1, 0.25 * (angles.to - angles.from));
  const y = (radians: number) =>
    surface.height - 5 -
    ((radians * degrees - angles.from + margin) / (angles.to - angles.from + 2 * margin)) *
      (surface.height - 10);
  drawTimeTicks(surface, p, axis, false);
  for (const angle of [angles.from, angles.to]) {
    c.strokeStyle = p.rule;
    line(c, LEFT_MARGIN, y(angle / degrees), surface.width - RIGHT_MARGIN, y(angle / degrees));
    write(c, `${angle}°`.replace("-", "−"), LEFT_MARGIN - 6, y(angle / degrees), p.quiet, AT_AXIS);
  }
  for (const side of [0, 1]) {
    c.strokeStyle = sideColour(p, side);
    c.lineWidth = 1.6;
    c.setLineDash(DASHES[side]!);
    clipped(surface, () => curve(surface, axis, run.rows, ROW.palm + side, y));
  }
  c.setLineDash([]);
}

// The y of the lines in the sequence chart: of both robots and, between them, of a station.
export interface Lanes {
  robots: [number, number];
  station: number;
  hasStation: boolean;
}

export function lanesOf(hasStation: boolean, isLow: boolean): Lanes {
  const bottom = (hasStation ? 166 : 104) - (isLow ? 14 : 0);
  return { robots: [26, bottom], station: (26 + bottom) / 2, hasStation };
}

export function sequenceHeight(lanes: Lanes): number {
  return lanes.robots[1] + 34;
}

// Solid: corrects; pale with a dashed edge: waits; empty, in the partner's colour: assists.
function drawActivity(
  surface: Surface, p: Palette, axis: TimeAxis, item: Activity, lanes: Lanes,
): void {
  const c = surface.context;
  const x0 = timeX(axis, item.start);
  const x1 = Math.max(timeX(axis, item.end), x0 + 2);
  const y = lanes.robots[item.robot]! - 8;
  const colour = sideColour(p, item.kind === "assists" ? 1 - item.robot : item.robot);
  c.fillStyle = p.background;
  c.fillRect(x0, y, x1 - x0, 16);
  c.fillStyle = c.strokeStyle = colour;
  c.lineWidth = 1.2;
  if (item.kind !== "assists") {
    c.globalAlpha = item.kind === "waits" ? 0.18 : 1;
    c.fillRect(x0, y, x1 - x0, 16);
    c.globalAlpha = 1;
  }
  c.setLineDash(item.kind === "waits" ? [4, 3] : []);
  c.strokeRect(x0, y, x1 - x0, 16);
  c.setLineDash([]);
  if (item.kind === "assists" || x1 - x0 <= 14) return;
  // In the middle of what the axis shows of it.
  const from = Math.max(x0, LEFT_MARGIN);
  const to = Math.min(x1, surface.width - RIGHT_MARGIN);
  const words = item.kind === "waits" && to - from > 60 ? `${item.name} waits` : item.name;
  const ink = item.kind === "waits" ? colour : p.background;
  write(c, words, (from + to) / 2, y + 8.5, ink, { weight: 650, size: 11 });
}

export interface Arrow {
  index: number; // among the messages of the carry
  message: Message;
  x0: number;
  y0: number;
  x1: number;
  y1: number;
}

// The arrows of the messages that a chart shows: of reports and commands those that say something new,
// and the chosen one, because a station sends in every control period.
export function arrowsOf(
  axis: TimeAxis, messages: Message[], latency: number, lanes: Lanes, chosen: number | null = null,
): Arrow[] {
  const found: Arrow[] = [];
  messages.forEach((message, index) => {
    const isStations = message.sender === 2 || message.receiver === 2;
    if (message.sent > axis.to || (isStations && !message.isNews && index !== chosen)) return;
    const lost = Number.isNaN(message.received);
    const share = lost ? 0.5 : 1;
    const arrival = lost ? message.sent + latency * share : message.received;
    if (arrival < axis.from) return;
    const [y0, y1] = [message.sender, message.receiver].map(
      (role) => lanes.robots[role] ?? lanes.station,
    ) as [number, number];
    // An arrow leaves room for the bars on the lines of the robots.
    const inset = 9 * Math.sign(y1 - y0);
    const start = y0 + (message.sender < 2 ? inset : 0);
    const stop = y1 - (message.receiver < 2 ? inset : 0);
    found.push({
      index, message, x0: timeX(axis, message.sent), y0: start, x1: timeX(axis, arrival),
      y1: lost ? start + (stop - start) * share : stop,
    });
  });
  return found;
}

// Where the words of an arrow stand: near the line of the sender.
function wordsY(message: Message, lanes: Lanes): number {
  if (message.sender === 2) return lanes.station + (message.receiver === 0 ? -16 : 16);
  return lanes.robots[message.sender]! + (message.sender === 0 ? 21 : -19);
}

interface MessageLabel {
  index: number;
  name: string;
  x: number;
  y: number;
  width: number;
}
const LETTER_WIDTH = 6.2; // at most, of the labels' letters, on average

// The names beside the arrows, where there is room for them.
export function labelsOf(
  arrows: Arrow[], chosen: number | null, lanes: Lanes,
): MessageLabel[] {
  const found: MessageLabel[] = [];
  const busyUntil = new Map<number, number>();
  for (const { index, message, x0, x1 } of arrows) {
    const [x, y] = [Math.max(x0, x1) + 6, wordsY(message, lanes)];
    if (index !== chosen && (!message.isNews || x <= (busyUntil.get(y) ?? -1e9) + 14)) continue;
    const name = message.short || message.kind;
    const width = LETTER_WIDTH * name.length;
    found.push({ index, name, x, y, width });
    busyUntil.set(y, x + width);
  }
  return found;
}

// The lanes of both robots, and of a station, with corrections, and an arrow for each message.
export function drawSequence(
  surface: Surface, p: Palette, axis: TimeAxis, run: Recorded, latency: number,
  chosen: number | null, isPeriodic: boolean, lanes: Lanes,
): void {
  const c = surface.context;
  drawTimeTicks(surface, p, axis, true);
  if (lanes.hasStation) {
    c.strokeStyle = p.quiet;
    c.lineWidth = 1;
    line(c, LEFT_MARGIN, lanes.station, surface.width - RIGHT_MARGIN, lanes.station);
    write(c, "station", LEFT_MARGIN - 4, lanes.station, p.quiet, { ...LANE_NAME, size: 10 });
  }
  for (const side of [0, 1]) {
    c.strokeStyle = sideColour(p, side);
    c.lineWidth = 1.5;
    line(c, LEFT_MARGIN, lanes.robots[side]!, surface.width - RIGHT_MARGIN, lanes.robots[side]!);
    write(c, side === 0 ? "left" : "right", LEFT_MARGIN - 6, lanes.robots[side]!, sideColour(p, side), LANE_NAME);
  }
  clipped(surface, () => {
    for (const item of activitiesOf(run)) {
      if (item.end >= axis.from && item.start <= axis.to) drawActivity(surface, p, axis, item, lanes);
    }
    drawArrows(surface, p, axis, run, latency, chosen, isPeriodic, lanes);
  });
}

function drawArrows(
  surface: Surface, p: Palette, axis: TimeAxis, run: Recorded, latency: number,
  chosen: number | null, isPeriodic: boolean, lanes: Lanes,
): void {
  const c = surface.context;
  const arrows = arrowsOf(axis, run.messages, latency, lanes, chosen).filter(
    (arrow) => arrow.x1 >= LEFT_MARGIN && arrow.x0 <= surface.width,
  );
  for (const arrow of arrows) {
    const lost = Number.isNaN(arrow.message.received);
    const isChosen = arrow.index === chosen;
    c.strokeStyle = lost ? p.drop : isChosen ? p.ink : p.quiet;
    c.fillStyle = c.strokeStyle;
    c.lineWidth = isChosen ? 2.6 : isPeriodic && !arrow.message.isNews ? 0.7 : 1.3;
    line(c, arrow.x0, arrow.y0, arrow.x1, arrow.y1);
    const turn = Math.atan2(arrow.y1 - arrow.y0, arrow.x1 - arrow.x0);
    c.beginPath();
    if (lost) {
      c.lineWidth = 2;
      line(c, arrow.x1 - 4, arrow.y1 - 4, arrow.x1 + 4, arrow.y1 + 4);
      line(c, arrow.x1 - 4, arrow.y1 + 4, arrow.x1 + 4, arrow.y1 - 4);
    } else if (!isPeriodic || isChosen) {
      for (const side of [-1, 1]) {
        c.moveTo(arrow.x1, arrow.y1);
        c.lineTo(arrow.x1 - 7 * Math.cos(turn + 0.4 * side), arrow.y1 - 7 * Math.sin(turn + 0.4 * side));
      }
      c.stroke();
    }
  }
  for (const { index, name, x, y } of labelsOf(arrows, chosen, lanes)) {
    const lost = Number.isNaN(run.messages[index]!.received);
    halo(c, p, name, x, y);
    write(c, name, x, y, lost ? p.drop : p.ink,
      { align: "left", weight: index === chosen ? 650 : 400, size: 11 });
  }
}
