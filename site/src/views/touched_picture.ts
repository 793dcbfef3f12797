// SPDX-License-Identifier: Apache-2.0
// The picture of everything that touches: contacts with normals and friction cones, the forces of one
// contact mode, and close-ups of what is too small to be seen beside the palms.
import { type Block, drawBlocks } from "../shared/blocks";
import type { Surface } from "../shared/canvas";
import { PLACES } from "../shared/core";
import type { Xy } from "../shared/object_transform";
import { type View, onFloor } from "../shared/pair_view";
import { line, write } from "../shared/strokes";
import { type Palette, sideColour } from "../shared/theme";
import type { Mode, Range, Touched } from "../shared/touched";

export interface TouchedPicture {
  places: Float64Array;
  contacts: Touched[];
  mode: Mode | null;
  hasFloor: boolean;
  blocks: Block[]; // walls and stands on the floor
  isAlone: boolean; // there is no right palm
  isThin: boolean; // palms without a thickness
}

const CORNERS = (PLACES.outline - PLACES.plate) / 4;
const PALM_NAMES = ["left palm", "right palm"];
const nameOf = (one: Touched) => PALM_NAMES[one.carrier] ?? one.kind;
const WEIGHT = 88; // length of a force as large as the weight [px]
const MOST_WEIGHTS = 1.6; // at which an arrow is cut

// What the table calls a contact, and what the picture calls it.
export function contactNames(contacts: Touched[]): { long: string; short: string }[] {
  return contacts.map((one, i) => {
    const long = nameOf(one);
    const same = contacts.filter((other) => nameOf(other) === long).length;
    const number = contacts.slice(0, i + 1).filter((other) => nameOf(other) === long).length;
    const short = long[0]!.toUpperCase();
    return same > 1 ? { long: `${long} ${number}`, short: `${short}${number}` } : { long, short };
  });
}

const carrierColour = (p: Palette, carrier: number) => (carrier < 2 ? sideColour(p, carrier) : p.both);

function trace(c: CanvasRenderingContext2D, points: Xy[]): void {
  c.beginPath();
  points.forEach(([x, y], i) => (i === 0 ? c.moveTo(x, y) : c.lineTo(x, y)));
  c.closePath();
}

function pointsOf(at: View, places: Float64Array, from: number, to: number): Xy[] {
  const found: Xy[] = [];
  for (let i = from; i < to; i += 2) found.push([at.x(places[i]!), at.y(places[i + 1]!)]);
  return found;
}

// Floor, object and palms as they are, with thin lines.
function drawShapes(surface: Surface, at: View, p: Palette, picture: TouchedPicture): void {
  const c = surface.context;
  const { places } = picture;
  if (picture.hasFloor) {
    const y = at.y(0);
    const wide = 2 * surface.width;
    c.fillStyle = p.ground;
    c.fillRect(-wide, y, 2 * wide + surface.width, 2 * surface.height);
    c.strokeStyle = p.edge;
    c.lineWidth = 1.2;
    line(c, -wide, y, wide + surface.width, y);
    drawBlocks(c, at, p, picture.blocks);
  }
  trace(c, pointsOf(at, places, PLACES.outline, places.length));
  c.fillStyle = p.object;
  c.globalAlpha = 0.55;
  c.fill();
  c.globalAlpha = 1;
  c.strokeStyle = p.objectEdge;
  c.lineWidth = 1.5;
  c.stroke();
  for (const side of picture.isAlone ? [0] : [0, 1]) {
    c.strokeStyle = c.fillStyle = sideColour(p, side);
    if (picture.isThin) {
      const [inner, outer] = [PLACES.inner, PLACES.outer].map((start) =>
        pointsOf(at, places, start + 2 * side, start + 2 * side + 2)[0]!) as [Xy, Xy];
      c.lineWidth = 3;
      line(c, ...inner, ...outer);
      continue;
    }
    const start = PLACES.plate + 2 * CORNERS * side;
    trace(c, pointsOf(at, places, start, start + 2 * CORNERS));
    c.globalAlpha = 0.75;
    c.fill();
    c.globalAlpha = 1;
    c.lineWidth = 1.2;
    c.stroke();
  }
}

