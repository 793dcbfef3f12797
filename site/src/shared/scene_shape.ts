// SPDX-License-Identifier: Apache-2.0
// Whether the values of a scene have the right type and size. Limits and words are those of the fields
// that check a scene in the package (src/palmbots/scene/fields.py).
import type { TomlDate } from "smol-toml";
import { type Json, type Shape, filledIn, tables } from "./tables";
import { tomlValue } from "./toml";

// A value as a message shows it.
function show(value: unknown): string {
  if (value === null || value === undefined) return "null";
  const written = value instanceof Date
    ? value.toISOString().replace(".000", "").replace("Z", "+00:00")
    : tomlValue(value as Json);
  const text = written.replaceAll("\n", " ");
  const most = tables.longestValue;
  return text.length > most ? `${text.slice(0, most - 1)}…` : text;
}

// Refuses a scene with one line: where, what, and what is allowed.
export function refuse(key: string, value: unknown, problem: string, allowed: string): never {
  throw new Error(`${key}: ${show(value)} ${problem}; allowed: ${allowed}`);
}

function kindOf(value: unknown): string {
  if (value === null || value === undefined) return "empty";
  if (Array.isArray(value)) return "list";
  if (value instanceof Date) return (value as TomlDate).isTime?.() ? "time" : "date";
  const names: Record<string, string> = {
    boolean: "boolean", string: "string", bigint: "whole", number: "number",
  };
  return names[typeof value] ?? "table";
}

function refuseKind(key: string, value: unknown, wanted: string, shape: Shape): never {
  const { kinds, problems } = tables;
  const words = { kind: kinds[kindOf(value)]!, wanted: kinds[wanted]! };
  refuse(key, value, filledIn(problems.kind!, words), shape.allowed);
}

function checkNumber(key: string, given: unknown, shape: Shape, hasBigints: boolean): void {
  const isNumber = typeof given === "number" || typeof given === "bigint";
  const isWhole = typeof given === "bigint" || (!hasBigints && Number.isInteger(given));
  const wanted = shape.type === "integer" ? "whole" : "number";
  if (wanted === "whole" ? !isWhole : !isNumber) refuseKind(key, given, wanted, shape);
  const value = Number(given);
  if (!Number.isFinite(value)) refuse(key, given, tables.problems.infinite!, shape.allowed);
  const { minimum, maximum, exclusiveMinimum, exclusiveMaximum } = shape;
  if (value < (minimum ?? value) || value <= (exclusiveMinimum ?? -Infinity)) {
    refuse(key, given, tables.problems.small!, shape.allowed);
  }
  if (value > (maximum ?? value) || value >= (exclusiveMaximum ?? Infinity)) {
    refuse(key, given, tables.problems.large!, shape.allowed);
  }
}

function checkTable(key: string, value: object, shape: Shape, hasBigints: boolean): void {
  const properties = shape.properties!;
  for (const [name, entry] of Object.entries(value)) {
    const inner = key ? `${key}.${name}` : name;
    if (!Object.hasOwn(properties, name)) {
      refuse(inner, entry, tables.problems.key!, Object.keys(properties).join(", "));
    }
    checkShape(inner, entry, properties[name]!, hasBigints);
  }
  for (const name of shape.required ?? []) {
    if (!Object.hasOwn(value, name)) {
      const missing = filledIn(tables.problems.missing!, { keys: shape.required!.join(", ") });
      throw new Error(`${key}.${name}: ${missing}`);
    }
  }
}

// Refuses a value whose type, size or keys are not those of `shape`. With `hasBigints`, the whole
// numbers are bigints, as in a scene file, where 1.0 is no whole number.
export function checkShape(
  key: string, value: unknown, shape: Shape = tables.rules, hasBigints = false,
): void {
  if (shape.many && Array.isArray(value)) return checkShape(key, value, shape.many, hasBigints);
  switch (shape.type) {
    case "object":
      if (kindOf(value) !== "table") refuse(key, value, tables.problems.table!, shape.allowed);
      return checkTable(key, value as object, shape, hasBigints);
    case "array": {
      if (!Array.isArray(value)) refuseKind(key, value, "list", shape);
      const items = value as unknown[];
      const count = items.length;
      if (count < (shape.minItems ?? 0) || count > (shape.maxItems ?? Infinity)) {
        const words = tables.problems[count === 1 ? "item" : "items"]!;
        refuse(key, value, filledIn(words, { count: String(count) }), shape.allowed);
      }
      items.forEach((item, k) => {
        checkShape(`${key}[${k}]`, item, (shape.prefixItems?.[k] ?? shape.items)!, hasBigints);
      });
      return;
    }
    case "boolean":
      if (typeof value !== "boolean") refuseKind(key, value, "boolean", shape);
      return;
    case "string":
      if (shape.enum ? !shape.enum.includes(value as string) : typeof value !== "string") {
        refuse(key, value, tables.problems[shape.enum ? "unknown" : "string"]!, shape.allowed);
      }
      return;
    default:
      checkNumber(key, value, shape, hasBigints);
  }
}
