# SPDX-License-Identifier: Apache-2.0
"""The checker compares a certificate's box with itself, with its scene and with a given scene."""

import copy
import json
import re
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._core import crossing_edges
from palmbots.cli.main import run
from palmbots.stability.certificates.checker.outline_validity import crosses_itself
from palmbots.stability.certificates.checker.scene_comparison import _in_hull
from palmbots.stability.certificates.prover import certify

Data = dict[str, Any]
TRAY = {"object": "tray"}


@pytest.fixture(scope="module")
def certificate() -> Data:
    """The paper's box, with uncertain COM; properties only, since they do not use the outline."""
    data = certify("paper", claims=("property 1", "property 2"), com_x_m=(0.12, 0.13)).data
    return json.loads(json.dumps(data))


def write(data: Data, folder: Path) -> Path:
    path = folder / "certificate.json"
    path.write_text(json.dumps(data))
    return path


def _outline_of_another_object(data: Data) -> None:
    data["box"]["outline_m"] = certify(TRAY, claims=("property 1",)).data["box"]["outline_m"]


def _wide_keel(data: Data) -> None:
    """An outline drawn 1 m wide, with a keel of 0.4 m, for contacts 0.25 m apart."""
    data["box"]["outline_m"] = [
        ["0", "1", "0"],
        ["0.5", "0.5", "-0.4"],
        ["1", "0", "0"],
        ["0.5", "0.5", "0.2"],
    ]
    data["box"]["right_contact"] = 2


def _half_length(data: Data) -> None:
    data["box"]["half_length_m"]["left"] = ["0.001", "0.001"]


def _crossed(data: Data) -> None:
    vertices = data["box"]["outline_m"]
    vertices[2], vertices[3] = vertices[3], vertices[2]


def _contact_elsewhere(data: Data) -> None:
    data["box"]["outline_m"][0][1] = "0.26"


def _slit(data: Data) -> None:
    """A vertex on the edge between two others, reached from above."""
    data["box"]["outline_m"].insert(3, ["0.1", "0.15", "0"])


def _no_scene(data: Data) -> None:
    del data["scene"]


def _bad_scene(data: Data) -> None:
    data["scene"]["object"]["contacts"] = [0, 9]


def _taller_scene(data: Data) -> None:
    data["scene"]["object"]["vertices_m"][2] = [0.25, 0.17]


INCONSISTENT: list[tuple[Callable[[Data], None], str]] = [
    (_outline_of_another_object, "drawn 0.3 m wide, which is outside width_m"),
    (_wide_keel, "drawn 1 m wide, which is outside width_m, 0.25 to 0.25 m"),
    (_half_length, "contacts_m reaches 0.075 m .* half_length_m, 0.001 m"),
    (_crossed, "crosses or touches itself"),
    (_contact_elsewhere, "contact vertices of the outline are at different distances"),
    (_slit, "crosses or touches itself"),
    (_no_scene, "^scene is missing$"),
    (_bad_scene, "object.contacts"),
    (_taller_scene, "not the object of the certificate's scene"),
]


@pytest.mark.parametrize(
    ("change", "reason"), INCONSISTENT, ids=lambda c: getattr(c, "__name__", "")
)
def test_inconsistent_box_is_refused(
    change: Callable[[Data], None], reason: str, certificate: Data, tmp_path: Path
) -> None:
    assert pb.check(write(certificate, tmp_path)).valid
    changed = copy.deepcopy(certificate)
    change(changed)
    result = pb.check(write(changed, tmp_path))
    assert not result.valid
    assert re.search(reason, result.reason), result.reason


