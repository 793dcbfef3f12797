// SPDX-License-Identifier: Apache-2.0
// The nine stories: what each shows, asks and explains. tests/site/test_stories.py pins how each part ends.
import type { Overrides } from "../shared/scene_values";

export interface Part {
  scene?: string;
  controller?: string;
  seed?: number;
  set?: Overrides;
  cones?: boolean;
  at?: number; // where it begins [s]
  until?: number; // where it ends, if before the end of the carry [s]
  speed?: number; // of the player
  task?: string; // the one thing to do that begins it, and the button for it
  label?: string;
  question?: { ask: string; answers: string[]; right: number };
  after: string; // the explanation, shown once the part has been watched
  hasSqueezes?: boolean; // `after` is about the squeezes that decide which contact slides
}

export interface Story {
  title: string;
  text: string; // reveals no answer to the questions of its parts
  parts: Part[];
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
const LIFT = { scene: "lift", controller: "shared-sign" };
const OFF_WHILE_RAISING = {
  "faults.script": [{ kind: "reboot", robot: "left", at_s: 9.5, duration_s: 5 }],
};
const ARRIVES = ["The box arrives.", "The box falls."];

export const STORIES: Story[] = [
  {
    title: "The paper's Figure 8",
    text:
      "Seven bumps shift the contacts, as in the paper. A robot senses only whether its own contact is outward on its palm (p > 0), in the middle (p = 0), or inward (p < 0).",
    parts: [
      {
        scene: "figure8", at: 0.4, until: 0.7,
        question: {
          ask: "The right contact is outward. Which palm must become flatter?",
          answers: ["Its own, the right one.", "The partner's, the left one."],
          right: 1,
        },
        after: "The right robot asks the left one to tilt up, case (a), and the left one assists, case (c): see TiltUp and Ack. With the left palm shallow, only the right contact slides when the robots drive apart: the right one drives away until its contact is near the middle.",
      },
      {
        scene: "figure8", at: 0.7, task: "See the other six bumps.", label: "go on",
        after: "If its contact has p < 0, a robot corrects it alone: case (d). If p > 0, it asks its partner, case (a). If both have p > 0, both ask: case (b).",
      },
    ],
  },
  {
    title: "A lost Ack, and leases",
    text:
      "At 0.4 s, the right robot asks for help with the message TiltUp. Then the radio of the left robot fails for half a second, and its answer, the Ack, is lost.",
    parts: [
      {
        set: SILENT_LEFT, speed: 2,
        question: {
          ask: "What will the right robot do?",
          answers: ["It asks again.", "It corrects without help.", "It waits for the Ack, to the end."],
          right: 2,
        },
        after: "The paper's algorithm hangs: the right robot waits for the Ack forever, and the left one for TiltDown. The box arrives only because nothing else disturbs it.",
      },
      {
        controller: "resilient", set: SILENT_LEFT, speed: 2,
        task: "Give the pair a controller with leases, on the same radio.", label: "resilient",
        after: "With the controller resilient, a robot repeats its message in periodic packets, called beacons. A beacon is valid for a limited time, its lease. The receiver acts on a beacon only until its lease ends. The right robot stops while it hears nothing. It continues when it hears its partner again, so no robot waits forever.",
      },
    ],
  },
  {
    title: "Why the palms tilt",
    text:
      "The right robot drives 8 mm/s too fast. First, no robot corrects anything, and both palms stay steep. Then a controller tilts them.",
    parts: [
      {
        cones: true, controller: "none", set: FAST_RIGHT, speed: 2,
        question: { ask: "What will happen to the box?", answers: ARRIVES, right: 1 },
        after: "With both palms steep, the robots do not choose which contact slides, and they correct nothing.",
      },
      {
        cones: true, controller: "distributed", set: FAST_RIGHT, speed: 2,
        task: "Give the pair a controller.", label: "distributed",
        after: "Both contacts slide inward, so both robots correct: case (d). Both palms go up and down, one after the other. Closing (driving together) raises the squeeze H: the force with which the palms press the object inward, in units of its weight. The contact whose friction cone ends first slides: the one on the flatter palm.",
        hasSqueezes: true,
      },
    ],
  },
  {
    title: "Two robots without a radio",
    text:
      "With the controller silent, the robots send nothing. Each robot makes corrections according to the sign of its own contact alone.",
    parts: [
      {
        controller: "silent", seed: 3, speed: 5,
        question: { ask: "Will the box arrive?", answers: ARRIVES, right: 0 },
        after: "The angles of the two palms decide which contact slides, and each robot turns only its own palm.",
      },
      {
        controller: "silent", seed: 3, set: { "robot.noise_m_s": 0.02 }, speed: 5,
        task: "Double the noise of the speeds.", label: "noise 20 mm/s",
        after: "The contacts move farther from p = 0, but the robots still correct them without any message. One carry says little: the view Compare counts how many of 1000 they drop.",
      },
    ],
  },
  {
    title: "A reboot",
    text:
      "At 0.4 s, the left robot begins a correction, and the right one assists. At 0.8 s, the right robot reboots, which takes 20 ms, and forgets that it was assisting.",
    parts: [
      {
        set: REBOOT, speed: 2,
        question: {
          ask: "What will the left robot do?",
          answers: ["It notices, and starts again.", "It continues its correction, to the end."],
          right: 1,
        },
        after: "One robot drives away and the other closer, forever, and the contacts no longer move.",
      },
      {
        controller: "resilient", set: REBOOT, speed: 2,
        task: "Run the same reboot with the controller resilient.", label: "resilient",
        after: "The beacons of a robot show that it has rebooted. Its partner gives up the old correction, and both robots start again.",
      },
    ],
  },
  {
    title: "A slope",
    text:
      "The floor rises in the direction of travel, and gravity pulls the box towards the left robot. The robots rely on two properties: closing slides only the shallow contact, and opening slides only the steep one.",
    parts: [
      {
        set: { "task.slope_deg": 4 }, speed: 5,
        question: { ask: "A slope of 4°. What will happen to the box?", answers: ARRIVES, right: 0 },
        after: "At the paper's angles, both properties hold up to 4.5°, wherever the contacts are on the palms.",
      },
      {
        set: { "task.slope_deg": 8 }, task: "Make it steeper.", label: "8°",
        question: { ask: "A slope of 8°. What will happen to the box?", answers: ARRIVES, right: 1 },
        after: "Beyond the limit of 4.5°, the wrong contact may slide, and corrections move a contact in the wrong direction. The view Design shows which angles tolerate a steeper floor.",
      },
    ],
  },
  {
    title: "An uneven load",
    text:
      "The box is 250 mm wide. Its centre of mass need not be in the middle.",
    parts: [
      {
        cones: true, set: { "object.com_m": [0.141, 0.04] }, speed: 5,
        question: {
          ask: "The centre of mass is 141 mm from the left edge. What will happen to the box?",
          answers: ARRIVES, right: 0,
        },
        after: "At the paper's angles, closing slides only the shallow contact, and opening only the steep one, if the centre of mass lies between 108.5 and 141.5 mm. This is true for any position of the contacts on the palms.",
      },
      {
        cones: true, set: { "object.com_m": [0.16, 0.04] }, speed: 2,
        task: "Move the centre of mass.", label: "160 mm",
        question: { ask: "160 mm from the left edge. What will happen to the box?", answers: ARRIVES, right: 1 },
        after: "More weight now presses on the right palm. When the right robot tilts this palm and drives closer, the left contact may slide instead, although the left palm is steep. The view Mechanics shows where the centre of mass may be.",
      },
    ],
  },
  {
    title: "Predict a correction",
    text: "A bump has moved the left contact 30 mm inward, so p_L < 0. The right contact is at p_R = 0.",
    parts: [
      {
        set: { ...QUIET, "bumps.script": [{ robot: "left", at_s: 0.5, shift_m: -0.03 }], "task.distance_m": 0.3 },
        at: 0.5,
        question: {
          ask: "What will the robots do?",
          answers: [
            "The left robot tilts its own palm up and drives closer.",
            "The left robot asks the right one to tilt up, then drives away.",
            "The right robot tilts up and drives closer.",
          ],
          right: 0,
        },
        after: "A robot corrects a contact with p < 0 alone. With its own palm shallow and its partner's palm steep, closing makes only its own contact slide, and it slides up.",
      },
    ],
  },
  {
    title: "From the floor",
    text:
      "The box stands on the floor. Both robots drive the noses of their palms under it. Each palm ends in a heel, a stop.",
    parts: [
      {
        ...LIFT, at: 1.9, until: 6.8, speed: 2,
        question: {
          ask: "The left nose is under first. What will the right one do?",
          answers: ["Follow, once the left heel stops the box.", "Push the box along for ever."],
          right: 0,
        },
        after: "The left robot brakes, and its heel, 12 mm high, stops the box. Then the right nose, 0.3 mm thick, gets under the rounded edge. Without heels, both would jam: in the view Carry, choose “heels: none”.",
      },
      {
        ...LIFT, set: OFF_WHILE_RAISING, at: 8, speed: 5,
        task: "Raise the box. Meanwhile, the left robot fails for 5 s.", label: "go on",
        question: {
          ask: "The left robot fails for 5 s. And the right arm?",
          answers: ["It rises, and the box tips.", "It waits for the left robot."],
          right: 1,
        },
        after: "An arm moves only while its robot hears that the partner is ready or moves, too, and is never more than a step ahead. So the box stays nearly level. At the end, both arms sink, and the robots drive away.",
      },
      {
        ...LIFT, set: { "radio.loss": 1 }, speed: 25,
        task: "Jam the radio from the start.", label: "loss 100 %",
        question: {
          ask: "No message arrives. What will the robots do?",
          answers: ["They raise the box all the same.", "They try three times, and stop."],
          right: 1,
        },
        after: "A robot that is under the box waits for its partner's word, but not for ever. While the noses are on the floor, backing off is safe. Once the arms rise, the robots would hold them, and wait for a person.",
      },
    ],
  },
];
