// SPDX-License-Identifier: Apache-2.0
// Words and lines on a canvas.

export interface Lettering {
  align?: CanvasTextAlign;
  weight?: number;
  size?: number; // of the letters [px]
}

// Writes words at half height of the point, in the middle unless the lettering says otherwise.
export function write(
  c: CanvasRenderingContext2D, words: string, x: number, y: number, colour: string,
  { align = "center", weight = 400, size = 12 }: Lettering = {},
): void {
  c.font = `${weight} ${size}px system-ui, sans-serif`;
  c.fillStyle = colour;
  c.textAlign = align;
  c.textBaseline = "middle";
  c.fillText(words, x, y);
}

export function line(c: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number): void {
  c.beginPath();
  c.moveTo(x0, y0);
  c.lineTo(x1, y1);
  c.stroke();
}
