// SPDX-License-Identifier: Apache-2.0
// A canvas as wide as its place, at the resolution of the screen, drawn anew when a signal changes.
import { effect, signal } from "@preact/signals";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import { palette } from "./theme";

export interface Surface {
  context: CanvasRenderingContext2D;
  width: number; // CSS pixels
  height: number;
}

interface Props {
  height: number | ((width: number) => number);
  draw: (surface: Surface) => void; // reads the signals on which it depends
  label: string;
  id?: string;
  class?: string;
  onPointerDown?: (event: PointerEvent) => void;
  onPointerMove?: (event: PointerEvent) => void;
  onPointerUp?: (event: PointerEvent) => void;
  onPointerLeave?: (event: PointerEvent) => void;
  onKeyDown?: (event: KeyboardEvent) => void;
}

export function Canvas(props: Props) {
  const place = useRef<HTMLCanvasElement>(null);
  const draw = useRef(props.draw);
  draw.current = props.draw;
  const height = useRef(props.height);
  height.current = props.height;
  const rendered = useRef(signal(0));

  // Before the browser shows the page: it would show a canvas of 150 px first, and move what is below.
  useLayoutEffect(() => {
    const canvas = place.current!;
    const context = canvas.getContext("2d")!;
    const wide = signal(canvas.clientWidth);
    const stop = effect(() => {
      void [rendered.current.value, palette.value];
      const width = wide.value;
      const high = typeof height.current === "number" ? height.current : height.current(width);
      const ratio = window.devicePixelRatio || 1;
      const [columns, rows] = [Math.round(width * ratio), Math.round(high * ratio)];
      if (columns !== canvas.width || rows !== canvas.height) {
        canvas.style.height = `${high}px`;
        canvas.width = columns;
        canvas.height = rows;
      }
      if (width === 0) return;
      context.setTransform(columns / width, 0, 0, columns / width, 0, 0);
      context.clearRect(0, 0, width, high);
      draw.current({ context, width, height: high });
    });
    const observer = new ResizeObserver(() => (wide.value = canvas.clientWidth));
    observer.observe(canvas);
    return () => {
      observer.disconnect();
      stop();
    };
  }, []);
  // The parent was rendered again: what it draws may depend on more than signals.
  useEffect(() => {
    rendered.current.value++;
  });

  return (
    <canvas
      ref={place}
      id={props.id}
      class={props.class}
      role="img"
      aria-label={props.label}
      tabIndex={props.onKeyDown ? 0 : undefined}
      onPointerDown={props.onPointerDown}
      onPointerMove={props.onPointerMove}
      onPointerUp={props.onPointerUp}
      onPointerLeave={props.onPointerLeave}
      onPointerCancel={props.onPointerUp}
      onKeyDown={props.onKeyDown}
    />
  );
}
