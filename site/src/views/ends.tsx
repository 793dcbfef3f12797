// SPDX-License-Identifier: Apache-2.0
// What ends a carry, by phase of the task: the table of the core.
import { tables } from "../shared/tables";

// `reason`: number of what ended the carry that is shown; 0: nothing did.
export function Ends(props: { reason: number }) {
  const phases = tables.phases.map(([name, meaning]) => [name.replace("_", " "), meaning.replaceAll("`", "")]);
  return (
    <details id="ends">
      <summary>What ends a carry?</summary>
      <div class="scroll">
        <table>
          <thead>
            <tr>
              <th scope="col">what happens</th>
              {phases.map(([name, meaning]) => <th scope="col" title={meaning}>{name}</th>)}
            </tr>
          </thead>
          <tbody>
            {tables.ends.map((end, k) => (
              <tr aria-current={k + 1 === props.reason ? "true" : undefined}>
                <th scope="row">{end.name}: {end.meaning}</th>
                {end.follows.map((words) => <td>{words}</td>)}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <p class="note">{phases.map((both) => both.join(": ")).join("; ")}.</p>
    </details>
  );
}
