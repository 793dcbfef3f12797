# SPDX-License-Identifier: Apache-2.0
"""Write what the page says in words, and the built-in scenes, as JSON files.

    .venv/bin/python scripts/site_tables.py FOLDER

Names, symbols and meanings come from the package's own tables, so the page cannot contradict it.
"""

import inspect
import json
import math
import re
import sys
from collections.abc import Iterable
from itertools import product
from pathlib import Path
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.arguments import LONGEST_VALUE
from palmbots._util.atomic_files import write_whole
from palmbots._version import __version__
from palmbots.control.interface import MOVES, PALMS, SIGN_WORDS
from palmbots.control.registry import describe, shipped_names
from palmbots.control.resilient_timing import REFUSALS
from palmbots.derivation.global_policy import table_1
from palmbots.errors import SceneError
from palmbots.mechanics.consistent_modes import CODE_OF
from palmbots.mechanics.contact_mode_words import MOTION_MEANINGS, SENTENCES
from palmbots.mechanics.contact_modes import CONTACT_MODES
from palmbots.mechanics.lifting import check_lift
from palmbots.mechanics.lone import on_one_palm
from palmbots.scene.fields import KINDS, PROBLEMS
from palmbots.scene.key_reference import built_in_meanings, scene_keys
from palmbots.scene.object_library import object_names
from palmbots.scene.overrides import SUPERSEDES
from palmbots.scene.robot_dimensions import PIVOT_HEIGHT
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.scene_schema import worded_schema
from palmbots.scene.spec import to_spec
from palmbots.simulation.carry_ends import ends
from palmbots.simulation.floor_job import MEANINGS, MISSED, RETRIES, STAGES
from palmbots.simulation.single import carry
from palmbots.stability.angle_grid import QUANTITIES
from palmbots.stability.linear_conditions import SLIDING_EDGES, text_of
from palmbots.viz import solids
from palmbots.viz.style import controller_looks

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "verify"))

from model_check import Run, claims_of, runs  # noqa: E402

# The page does not have the analysis of jobs on the floor (`check_lift`). It has what the analysis
# finds with these heels, and changes other keys only if it does not read them.
HEELS_M = (0.0, 0.002, 0.012)
FREE_IN_JOBS = (
    "robot.noise_m_s", "radio.loss", "radio.outages", "faults.script", "bumps.pushes", "task.dock",
    "task.distance_m",
)  # fmt: skip

# Of a node of a JSON Schema, what limits a value itself.
_KEPT = (
    "type", "enum", "required", "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum",
    "minItems", "maxItems", "allowed",
)  # fmt: skip
_FORMULA = re.compile(r"^/\* (.*) \*/\nltl (\w+) ", re.MULTILINE)
_STEP = re.compile(r"^\s*(\d+)\s{2}left\s+(.*?)\s{2,}right\s+(.*?)\s*$")
_SENT = re.compile(r"(left|right) sends (\w+)(?:, (lost|copied))?")
# A robot of Table 2 is in a case; the others are in a state that has a name.
_IN_CASE = re.compile(
    r"(?P<position>[+-]\d+) \((?P<case>[ a-d])\) (?P<palm>\w+) *(?P<turning>…)? *(?P<does>.*)"
)
_LIFTS = re.compile(r"arm +(?P<arm>\d+) (?P<state>\w+)")
_IN_STATE = re.compile(
    r"(?P<position>[+-]\d+) (?P<state>\w+) +(?P<rests>rests)? *(?P<palm>steep|shallow) *"
    r"(?P<turning>…)? *(?P<naps>naps)? *(?P<does>away|closer)?"
)


