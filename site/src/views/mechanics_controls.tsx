// SPDX-License-Identifier: Apache-2.0
// The sliders and fields of the view Mechanics: palm angles, contacts or the floor, friction, shapes.
import { SHAPES, setShape, shape } from "./mechanics_shape";
import {
  MOST_DRIVEN, MOST_RAISED, contact, driven, floorFriction, half, isAlone, isPipe, onFloor, raised, setContact, setDriven, setRaised,
  setTheta, theta,
} from "./mechanics_state";
import { KINDS, type Kind, choose, kind } from "./surroundings";
import { setExtra, setExtraFlag, setForAll, valuesOf } from "../shared/state";
import { tables } from "../shared/tables";

export function StateSliders() {
  const slider = (
    label: string, id: string, value: number, low: number, high: number, step: number, unit: string,
    change: (value: number) => void, digits = 1,
  ) => (
    <label class="slider">
      <span>
        {label} <span class="value">{value.toFixed(digits).replace("-", "−")} {unit}</span>
      </span>
      <input type="range" id={id} min={low} max={high} step={step} value={value}
        onInput={(event) => change(Number(event.currentTarget.value))} />
    </label>
  );
  const friction = valuesOf("palm.friction");
  const shown = [...new Set(friction.map((value) => value.toFixed(2)))].join(" / ");
  const least = onFloor.value ? 0 : -10;
  return (
    <div class="sliders tight">
      {slider("θ_L", "theta-left", theta.value[0], least, 50, 0.5, "°", (v) => setTheta(0, v))}
      {!isAlone.value && slider("θ_R", "theta-right", theta.value[1], least, 50, 0.5, "°", (v) => setTheta(1, v))}
      {!onFloor.value && slider("p_L", "p-left", contact.value[0], -1000 * half(0), 1000 * half(0), 0.5, "mm", (v) => setContact(0, v))}
      {!onFloor.value && !isPipe.value && slider("p_R", "p-right", contact.value[1], -1000 * half(1), 1000 * half(1), 0.5, "mm", (v) => setContact(1, v))}
      {onFloor.value && slider("left drives in", "driven-left", driven.value[0], 0, MOST_DRIVEN, 0.1, "mm", (v) => setDriven(0, v))}
      {onFloor.value && !isAlone.value && slider("right drives in", "driven-right", driven.value[1], 0, MOST_DRIVEN, 0.1, "mm", (v) => setDriven(1, v))}
      {onFloor.value && slider(isAlone.value ? "it rises" : "both rise", "raised", raised.value, 0, MOST_RAISED, 0.1, "mm", setRaised)}
      <label class="slider">
        <span>friction μ <span class="value">{shown}</span></span>
        <input type="range" id="friction" min={0.05} max={1.2} step={0.01} value={friction[0]}
          onInput={(event) => setForAll("palm.friction", Number(event.currentTarget.value))} />
      </label>
      {onFloor.value && slider("μ of the floor", "floor-friction", floorFriction.value, 0, 1.2, 0.01, "", (v) => setExtra("mf", String(v), "0.3"), 2)}
    </div>
  );
}

// The shape of what touches, in fields that also name the limits of the core.
export function ShapeFields() {
  return (
    <div class="shapes">
      {SHAPES.map(({ key, id, label, step }) => (
        <label class="field" title={tables.keys.find((k) => k.name === key)?.meaning}>
          <span>{label} [mm]</span>
          <input type="number" id={id} min={0} step={step} value={Number((1000 * shape.value[key]).toFixed(2))}
            onChange={(event) => setShape(key, Number(event.currentTarget.value) / 1000)} />
        </label>
      ))}
      <label class="check">
        <input type="checkbox" id="floor" checked={onFloor.value}
          onChange={(event) => setExtraFlag("floor", event.currentTarget.checked)} />
        on a floor
      </label>
      {onFloor.value && (
        <select id="surroundings" aria-label="the object on the floor" value={kind.value}
          title="A wall takes the place of the right palm"
          onChange={(event) => choose(event.currentTarget.value as Kind)}>
          {KINDS.map((one) => <option>{one}</option>)}
        </select>
      )}
    </div>
  );
}
