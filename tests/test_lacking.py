"""After a drop: one line where the scene lacks what the algorithms need, and none elsewhere."""

import json
import re
import shlex
from pathlib import Path

import pytest

import palmbots as pb
from palmbots import cli
from palmbots.stability.lacking import lacking

OFF_CENTRE = "object.com_m=[0.05,0.04]"


def carried(capsys: pytest.CaptureFixture[str], *words: str, outcome: str = "DROPPED") -> list[str]:
    """The lines of a carry's report that tell what the scene lacks."""
    status = cli.run(["carry", *words])
    said = capsys.readouterr().out
    assert f"\n{outcome} " in f"\n{said}", said
    assert status == (1 if outcome == "DROPPED" else 0)
    return [line for line in said.splitlines() if line.endswith(" tells more")]


@pytest.mark.parametrize(
    ("words", "lacks"),
    [
        ((OFF_CENTRE,), "property 1"),
        (("palm.friction=0.02",), "properties 0, 1 and 2"),
        ((OFF_CENTRE, "palm.length_m=1.0"), "property 1"),  # analyze refuses palms that long
        ((OFF_CENTRE, "tactile.zones=[]"), "property 1"),  # no edge of the zone: the palm's end
    ],
)
def test_a_drop_names_the_command_that_knows_why(
    words: tuple[str, ...], lacks: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """And that command says so."""
    keys = [word for key in words for word in ("--set", key)]
    (line,) = carried(capsys, *keys, "--set", "task.distance_m=30.0")
    assert line.startswith(f"  the scene does not have {lacks}, ")
    command = shlex.split(line.split(": ", 1)[1].removesuffix(" tells more"))
    assert command[:2] == ["palmbots", "analyze"]
    assert cli.run([*command[1:], "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["properties"]
    fails = {n for n, sides in found.items() if not all(s["holds"] for s in sides.values())}
    assert set(re.findall(r"\d", lacks)) <= fails


def test_it_is_told_of_the_dynamic_world_and_of_no_curved_path(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """`analyze` refuses a curved path: nothing may point there."""
    words = ("--world", "mujoco", "--set", OFF_CENTRE, "--set", "robot.left.bias_m_s=0.06")
    (line,) = carried(capsys, *words)
    assert "property 1" in line
    arc = ("--set", "task.path.kind=arc", "--set", "task.path.radius_m=3")
    assert carried(capsys, *words, *arc, "--beyond-budget") == []


@pytest.mark.parametrize(
    "words",
    [
        ("--set", "robot.noise_m_s=0.06"),  # nothing but noise
        ("-c", "none", "--set", "robot.left.bias_m_s=0.02"),
        ("-c", "none", "--set", "robot.left.bias_m_s=0.02", "--set", OFF_CENTRE),  # turns no palm
    ],
)
def test_a_drop_of_a_scene_that_lacks_nothing_says_nothing(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert carried(capsys, *words) == []


def test_nothing_is_said_of_a_scene_that_the_analysis_refuses(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Palms so long that the object cannot reach across them, and no zone that is smaller."""
    keys = (OFF_CENTRE, "palm.length_m=1.0", "tactile.zones=[]", "task.distance_m=100.0")
    words = [word for key in keys for word in ("--set", key)]
    assert carried(capsys, *words) == []
    assert cli.run(["analyze", *words]) == 2


def test_nothing_is_said_of_a_delivery_nor_in_json(capsys: pytest.CaptureFixture[str]) -> None:
    far_off = ("--set", "object.com_m=[0.01,0.04]")
    assert lacking(pb.load_scene("paper", {"object.com_m": [0.01, 0.04]}), "distributed")
    assert carried(capsys, *far_off, outcome="DELIVERED") == []
    assert cli.run(["carry", "--json", "--set", OFF_CENTRE]) == 1
    said = capsys.readouterr()
    assert json.loads(said.out)["outcome"] == "dropped"
    assert "tells more" not in said.err


def test_steep_palms_alone_are_asked_of_a_carry_that_turns_none() -> None:
    """Held between two steep palms, but not while one of them turns, and not held at all."""
    held = pb.load_scene("paper", {"palm.steep_deg": 60.0})
    assert pb.modes(held).closing is not None
    assert lacking(held, "distributed") == (0, 1, 2)
    assert lacking(held, "none") == ()
    loose = pb.load_scene("paper", {"palm.left.steep_deg": 60.0})
    assert pb.modes(loose).feasible == ()
    assert lacking(loose, "none") == (0,)


def test_a_scene_file_with_blanks_is_quoted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "my scene.toml"
    path.write_text("[object]\ncom_m = [0.05, 0.04]\n")
    (line,) = carried(capsys, str(path))
    assert shlex.quote(str(path)) in line
