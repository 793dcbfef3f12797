// SPDX-License-Identifier: Apache-2.0
// The state that the view Mechanics takes apart, which the URL holds: palm angles [°] and contacts [mm].
import { computed, signal } from "@preact/signals";
import type { Statics } from "../shared/core";
import { MAP, REACH } from "../shared/contact_mode_map";
import { ofSide } from "../shared/scene_values";
import { core, extra, extraFlag, extraNumber, extras, scene, setExtra } from "../shared/state";
import { SIDES } from "../shared/tables";
import { type PalmMotions, type TouchedState, modesOf, touchedOnFloor, touchedOnPalms } from "../shared/touched";

export const DEGREE = Math.PI / 180;

const usualTheta = (side: 0 | 1) =>
  ofSide(scene.value, "palm", SIDES[side], side === 0 ? "shallow_deg" : "steep_deg");
export const theta = computed<[number, number]>(() => {
  const least = onFloor.value ? 0 : -Infinity; // the inner end of a palm is its lowest point
  return [Math.max(least, extraNumber("tl", usualTheta(0))), Math.max(least, extraNumber("tr", usualTheta(1)))];
});
export const contact = computed<[number, number]>(() => [extraNumber("pl", -20), extraNumber("pr", 0)]);
// The contacts under the pointer in a map of contact modes. The view shows their state until it leaves.
export const hovered = signal<[number, number] | null>(null);
export const half = (side: 0 | 1) => ofSide(scene.value, "palm", SIDES[side], "length_m") / 2;

// A pipe has one coordinate of its own: p of the right contact follows from that of the left one.
export const isPipe = computed(() => core.value?.facts(scene.value).isPipe ?? false);

function staticsAt([pLeft, pRight]: [number, number]): Statics | null {
  const machine = core.value;
  if (!machine) return null;
  if (isPipe.value) return null;
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

const tenth = (value: number) => Math.round(10 * value) / 10;
export const halfMm = (mm: number) => Math.round(2 * mm) / 2;

export function setTheta(side: 0 | 1, degrees: number): void {
  const value = tenth(Math.min(60, Math.max(onFloor.peek() ? 0 : -20, degrees)));
  setExtra(side === 0 ? "tl" : "tr", String(value), String(usualTheta(side)));
}

export function setContact(side: 0 | 1, mm: number): void {
  const most = 1000 * half(side);
  const value = halfMm(Math.min(most, Math.max(-most, mm)));
  setExtra(side === 0 ? "pl" : "pr", String(value), side === 0 ? "-20" : "0");
}

export const inMm = (value: number) => `${value.toFixed(1).replace("-", "−")} mm`;
export const inDegrees = (value: number) => `${value.toFixed(1).replace("-", "−")}°`;

// With a floor, the palms stand on it beside the object, drive inward and then rise; the URL holds how
// far [mm].
export const onFloor = computed(() => extraFlag("floor"));
export const driven = computed<[number, number]>(() => [extraNumber("dl", 0), extraNumber("dr", 0)]);
export const raised = computed(() => extraNumber("up", 0));
export const floorFriction = computed(() => extraNumber("mf", 0.3));

// Whether there is no right palm: a wall stands in its place.
export const isAlone = computed(() => onFloor.value && extraFlag("alone"));

export const MOST_DRIVEN = 300;
export const MOST_RAISED = 100;

export function setDriven(side: 0 | 1, mm: number): void {
  setExtra(side === 0 ? "dl" : "dr", String(tenth(Math.min(MOST_DRIVEN, Math.max(0, mm)))), "0");
}
export function setRaised(mm: number): void {
  setExtra("up", String(tenth(Math.min(MOST_RAISED, Math.max(0, mm)))), "0");
}

// Everything that touches in the state that the view shows; null: the object does not reach.
export const touched = computed<TouchedState | null>(() => {
  const machine = core.value;
  if (!machine) return null;
  const angles: [number, number] = [theta.value[0] * DEGREE, theta.value[1] * DEGREE];
  if (onFloor.value) {
    try {
      machine.check(scene.value);
    } catch (error) {
      return { problem: (error as Error).message, end: "", refusal: "", held: false, contacts: [], starts: [0, 0], places: new Float64Array() };
    }
    return touchedOnFloor(machine, angles, {
      driven: [driven.value[0] / 1000, driven.value[1] / 1000], raised: raised.value / 1000,
      friction: floorFriction.value, hasRight: !isAlone.value,
    });
  }
  const { f, contacts } = shown.value;
  if (f && !f.reaches) return null;
  machine.setScene(scene.value);
  return touchedOnPalms(machine, angles, [contacts[0] / 1000, contacts[1] / 1000]);
});

// Whether the nine contact modes of two contacts do not describe the state.
export const isGeneral = computed(() => onFloor.value || isPipe.value || (touched.value?.contacts.length ?? 0) > 2);

// The motions of the palms for which the view lists contact modes.
export const MOTIONS: { id: string; name: string; palms: PalmMotions; needsFloor?: boolean }[] = [
  { id: "closing", name: "closing", palms: [[0.01, 0, 0], [-0.01, 0, 0]] },
  { id: "opening", name: "opening", palms: [[-0.01, 0, 0], [0.01, 0, 0]] },
  { id: "left-in", name: "left drives in", palms: [[0.01, 0, 0], [0, 0, 0]], needsFloor: true },
  { id: "right-in", name: "right drives in", palms: [[0, 0, 0], [-0.01, 0, 0]], needsFloor: true },
  { id: "rising", name: "both rise", palms: [[0, 0.01, 0], [0, 0.01, 0]], needsFloor: true },
  { id: "left-steeper", name: "left steeper", palms: [[0, 0, DEGREE], [0, 0, 0]] },
  { id: "left-shallower", name: "left shallower", palms: [[0, 0, -DEGREE], [0, 0, 0]] },
  { id: "right-steeper", name: "right steeper", palms: [[0, 0, 0], [0, 0, DEGREE]] },
  { id: "right-shallower", name: "right shallower", palms: [[0, 0, 0], [0, 0, -DEGREE]] },
];

// Every motion with the contact modes that may occur, in a general state.
export const listed = computed(() => {
  const here = touched.value;
  const machine = core.value;
  if (!here || here.problem || !machine || !isGeneral.value) return [];
  return MOTIONS.filter((m) => (onFloor.value || !m.needsFloor) && !(isAlone.value && m.id.startsWith("right")))
    .map((m) => ({ ...m, modes: modesOf(machine, here.contacts, m.palms) }));
});
export const chosenMotion = computed(() =>
  listed.value.find((m) => m.id === extra("mo", "closing")) ?? listed.value[0] ?? null);
export const chosenMode = computed(() => {
  const modes = chosenMotion.value?.modes ?? [];
  return modes[Math.min(extraNumber("mk", 0), modes.length - 1)] ?? null;
});
