// SPDX-License-Identifier: Apache-2.0
// Whether the values of a scene have the right type and size: the shape of every table, from the
// fields that check a scene in the package.
import { type Json, type Shape, tables } from "./tables";
import { tomlValue } from "./toml";

const LONGEST_VALUE = 80;

// A value as a message shows it.
export function show(value: unknown): string {
  if (value === null || value === undefined) return "null";
  const text = (value instanceof Date ? value.toISOString() : tomlValue(value as Json)).replaceAll("\n", " ");
  return text.length > LONGEST_VALUE ? `${text.slice(0, LONGEST_VALUE - 1)}…` : text;
}

// Refuses a scene with one line: where, what, and what is allowed.
export function refuse(key: string, value: unknown, problem: string, allowed: string): never {
  throw new Error(`${key}: ${show(value)} ${problem}; allowed: ${allowed}`);
}

function kindOf(value: unknown): string {
  if (value === null || value === undefined) return "empty";
  if (Array.isArray(value)) return "a list";
  if (value instanceof Date) return "a date";
  const words: Record<string, string> = {
    boolean: "a boolean", string: "a string", bigint: "a whole number", number: "a number",
  };
  return words[typeof value] ?? "a table";
}

const isTable = (value: unknown) => kindOf(value) === "a table";

function unitOf(key: string): string {
  const common = key.replace(/^(palm|robot|radio)\.(left|right|station)\./, "$1.");
  const unit = tables.keys.find((k) => k.name === common)?.unit;
  return unit && unit !== "–" ? ` in ${unit}` : "";
}

function limitsOf(shape: Shape): string {
  const { minimum, maximum, exclusiveMinimum, exclusiveMaximum } = shape;
  if (minimum !== undefined && maximum !== undefined) return `from ${minimum} to ${maximum}`;
  const words = [
    exclusiveMinimum !== undefined && `more than ${exclusiveMinimum}`,
    minimum !== undefined && `at least ${minimum}`,
    maximum !== undefined && `at most ${maximum}`,
    exclusiveMaximum !== undefined && `less than ${exclusiveMaximum}`,
  ];
  return words.filter(Boolean).join(" and ");
}

function allowed(key: string, shape: Shape): string {
  if (shape.enum) return shape.enum.map((word) => `'${word}'`).join(", ").replace(/, ([^,]*)$/, " or $1");
  switch (shape.type) {
    case "object": return `a table with the keys ${Object.keys(shape.properties!).join(", ")}`;
    case "array": {
      const [least, most] = [shape.minItems ?? 0, shape.maxItems];
      if (shape.prefixItems) return `a list of ${most} numbers`;
      return `a list of ${least > 0 ? `${least} to ${most}` : `at most ${most}`} items`;
    }
    case "boolean": return "true or false";
    case "integer": return `a whole number, ${limitsOf(shape)}`;
    case "number": return `a number${unitOf(key)}, ${limitsOf(shape)}`;
    default: return "a string";
  }
}

function checkNumber(key: string, given: unknown, shape: Shape, hasBigints: boolean): void {
  const isWhole = typeof given === "bigint" || (!hasBigints && Number.isInteger(given));
  if (typeof given !== "number" && typeof given !== "bigint") {
    const wanted = shape.type === "integer" ? "a whole number" : "a number";
    refuse(key, given, `is ${kindOf(given)}, not ${wanted}`, allowed(key, shape));
  }
  const value = Number(given);
  if (!Number.isFinite(value)) refuse(key, given, "is not finite", allowed(key, shape));
  if (shape.type === "integer" && !isWhole) {
    refuse(key, given, "is a number, not a whole number", allowed(key, shape));
  }
  const { minimum, maximum, exclusiveMinimum, exclusiveMaximum } = shape;
  if (value < (minimum ?? value) || value <= (exclusiveMinimum ?? -Infinity)) {
    refuse(key, given, "is too small", allowed(key, shape));
  }
  if (value > (maximum ?? value) || value >= (exclusiveMaximum ?? Infinity)) {
    refuse(key, given, "is too large", allowed(key, shape));
  }
}

function checkTable(key: string, value: object, shape: Shape, hasBigints: boolean): void {
  const properties = shape.properties!;
  for (const [name, entry] of Object.entries(value)) {
    const inner = key ? `${key}.${name}` : name;
    if (!Object.hasOwn(properties, name)) {
      refuse(inner, entry, "is the value of an unknown key", Object.keys(properties).join(", "));
    }
    checkShape(inner, entry, properties[name]!, hasBigints);
  }
  for (const name of shape.required ?? []) {
    if (!Object.hasOwn(value, name)) {
      throw new Error(`${key}.${name}: is missing; required there: ${shape.required!.join(", ")}`);
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
      if (!isTable(value)) refuse(key, value, "is not a table", allowed(key, shape));
      return checkTable(key, value as object, shape, hasBigints);
    case "array": {
      if (!Array.isArray(value)) {
        refuse(key, value, `is ${kindOf(value)}, not a list`, allowed(key, shape));
      }
      const items = value as unknown[];
      if (items.length < (shape.minItems ?? 0) || items.length > (shape.maxItems ?? Infinity)) {
        const plural = items.length === 1 ? "" : "s";
        refuse(key, value, `has ${items.length} item${plural}`, allowed(key, shape));
      }
      items.forEach((item, k) => {
        checkShape(`${key}[${k}]`, item, (shape.prefixItems?.[k] ?? shape.items)!, hasBigints);
      });
      return;
    }
    case "boolean":
      if (typeof value !== "boolean") {
        refuse(key, value, `is ${kindOf(value)}, not a boolean`, allowed(key, shape));
      }
      return;
    case "string":
      if (typeof value !== "string") {
        refuse(key, value, `is ${kindOf(value)}, not a string`, allowed(key, shape));
      }
      if (shape.enum && !shape.enum.includes(value as string)) {
        refuse(key, value, "is not known", allowed(key, shape));
      }
      return;
    default:
      checkNumber(key, value, shape, hasBigints);
  }
}
