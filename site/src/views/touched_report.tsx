// SPDX-License-Identifier: Apache-2.0
// What the view Mechanics reports of any contacts: what touches, and every contact mode that may occur
// while the palms move, with its forces, its margin and the inequality that ends it.
import { chosenMode, chosenMotion, listed, touched } from "./mechanics_state";
import { contactNames } from "./touched_picture";
import { limitWords, modeMarginWords } from "../shared/contact_mode_words";
import { setExtra } from "../shared/state";
import { tables } from "../shared/tables";
import type { Mode, Range } from "../shared/touched";

function force(value: number): string {
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const text = value.toFixed(3);
  return text === "-0.000" ? "0.000" : text.replace("-", "−");
}

function range([low, high]: Range): string {
  const ends = [force(low), force(high)];
  return ends[0] === ends[1] ? ends[0]! : ends.join(" … ");
}

export function TouchedReport() {
  const here = touched.value;
  if (!here || here.problem) return null;
  const motion = chosenMotion.value;
  const modes = motion?.modes ?? [];
  const mode = chosenMode.value;
  return (
    <>
      <p id="held" class={here.held ? "good" : "bad"}>
        {tables.contactModeSentences[here.held ? "all_hold" : "all_slip"]!.replace("{count}", String(here.contacts.length))}
      </p>
      <div class="row motions" role="group" aria-label="motion of the palms">
        {listed.value.map((m) => (
          <button type="button" id={`motion-${m.id}`} aria-pressed={m === motion}
            onClick={() => {
              setExtra("mo", m.id, "closing");
              setExtra("mk", "0", "0");
            }}>
            {m.name} <span class="count">{m.modes.length}</span>
          </button>
        ))}
      </div>
      <h2 id="motion-title">
        {motion?.name}: {modes.length === 0 ? "no contact mode" : modes.length === 1 ? "one contact mode" : `one of ${modes.length} contact modes`}
      </h2>
      {modes.length > 1 && (
        <div class="row motions" role="group" aria-label="contact modes">
          {modes.map((m, k) => (
            <button type="button" id={`mode-${k}`} aria-pressed={m === mode} onClick={() => setExtra("mk", String(k), "0")}>
              {m.motions.join(" ")}
            </button>
          ))}
        </div>
      )}
      <Forces mode={mode} />
      <p class="note" id="mode-margin">{mode ? modeMarginWords(mode) : tables.contactModeSentences.no_mode}</p>
      {mode && <Limits mode={mode} />}
    </>
  );
}

// The inequalities that decide, by contact.
function Limits(props: { mode: Mode }) {
  const names = contactNames(touched.value!.contacts);
  const limits = names.map(({ short }, i) => [short, limitWords(props.mode, i)] as const).filter(([, words]) => words);
  if (limits.length === 0) return null;
  return (
    <p class="note">
      The margin ends where
      {limits.map(([short, words], k) => <> {k > 0 && "and "}<span class="limit" data-contact={short}>{words}</span> at {short}</>)}.
    </p>
  );
}

function Forces(props: { mode: Mode | null }) {
  const { contacts } = touched.value!;
  const names = contactNames(contacts);
  const { mode } = props;
  return (
    <table class="forces">
      <thead>
        <tr><th>contact</th><th>motion</th><th class="num">normal</th><th class="num">friction</th></tr>
      </thead>
      <tbody>
        {contacts.map((one, i) => (
          <tr>
            <th scope="row">
              {names[i]!.short} <span class="count">{one.kind}</span>
            </th>
            <td>{mode?.motions[i] ?? ""}</td>
            <td class="num">{mode ? range(mode.normal[i]!) : ""}</td>
            <td class="num">{mode ? range(mode.friction[i]!) : ""}</td>
          </tr>
        ))}
      </tbody>
      <caption>forces in weights; friction to the left; BR: breaks contact</caption>
    </table>
  );
}
