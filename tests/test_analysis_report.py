"""What `palmbots analyze` and `design` print: no line contradicts another one."""

import math
import re

import pytest

import palmbots as pb
from palmbots import cli


def told(capsys: pytest.CaptureFixture[str], *words: str) -> list[str]:
    """The lines that a command prints; it exits with 0."""
    assert cli.run(list(words)) == 0
    return capsys.readouterr().out.splitlines()


def row(lines: list[str], name: str) -> str:
    (found,) = [line for line in lines if line.strip().startswith(name)]
    return found.strip().removeprefix(name).strip()


@pytest.mark.parametrize(
    ("key", "word"),
    [
        ("palm.shallow_deg=5", "HOLDS"),
        ("palm.shallow_deg=-6", "TOUCHES"),  # both properties hold, with a palm in the object
        ("object.com_m=[0.05,0.04]", "FAILS"),
    ],
)
def test_the_headline_is_the_whole_verdict(
    key: str, word: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit status 0 either way, as documented."""
    lines = told(capsys, "analyze", "--set", key)
    assert lines[0].split()[0] == word
    below = "\n".join(lines[1:])
    assert ("TOUCHES" in below) == (word == "TOUCHES")
    assert ("FAILS" in below) == (word == "FAILS")


def test_an_angle_error_says_what_clearance_leaves_of_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A palm that is wrong by 3° is in the paper's box long before a property fails."""
    lines = told(capsys, "analyze")
    least = math.degrees(pb.analyze("paper").clearance.turn.margin)
    assert row(lines, "angle error").endswith(f"touches after a turn of {least:.2f}°")
    touching = told(capsys, "analyze", "--set", "palm.shallow_deg=0")
    assert row(touching, "angle error").endswith("a palm touches already")
    roomy = {"palm.shallow_deg": 9.0, "palm.steep_deg": 14.0}  # clear for longer than it holds
    found = pb.analyze("paper", overrides=roomy)
    assert found.angle_error_rad is not None
    assert found.clearance.turn.margin > found.angle_error_rad
    keys = [word for key, value in roomy.items() for word in ("--set", f"{key}={value}")]
    assert re.fullmatch(r"±[\d.]+°", row(told(capsys, "analyze", *keys), "angle error"))


@pytest.mark.parametrize(
    "words",
    [
        ("analyze", "--set", "object=plank"),
        ("design", "--maximize", "friction", "--resolution-deg", "1"),
    ],
)
def test_friction_that_no_scene_accepts_is_told_with_its_limit(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    """Scenes themselves say where the limit is."""
    lines = told(capsys, *words)
    name = "friction, both palms" if words[0] == "analyze" else "friction "
    match = re.match(
        r"[\d.]+ to ([\d.]+).*, but a scene takes less than ([\d.]+) with a palm at ([\d.]+)°",
        row(lines, name),
    )
    assert match is not None, lines
    most, limit, steep_deg = map(float, match.groups())
    assert most > limit
    palm = {"palm.steep_deg": steep_deg, "palm.shallow_deg": 0.0}
    pb.load_scene("paper", palm | {"palm.friction": limit - 0.001})
    for friction in (limit + 0.001, most):
        with pytest.raises(pb.SceneError, match="allowed: less than"):
            pb.load_scene("paper", palm | {"palm.friction": friction})


def test_friction_within_the_limit_is_told_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert row(told(capsys, "analyze"), "friction, both palms") == "0.094 to 1.046"
