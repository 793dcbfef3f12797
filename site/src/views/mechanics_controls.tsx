// SPDX-License-Identifier: Apache-2.0
// The sliders of the view Mechanics: palm angles, contacts and friction.
import { contact, half, setContact, setTheta, theta } from "./mechanics_state";
import { setForAll, valuesOf } from "../shared/state";

export function StateSliders() {
  const slider = (
    label: string, id: string, value: number, low: number, high: number, step: number, unit: string,
    change: (value: number) => void,
  ) => (
    <label class="slider">
      <span>
        {label} <span class="value">{value.toFixed(1).replace("-", "−")} {unit}</span>
      </span>
      <input type="range" id={id} min={low} max={high} step={step} value={value}
        onInput={(event) => change(Number(event.currentTarget.value))} />
    </label>
  );
  const friction = valuesOf("palm.friction");
  const shown = [...new Set(friction.map((value) => value.toFixed(2)))].join(" / ");
  return (
    <div class="sliders tight">
      {slider("θ_L", "theta-left", theta.value[0], -10, 50, 0.5, "°", (v) => setTheta(0, v))}
      {slider("θ_R", "theta-right", theta.value[1], -10, 50, 0.5, "°", (v) => setTheta(1, v))}
      {slider("p_L", "p-left", contact.value[0], -1000 * half(0), 1000 * half(0), 0.5, "mm", (v) => setContact(0, v))}
      {slider("p_R", "p-right", contact.value[1], -1000 * half(1), 1000 * half(1), 0.5, "mm", (v) => setContact(1, v))}
      <label class="slider">
        <span>friction μ <span class="value">{shown}</span></span>
        <input type="range" id="friction" min={0.05} max={1.2} step={0.01} value={friction[0]}
          onInput={(event) => setForAll("palm.friction", Number(event.currentTarget.value))} />
      </label>
    </div>
  );
}
