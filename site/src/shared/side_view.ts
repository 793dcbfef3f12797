// SPDX-License-Identifier: Apache-2.0
// Draws the pair from the side: robots, palms, object, contacts, friction cones, a message in flight.
//
// The core places every point; pair_view.ts maps them to the screen.
import { type Block, drawBlocks } from "./blocks";
import { PLACES } from "./core";
import { type View, onFloor } from "./pair_view";
import { write } from "./strokes";
import { type Palette, sideColour } from "./theme";
import { tables } from "./tables";
import type { Surface } from "./canvas";

const { body, wheels, shoulder } = tables.robot; // the right one

const PLATE_CORNERS = (PLACES.outline - PLACES.plate) / 4;

export interface Flight {
  from: number; // side
  share: number; // of the way
  name: string;
  lost: boolean;
}

interface SidePicture {
  places: Float64Array;
  motion?: [number, number]; // of the contacts: up 1, sticks 0, down −1
  touches?: [boolean, boolean]; // whether the object touches the palms
  tags?: [string, string]; // on the robots' bodies
  waits?: [boolean, boolean]; // which of them wait for a message
  off?: [boolean, boolean];
  zones?: { from: number; to: number }; // the zero zone along each palm [m]
  flights?: Flight[];
  cones?: { x: number; y: number; height: number }[][];
  gravity?: boolean;
  blocks?: Block[]; // walls and stands
  start?: number; // of the COM [m]
  absent?: number; // the robot that takes no part
  labels?: boolean;
  floor?: boolean;
  dropped?: boolean;
}

function path(c: CanvasRenderingContext2D, points: [number, number][], close = true): void {
  c.beginPath();
  points.forEach(([x, y], i) => (i === 0 ? c.moveTo(x, y) : c.lineTo(x, y)));
  if (close) c.closePath();
}

function drawFloor(surface: Surface, view: View, p: Palette, level: number): void {
  const c = surface.context;
  const y = view.y(level);
  c.fillStyle = p.ground;
  const [from, to] = view.tilt ? [-surface.width, 2 * surface.width] : [0, surface.width];
  c.fillRect(from, y, to - from, view.tilt ? 2 * surface.width : surface.height - y);
  c.strokeStyle = p.rule;
  c.lineWidth = 1;
  path(c, [[from, y + 0.5], [to, y + 0.5]], false);
  c.stroke();
  const step = 0.1;
  const first = Math.ceil(view.worldX(from) / step);
  for (let k = first; k * step < view.worldX(to); ++k) {
    const x = view.x(k * step);
    const whole = k % 5 === 0;
    path(c, [[x, y], [x, y + (whole ? 8 : 4)]], false);
    c.strokeStyle = p.quiet;
    c.stroke();
    if (whole) write(c, `${(k * step).toFixed(1)} m`.replace("-", "−"), x, y + 16, p.quiet, { size: 11 });
  }
}

// The angle between the floor and a level line, in the corner above the lower end of the floor.
function drawSlope(surface: Surface, view: View, p: Palette): void {
  const c = surface.context;
  const uphill = Math.sign(view.tilt);
  const reach = 72;
  const x = surface.width / 2 - uphill * (surface.width / 2 - 16);
  const y = 24 + reach * Math.abs(Math.sin(view.tilt));
  c.strokeStyle = p.ink;
  c.lineWidth = 1.4;
  path(c, [
    [x + uphill * reach, y], [x, y],
    [x + uphill * reach * Math.cos(view.tilt), y - reach * Math.abs(Math.sin(view.tilt))],
  ], false);
  c.stroke();
  c.beginPath();
  c.arc(x, y, reach - 16, uphill > 0 ? -view.tilt : Math.PI, uphill > 0 ? 0 : Math.PI - view.tilt);
  c.stroke();
  const degrees = Number(((Math.abs(view.tilt) * 180) / Math.PI).toFixed(1));
  write(c, `slope ${degrees}°`, x, y + 11, p.ink, { align: uphill > 0 ? "left" : "right", weight: 650 });
}

