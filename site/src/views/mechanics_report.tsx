// SPDX-License-Identifier: Apache-2.0
// What the view Mechanics reports of one state: which squeezes the contacts can transmit, and which
// contact modes balance.
import type { Statics } from "../shared/core";
import { tables } from "../shared/tables";

const MOTION_NUMBERS = [0, 1, 2] as const;

// The squeezes that each contact can carry, on one axis. The ends decide which contact slides.
export function Squeezes(props: { f: Statics }) {
  const { f } = props;
  const finite = f.squeeze.flat().filter(Number.isFinite);
  const low = Math.min(-0.05, ...finite.map((v) => v * 1.15));
  const high = Math.max(0.3, ...finite.map((v) => v * 1.15));
  const x = (h: number) => 34 + (Math.min(high, Math.max(low, h)) - low) / (high - low) * 420;
  const both = [
    Math.max(f.squeeze[0]![0], f.squeeze[1]![0]), Math.min(f.squeeze[0]![1], f.squeeze[1]![1]),
  ] as const;
  const held = both[0] <= both[1];
  return (
    <svg class="squeezes" viewBox="0 0 470 122" role="img"
      aria-label={`squeezes that the left contact can transmit: ${f.squeeze[0]!.map((v) => v.toFixed(3)).join(" to ")} weights, the right one: ${f.squeeze[1]!.map((v) => v.toFixed(3)).join(" to ")}`}>
      {held && (
        <rect x={x(both[0])} y="8" width={Math.max(1, x(both[1]) - x(both[0]))} height="70" fill="var(--zero-pale)" />
      )}
      {f.squeeze.map(([from, to], side) => (
        <g>
          <text x="24" y={26 + 30 * side} text-anchor="end" class="label" fill={side === 0 ? "var(--left)" : "var(--right)"}>
            I{side === 0 ? "ʟ" : "ʀ"}
          </text>
          <line x1={x(from)} x2={x(to)} y1={22 + 30 * side} y2={22 + 30 * side} stroke={side === 0 ? "var(--left)" : "var(--right)"} stroke-width="7" />
        </g>
      ))}
      <line x1="34" x2="454" y1="82" y2="82" stroke="var(--edge)" />
      {[0, 0.1, 0.2, 0.3, 0.5, 1, 2].filter((v) => v > low && v < high).map((v) => (
        <g>
          <line x1={x(v)} x2={x(v)} y1="79" y2="85" stroke="var(--edge)" />
          <text x={x(v)} y="97" text-anchor="middle" class="tick">{v}</text>
        </g>
      ))}
      <text x="454" y="116" text-anchor="end" class="tick">squeeze H [weights]</text>
      {held && f.opening >= 0 && <Arrow x={x(both[0])} direction={-1} />}
      {held && f.closing >= 0 && <Arrow x={x(both[1])} direction={1} />}
    </svg>
  );
}

function Arrow(props: { x: number; direction: number }) {
  const tip = props.x + 3 * props.direction;
  return (
    <path d={`M${tip - 12 * props.direction} 67 L${tip} 67 m${-5 * props.direction} -4 l${5 * props.direction} 4 l${-5 * props.direction} 4`}
      fill="none" stroke="var(--ink)" stroke-width="1.6" />
  );
}

export function NineModes(props: { f: Statics }) {
  const { f } = props;
  const title = MOTION_NUMBERS.map((k) => tables.contactModes[3 * k]!.split("-")[0]!);
  // The core orders the motions of a contact as sticks, up, down; up is SL left and SR right.
  const leftAt = [0, 1, 2];
  const rightAt = [0, 2, 1];
  return (
    <table class="contact-modes">
      <caption>Nine contact modes: which ones balance, and which one occurs</caption>
      <thead>
        <tr>
          <th>left ↓ right →</th>
          {title.map((name) => <th>{name}</th>)}
        </tr>
      </thead>
      <tbody>
        {MOTION_NUMBERS.map((l) => (
          <tr>
            <th scope="row">{title[l]}</th>
            {MOTION_NUMBERS.map((r) => {
              const mode = 3 * leftAt[l]! + rightAt[r]!;
              const happens = [f.closing === mode ? "closing" : "", f.opening === mode ? "opening" : ""].filter(Boolean);
              return (
                <td class={happens.length ? "happens" : f.feasible[mode] ? "feasible" : "no"}>
                  {f.feasible[mode] ? happens.join(", ") || "balances" : "–"}
                </td>
              );
            })}
          </tr>
        ))}
      </tbody>
    </table>
  );
}
