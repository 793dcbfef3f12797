# SPDX-License-Identifier: Apache-2.0
"""Scenes with random values for every key that the core reads, drawn from its table.

A value is near the default of its key, so that a carry lasts. It is drawn again until it agrees
with the keys before it, as the core checks. Robots that cannot hold the object are those of the
default scene instead.
"""

import random
from collections.abc import Iterator
from typing import Any

import palmbots._core as _core
from palmbots.scene.core_keys import ROWS
from palmbots.scene.scene import load_scene
from palmbots.scene.section import as_given

Keys = dict[str, Any]

# How far a value may be from a default of 0, by unit; and values of keys that are not set.
NEAR_ZERO = {
    "": 0.04, "m": 0.004, "s": 0.03, "m/s": 0.003, "m/√s": 0.01, "degrees": 2.0,
    "parts per million": 200.0, "bumps per metre": 3.0,
}  # fmt: skip
INSTEAD_OF_NONE = {
    "": 0.3, "m": 0.2, "s": 0.5, "N": 30.0, "degrees": 15.0, "parts per million": 5000.0,
}  # fmt: skip
# Lists of what stands on a floor. Most of what carries random scenes has none and refuses them.
ON_FLOOR = ("floor.walls", "floor.stands")
CARRIED_ROWS = frozenset(name for name in ROWS if not name.startswith(ON_FLOOR))
OUTLINE = {  # the rows of an outline say nothing about its shape
    "object.vertices_m": lambda draw: [
        [0.02, draw.uniform(-0.01, 0.01)], [0.28, 0.0], [0.27, draw.uniform(0.1, 0.2)], [0.0, 0.17],
    ],
    "object.edge_radius_m": lambda draw: draw.choice(
        ([0.0] * 4, [draw.choice((0.0, draw.uniform(0.0, 0.01))) for _ in range(4)])
    ),
    "object.contacts": lambda draw: [0, 1],
    "object.com_m": lambda draw: [draw.uniform(0.14, 0.16), draw.uniform(0.04, 0.06)],
}  # fmt: skip


def value_of(row: dict[str, Any], draw: random.Random) -> Any:
    """A random value of a key."""
    if row["kind"] == "flag":
        return draw.choice((True, False))
    if row["kind"] == "choice":
        return draw.choice(row["choices"])
    least, most = row["least"], row["most"]
    if row["kind"] == "whole":
        return draw.randint(int(least), int(min(most, least + 3)))
    usual = INSTEAD_OF_NONE[row["unit"]] if row["default"] is None else row["default"]
    # The default of a key of a record is only the least that there may be.
    if "[]" in row["name"] and row["default"] is not None and row["unit"] == "s":
        usual = 0.4
    if usual == 0:
        drawn = draw.uniform(-NEAR_ZERO[row["unit"]], NEAR_ZERO[row["unit"]])
    else:
        drawn = usual * draw.uniform(0.8, 1.25)
    return min(max(drawn, least), most)


def holders_of(name: str) -> tuple[str, ...]:
    """The dotted names under which a key may be given."""
    section, _, key = name.partition(".")
    return (name, *(f"{section}.{holder}.{key}" for holder in ROWS[name]["holders"]))


def _nested(keys: Keys) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for name, value in keys.items():
        at = table
        *tables, last = name.split(".")
        for part in tables:
            at = at.setdefault(part, {})
        at[last] = value
    return table


def _agrees(keys: Keys) -> bool:
    return not _core.check_scene(_nested(keys))


def _record(name: str, draw: random.Random) -> Keys:
    rows = [row for row in ROWS.values() if row["name"].startswith(f"{name}[].")]
    return {
        row["name"].rpartition(".")[2]: value_of(row, draw)
        for row in rows
        if row["default"] is not None or draw.random() < 0.5
    }


def agreeing_value(given: str, name: str, keys: Keys, draw: random.Random) -> Any:
    """A random value of the key `given`, whose row is `name`, that agrees with other keys.

    None if the core refuses twenty of them.
    """
    for _ in range(20):
        value = value_of(ROWS[name], draw)
        if name == "robot.period_s":  # a multiple of another key
            value = draw.choice((2, 3)) * keys.get("control.period_s", 0.01)
        if name in ("palm.usable_m", "palm.nose_m"):  # at most another key
            name_of_most = name.replace("usable", "length").replace("nose", "thickness")
            most = keys.get(name_of_most, ROWS[name_of_most]["default"])
            value = draw.uniform(ROWS[name]["least"], most)
        if name == "task.timeout_s":  # long enough for a carry
            value = draw.uniform(5, 12)
        if _agrees({**keys, given: value}):
            return value
    return None


def random_keys(draw: random.Random, share: float = 0.6) -> Keys:
    """Keys of a valid scene; each of `CARRIED_ROWS` is in it with a probability `share`."""
    keys: Keys = {name: make(draw) for name, make in OUTLINE.items()}
    if draw.random() < 0.25:
        del keys["object.vertices_m"]
        keys["object.box_m"] = [draw.uniform(0.27, 0.3), draw.uniform(0.15, 0.2)]
    keys["object.mass_kg"] = 0.5
    keys["task.from"] = keys["task.to"] = "palms"  # most of what carries random scenes has no floor
    names = [n for n in ROWS if "[" not in n and n not in keys]
    lists = sorted({n.partition("[]")[0] for n in CARRIED_ROWS if "[]." in n})
    for name in draw.sample(names, len(names)):
        if draw.random() >= share:
            continue
        given = draw.choice(holders_of(name))
        if (value := agreeing_value(given, name, keys, draw)) is not None:
            keys[given] = value
    for name in lists:
        records: list[Keys] = []
        while len(records) < 2:
            record = _record(name, draw)
            if _agrees({**keys, name: [*records, record]}):
                records.append(record)
        if draw.random() < share:
            keys[name] = records
    keys["task.distance_m"] = draw.uniform(0.2, 0.5)
    if _core.load_refusal(as_given(load_scene("paper", keys)), False):
        return {name: value for name, value in keys.items() if not name.startswith("mujoco.")}
    return keys


def names_in(keys: Keys) -> Iterator[str]:
    """The rows of which a scene has values."""
    for name, value in keys.items():
        section, *_, last = name.split(".")
        common = f"{section}.{last}"
        if isinstance(value, list) and value and isinstance(value[0], dict):
            for record in value:
                yield from (f"{name}[].{key}" for key in record)
        elif isinstance(value, list):
            yield from (row for row in ROWS if row.startswith(f"{name}["))
        else:
            yield common
