// SPDX-License-Identifier: Apache-2.0
// Parts that several views use: choices of scene and controller, sliders, the command line.
import { useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useRef } from "preact/hooks";
import { POLICY_FILE, SCENE_FILE, carryCommand, needsFile, policyFile } from "../shared/command";
import { fromPaper, overridesOf } from "../shared/scene";
import { freeIn } from "../shared/floor_job";
import { get } from "../shared/scene_values";
import {
  OWN_ROWS, base, checkCanBeCarried, controller, core, forks, isJob, overrides, player, policy, recorded,
  scene, seed, setExtra, setForAll, valuesOf,
} from "../shared/state";
import { type Json, controllerInfo, tables } from "../shared/tables";
import { sceneFile } from "../shared/toml";

export function Field(props: { label: string; children: ComponentChildren; hint?: string }) {
  return (
    <label class="field" title={props.hint}>
      <span>{props.label}</span>
      {props.children}
    </label>
  );
}

export function controllerTitle(name: string): string {
  if (name === OWN_ROWS) return "nine rows of your own";
  return controllerInfo(name)?.name ?? name;
}

export function ControllerChoice(props: {
  value: string; onChange: (name: string) => void; label?: string; id?: string;
}) {
  return (
    <Field label={props.label ?? "controller"} hint={controllerInfo(props.value)?.description}>
      <select
        id={props.id}
        value={props.value}
        onChange={(event) => props.onChange(event.currentTarget.value)}
      >
        {tables.controllers.map((c) => (
          <option value={c.name}>{c.name}</option>
        ))}
        <option value={OWN_ROWS}>nine rows of your own</option>
      </select>
    </Field>
  );
}

// The name of the object that is carried, or "" for one of a file.
function objectName(): string {
  const named = overrides.value.object;
  if (typeof named === "string") return named;
  if ("object.vertices_m" in overrides.value) return "";
  return "box";
}

// The changed keys of the scene that no control beside it shows.
function changedKeys(): string[] {
  const shown = ["object", ...sliders().map((slider) => slider.name), ...(isJob.value ? JOB_KEYS : [])];
  return Object.keys(overrides.value).filter((key) => !shown.includes(key));
}

export function SceneChoice() {
  const meaning = tables.scenes.find((s) => s.name === base.value)?.meaning;
  const changed = changedKeys();
  const label = changed.length === 0 ? "scene" : `scene, ${changed.length} changed`;
  return (
    <>
      <Field label={label} hint={changed.length === 0 ? meaning : `changed: ${changed.join(", ")}`}>
        <select
          id="scene"
          value={base.value}
          onChange={(event) => {
            base.value = event.currentTarget.value;
            overrides.value = {};
            forks.value = [];
            player.seek(0);
          }}
        >
          {tables.scenes.map((s) => (
            <option value={s.name}>{s.name}</option>
          ))}
        </select>
      </Field>
      <Field label="object">
        <select
          id="object"
          value={objectName()}
          onChange={(event) => {
            const next = { ...overrides.value };
            for (const key of Object.keys(next)) if (key.startsWith("object")) delete next[key];
            if (event.currentTarget.value !== "box") next.object = event.currentTarget.value;
            overrides.value = next;
          }}
        >
          {objectName() === "" && <option value="">from a file</option>}
          {tables.objects.map((o) => (
            <option value={o.name}>{o.name}</option>
          ))}
        </select>
      </Field>
    </>
  );
}

// Back to the scene that a visitor finds first: what stories, sliders and hands have set is gone.
export function ResetButton() {
  return (
    <button
      type="button"
      id="reset"
      onClick={() => {
        base.value = "paper";
        controller.value = tables.defaultController;
        seed.value = 0;
        overrides.value = {};
        forks.value = [];
        setExtra("m", "", "");
        player.speed.value = 1;
        player.pause();
        player.seek(0);
      }}
    >
      reset
    </button>
  );
}

interface SliderOfKey {
  name: string;
  label: string;
  min: number;
  max: number;
  step: number;
  unit?: string;
  factor?: number;
  digits?: number;
}

// Loss up to 100 %: the radio is jammed. In the quasistatic world no motion depends on the mass.
const SLIDERS: SliderOfKey[] = [
  { name: "robot.noise_m_s", label: "speed noise", min: 0, max: 40, step: 1, factor: 1000, unit: "mm/s" },
  { name: "radio.latency_s", label: "radio latency", min: 0, max: 500, step: 10, factor: 1000, unit: "ms" },
  { name: "radio.loss", label: "radio loss", min: 0, max: 100, step: 1, factor: 100, unit: "%" },
  { name: "palm.left.friction", label: "left friction", min: 0.05, max: 1.2, step: 0.01, digits: 2 },
  { name: "palm.right.friction", label: "right friction", min: 0.05, max: 1.2, step: 0.01, digits: 2 },
  { name: "object.mass_kg", label: "mass", min: 0.1, max: 10, step: 0.1, digits: 1, unit: "kg: same motion" },
];

export function KeySlider(props: SliderOfKey) {
  const factor = props.factor ?? 1;
  const values = valuesOf(props.name).map((v) => v * factor);
  const value = values[0]!;
  const shown = [...new Set(values.map((v) => v.toFixed(props.digits ?? 0)))];
  const meaning = tables.keys.find((k) => k.name === props.name)?.meaning;
  return (
    <label class="slider" title={meaning}>
      <span>
        {props.label} <span class="value">{shown.join(" / ")}{props.unit ? ` ${props.unit}` : ""}</span>
      </span>
      <input
        type="range"
        data-key={props.name}
        min={props.min}
        max={props.max}
        step={props.step}
        value={value}
        onInput={(event) => {
          const next = Number((Number(event.currentTarget.value) / factor).toPrecision(12));
          setForAll(props.name, next);
        }}
      />
    </label>
  );
}

