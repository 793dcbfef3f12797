# SPDX-License-Identifier: Apache-2.0
"""The output of `palmbots analyze` and `design`: no line contradicts another one."""

import json
import math
import re
from typing import Any

import pytest

import palmbots as pb
from palmbots._types import Region
from palmbots.cli import main as cli
from palmbots.stability.holding import holding
from palmbots.stability.tightest_margins import noise_over_carry_m


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> list[str]:
    """The lines that a command prints; it exits with 0."""
    assert cli.run(list(words)) == 0
    return capsys.readouterr().out.splitlines()


def row(lines: list[str], name: str) -> str:
    """One row of a table, with the lines on which it continues."""
    (start,) = [k for k, line in enumerate(lines) if line.strip().startswith(name)]
    parts = [lines[start].strip().removeprefix(name).strip()]
    for line in lines[start + 1 :]:
        if not line.startswith(12 * " "):
            break
        parts.append(line.strip())
    return " ".join(parts)


@pytest.mark.parametrize(
    ("key", "word"),
    [
        ("palm.shallow_deg=5", "HOLDS"),
        ("palm.shallow_deg=-6", "TOUCHES"),  # both properties hold, with a palm in the object
        ("object.com_m=[0.05,0.04]", "FAILS"),
    ],
)
def test_headline_combines_properties_and_clearance(
    key: str, word: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit status 0 either way, as documented."""
    lines = printed(capsys, "analyze", "--set", key)
    assert lines[0].split()[0] == word
    below = "\n".join(lines[1:])
    assert ("TOUCHES" in below) == (word == "TOUCHES")
    assert ("FAILS" in below) == (word == "FAILS")
    assert printed(capsys, "load", "--set", key)[0] == lines[0]  # the same question


INNER = (-0.01, 0.01)
NARROW = {"palm.left.usable_m": 0.04}
VERDICTS: list[tuple[str, dict[str, Any], Region, str, str]] = [
    ("paper", {"object.mass_kg": 1.5}, "palm", "MAY FAIL", "with contacts up to 47.3 mm from the "),
    # a load that is too heavy only farther out
    ("paper", {"object.mass_kg": 1.5}, INNER, "HOLDS",
     "an object of 1.5 kg, with contacts from -10.0 to 10.0 mm"),
    ("paper", {"object.mass_kg": 5}, INNER, "MAY FAIL", "a wheel slips above 2.54 kg, "),
    # all of the left palm, but not of the right one
    ("paper", NARROW, "palm", "HOLDS", "an object of 0.5 kg, with contacts anywhere on the palms"),
    ("paper", NARROW, (-0.02, 0.02), "HOLDS",
     "an object of 0.5 kg, with contacts from -20.0 to 20.0 mm"),
    # a job that robots cannot do
    ("lift", {"object.mass_kg": 2.0}, "palm", "FAILS", "object.mass_kg: value is 2, "),
]  # fmt: skip


@pytest.mark.parametrize(("scene", "keys", "region", "word", "start"), VERDICTS)
def test_verdict_is_about_the_contacts_of_the_region(
    scene: str, keys: dict[str, Any], region: Region, word: str, start: str
) -> None:
    found = holding(pb.analyze(scene, region_m=region, overrides=keys))
    assert found.word == word and found.text.startswith(start)


def test_angle_error_states_what_clearance_leaves_of_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A palm that is wrong by 3° is in the paper's box long before a property fails."""
    lines = printed(capsys, "analyze")
    least = math.degrees(pb.analyze("paper").clearance.rotation_margin.margin)
    assert row(lines, "angle error").endswith(f"touches after a turn of {least:.2f}°")
    touching = printed(capsys, "analyze", "--set", "palm.shallow_deg=0")
    assert row(touching, "angle error").endswith("a palm touches already")
    roomy = {"palm.shallow_deg": 9.0, "palm.steep_deg": 14.0}  # clear for longer than it holds
    found = pb.analyze("paper", overrides=roomy)
    assert found.angle_error_rad is not None
    assert found.clearance.rotation_margin.margin > found.angle_error_rad
    keys = [word for key, value in roomy.items() for word in ("--set", f"{key}={value}")]
    assert re.fullmatch(r"±[\d.]+°", row(printed(capsys, "analyze", *keys), "angle error"))


@pytest.mark.parametrize(
    "words",
    [
        ("analyze", "--set", "object=plank"),
        (
            "design",
            "--maximize",
            "friction",
            "--common-friction",
            "--resolution-deg",
            "1",
            "--set",
            "task.distance_m=0.2",
        ),
    ],
)
def test_friction_beyond_the_limit_of_scenes_is_printed_with_the_limit(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    """Scenes at the limit confirm it."""
    lines = printed(capsys, *words)
    name = "friction, both palms" if words[0] == "analyze" else "friction "
    match = re.match(
        r"[\d.]+ to ([\d.]+).*; a scene with a palm at ([\d.]+)° accepts less than ([\d.]+)",
        row(lines, name),
    )
    assert match is not None, lines
    most, steep_deg, limit = map(float, match.groups())
    assert most > limit
    palm = {"palm.steep_deg": steep_deg, "palm.shallow_deg": 0.0}
    pb.load_scene("paper", palm | {"palm.friction": limit - 0.001})
    for friction in (limit + 0.001, most):
        with pytest.raises(pb.SceneError, match="allowed: less than"):
            pb.load_scene("paper", palm | {"palm.friction": friction})


def test_friction_within_the_limit_is_printed_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert row(printed(capsys, "analyze"), "friction, both palms") == "0.094 to 1.046"


def test_motions_are_printed_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    """No line of the report abbreviates a motion; the JSON explains every abbreviation."""
    lines = printed(capsys, "analyze")
    (opening,) = [line for line in lines if "opening there" in line]
    assert "left flush breaks (leaves the palm)" in opening
    assert not re.search(r"\b(BR|SL|SR|ST)\b", "\n".join(lines))
    touch = json.loads("".join(printed(capsys, "analyze", "--json")))["touch"]
    used = {
        motion
        for outcomes in (touch["closing"], touch["opening"])
        for o in outcomes
        for motion in o
    }
    assert "BR" in used
    assert used <= set(touch["motion_names"])


def test_limits_that_the_scene_exceeds_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    lines = printed(capsys, "analyze", "--set", "robot.acceleration_m_s2=0.9")
    (warning,) = [line for line in lines if line.startswith("warning: ")]
    assert "robot.acceleration_m_s2 is 0.9" in warning
    assert not any("warning" in line for line in printed(capsys, "analyze"))


def test_report_begins_with_the_margins_that_the_scene_uses_up_most(
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = pb.analyze("paper")
    ranking = found.ranking
    assert [one.quantity for one in ranking[:3]] == ["contact", "clearance", "slope"]
    lines = printed(capsys, "analyze")
    heads = [k for k, line in enumerate(lines) if line.startswith(("  1. ", "  2. ", "  3. "))]
    assert heads[0] == 2 and len(heads) == 3
    text = " ".join(" ".join(lines).split())
    for k, one in enumerate(ranking[:3], 1):
        assert f"{k}. {one.sentence()}" in text
    times = [one.times for one in ranking if one.times is not None]
    assert times == sorted(times) and times[0] > 1


def test_noise_over_the_carry_is_the_integral_of_its_correlation() -> None:
    scene = pb.load_scene("paper", {"robot.bias_m_s": 0.002, "robot.left.noise_m_s": 0.02})
    times = [0.1 * k for k in range(250)]  # the carry takes 25 s
    weight = sum(0.01 * math.exp(-abs(s - t) / 0.5) for s in times for t in times)
    expected = math.sqrt((0.02**2 + 0.01**2) * weight)
    assert noise_over_carry_m(scene) == pytest.approx(expected, rel=0.02)
    apart = pb.load_scene(scene, {"robot.left.bias_m_s": -0.002})
    assert noise_over_carry_m(apart) - noise_over_carry_m(scene) == pytest.approx(0.004 * 25)


@pytest.mark.parametrize(
    ("key", "value", "quantity"),
    [
        ("robot.noise_m_s", 0.05, "contact"),
        ("palm.rate_deg_s", 400.0, "clearance"),
        ("task.slope_deg", 2.0, "slope"),
        ("object.mass_kg", 3.0, "mass"),
        ("object.com_m", [0.03, 0.04], "com"),
    ],
)
def test_margin_that_a_key_uses_up_comes_first(key: str, value: object, quantity: str) -> None:
    first = pb.analyze("paper", overrides={key: value}).ranking[0]
    assert first.quantity == quantity
    assert first.times is not None and first.times < 1
