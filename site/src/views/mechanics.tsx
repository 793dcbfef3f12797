// SPDX-License-Identifier: Apache-2.0
// Mechanics: one state to take apart. Figures 3 to 6 of the paper, alive.
import { computed, signal } from "@preact/signals";
import { AtHome, SceneChoice, presentRun } from "./parts";
import { type Handle, Handles } from "./handles";
import { zeroZone } from "./stage";
import { Canvas, type Surface } from "../shared/canvas";
import { sceneWords, settings } from "../shared/command";
import { PLACES, type Statics } from "../shared/core";
import { MAP, MAP_LEFT, MAP_TOP, REACH, drawModeMap, mapSize, modeColour } from "../shared/mode_map";
import { decision, marginWords, modeName, modeWords } from "../shared/mode_words";
import { type Xy, objectTransform } from "../shared/object_transform";
import { drawCells } from "../shared/raster";
import { type Overrides, get, ofSide, tiltOf } from "../shared/scene_values";
import { type View, onFloor, viewOf } from "../shared/pair_view";
import { drawSide } from "../shared/side_view";
import { base, core, extraNumber, extras, overrides, scene, setExtra, setForAll, valuesOf } from "../shared/state";
import { SIDES, tables } from "../shared/tables";
import { type Palette, isLow, palette } from "../shared/theme";

const DEGREE = Math.PI / 180;
const MODE_CELLS = [0, 1, 2] as const;

const usualTheta = (side: 0 | 1) =>
  ofSide(scene.value, "palm", SIDES[side], side === 0 ? "shallow_deg" : "steep_deg");
const theta = computed<[number, number]>(() => [
  extraNumber("tl", usualTheta(0)), extraNumber("tr", usualTheta(1)),
]);
const contact = computed<[number, number]>(() => [extraNumber("pl", -20), extraNumber("pr", 0)]);
// The contacts under the pointer in a map of contact modes. The view shows their state until it leaves.
const hovered = signal<[number, number] | null>(null);
const half = (side: 0 | 1) => ofSide(scene.value, "palm", SIDES[side], "length_m") / 2;

function staticsAt([pLeft, pRight]: [number, number]): Statics | null {
  const machine = core.value;
  if (!machine) return null;
  machine.setScene(scene.value);
  return machine.statics(
    [theta.value[0] * DEGREE, theta.value[1] * DEGREE], [pLeft / 1000, pRight / 1000],
  );
}

// The state that the view shows: where the pointer is, if the object reaches from palm to palm there.
const shown = computed(() => {
  const under = hovered.value && staticsAt(hovered.value);
  return under?.reaches
    ? { contacts: hovered.value!, f: under, isUnderPointer: true }
    : { contacts: contact.value, f: staticsAt(contact.value), isUnderPointer: false };
});
const found = computed(() => shown.value.f);

// The shallow and the steep angle [°] of either palm in the map of COMs: those of the scene until the
// visitor turns a palm, then the smaller and the larger of the two angles of the state.
const angles = computed<[[number, number], [number, number]]>(() => {
  const own = (side: 0 | 1): [number, number] => [
    ofSide(scene.value, "palm", SIDES[side], "shallow_deg"),
    ofSide(scene.value, "palm", SIDES[side], "steep_deg"),
  ];
  if (!("tl" in extras.value || "tr" in extras.value)) return [own(0), own(1)];
  const chosen: [number, number] = [Math.min(...theta.value), Math.max(...theta.value)];
  return [chosen, chosen];
});

const map = (closing: boolean) =>
  computed(() => {
    const machine = core.value;
    if (!machine) return null;
    machine.setScene(scene.value);
    return machine.modeMap([theta.value[0] * DEGREE, theta.value[1] * DEGREE], closing, MAP, REACH);
  });
const maps = { closing: map(true), opening: map(false) };

const halfMm = (mm: number) => Math.round(2 * mm) / 2;

function setTheta(side: 0 | 1, degrees: number): void {
  const value = Math.round(10 * Math.min(60, Math.max(-20, degrees))) / 10;
  setExtra(side === 0 ? "tl" : "tr", String(value), String(usualTheta(side)));
}

