// SPDX-License-Identifier: Apache-2.0
// Draws the map of contact modes over both contact positions (paper, Figure 5).
import type { Surface } from "./canvas";
import { JAMMED, NOT_HELD, motionsOf } from "./contact_mode_words";
import { drawCells } from "./raster";
import type { Palette } from "./theme";

export const MAP = 64; // pairs of contacts along each axis
export const REACH = 2.6; // how far the map extends beyond the ends of the palms, as in Figure 5
export const [MAP_LEFT, MAP_TOP, MAP_FOOT] = [34, 6, 34];

export interface Region {
  pL: [number, number]; // mm
  pR: [number, number];
  dashed?: boolean;
}

export function contactModeColour(p: Palette, mode: number): string {
  if (mode === NOT_HELD) return p.rule;
  if (mode === JAMMED) return p.quiet;
  const [l, r] = motionsOf(mode);
  if (l !== 0 && r !== 0) return p.both;
  return l !== 0 ? p.left : p.right;
}


export function mapSize(surface: { width: number; height: number }): number {
  return Math.min(surface.width, surface.height) - MAP_FOOT;
}

// The contact modes, the frame of the palms and further regions, a dot, and a small one under the pointer.
// Lengths in mm; `half` is that of the palms.
export function drawContactModeMap(
  surface: Surface, p: Palette, values: Float64Array, half: [number, number], regions: Region[],
  dot: [number, number] | null, under: [number, number] | null = null,
): void {
  const c = surface.context;
  const size = mapSize(surface);
  const [x0, y0] = [MAP_LEFT, MAP_TOP];
  const x = (mm: number) => x0 + (0.5 + mm / (2 * half[0] * REACH)) * size;
  const y = (mm: number) => y0 + (0.5 - mm / (2 * half[1] * REACH)) * size;
  drawCells(c, { x: x0, y: y0, width: size, height: size }, MAP, MAP, (k) => [
    contactModeColour(p, values[k]!), values[k]! < 0 ? 1 : 0.5,
  ]);
  c.strokeStyle = p.quiet;
  c.lineWidth = 1;
  c.setLineDash([2, 3]);
  c.beginPath();
  c.moveTo(x(0), y0);
  c.lineTo(x(0), y0 + size);
  c.moveTo(x0, y(0));
  c.lineTo(x0 + size, y(0));
  c.stroke();
  c.strokeStyle = p.ink;
  c.lineWidth = 1.5;
  for (const region of regions) {
    c.setLineDash(region.dashed ? [5, 4] : []);
    const [left, top] = [x(region.pL[0]), y(region.pR[1])];
    c.strokeRect(left, top, x(region.pL[1]) - left, y(region.pR[0]) - top);
  }
  c.setLineDash([]);
  const circle = (at: [number, number], radius: number) => {
    c.beginPath();
    c.arc(x(at[0]), y(at[1]), radius, 0, 2 * Math.PI);
    c.fillStyle = p.background;
    c.fill();
    c.lineWidth = 2;
    c.stroke();
  };
  if (dot) circle(dot, 5);
  if (under) circle(under, 2.5);
  c.lineWidth = 1;
  c.fillStyle = p.quiet;
  c.font = "11px system-ui, sans-serif";
  c.textAlign = "center";
  c.textBaseline = "top";
  const ends = (mm: number) => `from −${(REACH * mm).toFixed(0)} to ${(REACH * mm).toFixed(0)} mm`;
  c.fillText(`p_L ${ends(half[0])}`, x0 + size / 2, y0 + size + 8);
  c.save();
  c.translate(12, y0 + size / 2);
  c.rotate(-Math.PI / 2);
  c.fillText(`p_R ${ends(half[1])}`, 0, 0);
  c.restore();
}
