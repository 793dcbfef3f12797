// SPDX-License-Identifier: Apache-2.0
// Design: how much error each pair of palm angles tolerates, and what limits the chosen pair.
import { computed } from "@preact/signals";
import { AtHome, KeySlider, SceneChoice } from "./parts";
import { Canvas, type Surface } from "../shared/canvas";
import { SCENE_FILE, carryOf, controllerWord } from "../shared/command";
import type { Limit } from "../shared/core";
import { MAP, REACH, type Region, drawContactModeMap, contactModeColour } from "../shared/contact_mode_map";
import { contactModeName } from "../shared/contact_mode_words";
import { drawCells } from "../shared/raster";
import { fromPaper } from "../shared/scene";
import { get, ofSide } from "../shared/scene_values";
import {
  address, base, controller, core, extra, extraNumber, forks, overrides, recorded, scene, seed, setExtra,
} from "../shared/state";
import { type Json, SIDES, tables } from "../shared/tables";
import { isLow, palette } from "../shared/theme";
import { sceneFile } from "../shared/toml";

const DEGREE = Math.PI / 180;
const [FROM, TO, STEP] = [-5, 50, 0.5]; // of both angles [°], as in palmbots design
const COUNT = (TO - FROM) / STEP + 1;
const QUANTITIES = ["com", "friction", "slope", "angle"];
const [MARGIN, FOOT] = [44, 40];

// cividis, which matplotlib uses for the same map: equal steps look equal, to every eye.
const CIVIDIS = [
  "#00224e", "#123570", "#3b496c", "#575d6d", "#707173", "#8a8678", "#a59c74", "#c3b369", "#e1cc55",
  "#fee838",
];

const quantity = computed(() => {
  const name = extra("q", "com");
  return QUANTITIES.includes(name) ? name : "com";
});
const halfPalm = computed(() => Math.min(...SIDES.map((s) => ofSide(scene.value, "palm", s, "length_m"))) / 2);
const region = computed(() => Math.min(halfPalm.value, extraNumber("r", 1000 * halfPalm.value) / 1000));

const map = computed(() => {
  const machine = core.value;
  if (!machine) return null;
  machine.setScene(scene.value);
  const info = tables.quantities[quantity.value]!;
  return machine.toleranceMap(
    FROM * DEGREE, STEP * DEGREE, COUNT, info.number, info.most, region.value,
  );
});

const pair = computed<[number, number]>(() => [
  Number(get(scene.value, "palm.shallow_deg")), Number(get(scene.value, "palm.steep_deg")),
]);

const limits = computed<Limit[]>(() => {
  const machine = core.value;
  if (!machine) return [];
  machine.setScene(scene.value);
  return machine.limits(region.value);
});

// The unit and the factor in which a tolerance is shown.
function shown(value: number): string {
  if (!(value >= 0)) return "none";
  if (quantity.value === "com") return `±${(1000 * value).toFixed(1)} mm`;
  if (quantity.value === "friction") return `±${value.toFixed(3)}`;
  return quantity.value === "slope"
    ? `±${(Math.atan(value) / DEGREE).toFixed(2)}°`
    : `±${(value / DEGREE).toFixed(2)}°`;
}

function setPair(shallow: number, steep: number): void {
  const fit = (value: number) => Math.min(TO, Math.max(FROM, Math.round(value / STEP) * STEP));
  const next: Record<string, Json> = { ...overrides.peek() };
  next["palm.shallow_deg"] = fit(shallow);
  next["palm.steep_deg"] = Math.max(fit(steep), fit(shallow) + STEP);
  overrides.value = next;
}

function box(surface: Surface): { x: number; y: number; size: number } {
  return { x: MARGIN, y: 8, size: Math.min(surface.width - MARGIN - 18, surface.height - FOOT - 8) };
}

function draw(surface: Surface): void {
  const values = map.value;
  if (!values) return;
  const p = palette.value;
  const c = surface.context;
  const { x, y, size } = box(surface);
  let most = 0;
  for (let k = 0; k < values.length; k += 2) {
    if (values[k + 1]! >= 0 && values[k]! > most) most = values[k]!;
  }
  c.fillStyle = p.ground;
  c.fillRect(x, y, size, size);
  // Shallow to the right, steep upward.
  drawCells(c, { x, y, width: size, height: size }, COUNT, COUNT, (k) => {
    const [row, column] = [Math.floor(k / COUNT), k % COUNT];
    const at = 2 * (column * COUNT + row);
    if (!(values[at]! > 0)) return null;
    if (!(values[at + 1]! >= 0)) return [p.rule, 1];
    const share = Math.min(0.999, values[at]! / most);
    return [CIVIDIS[Math.floor(share * CIVIDIS.length)]!, 1];
  });
  c.strokeStyle = p.quiet;
  c.strokeRect(x, y, size, size);
  c.fillStyle = p.quiet;
  c.font = "11px system-ui, sans-serif";
  c.textBaseline = "middle";
  const place = (degrees: number) => ((degrees - FROM) / (TO - FROM)) * size;
  for (let degrees = 0; degrees <= TO; degrees += 10) {
    c.textAlign = "center";
    c.fillText(`${degrees}°`, x + place(degrees), y + size + 12);
    c.textAlign = "right";
    c.fillText(`${degrees}°`, x - 6, y + size - place(degrees));
  }
  c.textAlign = "center";
  c.fillText("shallow angle", x + size / 2, y + size + 28);
  c.save();
  c.translate(10, y + size / 2);
  c.rotate(-Math.PI / 2);
  c.fillText("steep angle", 0, 0);
  c.restore();
  mark(c, x + place(5), y + size - place(15), p.right, "paper", p.ink, p.background);
  const [shallow, steep] = pair.value;
  if (shallow !== 5 || steep !== 15) {
    mark(c, x + place(shallow), y + size - place(steep), p.background, "chosen", p.ink, p.background);
  }
}