def shape(node: dict[str, Any], tables: dict[str, Any]) -> dict[str, Any]:
    """A node of the scene's JSON Schema with what a check of values needs, and nothing to look up.

    What is not set is left out of a scene, so there is no null.
    """
    if "$ref" in node:
        node = tables[node["$ref"].rpartition("/")[2]]
    if "anyOf" in node:  # beside null, or beside the name of an object, which the page looks up
        first, second = node["anyOf"][:2]
        is_list = second.get("type") == "array"
        return shape(first, tables) | ({"many": shape(second, tables)} if is_list else {})
    found = {word: node[word] for word in _KEPT if word in node}
    if "items" in node:
        found["items"] = shape(node["items"], tables)
    if "prefixItems" in node:
        found["prefixItems"] = [shape(item, tables) for item in node["prefixItems"]]
    if "properties" in node:
        properties = node["properties"].items()
        found["properties"] = {name: shape(item, tables) for name, item in properties}
    return found


def scene_rules() -> dict[str, Any]:
    """What a scene may hold: the shape of every table."""
    schema = worded_schema()
    return shape(schema, schema["$defs"])


def counterexample(path: Path) -> dict[str, Any]:
    """A transcript of the model checker as steps, and the scene in which it can be carried."""
    title, *lines = path.read_text("utf-8").splitlines()
    run = runs()[path.stem]
    shown = controller_of(run)
    steps: list[dict[str, Any]] = []
    before: list[dict[str, Any]] = []
    loop: int | None = None
    for line in lines:
        step = _STEP.match(line)
        if step:
            robots = [_robot(step[2], shown), _robot(step[3], shown)]
            if run.parameters.get("SPAN") == 0:  # the model has no contacts
                for robot in robots:
                    robot.pop("position", None)
            steps.append({"before": before, "robots": robots})
            before = []
        elif "from here for ever" in line:
            loop = len(steps)
        elif line.strip():
            before.append(_event(line.strip()))
    what, _, violated = title.rpartition(": ")
    claim = violated.removesuffix(" is violated")
    scene = path.with_suffix(".toml")
    return {
        "name": path.stem,
        "title": what,
        "claim": claim,
        "meaning": _meaning(run, claim),
        "isShortest": run.search == "shortest",
        "controller": shown,
        "steps": steps,
        "after": before,
        "loop": loop,
        "scene": load_scene(scene).model_dump() if scene.exists() else None,
    }


def controller_of(run: Run) -> str:
    """The shipped controller that a run of the model checker explores."""
    if run.model == "signs" and not run.parameters["TALKS"]:
        return "silent"
    return {"signs": "shared-sign", "beacons": "shared-sign"}.get(run.model, run.model)


def _meaning(run: Run, claim: str) -> str:
    """A claim or formula in the words of the model, with the numbers of the run."""
    stated = {name: says for name, (_, says) in claims_of(run.model).items()}
    text = (ROOT / "verify" / "models" / f"{run.model}.pml").read_text("utf-8")
    stated |= {name: says for says, name in _FORMULA.findall(text)}
    says = re.sub(r"^S\d: ", "", stated[claim]).removesuffix(".")
    for parameter, value in run.parameters.items():
        says = re.sub(rf"\b{parameter}\b", str(value), says)
    return says[0].lower() + says[1:]


def _event(text: str) -> dict[str, Any]:
    """What happens between two steps: its text, and what of it can be drawn."""
    sent = _SENT.fullmatch(text)
    if sent:
        sender, name, fate = sent.groups()
        return {"text": text, "sender": SIDES.index(sender), "name": name, "fate": fate or ""}
    side = next((k for k, side in enumerate(SIDES) if side in text.split()), None)
    return {"text": text, "robot": side}


