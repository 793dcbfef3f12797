// SPDX-License-Identifier: Apache-2.0
// Stories: nine short scenes in parts. A part asks what will happen or begins with a click, plays, and explains.
import { batch, effect } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect } from "preact/hooks";
import { AtHome, presentRun } from "./parts";
import { PlayerBar, usePlayerKeys } from "./player_bar";
import { Charts } from "./sequence";
import { Stage } from "./stage";
import { Stages } from "./stages";
import { outcomeText } from "./carry";
import { STORIES, type Part, type Story } from "./story_texts";
import type { Recorded } from "../shared/core";
import {
  base, controller, core, extraFlag, extraNumber, forks, isJob, overrides, player, recorded, scene, seed, setExtra,
  setExtraFlag,
} from "../shared/state";
import { decision } from "../shared/contact_mode_words";
import { get } from "../shared/scene_values";
import { controllerInfo, tables } from "../shared/tables";
import { reducedMotion } from "../shared/theme";

const storyNumber = () => Math.min(STORIES.length, Math.max(1, Math.floor(extraNumber("story", 1))));
const storyNow = () => STORIES[storyNumber() - 1]!;
const partNumber = () =>
  Math.min(storyNow().parts.length, Math.max(1, Math.floor(extraNumber("part", 1))));
const partNow = () => storyNow().parts[partNumber() - 1]!;

// The answer that the visitor has chosen, from 1; 0: none.
const answered = () => extraNumber("answer", 0);

// Whether the part has been watched to its end: only then the page shows what happens.
const isSeen = () => extraFlag("seen");

// The part asks for a prediction, which was not given yet, and was not watched to its end yet.
const isAsking = () => partNow().question !== undefined && answered() === 0 && !isSeen();

function begin(story: number, number: number): void {
  const part = STORIES[story - 1]!.parts[number - 1]!;
  batch(() => {
    setExtra("story", String(story), "1");
    setExtra("part", String(number), "1");
    for (const name of ["answer", "seen", "m"]) setExtra(name, "", "");
    base.value = part.scene ?? "paper";
    controller.value = part.controller ?? tables.defaultController;
    seed.value = part.seed ?? 0;
    overrides.value = part.set ?? {};
    forks.value = [];
    setExtraFlag("cones", part.cones ?? false);
    player.speed.value = part.speed ?? 1;
    player.seek(part.at ?? 0);
  });
  if (part.question) player.pause();
  else run();
}

// Begins a part with a button that is gone then: the focus goes where the part is played.
function goOn(story: number, number: number): void {
  begin(story, number);
  document.getElementById("play")?.focus();
}

function run(): void {
  if (!reducedMotion.matches) player.play();
}

// Whether scene and controller are those of the present part: then a reload keeps the state.
function isOfPart(part: Part): boolean {
  return (
    base.value === (part.scene ?? "paper") &&
    controller.value === (part.controller ?? tables.defaultController) &&
    JSON.stringify(overrides.value) === JSON.stringify(part.set ?? {})
  );
}

// Notes when a part has been watched, and stops a part that ends before its carry.
function useEnd(): void {
  useEffect(
    () =>
      effect(() => {
        const carried = recorded.value;
        const time = player.time.value;
        if (!carried || isSeen()) return;
        const { until } = partNow();
        if (time < Math.min(until ?? Infinity, carried.time)) return;
        if (until !== undefined && player.playing.peek()) {
          player.pause();
          player.seek(until);
        }
        setExtraFlag("seen", true);
      }),
    [],
  );
}

