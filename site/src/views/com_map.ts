// SPDX-License-Identifier: Apache-2.0
// The map of the centres of mass for which both properties hold (Figure 6).
import { DEGREE, angles, inDegrees } from "./mechanics_state";
import type { Surface } from "../shared/canvas";
import { settings } from "../shared/command";
import type { Xy } from "../shared/object_transform";
import { drawCells } from "../shared/raster";
import { type Overrides, get, ofSide } from "../shared/scene_values";
import { core, scene } from "../shared/state";
import { SIDES } from "../shared/tables";
import { palette } from "../shared/theme";

const radians = (degrees: [[number, number], [number, number]]): [[number, number], [number, number]] =>
  degrees.map((pair) => pair.map((angle) => angle * DEGREE)) as [[number, number], [number, number]];

// Which angles the map of COMs takes.
export function anglesWords(): string {
  const [left, right] = angles.value.map((pair) => pair.map(inDegrees)) as [string[], string[]];
  if (left.every((angle, k) => angle === right[k])) {
    return `The shallow angle is ${left[0]}, the steep one ${left[1]}.`;
  }
  return `The shallow and the steep angle of the left palm are ${left[0]} and ${left[1]}, those of the right one ${right[0]} and ${right[1]}.`;
}

// The command that draws the map of COMs with these angles, if a scene may have them.
export function analyzeLines(words: string): string[] {
  if (angles.value.some(([shallow, steep]) => shallow >= steep)) return [];
  const keys: Overrides = {};
  angles.value.forEach((pair, side) =>
    ["shallow_deg", "steep_deg"].forEach((name, k) => {
      if (ofSide(scene.value, "palm", SIDES[side]!, name) === pair[k]) return;
      const own = `palm.${SIDES[side]}.${name}`;
      keys[get(scene.value, own) === undefined ? `palm.${name}` : own] = pair[k]!;
    }),
  );
  return [["palmbots analyze", words, ...settings(keys), "--out out"].join(" ")];
}

// Figure 6: the COMs for which the properties hold over the whole palms, drawn on the object.
export function drawCom(surface: Surface): void {
  const machine = core.value;
  if (!machine) return;
  const p = palette.value;
  const c = surface.context;
  const vertices = get(scene.value, "object.vertices_m") as Xy[];
  const contacts = get(scene.value, "object.contacts") as [number, number];
  const [a, b] = [vertices[contacts[0]]!, vertices[contacts[1]]!];
  const width = Math.hypot(b[0] - a[0], b[1] - a[1]);
  const [ex, ey] = [(b[0] - a[0]) / width, (b[1] - a[1]) / width];
  const inFrame = ([x, y]: Xy): Xy => [
    (x - a[0]) * ex + (y - a[1]) * ey, (y - a[1]) * ex - (x - a[0]) * ey,
  ];
  const points = vertices.map(inFrame);
  const xs = points.map((v) => v[0]);
  const ys = points.map((v) => v[1]);
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  machine.setScene(scene.value);
  const [nx, ny] = [180, 90];
  const bits = machine.comMap([x0, x1], [y0, y1], nx, ny, radians(angles.value));
  const scale = Math.min((surface.width - 20) / (x1 - x0), (surface.height - 20) / (y1 - y0));
  const [left, top] = [(surface.width - scale * (x1 - x0)) / 2, (surface.height - scale * (y1 - y0)) / 2];
  const at = ([x, y]: Xy): Xy => [left + (x - x0) * scale, top + (y1 - y) * scale];
  c.save();
  c.beginPath();
  points.forEach((point, k) => (k === 0 ? c.moveTo(...at(point)) : c.lineTo(...at(point))));
  c.closePath();
  c.fillStyle = p.ground;
  c.fill();
  c.clip();
  const box = { x: left, y: top, width: scale * (x1 - x0), height: scale * (y1 - y0) };
  drawCells(c, box, nx, ny, (k) => {
    const bit = bits[k]!;
    if (bit === 0) return null;
    return bit === 3 ? [p.zero, 0.6] : bit === 1 ? [p.left, 0.28] : [p.right, 0.28];
  });
  c.restore();
  c.strokeStyle = p.objectEdge;
  c.lineWidth = 1.5;
  c.beginPath();
  points.forEach((point, k) => (k === 0 ? c.moveTo(...at(point)) : c.lineTo(...at(point))));
  c.closePath();
  c.stroke();
  const [mx, my] = at(inFrame(get(scene.value, "object.com_m") as Xy));
  c.beginPath();
  c.arc(mx, my, 5, 0, 2 * Math.PI);
  c.fillStyle = p.background;
  c.fill();
  c.strokeStyle = p.ink;
  c.lineWidth = 2;
  c.stroke();
}
