// SPDX-License-Identifier: Apache-2.0
// The package's own names, symbols and meanings. scripts/site_tables.py writes them at build time.
import data from "../generated/tables.json";

export type Json = string | number | boolean | Json[] | { [key: string]: Json };
export type Scene = { [section: string]: Json };

interface ControllerInfo {
  name: string;
  description: string;
  team: string;
  usesRadio: boolean;
  isPeriodic: boolean;
  cases: Record<string, string>;
  states: string[]; // what a robot does in each state of its program
  messages: string[];
  colour: string;
}

// The types and limits of a value of a scene, as in JSON Schema, and in words.
export interface Shape {
  allowed: string;
  type: "object" | "array" | "string" | "boolean" | "number" | "integer";
  enum?: string[];
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
  minItems?: number;
  maxItems?: number;
  required?: string[];
  properties?: Record<string, Shape>;
  items?: Shape;
  prefixItems?: Shape[];
  many?: Shape; // of a list that may stand in place of one value
}

interface Tables {
  version: string;
  controllers: ControllerInfo[];
  defaultController: string;
  refusals: string[]; // of a scene by a controller: too short beacons, lease too short, too long, none possible
  palms: string[];
  drives: string[];
  signWords: string[]; // of the signs −1, 0, 1
  scenes: { name: string; meaning: string; scene: Scene }[];
  objects: { name: string; meaning: string; object: Json }[];
  keys: { name: string; unit: string; meaning: string }[];
  rules: Shape; // what a scene may hold
  // By table: an override of a key (KEY=VALUE: to this value) makes other keys obsolete.
  supersedes: Record<string, Record<string, string[]>>;
  kinds: Record<string, string>; // of values, in words
  problems: Record<string, string>; // of values, with names in braces for what is filled in
  longestValue: number; // characters of a value that a message quotes
  outcomes: string[];
  phases: [string, string][]; // of a task that differ in what ends it, with their meanings
  ends: { name: string; meaning: string; follows: string[] }[]; // by reason − 1, and by phase
  contactModes: string[];
  requiredContactModes: Record<string, string>; // by property, with the left palm shallow
  motionCodes: Record<string, string>[]; // by side, of a motion as the core numbers it
  motionMeanings: Record<string, string>; // of the symbols in contactModes
  contactModeSentences: Record<string, string>; // with names in braces for what is filled in
  bindings: Record<string, string>;
  bindingNames: string[];
  quantities: Record<string, { number: number; most: number; unit: string; name: string }>;
  table1: { signs: number[]; palms: string[]; moves: string[] }[];
  robot: {
    body: { near: number; far: number; low: number; top: number };
    wheels: { x: number; y: number; radius: number }[];
    shoulder: { x: number; y: number };
    pivotHeight: number;
  };
  // The phases of jobs on the floor by number: what each belongs to, and what a job missed that ends
  // there; `rank`: how early that is.
  lifting: Record<number, {
    name: string; meaning: string; stage: string; missed: string; rank: number; isRetry: boolean;
  }>;
  // What the analysis of such jobs finds for built-in scenes with some changes, and the keys on which
  // it does not depend, by scene.
  jobs: {
    free: Record<string, string[]>;
    heels: number[];
    checked: { scene: string; changes: Record<string, Json>; refusal: string; warnings: string[] }[];
  };
}

export const tables = data as unknown as Tables;

// A sentence of the package with its names in braces replaced.
export function filledIn(text: string, values: Record<string, string>): string {
  return text.replace(/\{(\w+)\}/g, (_, key: string) => values[key]!);
}

export const SIDES = ["left", "right"] as const;
export const SENDERS = [...SIDES, "station"] as const;

export function controllerInfo(name: string): ControllerInfo | undefined {
  return tables.controllers.find((c) => c.name === name);
}