function drawRobot(
  surface: Surface, view: View, p: Palette, picture: SidePicture, side: number, level: number,
): void {
  const c = surface.context;
  const { places } = picture;
  const out = side === 0 ? -1 : 1;
  const colour = sideColour(p, side);
  const px = places[PLACES.pivot + 2 * side]!;
  const off = picture.off?.[side] ?? false;
  const x = (beside: number) => view.x(px + out * beside); // outward from the pivot
  const y = (up: number) => view.y(level + up);
  const size = (body.far - body.near) * view.scale;
  const bodyX = x((body.near + body.far) / 2);
  c.globalAlpha = off ? 0.45 : 1;
  c.strokeStyle = p.quiet;
  c.lineWidth = Math.max(3, 0.014 * view.scale);
  c.lineCap = "round";
  path(c, [[x(shoulder.x), y(shoulder.y)], [x(0), view.y(places[PLACES.pivot + 2 * side + 1]!)]], false);
  c.stroke();
  c.fillStyle = p.body;
  c.strokeStyle = colour;
  c.lineWidth = 2;
  c.beginPath();
  c.roundRect(bodyX - size / 2, y(body.top), size, (body.top - body.low) * view.scale, 6);
  c.fill();
  c.stroke();
  for (const wheel of wheels) {
    const [hubX, hubY, radius] = [x(wheel.x), y(wheel.y), wheel.radius * view.scale];
    const turn = px / wheel.radius;
    const [cos, sin] = [radius * Math.cos(turn), radius * Math.sin(turn)];
    c.beginPath();
    c.arc(hubX, hubY, radius, 0, 2 * Math.PI);
    c.fillStyle = p.background;
    c.fill();
    c.stroke();
    path(c, [[hubX - cos, hubY - sin], [hubX + cos, hubY + sin]], false);
    c.lineWidth = 1;
    c.stroke();
    c.lineWidth = 2;
  }
  const tag = off ? "off" : picture.tags?.[side];
  if (tag) {
    const letters = Math.max(12, Math.min(22, 0.075 * view.scale));
    write(c, tag, bodyX, y(body.top - 0.055), colour, { weight: 650, size: letters });
    if (picture.waits?.[side] && !off) {
      write(c, "waits", bodyX, y(body.top - 0.055) + 0.9 * letters, colour, { size: 12 });
    }
  }
  c.globalAlpha = 1;
  if (picture.labels) {
    write(c, side === 0 ? "left robot" : "right robot", bodyX + 14 * out, y(body.top) - 11, p.quiet);
  }
}

function drawPalm(
  surface: Surface, view: View, p: Palette, picture: SidePicture, side: number,
): void {
  const c = surface.context;
  const { places } = picture;
  const at = (start: number): [number, number] => [
    view.x(places[start + 2 * side]!),
    view.y(places[start + 2 * side + 1]!),
  ];
  const [ix, iy] = at(PLACES.inner);
  const [ox, oy] = at(PLACES.outer);
  // The plate, and a line below its surface, so that it is seen from afar.
  const width = Math.max(4, 0.012 * view.scale);
  const length = Math.hypot(ox - ix, oy - iy);
  const [nx, ny] = [((iy - oy) / length) * (side === 0 ? -1 : 1), ((ox - ix) / length) * (side === 0 ? -1 : 1)];
  const down: [number, number] = ny > 0 ? [nx, ny] : [-nx, -ny];
  const shift = (x: number, y: number): [number, number] => [
    x + (down[0] * width) / 2,
    y + (down[1] * width) / 2,
  ];
  c.lineCap = "butt";
  c.lineWidth = width;
  c.strokeStyle = sideColour(p, side);
  path(c, [shift(ix, iy), shift(ox, oy)], false);
  c.stroke();
  const plate = Array.from({ length: PLATE_CORNERS }, (_, i): [number, number] => {
    const k = PLACES.plate + 2 * (side * PLATE_CORNERS + i);
    return [view.x(places[k]!), view.y(places[k + 1]!)];
  });
  c.fillStyle = sideColour(p, side);
  path(c, plate);
  c.fill();
  c.lineWidth = 2; // a heel is thin
  c.stroke();
  if (picture.zones) {
    const metres = length / view.scale;
    const share = (q: number) => Math.min(1, Math.max(0, 0.5 + q / metres));
    const along = (s: number): [number, number] => shift(ix + (ox - ix) * s, iy + (oy - iy) * s);
    c.strokeStyle = p.zeroPale;
    c.lineWidth = Math.max(2, width - 3);
    path(c, [along(share(picture.zones.from)), along(share(picture.zones.to))], false);
    c.stroke();
  }
  const [px, py] = at(PLACES.pivot);
  c.beginPath();
  c.arc(px, py + width / 2, Math.max(3, 0.009 * view.scale), 0, 2 * Math.PI);
  c.fillStyle = p.background;
  c.strokeStyle = p.ink;
  c.lineWidth = 1.5;
  c.fill();
  c.stroke();
}

