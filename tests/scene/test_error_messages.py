# SPDX-License-Identifier: Apache-2.0
"""Every kind of wrong input has one clear line: file, key, value, and what is allowed."""

import datetime
import tomllib
from pathlib import Path

import numpy as np
import pytest

from palmbots.errors import SceneError
from palmbots.scene.error_messages import dotted_keys
from palmbots.scene.overrides import parse_override
from palmbots.scene.scene import Scene, load_scene

KEYS = sorted(dotted_keys(Scene))


def refusal(source, overrides=None) -> str:
    with pytest.raises(SceneError) as error:
        load_scene(source, overrides)
    line = str(error.value)
    assert line.isprintable(), "a message is one line"
    return line


FILE = Path(__file__).parent / "bad_scenes.toml"
BAD = [(bad["scene"], bad["line"]) for bad in tomllib.loads(FILE.read_text("utf-8"))["bad"]]


@pytest.mark.parametrize(("text", "line"), BAD, ids=[line.split(": ")[0] for _, line in BAD])
def test_bad_scene_is_refused_in_one_line(tmp_path, text, line):
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    assert refusal(path) == f"{path}: {line}"
    assert refusal(tomllib.loads(text)) == f"scene: {line}"
    assert refusal("paper", tomllib.loads(text)) == f"overrides: {line}"


def test_of_several_faults_the_misspelt_key_is_reported():
    line = refusal({"object": {"mass_kg": -1}, "task": {"distanc_m": 1}})
    assert line.startswith("scene: task.distanc_m: 1 is the value of an unknown key; did you mean ")


@pytest.mark.parametrize("key", KEYS)
def test_misspelt_key_suggests_the_right_one(key):
    table, _, name = key.rpartition(".")
    for wrong in (name[1:], name[:1] + name[2:], name[1] + name[0] + name[2:], name + "s"):
        line = refusal("paper", {f"{table}.{wrong}": 1})
        assert line.startswith(f"overrides: {table}.{wrong}: 1 is the value of an unknown key; ")
        # A long list is left out, which would hide the key that was meant.
        inside = {
            o.removeprefix(f"{table}.").split(".")[0] for o in KEYS if o.startswith(f"{table}.")
        }
        is_long = len(inside) > 12
        assert line.endswith(f"did you mean {key}?") == is_long
        assert (f"did you mean {key}? allowed in {table}: " in line) != is_long


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (10**400, f"1{'0' * 58}…"),
        (1 << 20_000, "<int>"),  # longer than Python is willing to print
        (None, "null"),
        (b"x", "b'x'"),
        (datetime.date(2001, 2, 3), "2001-02-03"),
        ("a\nb\ud800" * 20, '"' + ("a\\nb\\ud800" * 20)[:58] + "…"),
    ],
    ids=["long", "very long", "none", "bytes", "date", "text"],
)
def test_values_are_shown_short_and_on_one_line(value, shown):
    line = refusal({"radio": {"loss": value}})
    assert line.startswith(f"scene: radio.loss: {shown} is ")


@pytest.mark.parametrize(
    ("value", "line"),
    [
        ("1979-05-27", "radio.loss: 1979-05-27 is a date, not a number"),
        ("07:32:00", "radio.loss: 07:32:00 is a time, not a number"),
        ("1979-05-27T07:32:00Z", "radio.loss: 1979-05-27T07:32:00+00:00 is a date, not a number"),
    ],
)
def test_dates_are_shown_as_in_toml(value, line):
    assert line in refusal(dict([parse_override(f"radio={{loss={value}}}")]))


def test_numpy_numbers_are_accepted():
    for number in (np.float64(0.5), np.float32(0.5)):
        assert load_scene("paper", {"radio.loss": number}).radio.loss == 0.5
    one = load_scene("paper", {"radio.loss": np.int64(1), "object.contacts": [np.int8(0), 1]})
    assert type(one.radio.loss) is float
    assert type(one.object.contacts[0]) is int
    assert "is of type bool" in refusal("paper", {"radio.loss": np.True_})