function setContact(side: 0 | 1, mm: number): void {
  const most = 1000 * half(side);
  const value = halfMm(Math.min(most, Math.max(-most, mm)));
  setExtra(side === 0 ? "pl" : "pr", String(value), side === 0 ? "-20" : "0");
}

const inMm = (value: number) => `${value.toFixed(1).replace("-", "−")} mm`;
const inDegrees = (value: number) => `${value.toFixed(1).replace("-", "−")}°`;
const fine = (value: number) => Math.round(value * 2000) / 2000; // half a millimetre

// Writes the outline explicitly, so that every part of it is the visitor's own from now on.
function setObject(changes: { vertices_m?: Xy[]; com_m?: Xy }): void {
  const object = get(scene.peek(), "object") as Record<string, unknown>;
  const next = { ...overrides.peek() };
  for (const key of Object.keys(next)) if (key.startsWith("object")) delete next[key];
  for (const key of ["vertices_m", "contacts", "com_m", "mass_kg", "depth_m"]) {
    next[`object.${key}`] = (changes[key as "com_m"] ?? object[key]) as never;
  }
  overrides.value = next;
}

const view = signal<View | null>(null);

function mechanicsHeight(width: number): number {
  return Math.round(Math.min(isLow.value ? 310 : 400, Math.max(260, width * 0.45)));
}