const JOB_KEYS = ["task.dock", "palm.heel_m"];
const DOCKS = ["together", "one-first"];

// Whether a control of this key is shown: the page knows only with some keys whether the robots lift the
// object.
const isShown = (key: string) => !isJob.value || freeIn(base.value).includes(key);
const sliders = () => SLIDERS.filter((one) => isShown(one.name));

function KeyChoice<T extends string | number>(props: {
  name: string; label: string; values: T[]; words: (value: T) => string;
}) {
  const meaning = tables.keys.find((k) => k.name === props.name)?.meaning;
  const value = get(scene.value, props.name) as T;
  return (
    <Field label={props.label} hint={meaning}>
      <select
        data-key={props.name}
        value={props.values.indexOf(value)}
        onChange={(event) => setForAll(props.name, props.values[Number(event.currentTarget.value)]!)}
      >
        {props.values.map((one, k) => <option value={k}>{props.words(one)}</option>)}
      </select>
    </Field>
  );
}

// Of a job on the floor.
export function JobChoices() {
  return (
    <>
      {isShown("task.dock") &&
        <KeyChoice name="task.dock" label="docking" values={DOCKS} words={(dock) => dock.replace("-", " ")} />}
      <KeyChoice name="palm.heel_m" label="heels" values={tables.jobs.heels}
        words={(heel) => (heel === 0 ? "none" : `${1000 * heel} mm`)} />
    </>
  );
}

export function Disturbances() {
  return (
    <div class={`sliders ${isJob.value ? "few" : ""}`}>
      {sliders().map((slider) => <KeySlider {...slider} />)}
    </div>
  );
}

export function download(name: string, data: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(data);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export interface Run {
  command: string;
  hash: string | undefined;
}

// The carry that the state describes, at home.
export function presentRun(): Run[] {
  if (!recorded.value) return [];
  const command = carryCommand(
    base.value, overrides.value, controller.value, seed.value, forks.value,
  );
  return [{ command, hash: recorded.value.hash }];
}

// "Run it on your computer": command lines, those of carries with their traces, and the files that they need.
export function AtHome(props: {
  runs: Run[]; lines?: string[]; note?: ComponentChildren; files?: [string, string][];
}) {
  const copied = useSignal(false);
  const lines = useRef<HTMLPreElement>(null);
  const text = [...(props.lines ?? []), ...props.runs.map((run) => run.command)].join("\n");
  const files = [...(props.files ?? [])];
  const isThere = files.some(([name]) => name === SCENE_FILE);
  if (!isThere && needsFile(overrides.value) && text.includes(SCENE_FILE)) {
    files.push([SCENE_FILE, sceneFile(fromPaper(base.value, overrides.value))]);
  }
  if (text.includes(POLICY_FILE)) files.push([POLICY_FILE, policyFile(policy.value)]);
  return (
    <section class="home" aria-label="run it on your computer">
      <h2>Run it on your computer</h2>
      <pre class="command" tabIndex={0} ref={lines}>{text}</pre>
      <p class="row">
        <button
          type="button"
          onClick={async () => {
            // Only a page from this machine or over HTTPS may write to the clipboard.
            if (!navigator.clipboard) return getSelection()?.selectAllChildren(lines.current!);
            await navigator.clipboard.writeText(text);
            copied.value = true;
            setTimeout(() => (copied.value = false), 1500);
          }}
        >
          {copied.value ? "copied" : "copy"}
        </button>
        {files.map(([name, content]) => (
          <button type="button" onClick={() => download(name, new Blob([content]))}>
            save {name}
          </button>
        ))}
        {props.runs.length > 0 && (
          <span>
            {props.runs.length > 1 ? "traces " : "trace "}
            {props.runs.map(({ hash }, k) => (
              <>
                {k > 0 && " and "}
                <code id={k === 0 ? "hash" : `hash-${k}`}>{hash}</code>
              </>
            ))}
            : your computer computes the same bits.
          </span>
        )}
        {props.note && <span>{props.note}</span>}
      </p>
    </section>
  );
}

// Opens a scene file that was dropped or chosen. Throws an Error with one line.
export async function openScene(file: File): Promise<void> {
  const { parse } = await import("smol-toml");
  if (file.size > 200_000) throw new Error(`${file.name}: is too large for a scene`);
  let table: Record<string, unknown>;
  try {
    table = parse(await file.text(), { integersAsBigInt: true });
  } catch (error) {
    throw new Error(`${file.name}: ${(error as Error).message.split("\n")[0]}`);
  }
  let found: Record<string, Json>;
  try {
    const machine = core.peek();
    if (!machine) throw new Error("the core is not loaded yet; allowed: again in a moment");
    found = overridesOf(machine, table, true);
    checkCanBeCarried(found);
  } catch (error) {
    throw new Error(`${file.name}: ${(error as Error).message}`);
  }
  base.value = "paper";
  overrides.value = found;
  forks.value = [];
  player.seek(0);
}

// A case in words: what a robot does in the state that its table names. A station has no such states,
// and the condition of its cases held when they began: later the contacts may be elsewhere.
export function caseWords(name: string, letter: string, state: number): string {
  const does = controllerInfo(name)?.states[state];
  if (does) return `(${letter}) ${does}`;
  const meaning = (controllerInfo(name)?.cases[letter] ?? "").replaceAll(/ ([<>]) /g, "\u00a0$1\u00a0");
  return `(${letter}) ${/[<>]/.test(meaning) ? "began with " : ""}${meaning}`;
}

export function setController(name: string): void {
  controller.value = name;
  forks.value = [];
}
