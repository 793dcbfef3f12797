# SPDX-License-Identifier: Apache-2.0
"""After a drop, or a start by touch that failed: one line if the scene lacks a property that the
robots need, else none."""

import json
import re
import shlex
from pathlib import Path

import pytest

import palmbots as pb
from palmbots.cli import main as cli
from palmbots.stability.drop_hints import missing_properties

OFF_CENTRE = "object.com_m=[0.05,0.04]"
HINT = ", even with contacts inside the zero zone; run: "
LONG = ("palm.length_m=0.36", "palm.steep_deg=50")  # that the object cannot span them


def carried(capsys: pytest.CaptureFixture[str], *words: str, outcome: str = "DROPPED") -> list[str]:
    """What a carry's report says of missing properties: a wrapped sentence and a whole command."""
    status = cli.run(["carry", "--seeds", "1", *words])
    output = capsys.readouterr().out
    assert f"\n{outcome} " in f"\n{output}", output
    assert status == (0 if outcome == "DELIVERED" else 1)
    lines = output.splitlines()
    assert all(len(line) <= 80 for line in lines if not line.startswith("  run: "))
    return [
        " ".join(" ".join(lines[2:k]).split()) + "; " + line.strip()
        for k, line in enumerate(lines)
        if line.startswith("  run: palmbots analyze ")
    ]


@pytest.mark.parametrize(
    ("words", "lacks"),
    [
        ((OFF_CENTRE,), "property 1"),
        (("palm.friction=0.02",), "properties 0, 1 and 2"),
        ((OFF_CENTRE, *LONG), "properties 0, 1 and 2"),  # analyze refuses palms that long
        ((OFF_CENTRE, "tactile.zones=[]"), "property 1"),  # no edge of the zone: the palm's end
    ],
)
def test_drop_prints_the_command_that_reports_the_reason(
    words: tuple[str, ...], lacks: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The printed command reports the same properties."""
    keys = [word for key in words for word in ("--set", key)]
    (line,) = carried(capsys, *keys, "--set", "task.distance_m=30.0")
    verb = "do" if "properties" in lacks else "does"
    assert f"{lacks} {verb} not hold{HINT}" in line
    command = shlex.split(line.split(HINT)[1])
    assert command[:2] == ["palmbots", "analyze"]
    assert cli.run([*command[1:], "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["properties"]
    fails = {n for n, sides in found.items() if not all(s["holds"] for s in sides.values())}
    assert {("turning", "closing", "opening")[int(n)] for n in re.findall(r"\d", lacks)} <= fails


def test_hint_covers_the_mujoco_world_but_no_curved_path(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """`analyze` refuses a curved path, so no hint may name it."""
    words = ("--world", "mujoco", "--set", OFF_CENTRE, "--set", "robot.left.bias_m_s=0.06")
    (line,) = carried(capsys, *words)
    assert "property 1" in line
    arc = ("--set", "task.path.kind=arc", "--set", "task.path.radius_m=3")
    assert carried(capsys, *words, *arc, "--allow-drift-beyond-budget") == []


@pytest.mark.parametrize(
    "words",
    [
        ("--set", "robot.noise_m_s=0.06"),  # nothing but noise
        ("-c", "none", "--set", "robot.left.bias_m_s=0.02"),
        ("-c", "none", "--set", "robot.left.bias_m_s=0.02", "--set", OFF_CENTRE),  # turns no palm
    ],
)
def test_drop_without_a_missing_property_prints_no_hint(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert carried(capsys, *words) == []


def test_scene_that_the_analysis_refuses_has_no_hint(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Palms so long that the object cannot span them, and no smaller zone."""
    keys = (OFF_CENTRE, *LONG, "tactile.zones=[]", "task.distance_m=6.0")
    words = [word for key in keys for word in ("--set", key)]
    assert carried(capsys, *words, "--seed", "5") == []
    assert cli.run(["analyze", *words]) == 2


def test_delivery_and_json_have_no_hint(capsys: pytest.CaptureFixture[str]) -> None:
    far_off = ("--set", "object.com_m=[0.01,0.04]")
    assert missing_properties(pb.load_scene("paper", {"object.com_m": [0.01, 0.04]}), "distributed")
    assert carried(capsys, *far_off, outcome="DELIVERED") == []
    assert cli.run(["carry", "--json", "--set", OFF_CENTRE]) == 1
    output = capsys.readouterr()
    assert json.loads(output.out)["outcome"] == "dropped"
    assert HINT not in output.err


def test_controller_none_needs_two_steep_palms_only() -> None:
    """Held between two steep palms, but not while one of them turns, and not held at all."""
    held = pb.load_scene("paper", {"palm.steep_deg": 60.0})
    assert pb.contact_modes(held).closing is not None
    assert missing_properties(held, "distributed") == (0, 1, 2)
    assert missing_properties(held, "none") == ()
    loose = pb.load_scene("paper", {"palm.left.steep_deg": 60.0})
    assert pb.contact_modes(loose).feasible == ()
    assert missing_properties(loose, "none") == (0,)


def test_scene_file_with_blanks_is_quoted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "my scene.toml"
    path.write_text("[object]\ncom_m = [0.05, 0.04]\n")
    (line,) = carried(capsys, str(path))
    assert shlex.quote(str(path)) in line


@pytest.mark.parametrize(
    ("words", "leader"),
    [
        (("object.com_m=[0.155,0.04]",), "right"),
        (("object.com_m=[0.095,0.04]", 'task.direction="backward"'), "left"),
        (("palm.left.friction=0.2", "palm.right.friction=0.4"), "right"),
    ],
)
def test_failed_start_by_touch_prints_why_the_leader_feels_nothing(
    words: tuple[str, ...], leader: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The printed command reports that property 1 fails with the leader's palm shallow."""
    keys = [word for key in words for word in ("--set", key)]
    start = ("-c", "silent", "--set", "control.start=touch")
    (line,) = carried(capsys, *start, *keys, outcome="STALLED")
    assert f"property 1 does not hold with the {leader} palm shallow" in line
    command = shlex.split(line.split("; run: ")[1])
    assert command[:2] == ["palmbots", "analyze"]
    assert cli.run([*command[1:], "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["properties"]["closing"]
    assert not found[leader]["holds"]


@pytest.mark.parametrize(
    "words",
    [
        ("-c", "silent", "--set", "control.start=touch", "--set", "task.timeout_s=5.0"),
        ("-c", "silent", "--set", OFF_CENTRE, "--set", "task.timeout_s=1.0"),
        ("--set", "control.start=touch", "--set", OFF_CENTRE, "--set", "task.timeout_s=1.0"),
    ],
)
def test_stall_for_another_reason_prints_no_hint(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    """The leader feels the start; both start together; the controller has no start by touch."""
    assert carried(capsys, *words, outcome="STALLED") == []


@pytest.mark.parametrize("scene", ["handover", "lone"])
def test_no_property_is_missing_where_one_palm_holds_the_object(scene: str) -> None:
    """Two palms at this angle would not hold it."""
    assert missing_properties(pb.load_scene(scene, {"palm.steep_deg": 60}), "shared-sign") == ()
