// SPDX-License-Identifier: Apache-2.0
// Handles over a drawing: buttons that one drags, or moves with the arrow keys.
import { useRef } from "preact/hooks";

export interface Handle {
  id: string;
  label: string;
  kind: "com" | "corner" | "palm" | "contact" | "cone" | "shape";
  x: number; // pixels
  y: number;
  move: (x: number, y: number) => void; // to pixels
}

const KEY_PIXELS = 2;
const KEYS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
};

export function Handles(props: { handles: Handle[] }) {
  const place = useRef<HTMLDivElement>(null);
  const grip = useRef<{ dx: number; dy: number } | null>(null);
  const handles = useRef(props.handles);
  handles.current = props.handles;
  return (
    <div class="handles" ref={place}>
      {props.handles.map((handle, k) => (
        <button
          type="button"
          key={handle.id}
          id={`handle-${handle.id}`}
          class={`handle ${handle.kind}`}
          aria-label={`${handle.label}: drag, or use the arrow keys`}
          title={handle.label}
          style={{ left: `${handle.x}px`, top: `${handle.y}px` }}
          onPointerDown={(event) => {
            const rect = place.current!.getBoundingClientRect();
            event.currentTarget.setPointerCapture(event.pointerId);
            grip.current = {
              dx: handle.x - (event.clientX - rect.left),
              dy: handle.y - (event.clientY - rect.top),
            };
          }}
          onPointerMove={(event) => {
            if (!grip.current) return;
            const rect = place.current!.getBoundingClientRect();
            handles.current[k]!.move(
              event.clientX - rect.left + grip.current.dx,
              event.clientY - rect.top + grip.current.dy,
            );
          }}
          onPointerUp={() => (grip.current = null)}
          onPointerCancel={() => (grip.current = null)}
          onKeyDown={(event) => {
            const step = KEYS[event.key];
            if (!step) return;
            event.preventDefault();
            const far = event.shiftKey ? 5 : 1;
            const now = handles.current[k]!;
            now.move(now.x + KEY_PIXELS * far * step[0], now.y + KEY_PIXELS * far * step[1]);
          }}
        />
      ))}
    </div>
  );
}
