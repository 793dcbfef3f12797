// SPDX-License-Identifier: Apache-2.0
// Stories: eight short scenes with one thing to do in each.
import type { ComponentChildren } from "preact";
import { useEffect } from "preact/hooks";
import { AtHome, presentRun } from "./parts";
import { PlayerBar, usePlayerKeys } from "./player_bar";
import { Charts } from "./sequence";
import { Stage } from "./stage";
import { outcomeText } from "./carry";
import type { Recorded } from "../shared/core";
import type { Overrides } from "../shared/scene_values";
import {
  base, controller, core, extraFlag, extraNumber, forks, overrides, player, recorded, scene, seed, setExtra,
  setExtraFlag,
} from "../shared/state";
import { decision } from "../shared/mode_words";
import { get } from "../shared/scene_values";
import { controllerInfo } from "../shared/tables";
import { reducedMotion } from "../shared/theme";

interface Start {
  scene?: string;
  controller?: string;
  seed?: number;
  set?: Overrides;
  cones?: boolean;
  at?: number;
}

interface Story {
  title: string;
  start: Start;
  text: string;
  task: string; // the one thing to do
  actions: { label: string; act: Start }[];
  after: string; // what the action shows
  hasSqueezes?: boolean; // `after` is about the squeezes that decide which contact slides
  question?: { ask: string; answers: string[]; right: number };
}

const QUIET = { "robot.noise_m_s": 0 };
// The left robot is silent while it should answer.
const SILENT_LEFT = {
  ...QUIET, "bumps.script": [{ robot: "right", at_s: 0.4, shift_m: 0.011 }], "task.distance_m": 0.9,
  "radio.outages": [{ sender: "left", start_s: 0.5, end_s: 1 }],
};
const REBOOT = {
  ...QUIET, "task.distance_m": 0.5,
  "bumps.script": [
    { robot: "left", at_s: 0.4, shift_m: 0.04 }, { robot: "right", at_s: 0.6, shift_m: -0.02 },
  ],
  "faults.script": [{ kind: "reboot", robot: "right", at_s: 0.8, duration_s: 0.02 }],
};
const FAST_RIGHT = { ...QUIET, "robot.right.bias_m_s": 0.008 };