// A view of the pair that leaves room above for the cones.
function draw(surface: Surface): void {
  const f = found.value;
  if (!f || !f.reaches) return;
  const at = viewOf(surface, f.places, tiltOf(scene.value), false);
  // The handles lie over the drawing: they are moved only when the view changes.
  const last = view.peek();
  const same = last && last.tilt === at.tilt && last.scale === at.scale && last.x(0) === at.x(0) && last.y(0) === at.y(0);
  if (!same) view.value = at;
  drawSide(
    surface, at, palette.value,
    { places: f.places, zones: zeroZone(scene.value), cones: f.cones, gravity: true },
    0, false,
  );
  onFloor(surface, at, () => drawCrossings(surface, at, palette.value, f));
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

function handles(): Handle[] {
  const at = view.value;
  const f = found.value;
  if (!at || !f || !f.reaches) return [];
  const places = f.places;
  const frame = objectTransform(scene.value, places);
  const world = (x: number, y: number): Xy => {
    const origin = at.y(0);
    return [at.worldX(x), (origin - y) / at.scale];
  };
  const list: Handle[] = [];
  const vertices = get(scene.value, "object.vertices_m") as Xy[];
  vertices.forEach((vertex, k) => {
    const [x, y] = frame.toWorld(vertex);
    list.push({
      id: `corner-${k}`, label: `corner ${k + 1} of the object`, kind: "corner", x: at.x(x), y: at.y(y),
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
  for (const side of [0, 1] as const) {
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
  for (const side of [0, 1] as const) list.push(coneHandle(side, f, at, world));
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

function State() {
  const slider = (
    label: string, id: string, value: number, low: number, high: number, step: number, unit: string,
    change: (value: number) => void,
  ) => (
    <label class="slider">
      <span>
        {label} <output>{value.toFixed(1).replace("-", "−")} {unit}</output>
      </span>
      <input type="range" id={id} min={low} max={high} step={step} value={value}
        onInput={(event) => change(Number(event.currentTarget.value))} />
    </label>
  );
  const friction = valuesOf("palm.friction");
  const shown = [...new Set(friction.map((value) => value.toFixed(2)))].join(" / ");
  return (
    <div class="sliders tight">
      {slider("θ_L", "theta-left", theta.value[0], -10, 50, 0.5, "°", (v) => setTheta(0, v))}
      {slider("θ_R", "theta-right", theta.value[1], -10, 50, 0.5, "°", (v) => setTheta(1, v))}
      {slider("p_L", "p-left", contact.value[0], -1000 * half(0), 1000 * half(0), 0.5, "mm", (v) => setContact(0, v))}
      {slider("p_R", "p-right", contact.value[1], -1000 * half(1), 1000 * half(1), 0.5, "mm", (v) => setContact(1, v))}
      <label class="slider">
        <span>friction μ <output>{shown}</output></span>
        <input type="range" id="friction" min={0.05} max={1.2} step={0.01} value={friction[0]}
          onInput={(event) => setForAll("palm.friction", Number(event.currentTarget.value))} />
      </label>
    </div>
  );
}

// The squeezes that each contact can carry, on one axis. The ends decide which contact slides.
function Squeezes(props: { f: Statics }) {
  const { f } = props;
  const finite = f.squeeze.flat().filter(Number.isFinite);
  const low = Math.min(-0.05, ...finite.map((v) => v * 1.15));
  const high = Math.max(0.3, ...finite.map((v) => v * 1.15));
  const x = (h: number) => 34 + (Math.min(high, Math.max(low, h)) - low) / (high - low) * 420;
  const both = [
    Math.max(f.squeeze[0]![0], f.squeeze[1]![0]), Math.min(f.squeeze[0]![1], f.squeeze[1]![1]),
  ] as const;
  const held = both[0] <= both[1];
  return (
    <svg class="squeezes" viewBox="0 0 470 122" role="img"
      aria-label={`squeezes that the left contact can transmit: ${f.squeeze[0]!.map((v) => v.toFixed(3)).join(" to ")} weights, the right one: ${f.squeeze[1]!.map((v) => v.toFixed(3)).join(" to ")}`}>
      {held && (
        <rect x={x(both[0])} y="8" width={Math.max(1, x(both[1]) - x(both[0]))} height="70" fill="var(--zero-pale)" />
      )}
      {f.squeeze.map(([from, to], side) => (
        <g>
          <text x="24" y={26 + 30 * side} text-anchor="end" class="label" fill={side === 0 ? "var(--left)" : "var(--right)"}>
            I{side === 0 ? "ʟ" : "ʀ"}
          </text>
          <line x1={x(from)} x2={x(to)} y1={22 + 30 * side} y2={22 + 30 * side} stroke={side === 0 ? "var(--left)" : "var(--right)"} stroke-width="7" />
        </g>
      ))}
      <line x1="34" x2="454" y1="82" y2="82" stroke="var(--edge)" />
      {[0, 0.1, 0.2, 0.3, 0.5, 1, 2].filter((v) => v > low && v < high).map((v) => (
        <g>
          <line x1={x(v)} x2={x(v)} y1="79" y2="85" stroke="var(--edge)" />
          <text x={x(v)} y="97" text-anchor="middle" class="tick">{v}</text>
        </g>
      ))}
      <text x="454" y="116" text-anchor="end" class="tick">squeeze H [weights]</text>
      {held && f.opening >= 0 && <Arrow x={x(both[0])} direction={-1} />}
      {held && f.closing >= 0 && <Arrow x={x(both[1])} direction={1} />}
    </svg>
  );
}

function Arrow(props: { x: number; direction: number }) {
  const tip = props.x + 3 * props.direction;
  return (
    <path d={`M${tip - 12 * props.direction} 67 L${tip} 67 m${-5 * props.direction} -4 l${5 * props.direction} 4 l${-5 * props.direction} 4`}
      fill="none" stroke="var(--ink)" stroke-width="1.6" />
  );
}

function NineModes(props: { f: Statics }) {
  const { f } = props;
  const title = MODE_CELLS.map((k) => tables.modes[3 * k]!.split("-")[0]!);
  // The core orders the motions of a contact as sticks, up, down; up is SL left and SR right.
  const leftAt = [0, 1, 2];
  const rightAt = [0, 2, 1];
  return (
    <table class="modes">
      <caption>Nine contact modes: which ones balance, and which one occurs</caption>
      <thead>
        <tr>
          <th>left ↓ right →</th>
          {title.map((name) => <th>{name}</th>)}
        </tr>
      </thead>
      <tbody>
        {MODE_CELLS.map((l) => (
          <tr>
            <th scope="row">{title[l]}</th>
            {MODE_CELLS.map((r) => {
              const mode = 3 * leftAt[l]! + rightAt[r]!;
              const happens = [f.closing === mode ? "closing" : "", f.opening === mode ? "opening" : ""].filter(Boolean);
              return (
                <td class={happens.length ? "happens" : f.feasible[mode] ? "feasible" : "no"}>
                  {f.feasible[mode] ? happens.join(", ") || "balances" : "–"}
                </td>
              );
            })}
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function ModeMap(props: { closing: boolean }) {
  const values = props.closing ? maps.closing : maps.opening;
  const seen = [...new Set(values.value ?? [])];
  // The contacts [mm] under the pointer, as shares of the map's half width.
  const pick = (event: PointerEvent) => {
    const place = event.currentTarget as HTMLElement;
    const rect = place.getBoundingClientRect();
    const size = mapSize(rect);
    const x = 2 * ((event.clientX - rect.left - MAP_LEFT) / size) - 1;
    const y = 1 - 2 * ((event.clientY - rect.top - MAP_TOP) / size);
    const at: [number, number] = [x * 1000 * REACH * half(0), y * 1000 * REACH * half(1)];
    const isInside = Math.max(Math.abs(x), Math.abs(y)) <= 1;
    const isHovering = isInside && event.buttons === 0 && event.pointerType !== "touch";
    hovered.value = isHovering ? [halfMm(at[0]), halfMm(at[1])] : null;
    if (event.buttons === 0) return;
    place.setPointerCapture(event.pointerId);
    setContact(0, at[0]);
    setContact(1, at[1]);
  };
  const name = props.closing ? "closing" : "opening";
  return (
    <figure class="map">
      <figcaption>{name}</figcaption>
      <Canvas
        id={props.closing ? "map-closing" : "map-opening"}
        height={(width) => Math.min(width, 300)}
        label={`map of the contact mode on ${name}, over both contact positions`}
        onPointerDown={pick}
        onPointerMove={pick}
        onPointerLeave={() => (hovered.value = null)}
        draw={(s) => {
          if (!values.value) return;
          const size: [number, number] = [1000 * half(0), 1000 * half(1)];
          const palms = { pL: [-size[0], size[0]] as [number, number], pR: [-size[1], size[1]] as [number, number] };
          drawModeMap(s, palette.value, values.value, size, [palms], contact.value, shown.value.isUnderPointer ? shown.value.contacts : null);
        }}
      />
      <ul class="key">
        {seen.sort((a, b) => b - a).map((mode) => (
          <li>
            <i style={{ background: modeColour(palette.value, mode), opacity: mode < 0 ? 1 : 0.5 }} /> {modeName(mode)}
          </li>
        ))}
      </ul>
    </figure>
  );
}

const radians = (degrees: [[number, number], [number, number]]): [[number, number], [number, number]] =>
  degrees.map((pair) => pair.map((angle) => angle * DEGREE)) as [[number, number], [number, number]];

// Which angles the map of COMs takes.
function anglesWords(): string {
  const [left, right] = angles.value.map((pair) => pair.map(inDegrees)) as [string[], string[]];
  if (left.every((angle, k) => angle === right[k])) {
    return `The shallow angle is ${left[0]}, the steep one ${left[1]}.`;
  }
  return `The shallow and the steep angle of the left palm are ${left[0]} and ${left[1]}, those of the right one ${right[0]} and ${right[1]}.`;
}

// The command that draws the map of COMs with these angles, if a scene may have them.
function analyzeLines(words: string): string[] {
  if (angles.value.some(([shallow, steep]) => shallow >= steep)) return [];
  const keys: Overrides = {};
  angles.value.forEach((pair, side) =>
    ["shallow_deg", "steep_deg"].forEach((name, k) => {
      if (ofSide(scene.value, "palm", SIDES[side]!, name) === pair[k]) return;
      const own = `palm.${SIDES[side]}.${name}`;
      keys[get(scene.value, own) === undefined ? `palm.${name}` : own] = pair[k]!;
    }),
  );
  return [["palmbots analyze", words, ...settings(keys), "--figures out"].join(" ")];
}

// Figure 6: the COMs for which the properties hold over the whole palms, drawn on the object.
function drawCom(surface: Surface): void {
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

export function MechanicsView() {
  const f = found.value;
  const words = sceneWords(base.value, overrides.value).join(" ");
  const numbers = [
    "--theta-left-deg", theta.value[0], "--theta-right-deg", theta.value[1],
    "--p-left-m", contact.value[0] / 1000, "--p-right-m", contact.value[1] / 1000,
  ].join(" ");
  return (
    <>
      <header class="lead">
        <h1>Which contact slides?</h1>
        <p>
          Drag the centre of mass, a corner, a palm, a contact or an edge of the cones. The squeeze H, the
          force with which the palms press the object inward, decides which contact slides on closing
          (the robots drive the contact points together) and on opening (apart).
        </p>
      </header>
      <div class="choices">
        <SceneChoice />
        <button type="button" id="reset" onClick={() => {
          overrides.value = {};
          for (const name of ["tl", "tr", "pl", "pr"]) setExtra(name, "", "");
        }}>
          reset
        </button>
      </div>
      <div class="state-and-words">
      <section class="panel" aria-label="one state">
        <div class="stage over">
          <Canvas id="mechanics" height={mechanicsHeight} draw={draw}
            label="object, palms, friction cones and line of gravity of one state" />
          <Handles handles={handles()} />
          {f && !f.reaches && <p class="status refusal">The object does not reach from palm to palm.</p>}
          {f && f.reaches && f.reason > 0 && (
            <p class="status refusal">{tables.dropReasons[f.reason]![0]}: {tables.dropReasons[f.reason]![1]}</p>
          )}
        </div>
        <State />
      </section>
      {f && f.reaches && (
        <section class="state">
          <p class="note" id="shown-state">
            State {shown.value.isUnderPointer ? "under the pointer" : "at the dot of the maps below"}:{" "}
            p<sub>L</sub> = {inMm(shown.value.contacts[0])}, p<sub>R</sub> = {inMm(shown.value.contacts[1])}
          </p>
          <h2>Closing: {modeName(f.closing)}</h2>
          <p id="closing-words">{modeWords(f.closing)} {decision(f, true)}</p>
          <h2>Opening: {modeName(f.opening)}</h2>
          <p id="opening-words">{modeWords(f.opening)} {decision(f, false)}</p>
          <p class="note" id="margin-words">{marginWords(f.margin)}</p>
          <Squeezes f={f} />
        </section>
      )}
      </div>
      {f && f.reaches && (
        <>
          <section>
            <NineModes f={f} />
            <p class="note">
              {Object.entries(tables.motionMeanings).map((both) => both.join(": ")).reverse().join(", ")}
            </p>
          </section>
          <section>
            <h2>Every pair of contacts</h2>
            <p class="note">
              The maps show the contact mode at these palm angles for all positions of the contacts, as in
              Figure 5 of the paper. Each contact mode occupies a band. The square contains the positions on the
              palms. Hold the pointer over a map to see the state there. Drag the dot to move the contacts.
            </p>
            <div class="columns">
              <ModeMap closing />
              <ModeMap closing={false} />
            </div>
          </section>
          <section>
            <h2>Every centre of mass</h2>
            <p class="note">
              The map shows where the centre of mass may lie so that both properties hold with the
              contacts anywhere on the palms, whichever palm is the shallow
              one. <span id="com-angles">{anglesWords()}</span> If you turn a palm, the map takes the
              smaller and the larger of the two angles above. Property
              1: {tables.modeSentences.property_1} Property 2: {tables.modeSentences.property_2} This map
              corresponds to Figure 6 of the paper.
            </p>
            <Canvas id="com-map" height={(width) => Math.min(280, Math.max(160, width * 0.4))} draw={drawCom}
              label="region of centres of mass for which both properties hold, on the object" />
            <ul class="key">
              <li><i style="background: var(--zero); opacity: 0.6" /> both properties hold</li>
              <li><i style="background: var(--left); opacity: 0.28" /> only property 1</li>
              <li><i style="background: var(--right); opacity: 0.28" /> only property 2</li>
            </ul>
          </section>
        </>
      )}
      <AtHome
        lines={[`palmbots contact-modes ${words} ${numbers}`, ...analyzeLines(words)]}
        runs={presentRun()}
        note="The last command simulates a carry of the object in this view."
      />
    </>
  );
}