def test_box_and_scene_are_printed(
    certificate: Data, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(certificate, tmp_path)
    assert run(["check", str(path)]) == 0
    paper = capsys.readouterr().out
    for phrase in ("250 × 160 mm", "x 120 to 130 mm", "-75 to 75 mm", "5° and 15°"):
        assert phrase in paper
    # A certificate about another object, and one about a single state, print another box.
    tray = certify(TRAY, claims=("property 1",))
    tray.save(path)
    assert run(["check", str(path)]) == 0
    printed = capsys.readouterr().out
    assert "250 × 160 mm" not in printed
    assert "object.vertices_m" in printed
    certify("paper", region_m=(0, 0), claims=("property 1",)).save(path)
    assert pb.check(path).box_text["contacts"] == "0 mm"


def test_scene_of_the_user_must_be_in_the_box(
    certificate: Data, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(certificate, tmp_path)
    inside = pb.load_scene("paper", {"object.com_m": [0.1299, 0.04], "object.mass_kg": 3.0})
    assert pb.check(path, inside).valid
    for overrides, reason in (
        ({"object.com_m": [0.1301, 0.04]}, "the COM is at"),
        ({"palm.friction": 0.31}, "palm.friction is 0.31"),
        ({"palm.left.steep_deg": 14.0}, "palm.left.steep_deg is 14, but the parameter box has 15"),
        ({"palm.length_m": 0.16}, "palm.length_m is 0.16"),
        ({"palm.pivot_offset_m": 0.01}, "palm.pivot_offset_m"),
        ({"task.slope_deg": 1.0}, "task.slope_deg"),
        ({"object": "tray"}, "another object"),
    ):
        result = pb.check(path, pb.load_scene("paper", overrides))
        assert not result.valid
        assert reason in result.reason
    assert run(["check", str(path), "--scene", "paper"]) == 0
    file = tmp_path / "scene.toml"
    file.write_text("palm.friction = 0.4\n")
    capsys.readouterr()
    assert run(["check", str(path), "--scene", str(file), "--json"]) == 1
    assert "palm.friction is 0.4" in json.loads(capsys.readouterr().out)["reason"]
    with pytest.raises(pb.SceneError):
        pb.check(path, "no-such-scene")


def test_object_in_another_pose_of_its_coordinates_is_the_same_object(
    certificate: Data, tmp_path: Path
) -> None:
    """Vertices turned, shifted and listed clockwise describe the same outline."""
    turn = np.radians(25)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    points = np.array([(0, 0), (0.25, 0), (0.25, 0.16), (0, 0.16), (0.125, 0.04)]) @ rotation.T
    *vertices, com = (points + np.array((3, -1))).tolist()
    body = {"vertices_m": vertices[::-1], "contacts": [3, 2], "com_m": com}
    assert pb.check(write(certificate, tmp_path), {"object": body}).valid
    body["contacts"] = [2, 3]
    with pytest.raises(pb.SceneError):
        pb.check(write(certificate, tmp_path), {"object": body})


def test_scene_outside_its_own_box_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "certificate.json"
    certify("paper", friction=(0.35, 0.36), claims=("property 1",)).save(path)
    result = pb.check(path)
    assert result.valid
    assert result.outside == ("palm.friction is 0.3, but the parameter box has 0.35 to 0.36",)


def test_older_format_is_refused_with_both_versions(
    certificate: Data, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(certificate | {"format": "palmbots certificate 3"}, tmp_path)
    assert run(["check", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "has certificate format 3" in line
    assert "reads format 4" in line


def test_simple_polygons_are_those_of_the_scene_reader() -> None:
    rng = np.random.default_rng(5)
    counts = {True: 0, False: 0}
    for _ in range(400):
        points = rng.integers(0, 6, (int(rng.integers(3, 7)), 2)).tolist()
        crosses = crossing_edges([(float(x), float(y)) for x, y in points]) is not None
        exact = [(Fraction(x), Fraction(y)) for x, y in points]
        assert crosses_itself(exact) == crosses, points
        counts[crosses] += 1
    assert min(counts.values()) > 50


def test_hull_contains_the_combinations_of_its_corners() -> None:
    rng = np.random.default_rng(6)
    for count in (1, 2, 4, 7):
        corners = rng.integers(-20, 20, (count, 2))
        exact = [(Fraction(int(x), 10), Fraction(int(y), 10)) for x, y in corners]
        weights = rng.dirichlet(np.ones(count), 30)
        for x, y in weights @ corners / 10:
            point = (Fraction(float(x)), Fraction(float(y)))
            assert _in_hull(point, exact, Fraction(1, 10**9))
        for angle in np.linspace(0, 6, 20):
            way = np.array([np.cos(angle), np.sin(angle)])
            far = corners[np.argmax(corners @ way)] / 10 + 0.01 * way
            assert not _in_hull(
                (Fraction(float(far[0])), Fraction(float(far[1]))), exact, Fraction(1, 10**9)
            )
