// SPDX-License-Identifier: Apache-2.0
// The page: navigation, the view that the URL names, and the core.
import { signal } from "@preact/signals";
import { type ComponentType, render } from "preact";
import { CarryView } from "./views/carry";
import { openScene } from "./views/parts";
import { Core } from "./shared/core";
import {
  VIEWS, type ViewName, address, core, extra, followState, go, player, readAddress, recorded, setExtra, view,
} from "./shared/state";
import { tables } from "./shared/tables";
import { reducedMotion, setTheme, systemTheme, theme } from "./shared/theme";
import "./style.css";

const TITLES: Record<ViewName, string> = {
  carry: "Carry", compare: "Compare", mechanics: "Mechanics", design: "Design",
  stories: "Stories", proofs: "Proofs",
};

// All views but the first are fetched when they are opened.
const LOADERS: Partial<Record<ViewName, () => Promise<ComponentType>>> = {
  compare: () => import("./views/compare").then((m) => m.CompareView),
  mechanics: () => import("./views/mechanics").then((m) => m.MechanicsView),
  design: () => import("./views/design").then((m) => m.DesignView),
  stories: () => import("./views/stories").then((m) => m.StoriesView),
  proofs: () => import("./views/proofs").then((m) => m.ProofsView),
};
const loaded = signal<Partial<Record<ViewName, ComponentType>>>({ carry: CarryView });
const failure = signal("");

function Body() {
  const name = view.value;
  const View = loaded.value[name];
  if (!View) {
    void LOADERS[name]!().then((found) => (loaded.value = { ...loaded.value, [name]: found }));
    return <p class="status">…</p>;
  }
  return core.value ? <View /> : <p class="status">…</p>;
}

function Page() {
  return (
    <>
      <a class="skip" href="#main" onClick={(event) => {
        event.preventDefault();
        document.getElementById("main")!.focus();
      }}>
        Skip to the content
      </a>
      <nav aria-label="views">
        <strong class="brand">palmbots</strong>
        <div class="tabs">
          {VIEWS.map((name) => (
            <a
              href={address({ view: name, time: false })}
              aria-current={view.value === name ? "page" : undefined}
              onClick={(event) => {
                if (event.ctrlKey || event.metaKey || event.shiftKey) return;
                event.preventDefault();
                go(address({ view: name, time: false }));
              }}
            >
              {TITLES[name]}
            </a>
          ))}
        </div>
        {import.meta.env.MODE !== "file" && (
          <a class="aside" id="book" href="./docs/">documentation</a>
        )}
        <label class="file">
          open a scene
          <input
            type="file"
            id="scene-file"
            accept=".toml"
            onChange={(event) => {
              const file = event.currentTarget.files?.[0];
              if (file) void open(file);
              event.currentTarget.value = "";
            }}
          />
        </label>
        <button type="button" class="plain" id="theme" onClick={changeTheme}>
          light / dark
        </button>
      </nav>
      {failure.value && (
        <p class="failure" role="alert">
          {failure.value}
          <button type="button" class="plain" onClick={() => (failure.value = "")} aria-label="close">
            ×
          </button>
        </p>
      )}
      <main id="main" tabIndex={-1}>
        <Body />
      </main>
      <footer>
        The task, its analysis and two of the algorithms are from A. Gupta and W. H. Huang,{" "}
        <cite>A Carrying Task for Nonprehensile Mobile Manipulators</cite>, IROS 2003. palmbots{" "}
        {tables.version}, Apache License 2.0.
      </footer>
    </>
  );
}

// The URL holds a theme that differs from the system's.
function changeTheme(): void {
  setTheme(theme() === "dark" ? "light" : "dark");
  setExtra("theme", theme(), systemTheme());
}

function takeTheme(): void {
  const named = extra("theme", theme());
  if (named === "dark" || named === "light") setTheme(named);
}

async function open(file: File): Promise<void> {
  try {
    await openScene(file);
    failure.value = "";
    if (view.value !== "carry") go(address({ view: "carry", time: false }));
  } catch (error) {
    failure.value = (error as Error).message;
  }
}

function takeAddress(): void {
  const time = readAddress(location.hash);
  takeTheme();
  player.pause();
  player.seek(time ?? 0);
}

document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", (event) => {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file) void open(file);
});
window.addEventListener("popstate", takeAddress);
window.addEventListener("hashchange", takeAddress);

const time = readAddress(location.hash);
takeTheme();
render(<Page />, document.getElementById("app")!);

Core.load().then(
  (machine) => {
    core.value = machine;
    void recorded.value;
    player.seek(time ?? 0);
    followState();
    // The first view moves by itself, unless the URL names a moment or motion is unwelcome.
    if (time === null && !reducedMotion.matches && view.value === "carry") player.play();
    document.documentElement.dataset.ready = "true";
  },
  (error: Error) => (failure.value = `The core cannot be loaded: ${error.message}`),
);