function drawObject(surface: Surface, view: View, p: Palette, picture: SidePicture): void {
  const c = surface.context;
  const { places } = picture;
  const corners: [number, number][] = [];
  for (let i = PLACES.outline; i < places.length; i += 2) {
    corners.push([view.x(places[i]!), view.y(places[i + 1]!)]);
  }
  path(c, corners);
  c.fillStyle = p.object;
  c.globalAlpha = picture.cones ? 0.55 : 0.92;
  c.fill();
  c.globalAlpha = 1;
  c.strokeStyle = picture.dropped ? p.drop : p.objectEdge;
  c.lineWidth = picture.dropped ? 2.5 : 1.5;
  c.lineJoin = "round";
  c.stroke();
}

function drawCom(surface: Surface, view: View, p: Palette, places: Float64Array): void {
  const c = surface.context;
  const x = view.x(places[PLACES.com]!);
  const y = view.y(places[PLACES.com + 1]!);
  const r = Math.max(5, 0.016 * view.scale);
  c.beginPath();
  c.arc(x, y, r, 0, 2 * Math.PI);
  c.fillStyle = p.background;
  c.fill();
  c.strokeStyle = p.ink;
  c.lineWidth = 1.3;
  c.stroke();
  c.fillStyle = p.ink;
  for (const start of [0, Math.PI]) {
    c.beginPath();
    c.moveTo(x, y);
    c.arc(x, y, r, start, start + Math.PI / 2);
    c.fill();
  }
}

function drawContacts(surface: Surface, view: View, p: Palette, picture: SidePicture): void {
  const c = surface.context;
  const { places } = picture;
  for (const side of [0, 1]) {
    if (picture.touches?.[side] === false) continue;
    const x = view.x(places[PLACES.contact + 2 * side]!);
    const y = view.y(places[PLACES.contact + 2 * side + 1]!);
    const motion = picture.motion?.[side] ?? 0;
    c.beginPath();
    c.arc(x, y, Math.max(4, 0.011 * view.scale), 0, 2 * Math.PI);
    c.fillStyle = motion === 0 ? p.zero : p.slides;
    c.fill();
    c.strokeStyle = p.ink;
    c.lineWidth = 1.2;
    c.stroke();
    if (motion !== 0) {
      const ox = places[PLACES.outer + 2 * side]! - places[PLACES.inner + 2 * side]!;
      const oy = places[PLACES.outer + 2 * side + 1]! - places[PLACES.inner + 2 * side + 1]!;
      const length = Math.hypot(ox, oy);
      const [ux, uy] = [(motion * ox) / length, (-motion * oy) / length];
      const lift = Math.max(16, 0.05 * view.scale);
      const reach = Math.max(12, 0.035 * view.scale);
      const [bx, by] = [x, y + lift];
      c.strokeStyle = p.ink;
      c.fillStyle = p.ink;
      c.lineWidth = 1.6;
      path(c, [[bx - ux * reach, by - uy * reach], [bx + ux * reach, by + uy * reach]], false);
      c.stroke();
      path(c, [
        [bx + ux * (reach + 6), by + uy * (reach + 6)],
        [bx + ux * reach - uy * 4, by + uy * reach + ux * 4],
        [bx + ux * reach + uy * 4, by + uy * reach - ux * 4],
      ]);
      c.fill();
    }
  }
}