export const STORIES: Story[] = [
  {
    title: "The paper's Figure 8",
    start: { scene: "figure8" },
    text:
      "The carry has seven bumps in six and a half seconds, as in the paper. If its contact has p < 0, a robot corrects it alone: case (d). If p > 0, the robot asks its partner to tilt up, case (a), and the partner assists, case (c).",
    task: "Stop at 0.7 s and look at the arrows: TiltUp, Ack, TiltDown.",
    actions: [{ label: "go to 0.7 s", act: { scene: "figure8", at: 0.7 } }],
    after: "The left palm is shallow, so opening slides only the right contact. The right robot drives away until its contact is back near the pivot.",
  },
  {
    title: "A lost Ack, and leases",
    start: { set: SILENT_LEFT },
    text:
      "The radio of the left robot fails for half a second, and the Ack is lost. The paper's algorithm hangs: the right robot waits for the Ack and the left one for TiltDown, both forever. The box arrives only because nothing else disturbs it.",
    task: "Give the pair a controller with leases, on the same radio.",
    actions: [{ label: "resilient", act: { controller: "resilient", set: SILENT_LEFT } }],
    after: "With the controller resilient, a robot repeats its message in periodic packets, called beacons. A beacon is valid for a limited time, its lease. The receiver acts on a beacon only until its lease ends. The right robot stops while it hears nothing. It continues when it hears its partner, so no robot waits forever.",
  },
  {
    title: "Why the palms tilt",
    start: { cones: true, controller: "none", set: FAST_RIGHT, at: 0.01 },
    text:
      "The right robot drives 8 mm/s too fast. With both palms steep, the object decides which contact slides, and no robot corrects it. Watch it slide off.",
    task: "Give the pair a controller.",
    actions: [
      { label: "distributed", act: { cones: true, controller: "distributed", set: FAST_RIGHT } },
    ],
    after: "The squeeze H is the force with which the palms press the object inward, in weights of the object. Driving together raises H until the first of the two friction cones ends. That contact slides, and the cone of a shallow palm ends first:",
    hasSqueezes: true,
  },
  {
    title: "Two robots without a radio",
    start: { controller: "silent", seed: 3 },
    text:
      "With the controller silent, the robots send nothing. Each robot makes corrections according to the sign of its own contact. The angles of the two palms decide which contact slides.",
    task: "Double the noise.",
    actions: [{ label: "noise 20 mm/s", act: { controller: "silent", seed: 3, set: { "robot.noise_m_s": 0.02 } } }],
    after: "The contacts move further from p = 0, but the robots still correct them without any message. The view Compare counts how often they drop the box.",
  },
  {
    title: "A reboot",
    start: { set: REBOOT },
    text:
      "The right robot reboots for 20 ms while it assists, and forgets that it was assisting. Now one robot drives away and the other closer, forever, and the contacts no longer move.",
    task: "Run the same reboot with the controller resilient.",
    actions: [{ label: "resilient", act: { controller: "resilient", set: REBOOT } }],
    after: "The beacons of a robot show that it has rebooted. Its partner gives up the old correction, and both robots start again.",
  },
  {
    title: "A slope",
    start: { set: { "task.slope_deg": 4 } },
    text:
      "On a slope, gravity pulls the box towards one robot. The robots rely on two properties: closing slides only the shallow contact, and opening slides only the steep one. At the paper's angles, both properties hold up to 4.5°.",
    task: "Make it 8°.",
    actions: [{ label: "8°", act: { set: { "task.slope_deg": 8 } } }],
    after: "Beyond this limit, the wrong contact may slide, and corrections move a contact in the wrong direction. The view Design shows which angles tolerate a steeper floor.",
  },
  {
    title: "The edge of the feasible region",
    start: { cones: true, set: { "object.com_m": [0.141, 0.04] } },
    text:
      "The box is 250 mm wide. At the paper's angles, closing slides only the shallow contact, and opening only the steep one, if the centre of mass lies between 108.5 and 141.5 mm. This is true for any position of the contacts on the palms. Here, the centre of mass lies at 141 mm.",
    task: "Move the centre of mass to 160 mm.",
    actions: [
      { label: "160 mm", act: { cones: true, set: { "object.com_m": [0.16, 0.04] } } },
    ],
    after: "More of the weight now presses on the right palm. When the right robot tilts this palm and drives closer, the left contact may slide instead, although the left palm is steep. The view Mechanics draws the permitted region on the box.",
  },
  {
    title: "Predict first, then watch",
    start: {
      set: { ...QUIET, "bumps.script": [{ robot: "left", at_s: 0.5, shift_m: -0.03 }], "task.distance_m": 0.3 },
      at: 0.6,
    },
    text: "A bump has moved the left contact 30 mm inward, so p_L < 0. The right contact is at p_R = 0.",
    task: "What will the robots do?",
    actions: [],
    after: "",
    question: {
      ask: "What will the robots do?",
      answers: [
        "The left robot tilts its own palm up and drives closer.",
        "The left robot asks the right one to tilt up, then drives away.",
        "The right robot tilts up and drives closer.",
      ],
      right: 0,
    },
  },
];

const isDone = () => extraFlag("done");

function setDone(done: boolean): void {
  setExtraFlag("done", done);
}

// The answer that the visitor has chosen, from 1.
const answered = () => extraNumber("answer", 0);

function begin(start: Start): void {
  base.value = start.scene ?? "paper";
  controller.value = start.controller ?? "distributed";
  seed.value = start.seed ?? 0;
  overrides.value = start.set ?? {};
  forks.value = [];
  setExtraFlag("cones", start.cones ?? false);
  player.seek(start.at ?? 0);
}

function run(start: Start): void {
  const still = start.at !== undefined && start.at > 0.05;
  if (still || reducedMotion.matches) player.pause();
  else player.play();
}

// Whether the state is one that the present story has made: then it stays after a reload.
function isOfStory(story: Story): boolean {
  const same = (start: Start) =>
    base.value === (start.scene ?? "paper") &&
    controller.value === (start.controller ?? "distributed") &&
    JSON.stringify(overrides.value) === JSON.stringify(start.set ?? {});
  return same(story.start) || story.actions.some(({ act }) => same(act));
}

