# SPDX-License-Identifier: Apache-2.0
"""Which values of a scene are assumed rather than measured, as far as palmbots can know."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from palmbots._types import SIDES, Interval
from palmbots._util.report import Table
from palmbots.assessment.answer import Answer, suffices
from palmbots.assessment.change_trial import ChangeTrial
from palmbots.control.registry import WIDE_ZONE, describe
from palmbots.errors import SceneError
from palmbots.mujoco.curve_trial import CurveTrial
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.section import as_given
from palmbots.scene.sides import on_every_side, value_of
from palmbots.simulation.outcome_counts import OutcomeCounts
from palmbots.stability.analysis import Analysis
from palmbots.stability.analysis_lines import TIGHTEST

FRICTION = "palm.friction"
DECISIVE = (
    FRICTION, "robot.noise_m_s", "object.mass_kg", "object.com_m", "object.depth_m",
    "radio.latency_s", "mujoco.palm_torque_n_m",
)  # fmt: skip
"""Keys of what users seldom know exactly, and on which most answers depend."""
_IN_A_ROW = 2  # of a table, so that a value stands beside its key
_SHAPE = ("object.vertices_m", "object.box_m")  # everybody knows the outline


def deciding_keys(
    analysis: Analysis,
    counts: Sequence[OutcomeCounts],
    change: ChangeTrial | None,
    curve: CurveTrial | None,
) -> tuple[str, ...]:
    """Further keys that decide answers about a scene.

    They are the keys of the tightest margins and of the warnings, and those with which another
    value changed how carries end. The zero zone is among them if a controller that suffices needs a
    wide one; the width of the palms is, if they have no lips and a curve was tried.
    """
    return tuple(dict.fromkeys(_deciding(analysis, counts, change, curve)))


def _deciding(
    analysis: Analysis,
    counts: Sequence[OutcomeCounts],
    change: ChangeTrial | None,
    curve: CurveTrial | None,
) -> Iterator[str]:
    scene = analysis.scene
    names = [key for margin in analysis.ranking[:TIGHTEST] for key in margin.keys]
    names += [text.split()[0] for text in analysis.warnings]
    names += change.deciding if change is not None else ()
    if any(WIDE_ZONE in describe(one.controller).requirements for one in counts if suffices(one)):
        names.append("tactile.zero_half_width_m")
    if curve is not None and not any(scene.palm_of(side).lip_height_m for side in SIDES):
        names.append("palm.width_m")
    for name in names:
        if "." in name and name not in _SHAPE:
            yield _without_side(name)


def _without_side(key: str) -> str:
    section, _, name = key.partition(".")
    holder, _, own = name.partition(".")
    return f"{section}.{own}" if own and holder in SIDES else key


def assumed(scene: Scene, keys: Iterable[str] = DECISIVE) -> dict[str, Any]:
    """Those of the keys that nobody gave, with their defaults. The default of the COM and of the
    mass follows from the outline of the object."""
    outline = {"vertices_m": scene.object.vertices_m, "contacts": scene.object.contacts}
    try:
        usual = load_scene({"object": outline})
    except SceneError:  # on these contacts the object tips over by itself unless its COM is set
        usual = Scene()
    found = {}
    for key in keys:
        default = value_of(usual, key)
        for one in on_every_side(scene, {key: None}):
            if value_of(scene, one) == default and not _is_given(scene, one):
                found[one] = default
    return found


def _is_given(scene: Scene, key: str) -> bool:
    """Whether somebody set a key, as far as it can be known: a scene made from another one has
    all of its keys, and a scene always has the COM and the mass that follow from its outline."""
    *tables, name = key.split(".")
    given: Any = as_given(scene)
    for table in tables:
        given = given.get(table, {})
    everything = Scene().model_dump()[tables[0]]
    return tables != ["object"] and name in given and not everything.keys() <= given.keys()


def on_assumptions(
    scene: Scene, friction: Interval | None = None, deciding: Sequence[str] = ()
) -> Answer:
    """What the answers take for granted; palmbots cannot know whether it is true.

    Args:
        scene: whose values they are.
        friction: the interval that was assessed; None: the scene's own values were.
        deciding: further keys on which the answers depend, from `deciding_keys`.
    """
    missing, given = _values(scene, friction, deciding)
    text = f"of {len(missing) + len(given)} values that decide, {len(missing)} were not given"
    return Answer("Are the values measured?", "open", text, command_text("keys"))


def assumptions_table(
    scene: Scene, friction: Interval | None = None, deciding: Sequence[str] = ()
) -> Table:
    """The values that decide: those that were not given, and those that were."""
    rows = []
    labels = ("defaults", "given")
    for label, texts in zip(labels, _values(scene, friction, deciding), strict=True):
        for k in range(0, len(texts), _IN_A_ROW):
            rows.append((f"  {label}" if k == 0 else "", ", ".join(texts[k : k + _IN_A_ROW])))
    return Table(rows)


def _values(
    scene: Scene, friction: Interval | None, deciding: Sequence[str]
) -> tuple[list[str], list[str]]:
    """Keys and values that were not given, and that were."""
    names = tuple(dict.fromkeys((*DECISIVE, *deciding)))
    values = assumed(scene, names)
    keys = on_every_side(scene, dict.fromkeys(names))
    given = {key: value_of(scene, key) for key in keys if key not in values}
    if friction is not None:
        for key in on_every_side(scene, {FRICTION: None}):
            values.pop(key, None)
            given.pop(key, None)
        given = {FRICTION: "from {:g} to {:g} (--friction)".format(*friction), **given}
    return _listed(values), _listed(given)


def _listed(values: dict[str, Any]) -> list[str]:
    return [f"{key} {_text(value)}" for key, value in values.items()]


def _text(value: Any) -> str:
    if value is None:
        return "not set"
    if isinstance(value, list | tuple):
        return f"[{', '.join(f'{one:g}' for one in value)}]"
    return value if isinstance(value, str) else f"{value:g}"
