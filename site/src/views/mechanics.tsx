// SPDX-License-Identifier: Apache-2.0
// Mechanics: one state to take apart. Figures 3 to 6 of the paper, alive.
import { batch } from "@preact/signals";
import { analyzeLines, anglesWords, drawCom } from "./com_map";
import { Ends } from "./ends";
import { Handles } from "./handles";
import { ShapeFields, StateSliders } from "./mechanics_controls";
import { drawState, handles, mechanicsHeight } from "./mechanics_picture";
import { NineModes, Squeezes } from "./mechanics_report";
import { refused } from "./mechanics_shape";
import { contact, driven, floorFriction, found, inMm, isAlone, isGeneral, isPipe, onFloor, raised, shown, theta, touched } from "./mechanics_state";
import { TouchedReport } from "./touched_report";
import { ContactModeMap } from "./contact_mode_map_figure";
import { AtHome, SceneChoice, presentRun } from "./parts";
import { Canvas } from "../shared/canvas";
import { contactLines, floorLines, sceneWords } from "../shared/command";
import { decision, marginWords, contactModeName, contactModeWords } from "../shared/contact_mode_words";
import { type Overrides, tiltOf } from "../shared/scene_values";
import { base, extras, overrides, recorded, scene, setExtra } from "../shared/state";
import { tables } from "../shared/tables";

// Scenes and states in which further kinds of contact occur.
const EXAMPLES: { id: string; name: string; base: string; overrides: Overrides; extras: Record<string, string> }[] = [
  {
    id: "rounded-edge", name: "Rounded edge", base: "paper", overrides: { "object.edge_radius_m": 0.02 },
    extras: { tl: "0", pl: "0", pr: "2.63305" },
  },
  {
    id: "from-the-floor", name: "From the floor", base: "plate", overrides: { "object.edge_radius_m": 0.003 },
    extras: { floor: "1", tl: "15", tr: "45", dl: "14", dr: "10" },
  },
  {
    id: "one-palm-and-a-wall", name: "One palm and a wall", base: "plate",
    overrides: {
      "object.box_m": [0.12, 0.12], "object.com_m": [0.06, 0.06], "object.edge_radius_m": 0.003,
      "floor.walls": [{ at_m: 0.065, height_m: 0.2 }],
    },
    extras: { floor: "1", alone: "1", tl: "15", dl: "50" },
  },
];

function Examples() {
  return (
    <div class="row" role="group" aria-label="examples">
      {EXAMPLES.map((one) => (
        <button type="button" id={one.id} onClick={() => batch(() => {
          base.value = one.base;
          overrides.value = one.overrides;
          extras.value = one.extras;
        })}>
          {one.name}
        </button>
      ))}
    </div>
  );
}

// Over the picture: why the last change was cut, else what is wrong with the state.
function Status() {
  const f = onFloor.value ? null : found.value;
  const here = touched.value;
  const reason = (at: number) => `${tables.ends[at]!.name}: ${tables.ends[at]!.meaning}`;
  const words = refused.value || here?.problem || here?.refusal
    || (here?.end && `the palms stop here: ${reason(tables.ends.findIndex((end) => end.name === here.end))}`)
    || (f && !f.reaches && "The object does not reach from palm to palm.")
    || (f && f.reason > 0 && !isGeneral.value && reason(f.reason - 1));
  return words ? <p class="status refusal" role="status">{words}</p> : null;
}

export function MechanicsView() {
  const f = onFloor.value ? null : found.value;
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
          Drag the centre of mass, a corner, a palm, a contact, a cone, or a blue dot to shape edges and palms.
          The squeeze H, with which the palms press the object inward, decides which contact slides on
          closing (the robots drive the contact points together) and on opening (apart).
        </p>
      </header>
      <div class="choices">
        <SceneChoice />
        <button type="button" id="reset" onClick={() => {
          overrides.value = {};
          for (const name of ["tl", "tr", "pl", "pr", "floor", "alone", "dl", "dr", "up", "mf", "mo", "mk"]) setExtra(name, "", "");
        }}>
          reset
        </button>
        <Examples />
      </div>
      <div class="state-and-words">
      <section class="panel" aria-label="one state">
        <div class="stage over">
          <Canvas id="state-picture" height={mechanicsHeight} draw={drawState}
            label="object, palms, friction cones and line of gravity of one state" />
          <Handles handles={handles()} />
          <Status />
        </div>
        <StateSliders />
        <ShapeFields />
      </section>
      {isGeneral.value && (
        <section class="state">
          <TouchedReport />
        </section>
      )}
      {f && f.reaches && !isGeneral.value && (
        <section class="state">
          <p class="note" id="shown-state">
            State {shown.value.isUnderPointer ? "under the pointer" : "at the dot of the maps below"}:{" "}
            p<sub>L</sub> = {inMm(shown.value.contacts[0])}, p<sub>R</sub> = {inMm(shown.value.contacts[1])}
          </p>
          <h2>Closing: {contactModeName(f.closing)}</h2>
          <p id="closing-words">{contactModeWords(f.closing)} {decision(f, true)}</p>
          <h2>Opening: {contactModeName(f.opening)}</h2>
          <p id="opening-words">{contactModeWords(f.opening)} {decision(f, false)}</p>
          <p class="note" id="margin-words">{marginWords(f.margin)}</p>
          <Squeezes f={f} />
        </section>
      )}
      </div>
      {f && f.reaches && (
        <>
          <section>
            {isGeneral.value && <p class="note">If only the two contact vertices touched the palms:</p>}
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
              <ContactModeMap closing />
              <ContactModeMap closing={false} />
            </div>
          </section>
          <section>
            <h2>Every centre of mass</h2>
            <p class="note">
              The map shows where the centre of mass may lie so that both properties hold with the
              contacts anywhere on the palms, whichever palm is the shallow
              one. <span id="com-angles">{anglesWords()}</span> If you turn a palm, the map takes the
              smaller and the larger of the two angles above. Property
              1: {tables.contactModeSentences.property_1} Property 2: {tables.contactModeSentences.property_2} This map
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
      <Ends reason={0} />
      <AtHome
        lines={onFloor.value
          ? floorLines(base.value, overrides.value, {
            palms: theta.value, driven: driven.value, raised: raised.value, friction: floorFriction.value,
            isAlone: isAlone.value,
          })
          : isPipe.value ? contactLines(touched.value?.contacts ?? [], Math.tan(tiltOf(scene.value)))
          : [`palmbots contact-modes ${words} ${numbers}`, ...analyzeLines(words)]}
        runs={presentRun()}
        note={recorded.value && "The last command simulates a carry of the object in this view."}
      />
    </>
  );
}
