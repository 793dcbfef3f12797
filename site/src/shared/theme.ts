// SPDX-License-Identifier: Apache-2.0
// Colours of the drawings, from the style sheet, so that light and dark have one source.
import { signal } from "@preact/signals";

export interface Palette {
  ink: string;
  quiet: string;
  rule: string;
  ground: string;
  object: string;
  objectEdge: string;
  left: string;
  right: string;
  both: string;
  zero: string;
  zeroPale: string;
  slides: string;
  drop: string;
  background: string;
  body: string;
  edge: string;
}

const NAMES = [
  "ink", "quiet", "rule", "ground", "object", "objectEdge", "left", "right", "both", "zero",
  "zeroPale", "slides", "drop", "background", "body", "edge",
] as const;

function read(): Palette {
  const style = getComputedStyle(document.documentElement);
  const entries = NAMES.map((name) => {
    const variable = name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
    return [name, style.getPropertyValue(`--${variable}`).trim()];
  });
  return Object.fromEntries(entries) as unknown as Palette;
}

const root = document.documentElement;
const dark = matchMedia("(prefers-color-scheme: dark)");
root.dataset.theme = systemTheme();

export const palette = signal<Palette>(read());
export const reducedMotion = matchMedia("(prefers-reduced-motion: reduce)");

// A wide window without much height, such as a browser with all its bars on 1366 × 768: drawings are
// lower, so that what belongs together is on one screen (style.css has the same query).
const low = matchMedia("(min-width: 60rem) and (max-height: 48rem)");
export const isLow = signal(low.matches);
low.addEventListener("change", () => (isLow.value = low.matches));

type Theme = "dark" | "light";

export function systemTheme(): Theme {
  return dark.matches ? "dark" : "light";
}

export function theme(): Theme {
  return root.dataset.theme as Theme;
}

export function setTheme(next: Theme): void {
  root.dataset.theme = next;
  palette.value = read();
}

dark.addEventListener("change", () => setTheme(systemTheme()));

export function sideColour(p: Palette, side: number): string {
  return side === 0 ? p.left : side === 1 ? p.right : p.both;
}