function mark(
  c: CanvasRenderingContext2D, x: number, y: number, fill: string, words: string, ink: string,
  halo: string,
): void {
  c.beginPath();
  c.arc(x, y, 6, 0, 2 * Math.PI);
  c.fillStyle = fill;
  c.fill();
  c.strokeStyle = ink;
  c.lineWidth = 2;
  c.stroke();
  c.font = "600 12px system-ui, sans-serif";
  c.textAlign = "left";
  c.lineWidth = 3;
  c.strokeStyle = halo;
  c.strokeText(words, x + 11, y);
  c.fillStyle = ink;
  c.fillText(words, x + 11, y);
  c.lineWidth = 1;
}

function at(shallow: number, steep: number): [number, number] {
  const values = map.value;
  const place = (degrees: number) => Math.round((degrees - FROM) / STEP);
  const k = 2 * (place(shallow) * COUNT + place(steep));
  return values ? [values[k]!, values[k + 1]!] : [NaN, NaN];
}

function Limits() {
  const width = Math.hypot(
    ...([0, 1].map((k) => {
      const vertices = get(scene.value, "object.vertices_m") as number[][];
      const contacts = get(scene.value, "object.contacts") as number[];
      return vertices[contacts[1]!]![k]! - vertices[contacts[0]!]![k]!;
    }) as [number, number]),
  );
  const mm = (value: number) => (1000 * Math.min(width, Math.max(0, value))).toFixed(1);
  const words = (limit: Limit, by: number) => {
    const text = tables.bindings[`${limit.property}.${tables.bindingNames[by]}`];
    return text ?? "";
  };
  return (
    <div class="scroll">
      <table>
        <thead>
          <tr><th>property</th><th>shallow</th><th>COM along the object</th><th>what happens beyond</th></tr>
        </thead>
        <tbody>
          {limits.value.map((limit) => (
            <tr>
              <th scope="row">{limit.property === 1 ? "1, closing" : "2, opening"}</th>
              <td>{SIDES[limit.shallow]}</td>
              <td class={limit.holds ? "good" : "bad"}>
                {limit.low <= limit.high
                  ? `${mm(limit.low)} to ${mm(limit.high)} mm: ${limit.holds ? "holds" : "fails"}`
                  : "nowhere: fails"}
              </td>
              <td class="wrap">
                {[limit.lowBy, limit.highBy].map((by) => words(limit, by)).filter((w, k, all) => w && all.indexOf(w) === k).join("; ")}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

const regionMaps = computed(() => {
  const machine = core.value;
  if (!machine) return null;
  machine.setScene(scene.value);
  const theta: [number, number] = [pair.value[0] * DEGREE, pair.value[1] * DEGREE];
  return [true, false].map((closing) => machine.contactModeMap(theta, closing, MAP, REACH));
});

// The region of the chosen pair: where each property is needed, and what happens there.
function PairRegion() {
  const size: [number, number] = [
    500 * ofSide(scene.value, "palm", "left", "length_m"),
    500 * ofSide(scene.value, "palm", "right", "length_m"),
  ];
  const r = 1000 * region.value;
  const palms: Region = { pL: [-size[0], size[0]], pR: [-size[1], size[1]], dashed: true };
  const needed: Region[] = [{ pL: [-r, 0], pR: [-r, r] }, { pL: [-r, r], pR: [0, r] }];
  return (
    <div class="columns">
      {[0, 1].map((k) => {
        const values = regionMaps.value?.[k];
        const seen = [...new Set(values ?? [])].sort((a, b) => b - a);
        return (
          <figure class="map">
            <figcaption>
              {k === 0 ? "closing" : "opening"}: property {k + 1} requires {tables.requiredContactModes[k + 1]} in the
              frame
            </figcaption>
            <Canvas
              id={`region-${k}`}
              height={(width) => Math.min(width, 300)}
              label={`contact modes with the left palm shallow and the right one steep, on ${k === 0 ? "closing" : "opening"}; the frame is where the property is needed`}
              draw={(s) => values && drawContactModeMap(s, palette.value, values, size, [palms, needed[k]!], null)}
            />
            <ul class="key">
              {seen.map((mode) => (
                <li>
                  <i style={{ background: contactModeColour(palette.value, mode), opacity: mode < 0 ? 1 : 0.5 }} /> {contactModeName(mode)}
                </li>
              ))}
            </ul>
          </figure>
        );
      })}
    </div>
  );
}

export function DesignView() {
  const [shallow, steep] = pair.value;
  const [tolerance, clearance] = at(shallow, steep);
  const pick = (event: PointerEvent) => {
    if (event.buttons === 0) return;
    const rect = (event.currentTarget as HTMLElement).getBoundingClientRect();
    const { x, y, size } = box({ width: rect.width, height: rect.height } as Surface);
    setPair(
      FROM + ((event.clientX - rect.left - x) / size) * (TO - FROM),
      FROM + (1 - (event.clientY - rect.top - y) / size) * (TO - FROM),
    );
  };
  const keys = (event: KeyboardEvent) => {
    const by: Record<string, [number, number]> = {
      ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP],
    };
    const step = by[event.key];
    if (!step) return;
    event.preventDefault();
    setPair(shallow + step[0], steep + step[1]);
  };
  const run = recorded.value;
  const region_mm = 1000 * region.value;
  const ends = (value: number) => Number(value.toFixed(4));
  return (
    <>
      <header class="lead">
        <h1>Which palm angles?</h1>
        <p>
          The colour of a pair of angles shows how large the error of one quantity may be while the
          contacts still slide as the algorithms require. At grey pairs, a palm touches the outline of
          the object. At empty pairs, a property on which the algorithms rely fails. Click a pair to
          choose it.
        </p>
      </header>
      <div class="choices">
        <SceneChoice />
        <label class="field">
          <span>error of</span>
          <select id="quantity" value={quantity.value}
            onChange={(event) => setExtra("q", event.currentTarget.value, "com")}>
            {QUANTITIES.map((name) => <option value={name}>{tables.quantities[name]!.name}</option>)}
          </select>
        </label>
      </div>
      <div class="sliders">
        <KeySlider name="palm.friction" label="friction μ" min={0.05} max={1} step={0.01} digits={2} />
        <label class="slider">
          <span>contacts within <span class="value">±{region_mm.toFixed(0)} mm</span></span>
          <input type="range" id="region" min={5} max={1000 * halfPalm.value} step={1} value={region_mm}
            onInput={(event) => setExtra("r", event.currentTarget.value, String(1000 * halfPalm.value))} />
        </label>
      </div>
      <div class="columns">
        <Canvas id="design-map" height={(width) => Math.min(width, isLow.value ? 350 : 460)} draw={draw}
          class="crosshair" label="tolerance of each pair of palm angles; the arrow keys move the chosen pair"
          onPointerDown={pick} onPointerMove={pick} onKeyDown={keys} />
        <section>
          <h2>Shallow {shallow}°, steep {steep}°</h2>
          <p id="tolerance">
            {tolerance >= 0
              ? `Tolerates an error of ${shown(tolerance)} (${tables.quantities[quantity.value]!.name}).`
              : "A property fails even without an error: somewhere in the region, the wrong contact slides."}{" "}
            {tolerance >= 0 && (clearance >= 0
              ? `The outline clears the palms by ${(clearance / DEGREE).toFixed(2)}°.`
              : "However, the outline touches a palm.")}
          </p>
          <div class="scale" aria-hidden="true">
            {CIVIDIS.map((colour) => <i style={{ background: colour }} />)}
            <span>little</span><span>much</span>
          </div>
          <p class="note" id="proved-and-counted">
            This view looks at all positions of the contacts within ±{region_mm.toFixed(0)} mm, and
            assumes no noise. Where a property fails, a carry may still arrive, because its contacts may
            never reach such a position: <a href={address({ view: "compare", time: false })}>Compare</a>{" "}
            counts how many of 1000 drop the box. Where
            both properties hold, much noise can still push a contact off its palm.
          </p>
          <p class="note">
            The angles with the largest tolerance are not always the best ones, because steep palms
            take longer to turn. The second command below measures σ*, the speed noise at which 10 of
            1000 carries drop the object.
          </p>
        </section>
      </div>
      <section>
        <h2>The region of this pair</h2>
        <p class="note">
          The maps show the contact modes for all positions of the two contacts, with the left palm
          shallow and the right one steep. The dashed square contains the positions on the palms.
        </p>
        <PairRegion />
        <h2>What limits it</h2>
        <Limits />
      </section>
      <AtHome
        lines={[
          `palmbots certify ${SCENE_FILE} --region ${ends(-region.value)},${ends(region.value)} -o box.json`,
          `palmbots noise-limit ${SCENE_FILE} --controller ${controllerWord(controller.value)}`,
        ]}
        runs={run ? [{ command: carryOf([SCENE_FILE], controller.value, seed.value, forks.value), hash: run.hash }] : []}
        files={[[SCENE_FILE, sceneFile({ "palm.shallow_deg": shallow, "palm.steep_deg": steep, ...fromPaper(base.value, overrides.value) })]]}
        note="The page itself proves nothing. The first command proves a certificate, or reports where the proof fails."
      />
    </>
  );
}