def _robot(text: str, controller: str) -> dict[str, Any]:
    """What a transcript says about a robot in a step, and the meaning of its state in words."""
    if lifts := _LIFTS.fullmatch(text.strip()):
        return {"arm": int(lifts["arm"]), "name": lifts["state"], "state": MEANINGS[lifts["state"]]}
    said = _IN_CASE.fullmatch(text.strip()) or _IN_STATE.fullmatch(text.strip())
    if said is None:  # a model without contacts
        return {"state": text.strip()}
    part = said.groupdict()
    state, letter = part.get("state"), (part.get("case") or "").strip()
    if state is not None:
        words = "switched off" if state == "off" else describe(controller).states[state]
        letter = state[0] if re.match("[a-d]_", state) else ""
    else:
        words = describe(controller).cases[letter] if letter else "no correction"
    does = (part.get("does") or "").strip()
    return {
        "position": int(part["position"]),
        "case": letter,
        "name": state or "",
        "state": words,
        "palm": part["palm"],
        "turns": part["turning"] is not None,
        "drive": next((way for way in ("away", "closer") if does.endswith(way)), "hold"),
        "waits": does.removeprefix("waits for ") if does.startswith("waits for ") else "",
        "stands": part.get("rests") is not None,
        "misses": part.get("naps") is not None,
    }


def controllers() -> list[dict[str, Any]]:
    """The shipped controllers in the order of the core."""
    looks = controller_looks(shipped_names())
    found = []
    for name in shipped_names():
        entry = describe(name)
        found.append(
            {
                "name": name,
                "description": entry.description,
                "team": entry.team,
                "usesRadio": entry.uses_radio,
                "isPeriodic": entry.is_periodic,
                "cases": dict(entry.cases),
                "states": list(entry.states.values()),
                "messages": list(entry.messages),
                "colour": looks[name].colour,
            }
        )
    return found


def required_mode(number: int) -> str:
    """The contact mode that a property requires with the left palm shallow."""
    palm, edge = SLIDING_EDGES[number]
    is_left = palm == "shallow"
    motion = "SL" if is_left == (edge > 0) else "SR"  # up is outward: left on the left palm
    return f"{motion}-ST" if is_left else f"ST-{motion}"


def tables() -> dict[str, Any]:
    """Everything."""
    # A route takes several carries.
    scenes = {
        name: meaning
        for name, meaning in built_in_meanings("scenes").items()
        if not load_scene(name).task.route.is_set
    }
    objects = built_in_meanings("objects")
    return {
        "version": __version__,
        "controllers": controllers(),
        "defaultController": inspect.signature(carry).parameters["controller"].default,
        "refusals": list(REFUSALS.values()),
        "palms": list(PALMS),
        "drives": list(MOVES),
        "signWords": [SIGN_WORDS[sign] for sign in (-1, 0, 1)],
        "scenes": [
            {"name": name, "meaning": meaning, "scene": load_scene(name).model_dump()}
            for name, meaning in scenes.items()
        ],
        "objects": [
            {
                "name": name,
                "meaning": objects[name],
                "object": load_scene("paper", {"object": name}).object.model_dump(),
            }
            for name in object_names()
        ],
        "keys": [
            {"name": k.name, "unit": k.unit, "meaning": k.meaning}
            for k in scene_keys()
            if not k.name.startswith("mujoco.")
        ],
        "rules": scene_rules(),
        "supersedes": SUPERSEDES,
        "kinds": KINDS,
        "problems": PROBLEMS,
        "longestValue": LONGEST_VALUE,
        "outcomes": list(_core.carry_outcomes),
        "phases": list(ends().phases.items()),
        "ends": [
            {"name": end.name, "meaning": end.meaning, "follows": [*end.follows.values()]}
            for end in ends().ends
        ],
        "contactModes": ["-".join(mode) for mode in CONTACT_MODES],
        "requiredContactModes": {str(number): required_mode(number) for number in SLIDING_EDGES},
        "motionCodes": [{str(k): code for k, code in codes.items()} for codes in CODE_OF],
        "motionMeanings": MOTION_MEANINGS,
        "contactModeSentences": SENTENCES,
        "bindings": {
            f"{number}.{name}": text_of(number, name)
            for number in (1, 2)
            for name in ("first", "second", "lift_left", "lift_right", "wedged")
        },
        "bindingNames": ["nothing", "first", "second", "lift_left", "lift_right", "wedged"],
        "quantities": {
            name: {"number": n, "most": most if math.isfinite(most) else 10.0, "unit": unit,
                   "name": text}
            for name, (n, most, unit, _, text) in QUANTITIES.items()
        },
        "table1": [
            {
                "signs": list(case.signs),
                "palms": list(case.palms),
                "moves": [f"{move.direction} until {move.end}" for move in case.moves],
            }
            for case in table_1()
        ],
        "robot": robot(),
        "lifting": lifting_states(),
        "jobs": {
            "free": {name: free_in_job(load_scene(name)) for name in scenes},
            "heels": HEELS_M,
            "checked": checked_jobs(scenes),
        },
    }  # fmt: skip


