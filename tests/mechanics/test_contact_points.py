# SPDX-License-Identifier: Apache-2.0
"""Contacts of a state: flush edges, tips, further vertices, overlap; and what `modes` adds then."""

import json
import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from contact_scripts import SHARP
from palmbots.cli import main as cli
from palmbots.errors import PalmbotsError
from palmbots.mechanics.contact_points import Contact, touching
from palmbots.mechanics.state import palm_state
from palmbots.scene.placement import place
from palmbots.scene.scene import Scene

W = 0.25
# A box on two pointed feet, whose bottom an inner tip can meet; one with a lid, for an outer tip.
POINTED = [[0, 0], [0.02, 0.02], [0.23, 0.02], [0.25, 0], [0.25, 0.16], [0, 0.16]]
LID = [[0, 0], [0.25, 0], [0.25, 0.02], [0.35, 0.02], [0.35, 0.1], [-0.1, 0.1], [-0.1, 0.02], [0, 0.02]]  # fmt: skip  # noqa: E501
FOOTED = {"object": {"vertices_m": POINTED, "contacts": [0, 3], "com_m": [0.125, 0.06]}}
LIDDED = {"object": {"vertices_m": LID, "com_m": [0.125, 0.05]}}


def found(scene: Any = "paper", **state: Any) -> list[tuple[str, str, float]]:
    return [(c.side, c.kind, round(c.place_m, 6)) for c in pb.contacts(scene, **state)]


VERTICES = [("left", "vertex", 0.0), ("right", "vertex", 0.0)]


@pytest.mark.parametrize("name", SHARP)
def test_nominal_state_has_two_vertex_contacts(name: str) -> None:
    for left, right in ((15, 15), (5, 15), (15, 5), (5, 5)):
        scene = {"object": name}
        assert found(scene, theta_left_deg=left, theta_right_deg=right) == VERTICES


def test_points_are_in_the_object_frame() -> None:
    there = pb.contacts("paper", p_left_m=0.01, p_right_m=-0.02)
    assert there == [
        Contact("left", "vertex", 0.01, (0.0, 0.0)),
        Contact("right", "vertex", -0.02, (W, 0.0)),
    ]


def test_box_lies_flush_on_a_level_palm() -> None:
    """From the vertex to the inner tip, which lies before the middle of the box."""
    there = pb.contacts("paper", theta_left_deg=0, p_left_m=0.02, theta_right_deg=15)
    assert [(c.side, c.kind) for c in there] == [
        ("left", "flush"),
        ("left", "flush"),
        ("right", "vertex"),
    ]
    assert [c.place_m for c in there[:2]] == pytest.approx([0.02, -0.075])
    assert there[1].point_m == pytest.approx((0.095, 0.0))
    both = found(theta_left_deg=0, theta_right_deg=0)
    flush = [("flush", 0.0), ("flush", -0.075)]
    assert both == [(s, *f) for s in ("left", "right") for f in flush]


def test_tilted_box_lies_flush_on_a_tilted_palm() -> None:
    """At 5° left, the right contact is lower by sin 5° × w, to the precision of a typed number."""
    p_right = -W * math.sin(math.radians(5)) / math.sin(math.radians(30))
    state = {"theta_left_deg": 5, "theta_right_deg": 30, "p_right_m": round(p_right, 6)}
    assert [kind for _, kind, _ in found(**state)] == ["flush", "flush", "vertex"]
    state["p_right_m"] = p_right + 0.001
    assert [kind for _, kind, _ in found(**state)] == ["vertex", "vertex"]


def test_short_edge_lies_on_the_palm_as_a_whole() -> None:
    there = found({"object": "box-strips"}, theta_left_deg=0)
    assert there[:2] == [("left", "flush", 0.0), ("left", "flush", -0.01)]
    long = {"object": "box-strips", "palm": {"length_m": 0.6}}
    # One palm under both strips: only the outermost contacts count.
    there = found(long, theta_left_deg=0, theta_right_deg=15)
    assert there[:2] == [("left", "flush", 0.0), ("left", "flush", -W)]


def test_side_of_a_trapezoid_lies_flush_on_an_equally_steep_palm() -> None:
    steep = math.degrees(math.atan2(0.12, 0.08))
    there = found({"object": "trapezoid"}, theta_left_deg=steep, theta_right_deg=15)
    assert there == [("left", "flush", 0.0), ("left", "flush", 0.075), ("right", "vertex", 0.0)]