export function StoriesView() {
  const place = Math.min(STORIES.length, Math.max(1, Math.floor(extraNumber("story", 1))));
  const story = STORIES[place - 1]!;
  useEffect(() => {
    if (!isOfStory(story) || (player.time.peek() === 0 && !isDone())) {
      setDone(false);
      begin(story.start);
      run(story.start);
    }
  }, [place]);
  usePlayerKeys();
  const carried = recorded.value;
  const info = controllerInfo(controller.value);
  return (
    <>
      <ol class="chapters" aria-label="stories">
        {STORIES.map((item, k) => (
          <li>
            <button type="button" aria-current={k + 1 === place ? "step" : undefined}
              onClick={() => {
                for (const name of ["done", "answer", "m"]) setExtra(name, "", "");
                begin(item.start);
                setExtra("story", String(k + 1), "1");
                run(item.start);
              }}>
              {item.title}
            </button>
          </li>
        ))}
      </ol>
      <header class="lead">
        <h1>{story.title}</h1>
        <p>{story.text}</p>
      </header>
      <div class="task">
        {story.question ? <Question story={story} /> : (
          <>
            <strong>{story.task}</strong>
            {story.actions.map(({ label, act }) => (
              <button type="button" class="act" onClick={() => {
                begin(act);
                setDone(true);
                run(act);
              }}>
                {label}
              </button>
            ))}
            {isDone() && (
              <button type="button" class="plain" onClick={() => {
                begin(story.start);
                setDone(false);
                run(story.start);
              }}>
                back to the beginning
              </button>
            )}
          </>
        )}
      </div>
      <section class="panel beside" aria-label="the carry">
        <div class="scene">
          <Stage run={carried} name={controller.value} id="stage" draggable periodic={info?.isPeriodic} />
          <Ending />
          <PlayerBar />
          {isDone() && story.after && (
            <div class="after" role="status">
              <p>{story.after}</p>
              {story.hasSqueezes && <Squeezes />}
            </div>
          )}
        </div>
        <Charts />
      </section>
      <AtHome runs={presentRun()} />
      {import.meta.env.MODE !== "file" && (
        <p class="note">For a class: <a href="./lesson.html">a sheet with tasks for 45 minutes</a>, to print.</p>
      )}
    </>
  );
}

// What decides which contact slides when the robots drive together.
function Squeezes() {
  const machine = core.value;
  if (!machine) return null;
  machine.setScene(scene.value);
  const [shallow, steep] = ["palm.shallow_deg", "palm.steep_deg"].map(
    (key) => (Number(get(scene.value, key)) * Math.PI) / 180,
  ) as [number, number];
  const words = (left: number, p: number) => decision(machine.statics([left, steep], [p, 0]), true);
  return (
    <ul id="squeezes">
      <li>Both palms steep, both contacts at p = 0: {words(steep, 0)}</li>
      <li>Left palm shallow, p_L = −20 mm, as in case (d): {words(shallow, -0.02)}</li>
    </ul>
  );
}

const ENDLESS_S = 2; // a correction that lasts that long, and to the end of the carry

// Which robots still make a correction that began long ago.
function endless(carried: Recorded): string[] {
  const still = carried.corrections.filter(
    (c) => c.end >= carried.time && c.end - c.start > ENDLESS_S,
  );
  return still.length > 0 ? ["the last correction has not ended"] : [];
}

const counted = (number: number, what: string) =>
  `${number === 0 ? "no" : number} ${what}${number === 1 ? "" : "s"}`;

function Ending(): ComponentChildren {
  const carried = recorded.value;
  if (!carried || player.time.value < carried.time) return <p class="status">&nbsp;</p>;
  const wrong = carried.warnings.length > 0 ? carried.warnings : endless(carried);
  return (
    <p class="status ending">
      <strong class={carried.outcome === 1 && wrong.length === 0 ? "good" : "bad"}>
        {[outcomeText(carried), ...wrong].join("; ")}
      </strong>{" "}
      <span class="note" id="tally">
        {counted(carried.correctionCount, "correction")}, {counted(carried.sent, "message")}, contacts
        up to {(1000 * Math.max(...carried.peak)).toFixed(0)} mm from p = 0
      </span>
    </p>
  );
}

function Question(props: { story: Story }) {
  const { ask, answers, right } = props.story.question!;
  return (
    <fieldset>
      <legend>{ask}</legend>
      {answers.map((words, k) => (
        <label class="check">
          <input type="radio" name="prediction" checked={answered() === k + 1}
            onChange={() => {
              setExtra("answer", String(k + 1), "");
              player.seek(0.6);
              if (!reducedMotion.matches) player.play();
            }} />
          {words}
        </label>
      ))}
      {answered() > 0 && (
        <p class="after" role="status">
          {answered() === right + 1 ? "Yes. " : "Look again. "}
          A robot corrects a contact with p &lt; 0 alone. With its own palm shallow and its partner's palm
          steep, closing makes only its own contact slide, and it slides up.
        </p>
      )}
    </fieldset>
  );
}

