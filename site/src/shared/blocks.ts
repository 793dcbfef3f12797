// SPDX-License-Identifier: Apache-2.0
// Walls and stands of a scene as they are drawn. Their places count from the COM of the object at its
// start, and their heights from the floor [m].
import type { View } from "./pair_view";
import { get } from "./scene_values";
import type { Palette } from "./theme";
import type { Scene } from "./tables";

export interface Block {
  from: number;
  to: number;
  height: number;
}

const DRAWN_WALL = 0.05; // thickness of a wall in the picture
const DRAWN_HEIGHT = 0.5; // of an endless wall, if nothing else is asked for

const listed = (scene: Scene, key: string) => (get(scene, key) ?? []) as { [name: string]: number }[];
// The scene counts in the direction of travel, the picture to the right.
export const senseOf = (scene: Scene) => (get(scene, "task.direction") === "backward" ? -1 : 1);

export const wallsOf = (scene: Scene, most = DRAWN_HEIGHT): Block[] =>
  listed(scene, "floor.walls").map(({ at_m, height_m }) => {
    const at = senseOf(scene) * at_m!;
    const height = Math.min(height_m ?? most, most);
    return at < 0 ? { from: at - DRAWN_WALL, to: at, height } : { from: at, to: at + DRAWN_WALL, height };
  });
export const standsOf = (scene: Scene): Block[] => listed(scene, "floor.stands").map(({ from_m, to_m, height_m }) => {
  const [from, to] = senseOf(scene) > 0 ? [from_m!, to_m!] : [-to_m!, -from_m!];
  return { from, to, height: height_m! };
});
export const blocksOf = (scene: Scene, most = DRAWN_HEIGHT): Block[] => [...wallsOf(scene, most), ...standsOf(scene)];

// `origin`: where the COM was at the start, and the height of the floor [m].
export function drawBlocks(
  c: CanvasRenderingContext2D, at: View, p: Palette, blocks: Block[], origin: [number, number] = [0, 0],
): void {
  const [x, floor] = origin;
  c.fillStyle = p.ground;
  c.strokeStyle = p.edge;
  c.lineWidth = 1.2;
  for (const { from, to, height } of blocks) {
    const [left, top] = [at.x(x + from), at.y(floor + height)];
    const size: [number, number] = [at.x(x + to) - left, at.y(floor) - top];
    c.fillRect(left, top, ...size);
    c.strokeRect(left, top, ...size);
  }
}
