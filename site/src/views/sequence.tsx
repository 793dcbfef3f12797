// SPDX-License-Identifier: Apache-2.0
// Contacts, palms and messages over time, with one cursor. A message can be lost, delayed or copied.
import { computed, signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { Canvas } from "../shared/canvas";
import {
  LEFT_MARGIN, type Lanes, RIGHT_MARGIN, type TimeAxis, arrowsOf, drawContacts, drawPalms,
  drawSequence, labelsOf, lanesOf, sequenceHeight, timeAt,
} from "../shared/charts";
import { type Message, ROW, type Recorded } from "../shared/core";
import { get, ofSide } from "../shared/scene_values";
import {
  OWN_ROWS, append, before, controller, extraFlag, extras, isJob, player, recorded, runWith, scene, setExtra,
  setExtraFlag, setKey,
} from "../shared/state";
import { type Json, SENDERS, SIDES, controllerInfo } from "../shared/tables";
import { isLow, palette } from "../shared/theme";
import { zeroZone } from "./stage";

// The chosen message by its place among those of the carry.
const chosen = computed(() => {
  const place = Number(extras.value.m ?? NaN);
  return Number.isInteger(place) && place >= 0 ? place : null;
});
const choose = (place: number | null) => setExtra("m", place === null ? "" : String(place), "");
const whole = computed(() => extraFlag("whole"));
// While a finger drags the cursor, the axis stands still.
const held = signal<TimeAxis | null>(null);
const DELAY_S = 0.5;
const MOST_FAULTS = 16; // entries of radio.script
const PIXELS_PER_S = 85; // where the axis shows a part of the carry

// The part of the carry that the charts show: all of it, or what lies around the cursor.
function axis(run: Recorded, width: number): TimeAxis {
  if (held.value) return { ...held.value, width };
  const end = Math.max(run.time, before.value?.time ?? 0, 0.1);
  const span = Math.max(4, width / PIXELS_PER_S);
  if (whole.value || end <= span) return { from: 0, to: end, width };
  const from = Math.min(Math.max(player.time.value - 0.4 * span, 0), end - span);
  return { from, to: from + span, width };
}

function faultOf(message: Message): { [key: string]: Json } | undefined {
  return faultScript().find(isFaultOf(message));
}

function faultScript(): { [key: string]: Json }[] {
  return get(scene.value, "radio.script") as { [key: string]: Json }[];
}

// Sender, receiver and number of a message, as radio.script names them.
function nameOf(message: Message): { [key: string]: Json } {
  const name: { [key: string]: Json } = { sender: SENDERS[message.sender]!, message: message.number };
  if (message.sender === 2) name.receiver = SENDERS[message.receiver]!;
  return name;
}

function isFaultOf(message: Message): (fault: { [key: string]: Json }) => boolean {
  const name = nameOf(message);
  return (fault) => ["sender", "receiver", "message"].every((key) => fault[key] === name[key]);
}

function setFault(message: Message, effect: "lost" | "delayed" | "duplicated" | null): void {
  const isOwn = isFaultOf(message);
  const rest = faultScript().filter((f) => !isOwn(f));
  setKey("radio.script", rest.length > 0 ? rest : undefined);
  if (effect === null) return;
  append("radio.script", {
    ...nameOf(message), effect, ...(effect === "lost" ? {} : { delay_s: DELAY_S }),
  });
}

// True if a station commands the robots.
function stationed(name: string): boolean {
  return name === OWN_ROWS || controllerInfo(name)?.team === "station";
}

// `hidesFuture`: shows only what has happened by the time of the player. `showsWholePalms`: the contacts
// from end to end of the palms, however far they come: the axis does not tell.
export function Charts(props: { hidesFuture?: boolean; showsWholePalms?: boolean }) {
  const run = recorded.value;
  const frame = useRef<HTMLDivElement>(null);
  if (!run) return null;
  const of = scene.value;
  const info = controllerInfo(controller.value);
  const latency = Number(get(of, "radio.latency_s"));
  const half = Math.max(...SIDES.map((side) => ofSide(of, "palm", side, "length_m"))) / 2;
  const angles = SIDES.flatMap((side) => [
    ofSide(of, "palm", side, "shallow_deg"), ofSide(of, "palm", side, "steep_deg"),
  ]);
  const band = { from: Math.min(...angles), to: Math.max(...angles) };
  const hasStation = stationed(controller.value);
  const lanes = lanesOf(hasStation, isLow.value);
  const talks = hasStation || (info !== undefined && info.usesRadio);

  const scrub = (event: PointerEvent) => {
    if (event.buttons === 0) return;
    const place = event.currentTarget as HTMLElement;
    const rect = place.getBoundingClientRect();
    if (!held.value) {
      held.value = axis(run, rect.width);
      place.setPointerCapture(event.pointerId);
    }
    player.scrub(timeAt(axis(run, rect.width), event.clientX - rect.left));
  };
  const release = () => {
    held.value = null;
  };
  const pick = (event: PointerEvent) => {
    const rect = (event.currentTarget as HTMLElement).getBoundingClientRect();
    const [x, y] = [event.clientX - rect.left, event.clientY - rect.top];
    const shown = axis(run, rect.width);
    const arrows = arrowsOf(shown, run.messages, latency, lanes, chosen.peek());
    const labels = labelsOf(arrows, chosen.peek(), lanes);
    let best = labels.find((one) => x >= one.x && x <= one.x + one.width && Math.abs(y - one.y) < 8)?.index ?? -1;
    let nearest = 14;
    for (const a of best < 0 ? arrows : []) {
      const share = (y - a.y0) / (a.y1 - a.y0);
      if (share < -0.1 || share > 1.1) continue;
      const gap = Math.abs(x - (a.x0 + (a.x1 - a.x0) * share));
      if (gap < nearest) [nearest, best] = [gap, a.index];
    }
    if (best < 0 && hasStation) best = packetAt(run.messages, timeAt(shown, x), y, lanes);
    choose(best >= 0 ? best : null);
    if (best >= 0) {
      player.pause();
    } else {
      scrub(event);
    }
  };
  const keys = (event: KeyboardEvent) => {
    const step = event.shiftKey ? 0.1 : 0.01;
    if (event.key === "ArrowLeft") player.step(-step);
    else if (event.key === "ArrowRight") player.step(step);
    else if (event.key === "Home") player.scrub(0);
    else if (event.key === "End") player.scrub(run.time);
    else if (event.key === "m" || event.key === "M") {
      const next = nextNews(run.messages, event.key === "m" ? 1 : -1);
      if (next >= 0) {
        choose(next);
        player.scrub(run.messages[next]!.sent);
      }
    } else return;
    event.preventDefault();
  };

  return (
    <div class="charts">
      <div class="legend">
        <span class="left-key">left robot</span>
        <span class="right-key">right robot</span>
        <span class="zero-key">sensor reads 0</span>
        <span class="end-key">end of a palm</span>
        <label class="check small">
          <input
            type="checkbox"
            id="whole"
            checked={whole.value}
            onChange={(event) => setExtraFlag("whole", event.currentTarget.checked)}
          />
          whole carry
        </label>
      </div>
      <div class="plots" ref={frame}>
        <figure>
          <figcaption>contacts p [mm], outward is up</figcaption>
          <Canvas
            id="contacts-chart"
            height={isLow.value ? 96 : 132}
            label="contact coordinates over time; the arrow keys move the cursor"
            onPointerDown={scrub}
            onPointerMove={scrub}
            onPointerUp={release}
            onKeyDown={keys}
            draw={(s) =>
              drawContacts(
                s, palette.value, axis(run, s.width), run, before.value, zeroZone(of), half,
                props.showsWholePalms ?? false,
              )
            }
          />
        </figure>
        <figure>
          <figcaption>palm angles</figcaption>
          <Canvas
            id="palms-chart"
            height={isLow.value ? 48 : 66}
            label="palm angles over time"
            onPointerDown={scrub}
            onPointerMove={scrub}
            onPointerUp={release}
            draw={(s) => drawPalms(s, palette.value, axis(run, s.width), run, band)}
          />
        </figure>
        <figure>
          <figcaption class="keys">
            {talks ? "corrections and messages: click a message" : "corrections"}
            <span class="corrects-key" aria-hidden="true">corrects</span>
            {talks && !hasStation && <span class="waits-key" aria-hidden="true">waits</span>}
            {talks && !hasStation && <span class="assists-key" aria-hidden="true">assists</span>}
            {talks && <span class="lost-key" aria-hidden="true">lost</span>}
          </figcaption>
          <Canvas
            id="sequence-chart"
            height={sequenceHeight(lanes)}
            label="corrections and messages of both robots; M selects the next message"
            onPointerDown={pick}
            onPointerMove={scrub}
            onPointerUp={release}
            onKeyDown={keys}
            draw={(s) =>
              drawSequence(
                s, palette.value, axis(run, s.width), run, latency, chosen.value,
                info?.isPeriodic ?? false, lanes,
              )
            }
          />
        </figure>
        <Cursor run={run} frame={frame} hidesFuture={props.hidesFuture ?? false} />
      </div>
      <MessageCard run={run} />
      {hasStation && (
        <p class="note">
          Each robot reports to the station in every control period, and the station sends each robot a
          command. The chart shows only the packets with new content. Click between two lines to select
          any other packet.
        </p>
      )}
    </div>
  );
}

// The next or last message that says something new, from the chosen one or the time of the player.
function nextNews(messages: Message[], direction: 1 | -1): number {
  const count = messages.length;
  const start = chosen.value ?? messages.findIndex((m) => m.sent >= player.time.value) - direction;
  for (let k = 1; k <= count; ++k) {
    const index = (start + direction * k + 2 * count) % count;
    if (messages[index]!.isNews) return index;
  }
  return -1;
}

// The packet between a robot and the station that was sent nearest to a time: a report near the line
// of the robot, a command near that of the station.
function packetAt(messages: Message[], time: number, y: number, lanes: Lanes): number {
  const [top, bottom] = lanes.robots;
  if (y < top + 9 || y > bottom - 9) return -1;
  const robot = y < lanes.station ? 0 : 1;
  const isReport = Math.abs(y - lanes.station) > (bottom - top) / 4;
  const [sender, receiver] = isReport ? [robot, 2] : [2, robot];
  let best = -1;
  messages.forEach((m, index) => {
    if (m.sender !== sender || m.receiver !== receiver) return;
    const nearest = best < 0 ? Infinity : Math.abs(messages[best]!.sent - time);
    if (Math.abs(m.sent - time) < nearest) best = index;
  });
  return best;
}

// One line over all charts at the time of the player.
function Cursor(props: {
  run: Recorded; frame: { current: HTMLDivElement | null }; hidesFuture: boolean;
}) {
  const [width, setWidth] = useState(800);
  useEffect(() => {
    const observer = new ResizeObserver(([entry]) => setWidth(entry!.contentRect.width));
    observer.observe(props.frame.current!);
    return () => observer.disconnect();
  }, []);
  const shown = axis(props.run, width);
  const share = Math.min(1, Math.max(0, (player.time.value - shown.from) / (shown.to - shown.from)));
  const inner = `(100% - ${LEFT_MARGIN + RIGHT_MARGIN}px)`;
  const left = `calc(${LEFT_MARGIN}px + ${share} * ${inner})`;
  return (
    <>
      {props.hidesFuture && <div class="future" style={{ left }} />}
      <div class="cursor" style={{ left }} />
    </>
  );
}

// The time from which on the carry differs from the one in which this message has no fault or, if it
// has none, from the one in which it is lost; null: the two carries are equal.
function changedFrom(run: Recorded, message: Message, hasFault: boolean): number | null {
  const rest = faultScript().filter((f) => !isFaultOf(message)(f));
  const script = hasFault ? rest : [...rest, { ...nameOf(message), effect: "lost" }];
  const other = runWith({ "radio.script": script });
  if (!other || other.hash === run.hash) return null;
  const at = run.rows.findIndex((value, k) => value !== other.rows[k]);
  return at < 0 ? Math.min(run.time, other.time) : run.rows[at - (at % ROW.width)]!;
}

function MessageCard(props: { run: Recorded }) {
  if (chosen.value === null) return null;
  const message = props.run.messages[chosen.value];
  if (!message) return null;
  // In a job on the floor, radio.script counts the messages of two radios, each by itself.
  const fault = faultOf(message);
  const isFull = fault === undefined && faultScript().length >= MOST_FAULTS;
  const sender = message.sender === 2 ? "the station" : `the ${SENDERS[message.sender]} robot`;
  const receiver = message.sender === 2 ? ` to the ${SENDERS[message.receiver]} robot` : "";
  const lost = Number.isNaN(message.received);
  const from = isJob.value ? null : changedFrom(props.run, message, fault !== undefined);
  const what = fault === undefined ? "If it is lost" : `Because it is ${fault.effect}`;
  const effects = ["lost", "delayed", "duplicated"] as const;
  const words = { lost: "lose it", delayed: `delay it by ${DELAY_S} s`, duplicated: "deliver it twice" };
  return (
    <div class="card" role="group" aria-label="the chosen message">
      <p>
        <strong>{message.kind}</strong> from {sender}{receiver} at {message.sent.toFixed(2)} s{lost ? ", lost" : `, received at ${message.received.toFixed(2)} s`}
        {message.says && `: ${message.says}`}
      </p>
      {!isJob.value && (fault !== undefined || !(lost || isFull)) && (
        <p class="note" id="effect">
          {from === null ? `${what}, nothing changes.` : `${what}, the carry is different from ${from.toFixed(2)} s on.`}
        </p>
      )}
      <p class="row">
        {!isJob.value && effects.map((effect) => (
          <button
            type="button"
            data-effect={effect}
            aria-pressed={fault?.effect === effect}
            disabled={isFull}
            onClick={() => setFault(message, fault?.effect === effect ? null : effect)}
          >
            {words[effect]}
          </button>
        ))}
        <button type="button" class="plain" onClick={() => choose(null)} aria-label="close">
          ×
        </button>
      </p>
    </div>
  );
}

