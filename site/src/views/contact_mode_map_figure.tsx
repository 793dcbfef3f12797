// SPDX-License-Identifier: Apache-2.0
// The map of the contact mode over both contacts, in which a visitor picks a state (Figure 5).
import { contact, half, halfMm, hovered, maps, setContact, shown } from "./mechanics_state";
import { Canvas } from "../shared/canvas";
import { MAP_LEFT, MAP_TOP, REACH, drawContactModeMap, mapSize, contactModeColour } from "../shared/contact_mode_map";
import { contactModeName } from "../shared/contact_mode_words";
import { palette } from "../shared/theme";

export function ContactModeMap(props: { closing: boolean }) {
  const values = props.closing ? maps.closing : maps.opening;
  const seen = [...new Set(values.value ?? [])];
  // The contacts [mm] under the pointer, as shares of the map's half width.
  const pick = (event: PointerEvent) => {
    const place = event.currentTarget as HTMLElement;
    const rect = place.getBoundingClientRect();
    const size = mapSize(rect);
    const x = 2 * ((event.clientX - rect.left - MAP_LEFT) / size) - 1;
    const y = 1 - 2 * ((event.clientY - rect.top - MAP_TOP) / size);
    const at: [number, number] = [x * 1000 * REACH * half(0), y * 1000 * REACH * half(1)];
    const isInside = Math.max(Math.abs(x), Math.abs(y)) <= 1;
    const isHovering = isInside && event.buttons === 0 && event.pointerType !== "touch";
    hovered.value = isHovering ? [halfMm(at[0]), halfMm(at[1])] : null;
    if (event.buttons === 0) return;
    place.setPointerCapture(event.pointerId);
    setContact(0, at[0]);
    setContact(1, at[1]);
  };
  const name = props.closing ? "closing" : "opening";
  return (
    <figure class="map">
      <figcaption>{name}</figcaption>
      <Canvas
        id={props.closing ? "map-closing" : "map-opening"}
        height={(width) => Math.min(width, 300)}
        label={`map of the contact mode on ${name}, over both contact positions`}
        onPointerDown={pick}
        onPointerMove={pick}
        onPointerLeave={() => (hovered.value = null)}
        draw={(s) => {
          if (!values.value) return;
          const size: [number, number] = [1000 * half(0), 1000 * half(1)];
          const palms = { pL: [-size[0], size[0]] as [number, number], pR: [-size[1], size[1]] as [number, number] };
          drawContactModeMap(s, palette.value, values.value, size, [palms], contact.value, shown.value.isUnderPointer ? shown.value.contacts : null);
        }}
      />
      <ul class="key">
        {seen.sort((a, b) => b - a).map((mode) => (
          <li>
            <i style={{ background: contactModeColour(palette.value, mode), opacity: mode < 0 ? 1 : 0.5 }} /> {contactModeName(mode)}
          </li>
        ))}
      </ul>
    </figure>
  );
}
