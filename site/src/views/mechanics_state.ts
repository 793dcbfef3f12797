// SPDX-License-Identifier: Apache-2.0
// The state that the view Mechanics takes apart, which the URL holds: palm angles [°] and contacts [mm].
import { computed, signal } from "@preact/signals";
import type { Statics } from "../shared/core";
import { MAP, REACH } from "../shared/contact_mode_map";
import { ofSide } from "../shared/scene_values";
import { core, extraNumber, extras, scene, setExtra } from "../shared/state";
import { SIDES } from "../shared/tables";

export const DEGREE = Math.PI / 180;

const usualTheta = (side: 0 | 1) =>
  ofSide(scene.value, "palm", SIDES[side], side === 0 ? "shallow_deg" : "steep_deg");
export const theta = computed<[number, number]>(() => [
  extraNumber("tl", usualTheta(0)), extraNumber("tr", usualTheta(1)),
]);
export const contact = computed<[number, number]>(() => [extraNumber("pl", -20), extraNumber("pr", 0)]);
// The contacts under the pointer in a map of contact modes. The view shows their state until it leaves.
export const hovered = signal<[number, number] | null>(null);
export const half = (side: 0 | 1) => ofSide(scene.value, "palm", SIDES[side], "length_m") / 2;

function staticsAt([pLeft, pRight]: [number, number]): Statics | null {
  const machine = core.value;
  if (!machine) return null;
  machine.setScene(scene.value);
  return machine.statics(
    [theta.value[0] * DEGREE, theta.value[1] * DEGREE], [pLeft / 1000, pRight / 1000],
  );
}

// The state that the view shows: where the pointer is, if the object reaches from palm to palm there.
export const shown = computed(() => {
  const under = hovered.value && staticsAt(hovered.value);
  return under?.reaches
    ? { contacts: hovered.value!, f: under, isUnderPointer: true }
    : { contacts: contact.value, f: staticsAt(contact.value), isUnderPointer: false };
});
export const found = computed(() => shown.value.f);

// The shallow and the steep angle [°] of either palm in the map of COMs: those of the scene until the
// visitor turns a palm, then the smaller and the larger of the two angles of the state.
export const angles = computed<[[number, number], [number, number]]>(() => {
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
    return machine.contactModeMap([theta.value[0] * DEGREE, theta.value[1] * DEGREE], closing, MAP, REACH);
  });
export const maps = { closing: map(true), opening: map(false) };

export const halfMm = (mm: number) => Math.round(2 * mm) / 2;

export function setTheta(side: 0 | 1, degrees: number): void {
  const value = Math.round(10 * Math.min(60, Math.max(-20, degrees))) / 10;
  setExtra(side === 0 ? "tl" : "tr", String(value), String(usualTheta(side)));
}

export function setContact(side: 0 | 1, mm: number): void {
  const most = 1000 * half(side);
  const value = halfMm(Math.min(most, Math.max(-most, mm)));
  setExtra(side === 0 ? "pl" : "pr", String(value), side === 0 ? "-20" : "0");
}

export const inMm = (value: number) => `${value.toFixed(1).replace("-", "−")} mm`;
export const inDegrees = (value: number) => `${value.toFixed(1).replace("-", "−")}°`;
