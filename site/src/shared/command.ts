// SPDX-License-Identifier: Apache-2.0
// The command lines that reproduce at home what a view shows.
import type { Fork, PolicyRow } from "./core";
import type { Overrides } from "./scene_values";
import { OWN_ROWS, SIGN_PAIRS } from "./state";
import type { Json } from "./tables";
import { tomlValue } from "./toml";
import type { Touched } from "./touched";

export const POLICY_FILE = "rows.toml";
export const SCENE_FILE = "scene.toml";

// A word of a POSIX shell.
function quoted(word: string): string {
  return /^[\w./:=,@+-]+$/.test(word) ? word : `'${word.replaceAll("'", `'\\''`)}'`;
}

export function controllerWord(name: string): string {
  return name === OWN_ROWS ? `${POLICY_FILE}@station` : name;
}

export function settings(overrides: Overrides): string[] {
  return Object.entries(overrides).flatMap(([key, value]) => [
    "--set",
    quoted(`${key}=${typeof value === "string" ? value : tomlValue(value)}`),
  ]);
}

// A scene whose outline is the visitor's own is a file: as a word it would be too long.
export function needsFile(overrides: Overrides): boolean {
  return "object.vertices_m" in overrides;
}

export function sceneWords(base: string, overrides: Overrides): string[] {
  return needsFile(overrides) ? [SCENE_FILE] : [base, ...settings(overrides)];
}

export function carryCommand(
  base: string, overrides: Overrides, controller: string, seed: number, forks: Fork[],
): string {
  return carryOf(sceneWords(base, overrides), controller, seed, forks);
}

export function carryOf(sceneWords: string[], controller: string, seed: number, forks: Fork[]): string {
  const words = ["palmbots", "carry", ...sceneWords];
  words.push("--controller", controllerWord(controller), "--seed", String(seed));
  for (const fork of forks) words.push("--fork", `${fork.at}:${fork.seed}`);
  return words.join(" ");
}

// A value as Python writes it.
function pythonValue(value: Json): string {
  if (Array.isArray(value)) return `[${value.map(pythonValue).join(", ")}]`;
  if (typeof value === "boolean") return value ? "True" : "False";
  if (typeof value !== "object") return JSON.stringify(value);
  return `{${Object.entries(value).map(([key, v]) => `${JSON.stringify(key)}: ${pythonValue(v)}`).join(", ")}}`;
}

// The program that puts an object on a floor, drives palms under it [mm] and lists the contact modes.
export function floorLines(base: string, overrides: Overrides, at: {
  palms: [number, number]; driven: [number, number]; raised: number; friction: number; isAlone: boolean;
}): string[] {
  const metres = (mm: number) => Number((mm / 1000).toPrecision(12));
  const scene = needsFile(overrides) ? SCENE_FILE : base;
  const given = [JSON.stringify(scene), `palms_deg=(${at.palms.join(", ")})`];
  if (at.isAlone) given.push("gaps_m=(0.01, None)");
  if (at.friction !== 0.3) given.push(`floor_friction=${at.friction}`);
  if (!needsFile(overrides) && Object.keys(overrides).length > 0) given.push(`overrides=${pythonValue(overrides)}`);
  const up = metres(at.raised);
  const program = [
    "from palmbots.simulation import FloorWorld",
    `world = FloorWorld(${given.join(", ")})`,
    `world.move(${metres(at.driven[0])}, ${at.isAlone ? 0 : -metres(at.driven[1])})`,
    ...(up > 0 ? [`world.move(up_m=(${up}, ${up}))`] : []),
    ...["0.01, -0.01", "-0.01, 0.01"].map((way) => `print(world.contact_modes(${way}))`),
  ];
  return `python -c ${quoted(program.join("\n"))}`.split("\n");
}

// The contact modes of these contacts on two palms that close, and open.
export function contactLines(contacts: Touched[], slope: number): string[] {
  const of = ({ carrier, at, normal, friction }: Touched) => {
    const numbers = [`(${at.join(", ")})`, `(${normal.join(", ")})`, friction, `(${carrier === 0 ? "" : "-"}v, 0)`];
    return `    SurfaceContact("${carrier === 0 ? "left" : "right"} palm", ${numbers.join(", ")}),`;
  };
  const program = [
    "from palmbots import consistent_modes",
    "from palmbots.mechanics import SurfaceContact",
    "for v in (0.01, -0.01):",
    "  contacts = [",
    ...contacts.map(of),
    "  ]",
    `  print(consistent_modes(contacts${slope === 0 ? "" : `, slope=${slope}`}))`,
  ];
  return `python -c ${quoted(program.join("\n"))}`.split("\n");
}

export function policyFile(rows: PolicyRow[]): string {
  const lines = rows.map((row, k) => {
    const pair = (words: [string, string]) => `["${words[0]}", "${words[1]}"]`;
    return `"${SIGN_PAIRS[k]}" = { palms = ${pair(row.palms)}, drives = ${pair(row.drives)} }`;
  });
  return ['description = "rows from the page"', "", "[rows]", ...lines, ""].join("\n");
}
