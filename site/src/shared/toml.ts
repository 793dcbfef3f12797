// SPDX-License-Identifier: Apache-2.0
// TOML: values as --set takes them, and scenes as files.
import type { Overrides } from "./scene_values";
import type { Json } from "./tables";

export function tomlValue(value: Json): string {
  if (Array.isArray(value)) return `[${value.map(tomlValue).join(", ")}]`;
  if (typeof value === "object") {
    const entries = Object.entries(value).map(([key, entry]) => `${key} = ${tomlValue(entry)}`);
    return `{ ${entries.join(", ")} }`;
  }
  if (typeof value === "string") return JSON.stringify(value);
  return String(value);
}

// A scene file with only what differs from the scene `paper`.
export function sceneFile(overrides: Overrides): string {
  const sections = new Map<string, string[]>();
  for (const [key, value] of Object.entries(overrides)) {
    const cut = key.lastIndexOf(".");
    const section = key.slice(0, Math.max(cut, 0));
    const line = `${key.slice(cut + 1)} = ${tomlValue(value)}`;
    sections.set(section, [...(sections.get(section) ?? []), line]);
  }
  const order = [...sections.keys()].sort((a, b) => Number(a !== "") - Number(b !== ""));
  return order
    .map((name) => (name ? `[${name}]\n` : "") + sections.get(name)!.join("\n"))
    .join("\n\n")
    .concat("\n");
}