// The cones as wedges, and the line of gravity.
function drawCones(surface: Surface, view: View, p: Palette, picture: SidePicture): void {
  const c = surface.context;
  const { places, cones } = picture;
  if (!cones) return;
  const reach = 0.42 * view.scale;
  for (const side of [0, 1]) {
    const x = view.x(places[PLACES.contact + 2 * side]!);
    const y = view.y(places[PLACES.contact + 2 * side + 1]!);
    const ends = cones[side]!.map((edge): [number, number] => {
      const length = Math.hypot(edge.x, edge.y);
      return [x + (edge.x / length) * reach, y - (edge.y / length) * reach];
    });
    path(c, [[x, y], ...ends]);
    c.fillStyle = sideColour(p, side);
    c.globalAlpha = 0.16;
    c.fill();
    c.globalAlpha = 1;
    c.strokeStyle = sideColour(p, side);
    c.lineWidth = 1.4;
    ends.forEach((end, k) => {
      c.setLineDash(k === 0 ? [] : [6, 4]); // the edge on which a contact slides down is dashed
      path(c, [[x, y], end], false);
      c.stroke();
    });
    c.setLineDash([]);
  }
}

function drawGravity(surface: Surface, view: View, p: Palette, places: Float64Array): void {
  const c = surface.context;
  const [x] = view.turned(view.x(places[PLACES.com]!), view.y(places[PLACES.com + 1]!));
  c.strokeStyle = p.ink;
  c.lineWidth = 1.2;
  c.setLineDash([2, 4]);
  path(c, [[x, 8], [x, surface.height - 8]], false);
  c.stroke();
  c.setLineDash([]);
}

function drawFlights(
  surface: Surface, view: View, p: Palette, picture: SidePicture, level: number,
): void {
  const c = surface.context;
  const { places } = picture;
  const end = (side: number) => {
    const out = side === 0 ? -1 : 1;
    return view.x(places[PLACES.pivot + 2 * side]! + out * ((body.near + body.far) / 2));
  };
  const height = view.y(level + body.top) - 30;
  for (const flight of picture.flights ?? []) {
    const [from, to] = [end(flight.from), end(1 - flight.from)];
    const share = flight.lost ? Math.min(flight.share, 0.5) : flight.share;
    const x = from + (to - from) * share;
    const y = Math.max(14, height - 4 * share * (1 - share) * Math.min(60, 0.25 * view.scale));
    c.globalAlpha = flight.lost ? Math.max(0, 1 - flight.share) : 1;
    c.font = "600 11px system-ui, sans-serif";
    const wide = c.measureText(flight.name).width + 14;
    c.fillStyle = flight.lost ? p.drop : p.ink;
    c.beginPath();
    c.roundRect(x - wide / 2, y - 9, wide, 18, 9);
    c.fill();
    write(c, flight.name, x, y + 0.5, p.background, { weight: 600, size: 11 });
    c.globalAlpha = 1;
  }
}

export function drawSide(
  surface: Surface, view: View, p: Palette, picture: SidePicture, level: number, robots = true,
): void {
  const sides = [0, 1].filter((side) => side !== picture.absent);
  onFloor(surface, view, () => {
    if (robots) drawFloor(surface, view, p, level);
    drawBlocks(surface.context, view, p, picture.blocks ?? [], [picture.start ?? 0, level]);
    if (robots) for (const side of sides) drawRobot(surface, view, p, picture, side, level);
    drawObject(surface, view, p, picture);
    drawCones(surface, view, p, picture);
  });
  if (picture.gravity) drawGravity(surface, view, p, picture.places);
  onFloor(surface, view, () => {
    for (const side of sides) drawPalm(surface, view, p, picture, side);
    drawContacts(surface, view, p, picture);
    drawCom(surface, view, p, picture.places);
    if (robots) drawFlights(surface, view, p, picture, level);
  });
  if (view.tilt) drawSlope(surface, view, p);
}
