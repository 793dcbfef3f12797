// SPDX-License-Identifier: Apache-2.0
// What ends a carry, by phase of the task: the table of the core.
import { tables } from "../shared/tables";

// `reason`: number of what ended the carry that is shown; 0: nothing did.
export function Ends(props: { reason: number }) {
  const phases = Object.keys(tables.phases);
  return (
    <details id="ends">
      <summary>What ends a carry?</summary>
      <div class="scroll">
        <table>
          <thead>
            <tr>
              <th scope="col">what happens</th>
              {phases.map((phase) => <th scope="col" title={tables.phases[phase]}>{phase.replace("_", " ")}</th>)}
            </tr>
          </thead>
          <tbody>
            {tables.ends.map((end, k) => (
              <tr aria-current={k + 1 === props.reason ? "true" : undefined}>
                <th scope="row">{end.name}: {end.meaning}</th>
                {phases.map((phase) => <td>{end.follows[phase]}</td>)}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <p class="note">
        {phases.map((phase) => `${phase.replace("_", " ")}: ${tables.phases[phase]}`).join("; ").replaceAll("`", "")}.
      </p>
    </details>
  );
}
