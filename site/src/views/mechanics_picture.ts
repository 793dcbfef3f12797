// SPDX-License-Identifier: Apache-2.0
// The picture of the view Mechanics: object, palms and friction cones of one state, with their handles.
import { signal } from "@preact/signals";
import type { Handle } from "./handles";
import { setIfAllowed, shape } from "./mechanics_shape";
import {
  DEGREE, chosenMode, found, isAlone, isGeneral, isPipe, onFloor as isOnFloor, setContact, setTheta, theta,
  touched,
} from "./mechanics_state";
import { surroundingHandles } from "./surroundings";
import { driveHandles, palmHandles, radiusHandle } from "./shape_handles";
import { zeroZone } from "./stage";
import { type TouchedPicture, drawCloseUp, drawTouched } from "./touched_picture";
import { blocksOf } from "../shared/blocks";
import type { Surface } from "../shared/canvas";
import { PLACES, type Statics } from "../shared/core";
import { type Xy, objectTransform } from "../shared/object_transform";
import { type View, onFloor, viewOf } from "../shared/pair_view";
import { get, tiltOf } from "../shared/scene_values";
import { drawSide } from "../shared/side_view";
import { overrides, scene, setForAll } from "../shared/state";
import { SIDES } from "../shared/tables";
import { type Palette, isLow, palette } from "../shared/theme";

const fine = (value: number) => Math.round(value * 2000) / 2000; // half a millimetre

// Writes the outline explicitly, so that every part of it is the visitor's own from now on.
function setObject(changes: { vertices_m?: Xy[]; com_m?: Xy }): void {
  const object = get(scene.peek(), "object") as Record<string, unknown>;
  const next = { ...overrides.peek() };
  for (const key of Object.keys(next)) if (key.startsWith("object")) delete next[key];
  for (const key of ["vertices_m", "contacts", "com_m", "mass_kg", "depth_m", "edge_radius_m"]) {
    const value = changes[key as "com_m"] ?? object[key];
    if (value !== undefined) next[`object.${key}`] = value as never;
  }
  // On a floor, the object moves: what no scene may have could do anything there.
  if (isOnFloor.peek()) setIfAllowed(next);
  else overrides.value = next;
}

const view = signal<View | null>(null);

export function mechanicsHeight(width: number): number {
  return Math.round(Math.min(isLow.value ? 310 : 400, Math.max(260, width * 0.45)));
}

// What the view shows: places of palms and object; null: there is nothing to show.
function placesShown(): Float64Array | null {
  if (isOnFloor.value || isPipe.value) return touched.value?.problem === "" ? touched.value.places : null;
  return found.value?.reaches ? found.value.places : null;
}

// A view of the pair that leaves room above for the cones.
export function drawState(surface: Surface): void {
  const places = placesShown();
  if (!places) return;
  const at = viewOf(surface, places, tiltOf(scene.value), false);
  // The handles lie over the drawing: they are moved only when the view changes.
  const last = view.peek();
  const same = last && last.tilt === at.tilt && last.scale === at.scale && last.x(0) === at.x(0) && last.y(0) === at.y(0);
  if (!same) view.value = at;
  const p = palette.value;
  const s = shape.value;
  const here = touched.value;
  const picture: TouchedPicture = {
    places, contacts: here?.contacts ?? [], mode: chosenMode.value, hasFloor: isOnFloor.value,
    isThin: s["palm.thickness_m"] === 0, blocks: blocksOf(scene.value), isAlone: isAlone.value,
  };
  const f = found.value;
  if (isGeneral.value) drawTouched(surface, at, p, picture);
  else if (f) {
    drawSide(surface, at, p, { places, zones: zeroZone(scene.value), cones: f.cones, gravity: true }, 0, false);
    onFloor(surface, at, () => drawCrossings(surface, at, p, f));
  }
  const small = Math.max(s["object.edge_radius_m"], s["palm.thickness_m"], s["palm.heel_m"] / 2);
  if (!isGeneral.value && small === 0) return;
  const span = Math.min(0.05, Math.max(0.012, 3.2 * small));
  for (const side of sides()) drawCloseUp(surface, at, p, picture, side, centreOf(side, places), span);
}

// The palms that there are.
const sides = (): (0 | 1)[] => (isAlone.value ? [0] : [0, 1]);

// What the close-up of a side shows: a corner of the object, or the inner end of the palm.
function centreOf(side: 0 | 1, places: Float64Array): Xy {
  const own = touched.value?.contacts.filter((one) => one.carrier === side) ?? [];
  const seen = own.find((one) => one.kind !== "tip") ?? own[0];
  if (!seen) return [places[PLACES.inner + 2 * side]!, places[PLACES.inner + 2 * side + 1]!];
  return [places[PLACES.com]! + seen.at[0], places[PLACES.com + 1]! + seen.at[1]];
}

// Where the line of gravity meets the edges of the cones: L and R of Figure 4, where they are shown.
function drawCrossings(surface: Surface, at: View, p: Palette, f: Statics): void {
  const c = surface.context;
  const [comX, comY] = [f.places[PLACES.com]!, f.places[PLACES.com + 1]!];
  const names = [["L₁", "L₂"], ["R₂", "R₁"]];
  const spots: number[] = [];
  f.cones.forEach((edges, side) =>
    edges.forEach((edge, k) => {
      const y = at.y(edge.height);
      const x = at.x(comX + Math.tan(at.tilt) * (edge.height - comY));
      const below = edge.height < f.places[PLACES.contact + 2 * side + 1]!;
      if (below || y < 6 || y > surface.height - 6 || !Number.isFinite(y)) return;
      c.beginPath();
      c.arc(x, y, 3.5, 0, 2 * Math.PI);
      c.fillStyle = side === 0 ? p.left : p.right;
      c.fill();
      c.font = "600 12px system-ui, sans-serif";
      c.textBaseline = "middle";
      c.textAlign = side === 0 ? "right" : "left";
      const shift = spots.some((other) => Math.abs(other - y) < 12) ? 12 : 0;
      c.fillText(names[side]![k]!, x + (side === 0 ? -9 : 9), y + shift);
      spots.push(y);
    }),
  );
}

