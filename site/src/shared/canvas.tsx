// SPDX-License-Identifier: Apache-2.0
// A canvas as wide as its place, at the resolution of the screen, drawn anew when a signal changes.
import { effect } from "@preact/signals";
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
  const size = useRef({ width: 0, height: 0 });
  const again = useRef(() => {});

  // Before the browser shows the page: it would show a canvas of 150 px first, and move what is below.
  useLayoutEffect(() => {
    const canvas = place.current!;
    const context = canvas.getContext("2d")!;
    const paint = () => {
      const { width, height } = size.current;
      void palette.value;
      if (width === 0) return;
      const ratio = canvas.width / width;
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, width, height);
      draw.current({ context, width, height });
    };
    let stop = () => {};
    const start = () => {
      stop();
      stop = effect(paint);
    };
    const heightFor = (width: number) =>
      typeof height.current === "number" ? height.current : height.current(width);
    const measure = () => {
      const width = canvas.clientWidth;
      const high = heightFor(width);
      const ratio = window.devicePixelRatio || 1;
      size.current = { width, height: high };
      canvas.style.height = `${high}px`;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(high * ratio);
      start();
    };
    again.current = () => {
      if (size.current.width > 0 && heightFor(size.current.width) !== size.current.height) measure();
      else start();
    };
    measure();
    const observer = new ResizeObserver(() => {
      if (canvas.clientWidth !== size.current.width) measure();
    });
    observer.observe(canvas);
    return () => {
      observer.disconnect();
      stop();
    };
  }, []);
  // The parent was rendered again: what it draws may depend on more than signals.
  useEffect(() => again.current());

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