const screen = (v: Xy): Xy => [v[0], -v[1]];

function arrow(c: CanvasRenderingContext2D, x: number, y: number, dx: number, dy: number): void {
  const size = Math.hypot(dx, dy);
  if (size < 3) return;
  const [ux, uy] = [dx / size, dy / size];
  const head = Math.min(9, 0.6 * size);
  line(c, x, y, x + dx - ux * head * 0.7, y + dy - uy * head * 0.7);
  trace(c, [
    [x + dx, y + dy], [x + dx - ux * head - uy * head * 0.45, y + dy - uy * head + ux * head * 0.45],
    [x + dx - ux * head + uy * head * 0.45, y + dy - uy * head - ux * head * 0.45],
  ]);
  c.fill();
}

// Normal and friction cone: a wedge with the normal as a dashed line.
function drawCone(c: CanvasRenderingContext2D, p: Palette, x: number, y: number, one: Touched, reach: number): void {
  const [nx, ny] = screen(one.normal);
  const half = Math.atan(one.friction);
  const turn = (angle: number): Xy => [
    x + reach * (nx * Math.cos(angle) - ny * Math.sin(angle)),
    y + reach * (nx * Math.sin(angle) + ny * Math.cos(angle)),
  ];
  const colour = carrierColour(p, one.carrier);
  trace(c, [[x, y], turn(-half), turn(half)]);
  c.fillStyle = c.strokeStyle = colour;
  c.globalAlpha = 0.16;
  c.fill();
  c.globalAlpha = 1;
  c.lineWidth = 1.3;
  line(c, x, y, ...turn(-half));
  line(c, x, y, ...turn(half));
  c.setLineDash([3, 3]);
  line(c, x, y, ...turn(0));
  c.setLineDash([]);
}

const end = (value: number) => Math.min(MOST_WEIGHTS, Math.max(-MOST_WEIGHTS, value));
const middle = ([low, high]: Range) => (end(low) + end(high)) / 2;

// The force of a contact: an arrow; where it is not determined, to the middle of its ranges, over the
// region that both ranges span.
function drawForce(
  c: CanvasRenderingContext2D, p: Palette, x: number, y: number, one: Touched, normal: Range, friction: Range,
  weight: number,
): void {
  const [nx, ny] = screen(one.normal);
  const [lx, ly] = screen([-one.normal[1], one.normal[0]]);
  const tip = (n: number, f: number): Xy => [weight * (n * nx + f * lx), weight * (n * ny + f * ly)];
  const [n0, n1, f0, f1] = [end(normal[0]), end(normal[1]), end(friction[0]), end(friction[1])];
  c.strokeStyle = c.fillStyle = p.ink;
  if (n1 - n0 > 5e-4 || f1 - f0 > 5e-4) {
    trace(c, [tip(n0, f0), tip(n0, f1), tip(n1, f1), tip(n1, f0)].map(([dx, dy]): Xy => [x + dx, y + dy]));
    c.globalAlpha = 0.22;
    c.fill();
    c.globalAlpha = 1;
    c.lineWidth = 1;
    c.stroke();
  }
  c.lineWidth = 2.4;
  arrow(c, x, y, ...tip(middle(normal), middle(friction)));
}