export function StoriesView() {
  const place = storyNumber();
  const story = storyNow();
  const part = partNow();
  useEffect(() => {
    if (!isOfPart(part)) begin(place, 1);
    else if (player.time.peek() === 0 && !part.question) run();
  }, [place]);
  usePlayerKeys();
  useEnd();
  useEffect(() => {
    player.isHeld = isAsking;
    return () => {
      player.isHeld = () => false;
    };
  }, []);
  const carried = recorded.value;
  const info = controllerInfo(controller.value);
  const number = partNumber();
  const next = story.parts[number];
  return (
    <div class="stories">
      <ol class="chapters" aria-label="stories">
        {STORIES.map((item, k) => (
          <li>
            <button type="button" aria-current={k + 1 === place ? "step" : undefined}
              onClick={() => begin(k + 1, 1)}>
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
        {part.question && <Question story={story} part={part} />}
        {!part.question && <strong>{part.task}</strong>}
        {number > 1 && (
          <button type="button" class="plain" onClick={() => goOn(place, 1)}>
            back to the beginning
          </button>
        )}
      </div>
      <section class="panel beside" aria-label="the carry">
        <div class="scene">
          <Stage run={carried} name={controller.value} id="stage" draggable hasKey periodic={info?.isPeriodic}
            hidesCases={isAsking() && player.time.value <= (part.at ?? 0)} />
          <Stages run={carried} />
          <PlayerBar isHeld={isAsking()} />
          <Ending />
          {isSeen() && (
            <div class="after" role="status">
              <p>{part.after}</p>
              {part.hasSqueezes && <Squeezes />}
              {next && (
                <p class="row next">
                  <strong>{next.task}</strong>
                  <button type="button" class="act" onClick={() => goOn(place, number + 1)}>
                    {next.label}
                  </button>
                </p>
              )}
            </div>
          )}
        </div>
        <Charts hidesFuture={!isSeen()} showsWholePalms />
      </section>
      <AtHome runs={presentRun()} />
      {import.meta.env.MODE !== "file" && (
        <p class="note">For a class: <a href="./lesson.html">a sheet with tasks for 45 minutes</a>, to print.</p>
      )}
    </div>
  );
}

// The question of a part, its answers, and, once the part has been watched, which one was right.
function Question(props: { story: Story; part: Part }) {
  const { ask, answers, right } = props.part.question!;
  return (
    <fieldset>
      <legend>{ask}</legend>
      {answers.map((words, k) => (
        <label class={`check ${isSeen() && k === right ? "right-answer" : ""}`}>
          <input type="radio" name="prediction" checked={answered() === k + 1} disabled={isSeen()}
            onChange={() => {
              setExtra("answer", String(k + 1), "");
              run();
            }} />
          <span class="tick">{isSeen() && k === right && <>✓<span class="unseen">this happens:</span></>}</span>
          <span class="number">{k + 1}</span> {words}
        </label>
      ))}
    </fieldset>
  );
}

// What decides which contact slides on closing.
function Squeezes() {
  const machine = core.value;
  if (!machine) return null;
  machine.setScene(scene.value);
  const [shallow, steep] = ["palm.shallow_deg", "palm.steep_deg"].map(
    (key) => (Number(get(scene.value, key)) * Math.PI) / 180,
  ) as [number, number];
  const words = (palms: [number, number], p: [number, number]) => decision(machine.statics(palms, p), true);
  return (
    <ul id="squeezes">
      <li>Both palms steep, both contacts at p = 0: {words([steep, steep], [0, 0])}</li>
      <li>Left palm shallow, p_L = −20 mm, as in case (d): {words([shallow, steep], [-0.02, 0])}</li>
    </ul>
  );
}

const ENDLESS_S = 2; // a correction that lasts that long, and to the end of the carry

// Which robots still make a correction that began long ago.
function endless(carried: Recorded): string[] {
  if (carried.outcome === 2) return [];
  const still = carried.corrections.filter(
    (c) => c.end >= carried.time && c.end - c.start > ENDLESS_S,
  );
  return still.length > 0 ? ["the last correction has not ended"] : [];
}

const counted = (number: number, what: string) =>
  `${number === 0 ? "no" : number} ${what}${number === 1 ? "" : "s"}`;

// What to do next. It stands below the buttons, because above them it would move them.
function hint(): string {
  if (isAsking()) return "Answer first; then it plays.";
  if (isSeen() || player.playing.value) return "\u00a0";
  return "Press play, or the space bar, to see what happens.";
}

function Ending(): ComponentChildren {
  const carried = recorded.value;
  if (!carried || player.time.value < carried.time) return <p class="status ending" role="status">{hint()}</p>;
  const wrong = carried.warnings.length > 0 ? carried.warnings : endless(carried);
  return (
    <p class="status ending" role="status">
      <strong class={carried.outcome === 1 && wrong.length === 0 ? "good" : "bad"}>
        {[outcomeText(carried), ...wrong].join("; ")}
      </strong>{" "}
      <span class="note" id="tally">
        {counted(carried.correctionCount, "correction")}, {counted(carried.sent, "message")}
        {!isJob.value && (
          <>, contacts up to {(1000 * Math.max(...carried.peak)).toFixed(0)} mm from <span class="whole">p = 0</span></>
        )}
      </span>
    </p>
  );
}