export function handles(): Handle[] {
  const at = view.value;
  const f = found.value;
  const places = placesShown();
  if (!at || !places) return [];
  const frame = objectTransform(scene.value, places);
  const world = (x: number, y: number): Xy => {
    const origin = at.y(0);
    return [at.worldX(x), (origin - y) / at.scale];
  };
  const list: Handle[] = [];
  const vertices = get(scene.value, "object.vertices_m") as Xy[];
  const corners = vertices.map((vertex): Xy => {
    const [x, y] = frame.toWorld(vertex);
    return [at.x(x), at.y(y)];
  });
  if (!isPipe.value) corners.forEach(([x, y], k) => {
    list.push({
      id: `corner-${k}`, label: `corner ${k + 1} of the object`, kind: "corner", x, y,
      move: (px, py) => {
        const [sx, sy] = frame.toScene(world(px, py));
        setObject({ vertices_m: vertices.map((v, i): Xy => (i === k ? [fine(sx), fine(sy)] : v)) });
      },
    });
  });
  list.push({
    id: "com", label: "centre of mass", kind: "com", x: at.x(places[PLACES.com]!),
    y: at.y(places[PLACES.com + 1]!),
    move: (px, py) => {
      const [sx, sy] = frame.toScene(world(px, py));
      setObject({ com_m: [fine(sx), fine(sy)] });
    },
  });
  for (const side of sides()) {
    const out = side === 0 ? -1 : 1;
    const point = (start: number): Xy => [places[start + 2 * side]!, places[start + 2 * side + 1]!];
    const [inner, outer] = [point(PLACES.inner), point(PLACES.outer)];
    const middle: Xy = [(inner[0] + outer[0]) / 2, (inner[1] + outer[1]) / 2];
    list.push({
      id: `palm-${SIDES[side]}`, label: `angle of the ${SIDES[side]} palm`, kind: "palm",
      x: at.x(outer[0]), y: at.y(outer[1]),
      move: (px, py) => {
        const [wx, wy] = world(px, py);
        setTheta(side, Math.atan2(wy - middle[1], out * (wx - middle[0])) / DEGREE);
      },
    });
    if (isOnFloor.value || (isPipe.value && side === 1)) continue;
    const [cx, cy] = point(PLACES.contact);
    list.push({
      id: `contact-${SIDES[side]}`, label: `contact on the ${SIDES[side]} palm`, kind: "contact",
      x: at.x(cx), y: at.y(cy) + 13,
      move: (px, py) => {
        const [wx, wy] = world(px, py - 13);
        const length = Math.hypot(outer[0] - inner[0], outer[1] - inner[1]);
        const u: Xy = [(outer[0] - inner[0]) / length, (outer[1] - inner[1]) / length];
        // The pair moves along with the contact: measure from where the palm is now.
        setContact(side, 1000 * ((wx - middle[0]) * u[0] + (wy - middle[1]) * u[1]));
      },
    });
  }
  list.push(...radiusHandle(at, corners), ...palmHandles(at, places));
  if (isOnFloor.value) list.push(...driveHandles(at, places, touched.value!.starts), ...surroundingHandles(at));
  if (f && !isGeneral.value) for (const side of [0, 1] as const) list.push(coneHandle(side, f, at, world));
  return list.map((handle) => {
    const [x, y] = at.turned(handle.x, handle.y);
    return { ...handle, x, y, move: (px, py) => handle.move(...at.level(px, py)) };
  });
}

// At an edge of a friction cone, along it as the room above allows. Both cones follow.
function coneHandle(side: 0 | 1, f: Statics, at: View, world: (x: number, y: number) => Xy): Handle {
  const inward = side === 0 ? 1 : -1;
  const edge = f.cones[side]![0]!; // the up edge, which leans inward
  const length = Math.hypot(edge.x, edge.y);
  const start = PLACES.contact + 2 * side;
  const [ax, ay] = [f.places[start]!, f.places[start + 1]!];
  const room = (at.y(ay) - 18) / at.scale / Math.max(0.2, edge.y / length);
  // The upper edges cross near the top of the default view: there, one handle would hide the other.
  const reach = Math.max(0.05, Math.min(0.42, room)) * (side === 0 ? 1 : 0.75);
  return {
    id: side === 0 ? "cone" : "cone-right", kind: "cone",
    label: `half angle of the friction cones, at the ${SIDES[side]} one`,
    x: at.x(ax + (edge.x / length) * reach), y: at.y(ay + (edge.y / length) * reach),
    move: (px, py) => {
      const [wx, wy] = world(px, py);
      const lean = Math.atan2(inward * (wx - ax), wy - ay);
      const phi = Math.min(1.2, Math.max(0.01, lean - theta.peek()[side] * DEGREE));
      setForAll("palm.friction", Number(Math.tan(phi).toFixed(3)));
    },
  };
}