// Contacts: green where they stick, yellow where they slide, empty where they break.
function drawContacts(surface: Surface, at: View, p: Palette, picture: TouchedPicture, isClose: boolean): void {
  const c = surface.context;
  const { places, contacts, mode } = picture;
  const com: Xy = [places[PLACES.com]!, places[PLACES.com + 1]!];
  const spots = contacts.map((one): Xy => [at.x(com[0] + one.at[0]), at.y(com[1] + one.at[1])]);
  contacts.forEach((one, i) => drawCone(c, p, ...spots[i]!, one, isClose ? 29 : 58));
  if (mode) {
    contacts.forEach((one, i) =>
      drawForce(c, p, ...spots[i]!, one, mode.normal[i]!, mode.friction[i]!, isClose ? 48 : WEIGHT));
  }
  const names = contactNames(contacts);
  contacts.forEach((one, i) => {
    const [x, y] = spots[i]!;
    const motion = mode?.motions[i] ?? "ST";
    c.beginPath();
    c.arc(x, y, 4.5, 0, 2 * Math.PI);
    c.fillStyle = motion === "BR" ? p.background : motion === "ST" ? p.zero : p.slides;
    c.fill();
    c.strokeStyle = p.ink;
    c.lineWidth = 1.3;
    c.stroke();
    const [nx, ny] = screen(one.normal);
    const text = mode ? `${names[i]!.short} ${motion}` : names[i]!.short;
    const above = isClose ? 38 : 68; // beyond the cone
    write(c, text, x + nx * above, y + ny * above, p.ink, { size: 11, weight: 650, align: Math.abs(nx) > 0.7 ? (nx > 0 ? "left" : "right") : "center" });
  });
}

function drawWeight(surface: Surface, at: View, p: Palette, places: Float64Array): void {
  const c = surface.context;
  const [x, y] = at.turned(at.x(places[PLACES.com]!), at.y(places[PLACES.com + 1]!));
  c.strokeStyle = c.fillStyle = p.ink;
  c.lineWidth = 2.4;
  arrow(c, x, y, 0, WEIGHT);
  c.beginPath();
  c.arc(x, y, 5, 0, 2 * Math.PI);
  c.fillStyle = p.background;
  c.fill();
  c.lineWidth = 1.4;
  c.stroke();
  write(c, "weight", x + 8, y + WEIGHT - 4, p.ink, { align: "left", size: 11 });
}

export function drawTouched(surface: Surface, at: View, p: Palette, picture: TouchedPicture): void {
  onFloor(surface, at, () => drawShapes(surface, at, p, picture));
  drawWeight(surface, at, p, picture.places);
  onFloor(surface, at, () => drawContacts(surface, at, p, picture, false));
}

// A window onto the surroundings of a point, in a corner of the picture.
export function drawCloseUp(
  surface: Surface, at: View, p: Palette, picture: TouchedPicture, side: 0 | 1, centre: Xy, span: number,
): void {
  const c = surface.context;
  const [wide, high] = [Math.min(170, 0.21 * surface.width), Math.min(118, 0.36 * surface.height)];
  const left = side === 0 ? 6 : surface.width - wide - 6;
  const [cx, cy] = [left + wide / 2, 6 + high / 2];
  const scale = wide / span;
  const turn = (x: number, y: number, angle: number): Xy => [
    cx + (x - cx) * Math.cos(angle) + (y - cy) * Math.sin(angle),
    cy - (x - cx) * Math.sin(angle) + (y - cy) * Math.cos(angle),
  ];
  const close: View = {
    scale,
    x: (x) => cx + (x - centre[0]) * scale,
    y: (y) => cy - (y - centre[1]) * scale,
    worldX: (x) => centre[0] + (x - cx) / scale,
    tilt: at.tilt,
    turned: (x, y) => turn(x, y, at.tilt),
    level: (x, y) => turn(x, y, -at.tilt),
  };
  c.save();
  c.beginPath();
  c.roundRect(left, 6, wide, high, 6);
  c.clip();
  c.fillStyle = p.background;
  c.fillRect(left, 6, wide, high);
  onFloor(surface, close, () => {
    drawShapes(surface, close, p, picture);
    drawContacts(surface, close, p, picture, true);
  });
  c.restore();
  c.beginPath();
  c.roundRect(left, 6, wide, high, 6);
  c.strokeStyle = p.edge;
  c.lineWidth = 1.2;
  c.stroke();
  const mm = 1000 * span > 30 ? 10 : 1000 * span > 12 ? 5 : 2;
  c.strokeStyle = p.ink;
  line(c, left + 8, high - 3, left + 8 + (mm / 1000) * scale, high - 3);
  write(c, `${mm} mm`, left + 8, high - 11, p.ink, { align: "left", size: 11 });
}