def test_tray_and_plank_on_level_palms() -> None:
    for name, width in (("tray", 0.3), ("plank", 0.6)):
        there = pb.contacts({"object": name}, theta_left_deg=0, theta_right_deg=0)
        points = [c.point_m[0] for c in there]
        assert points == pytest.approx([0.0, 0.075, width, width - 0.075])


def test_tips_have_the_normal_of_the_edge() -> None:
    inner = -math.degrees(math.asin(0.02 / 0.075))
    there = pb.contacts(FOOTED, theta_left_deg=inner, theta_right_deg=15)
    assert [(c.side, c.kind) for c in there] == [
        ("left", "vertex"),
        ("left", "tip"),
        ("right", "vertex"),
    ]
    assert there[1].place_m == -0.075
    assert there[1].point_m == pytest.approx((math.sqrt(0.075**2 - 0.02**2), 0.02))
    outer = -inner
    there = pb.contacts(LIDDED, theta_left_deg=outer, theta_right_deg=5)
    assert (there[1].kind, there[1].place_m) == ("tip", 0.075)
    assert there[1].point_m == pytest.approx((-math.sqrt(0.075**2 - 0.02**2), 0.02))
    for scene, angle in ((FOOTED, inner), (LIDDED, outer)):
        state = palm_state(scene, 0.0, 0.0, angle, 5.0)
        _, _, _, nx, ny, _ = touching(state).supports[1]
        assert (nx, ny) == pytest.approx((0.0, 1.0), abs=1e-12)


@pytest.mark.parametrize(("between", "kind"), [([], "flush"), ([[0.03, 0.01]], "vertex")])
def test_keel_on_a_palm_that_rises_inward(between: list, kind: str) -> None:
    """It stands on the palm alone, or ends a flush edge from the contact vertex."""
    outline = [[0, 0], *between, [0.06, -0.01], [0.25, 0], [0.25, 0.1], [0, 0.1]]
    contacts = [0, 2 + len(between)]
    scene = {"object": {"vertices_m": outline, "contacts": contacts, "com_m": [0.125, 0.05]}}
    there = found(scene, theta_left_deg=math.degrees(math.atan2(0.01, 0.06)))
    keel = -round(math.hypot(0.06, 0.01), 6)
    assert there == [("left", kind, 0.0), ("left", kind, keel), ("right", "vertex", 0.0)]


def world(scene: Scene, state: dict) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the palms (2 palms, 2 ends, 2) and outline (n, 2), from the geometry of the
    figures."""
    at = palm_state(scene, state["p_left_m"], state["p_right_m"], *state["theta"])
    theta = at.theta_rad
    offset = [side.offset for side in at.spec.palms]
    # The separation at which the object fits: width between the contacts, horizontally.
    gap = sum(
        p * math.cos(t) - o * math.sin(t) for p, t, o in zip(at.p_m, theta, offset, strict=True)
    )
    separation = at.spec.width * math.cos(at.object_rad) - gap
    placed = place(
        at.spec,
        separation=[separation],
        midpoint=[0.0],
        palm=[theta],
        contact=[at.p_m],
        turn=[at.object_rad],
    )
    return np.stack([placed.palm_inner[0], placed.palm_outer[0]], axis=1), placed.outline[0]


def from_edges(points: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Distance of points from the boundary of a polygon."""
    least = np.full(len(points), np.inf)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        t = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        least = np.minimum(least, np.linalg.norm(points - a - t[:, None] * (b - a), axis=1))
    return least


