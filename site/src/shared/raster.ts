// SPDX-License-Identifier: Apache-2.0
// Maps as pictures: one colour for each cell, without seams between them.
const small = document.createElement("canvas");

const colours = new Map<string, [number, number, number]>();

// The red, green and blue of a colour "#rrggbb".
function parts(colour: string): [number, number, number] {
  let found = colours.get(colour);
  if (!found) {
    found = [1, 3, 5].map((k) => Number.parseInt(colour.slice(k, k + 2), 16)) as [number, number, number];
    colours.set(colour, found);
  }
  return found;
}

// Draws nx × ny cells into a rectangle; row 0 is at the bottom. colour(k) is "#rrggbb" and an opacity,
// or null where nothing is drawn.
export function drawCells(
  context: CanvasRenderingContext2D, box: { x: number; y: number; width: number; height: number },
  nx: number, ny: number, colour: (k: number) => [string, number] | null,
): void {
  small.width = nx;
  small.height = ny;
  const target = small.getContext("2d")!;
  const image = target.createImageData(nx, ny);
  for (let j = 0; j < ny; ++j) {
    for (let i = 0; i < nx; ++i) {
      const found = colour(j * nx + i);
      if (!found) continue;
      const at = 4 * ((ny - 1 - j) * nx + i);
      image.data.set([...parts(found[0]), Math.round(255 * found[1])], at);
    }
  }
  target.putImageData(image, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(small, box.x, box.y, box.width, box.height);
}