def lifting_states() -> dict[int, dict[str, Any]]:
    """The phases of jobs on the floor by their numbers in the core, and what a job missed that ends
    there."""
    order = list(MISSED)
    return {
        number: {
            "name": name,
            "meaning": MEANINGS[name],
            "stage": STAGES[name],
            "missed": MISSED[name],
            "rank": order.index(name),
            "isRetry": name in RETRIES,
        }
        for number, name in _core.lift_state_numbers.items()
    }


def free_in_job(scene: Scene) -> list[str]:
    """The keys of `FREE_IN_JOBS` that the analysis of this scene's job does not read."""
    is_read = {
        "task.dock": on_one_palm(scene),
        "task.distance_m": "stand" in scene.task.ends,
    }
    return [key for key in FREE_IN_JOBS if not is_read.get(key)]


def checked_jobs(scenes: Iterable[str]) -> list[dict[str, Any]]:
    """Why the job of each built-in scene on the floor cannot begin, and what may end it, with the
    objects and heels that the page offers."""
    found: list[dict[str, Any]] = []
    for name, target, heel in product(scenes, (None, *object_names()), (None, *HEELS_M)):
        given = {"object": target, "palm.heel_m": heel}
        changes = {key: value for key, value in given.items() if value is not None}
        refusal = ""
        warnings: tuple[str, ...] = ()
        try:
            scene = load_scene(name, changes)
            if not to_spec(scene).uses_floor:
                continue
            warnings = check_lift(scene)
        except SceneError as error:
            refusal = str(error)
        found.append({"scene": name, "changes": changes, "refusal": refusal, "warnings": warnings})
    return found


def robot() -> dict[str, Any]:
    """The right robot from the side, with its pivot above the origin, on a floor of height 0."""
    box = solids.body("right", 0.0).shape
    assert isinstance(box, solids.Box)
    x, y = zip(*box.corners(), strict=True)
    wheels = {
        (shape.centre[0], shape.centre[2], shape.radius)
        for solid in solids.robot("right", 0.0)
        if isinstance(shape := solid.shape, solids.Cylinder)
    }
    return {
        "body": {"near": min(x), "far": max(x), "low": min(y), "top": max(y)},
        "wheels": [{"x": x, "y": y, "radius": radius} for x, y, radius in sorted(wheels)],
        "shoulder": dict(zip("xy", solids.shoulder("right", 0.0), strict=True)),
        "pivotHeight": PIVOT_HEIGHT,
    }


def counterexamples() -> dict[str, Any]:
    """All pinned counterexamples. A robot has the number of its state in words. What is false or
    empty is left out, because they are a large part of the page."""
    folder = ROOT / "verify" / "counterexamples"
    found = [
        counterexample(path) for path in sorted(folder.glob("*.txt"), key=lambda path: path.stem)
    ]
    words: dict[str, int] = {}
    for step in (step for one in found for step in one["steps"]):
        for robot in step["robots"]:
            robot["state"] = words.setdefault(robot["state"], len(words))
        step["robots"] = [
            {key: value for key, value in robot.items() if value is not False and value != ""}
            for robot in step["robots"]
        ]
    return {"states": list(words), "runs": found}


def main() -> None:
    """Write the files."""
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in (("tables", tables()), ("counterexamples", counterexamples())):
        text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
        write_whole(folder / f"{name}.json", text + "\n")


if __name__ == "__main__":
    main()