def are_inside(points: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Which of the points a polygon contains, by crossings; for points that are not near its
    edges."""
    (x, y), (ax, ay), (bx, by) = points.T[..., None], outline.T, np.roll(outline, -1, axis=0).T
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = x < ax + (y - ay) / (by - ay) * (bx - ax)
    return np.sum(((ay > y) != (by > y)) & crossing, axis=1) % 2 == 1


def random_state(rng: np.random.Generator) -> tuple[Scene, dict]:
    values = [{"object": name} for name in SHARP] + [FOOTED, LIDDED]
    scene = pb.load_scene(values[int(rng.integers(len(values)))])
    offset = float(rng.choice([0.0, 0.01]))
    state = {
        "p_left_m": float(rng.choice([0.0, rng.uniform(-0.075, 0.075)])),
        "p_right_m": float(rng.choice([0.0, rng.uniform(-0.075, 0.075)])),
        "theta": [float(rng.choice([0.0, rng.uniform(-25, 40)])) for _ in range(2)],
    }
    return pb.load_scene(scene, {"palm.pivot_offset_m": offset}), state


def ask(scene: Scene, state: dict) -> list[Contact]:
    left, right = state["theta"]
    return pb.contacts(
        scene,
        p_left_m=state["p_left_m"],
        p_right_m=state["p_right_m"],
        theta_left_deg=left,
        theta_right_deg=right,
    )


def test_overlap_and_contacts_against_sampled_palms() -> None:
    """Contacts lie on palm and outline. States with a part of the palm inside the object are
    refused."""
    rng = np.random.default_rng(5)
    share = np.linspace(0, 1, 751)[:, None]
    seen = {"refused": 0, "flush": 0, "vertex": 0}
    for _ in range(150):
        scene, state = random_state(rng)
        palms, outline = world(scene, state)
        deepest = {"left": 0.0, "right": 0.0}
        for side, (inner, outer) in zip(deepest, palms, strict=True):
            samples = inner + share * (outer - inner)
            depths = from_edges(samples, outline)
            inside = (depths > 1e-6) & are_inside(samples, outline)
            deepest[side] = float(np.max(depths, where=inside, initial=0.0))
        try:
            there = ask(scene, state)
        except PalmbotsError as error:
            side = str(error).split(" palm inside")[0].split()[-1]
            assert deepest[side] > 0, (scene, state)
            seen["refused"] += 1
            continue
        assert max(deepest.values()) <= 1e-5, (scene.object, state)
        for contact in there:
            inner, outer = palms[("left", "right").index(contact.side)]
            half = scene.palm_of(contact.side).length_m / 2
            assert abs(contact.place_m) <= half
            on_palm = inner + (contact.place_m + half) / (2 * half) * (outer - inner)
            assert from_edges(on_palm[None], outline)[0] < 2e-5
            seen[contact.kind] += 1
    assert min(seen.values()) > 20, seen


def test_mirrored_state_gives_the_mirrored_result() -> None:
    rng = np.random.default_rng(7)
    compared = 0
    for _ in range(200):
        scene, state = random_state(rng)
        image = {
            "p_left_m": state["p_right_m"],
            "p_right_m": state["p_left_m"],
            "theta": state["theta"][::-1],
        }
        try:
            there = ask(scene, state)
        except PalmbotsError:
            with pytest.raises(PalmbotsError):
                ask(scene.mirrored(), image)
            continue
        back = ask(scene.mirrored(), image)
        other = {"left": "right", "right": "left"}
        assert sorted((other[c.side], c.kind, c.place_m) for c in back) == sorted(
            (c.side, c.kind, c.place_m) for c in there
        )
        compared += 1
    assert compared > 60


# --- What modes says ------------------------------------------------------------------------------


def test_modes_adds_nothing_with_two_contacts() -> None:
    result = pb.contact_modes("paper", theta_left_deg=5)
    assert result.held is None and result.motions_closing is None and result.motions_opening is None
    summary = result.summary()
    assert [c["kind"] for c in summary["contacts"]] == ["vertex", "vertex"]
    assert {summary[key] for key in ("held", "motions_closing", "motions_opening")} == {None}


def test_flush_box_slides_when_closing_and_pivots_on_the_tip_when_opening() -> None:
    result = pb.contact_modes("paper", theta_left_deg=0)
    assert result.held
    assert result.motions_closing == (("SL", "SL", "ST"),)
    # Opening, the right vertex slides down its slope, and the box pivots on the left palm's tip.
    assert result.motions_opening == (("BR", "ST", "SL"),)


def test_level_palms_close_to_either_side() -> None:
    """Forces are not determined there: either palm may slide, or both."""
    result = pb.contact_modes("paper", theta_left_deg=0, theta_right_deg=0)
    assert result.motions_closing is not None and result.motions_opening is not None
    slide = [("ST", "ST", "SR", "SR"), ("SL", "SL", "ST", "ST"), ("SL", "SL", "SR", "SR")]
    assert sorted(result.motions_closing) == sorted(slide)
    assert len(result.motions_opening) == 3


def test_flush_contact_holds_where_a_vertex_does_not() -> None:
    state: dict[str, Any] = {"theta_left_deg": 0, "overrides": {"palm.friction": 0.1}}
    result = pb.contact_modes("paper", **state)
    assert not result.feasible and result.held


def test_mirrored_motions() -> None:
    swap = {"ST": "ST", "SL": "SR", "SR": "SL", "BR": "BR"}
    scene = pb.load_scene({"object": "l-shape"})
    there = pb.contact_modes(scene, theta_left_deg=0, p_left_m=0.01)
    back = pb.contact_modes(scene.mirrored(), theta_right_deg=0, p_right_m=0.01)
    for ours, image in (
        (there.motions_closing, back.motions_closing),
        (there.motions_opening, back.motions_opening),
    ):
        assert ours and image
        # Left first: vertex, tip, right vertex; in the mirror left vertex, right vertex, right tip.
        assert sorted(ours) == sorted((swap[b], swap[c], swap[a]) for a, b, c in image)


def test_motions_when_one_palm_turns() -> None:
    """From flush, tilting up lifts the vertex off the palm, tilting down the box off the tip."""
    at = touching(palm_state("paper", 0.0, 0.0, 0.0, 15.0))
    up, down = at.turning("left", up=True), at.turning("left", up=False)
    assert up and all(motion[0] == "BR" and motion[1] != "BR" for motion in up)
    assert down and all(motion[1] == "BR" and motion[0] != "BR" for motion in down)


def test_command_prints_contacts_and_motions(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(["contact-modes", "--theta-left-deg", "0", "--json"]) == cli.DONE
    summary = json.loads(capsys.readouterr().out)
    assert summary["held"] is True
    assert summary["motions_closing"] == [["SL", "SL", "ST"]]
    assert [c["side"] for c in summary["contacts"]] == ["left", "left", "right"]
    assert set(summary["contacts"][0]) == {"side", "kind", "place_m", "point_m"}

    assert cli.run(["contact-modes", "--theta-left-deg", "0"]) == cli.DONE
    result = capsys.readouterr().out
    assert result.startswith("HELD  with all 3 contacts sticking")
    rows = [line.split()[:3] for line in result.splitlines()]
    for k, motion in ((1, "SL"), (2, "SL")):
        assert ["left", str(k), motion] in rows
    opening = rows[[row[:1] for row in rows].index(["opening"]) :]
    assert [row[-1] if row[0] == "left" else row[1] for row in opening[1:4]] == ["BR", "ST", "SL"]
    assert "If only the two contact vertices touched the palms:" in result


def test_two_contacts_move_as_in_the_quasistatic_world() -> None:
    """A small step of the exact motion, driving or turning one palm, is one of the outcomes."""
    rng = np.random.default_rng(11)
    steep = math.radians(15)
    compared = 0
    for _ in range(150):
        p = rng.uniform(-0.03, 0.03, 2)
        overrides = {
            "start": {"left_m": p[0], "right_m": p[1]},
            "object.com_m": [rng.uniform(0.06, 0.19), rng.uniform(0.02, 0.1)],
            "palm.friction": rng.uniform(0.15, 0.6),
        }
        at = palm_state("paper", p[0], p[1], None, None, overrides)
        touched = touching(at)
        steps = [
            (touched.closing(), -1e-6, (steep, steep)),
            (touched.opening(), 1e-6, (steep, steep)),
            (touched.turning("left", up=True), 0.0, (steep - 1e-5, steep)),
            (touched.turning("right", up=True), 0.0, (steep, steep - 1e-5)),
            (touched.turning("left", up=False), 0.0, (steep + 1e-5, steep)),
            (touched.turning("right", up=False), 0.0, (steep, steep + 1e-5)),
        ]
        for outcomes, change, palms in steps:
            end, _, left, right, pieces = _core.World(at.spec).advance(change, palms)
            if end or pieces != 1 or not touched.held:
                continue
            names = ({0: "ST", 1: "SL", -1: "SR"}[left], {0: "ST", 1: "SR", -1: "SL"}[right])
            assert names in outcomes, (p, overrides, change, palms, outcomes)
            compared += 1
    assert compared > 500
