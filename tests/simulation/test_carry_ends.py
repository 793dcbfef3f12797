# SPDX-License-Identifier: Apache-2.0
"""What ends a carry: the table of the core, cell by cell, in carries, jobs and by hand."""

import json
import math
from typing import Any

import pytest

import palmbots as pb
import palmbots._core as _core
from commands import Run
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import FloorWorld
from palmbots.simulation.carry_ends import PHASES, ends_in, reason_text
from palmbots.simulation.floor_job import MEANINGS, TASK_PHASES
from random_lifts import random_lift

ENDS, GOES_ON, STALLS, NEVER = "ends", "goes on", "wheels stall", "–"
FELL, TOPPLED = "falls, or fell", "falls, or toppled"
TABLE = {  # placed, held, low, by hand
    "off-palm": (ENDS, ENDS, GOES_ON, GOES_ON),
    "sliding": (ENDS, ENDS, FELL, FELL),
    "flush": (ENDS, GOES_ON, GOES_ON, GOES_ON),
    "tip": (ENDS, GOES_ON, GOES_ON, GOES_ON),
    "tipping": (ENDS, ENDS, TOPPLED, TOPPLED),
    "jammed": (NEVER, ENDS, STALLS, ENDS),
    "lifting": (NEVER, ENDS, GOES_ON, GOES_ON),
    "robot tipped": (NEVER, ENDS, ENDS, NEVER),
    "fell": (NEVER, NEVER, NEVER, NEVER),
    "toppled": (NEVER, NEVER, NEVER, NEVER),
}


def test_the_table() -> None:
    assert {end.name: tuple(end.follows.values()) for end in pb.ends().ends} == TABLE
    assert set(TASK_PHASES) == set(MEANINGS) and set(TASK_PHASES.values()) == {"low", "carried"}


def test_the_command_lists_the_table(here: Run) -> None:
    found = json.loads(here("ends", "--json").stdout)
    assert found["phases"] == PHASES
    assert {row["name"]: tuple(row["follows"].values()) for row in found["ends"]} == TABLE
    text = " ".join(here("ends").stdout.split())
    assert all(f"{end.name}: {end.meaning}" in text for end in pb.ends().ends)
    assert all(f" {what} " in text for what in ("wheels stall", "falls, or NAME", "–"))


def test_words_for_people() -> None:
    assert reason_text("toppled", "mujoco") == "toppled: the object turned by more than 60°"
    assert reason_text("fell", "mujoco") == reason_text("fell", "quasistatic")
    assert reason_text("", "mujoco") == ""


# --- carries --------------------------------------------------------------------------------------


def with_keel(x_m: tuple[float, float], low_m: float) -> dict[str, Any]:
    """A box with a keel below its bottom."""
    near, far = x_m
    keel = [[0, 0], [near, 0], [near, -low_m], [far, -low_m], [far, 0], [0.25, 0]]
    return {
        "object.vertices_m": [*keel, [0.25, 0.16], [0, 0.16]],
        "object.contacts": [0, 5],
        "task.distance_m": 0.6,
    }


def bump(robot: str, shift_m: float) -> dict[str, Any]:
    script = [{"robot": robot, "at_s": 0.5, "shift_m": shift_m}]
    return {"bumps.script": script, "robot.noise_m_s": 0.0}


WEDGE = {
    "object.vertices_m": [[0, 0], [0.125, -0.02], [0.25, 0], [0.25, 0.08], [0, 0.08]],
    "object.contacts": [0, 2],
}
TALL = {
    "object.vertices_m": [[0, 0], [0.25, 0], [0.25, 0.5], [0, 0.5]],
    "object.com_m": [0.01, 0.3],
    "palm.friction": 0.5,
    "palm.length_m": 0.24,
}
PLACED: dict[str, tuple[str, dict[str, Any], float]] = {  # controller, keys, end [s]
    "off-palm": ("none", bump("right", 0.1), 0.5),
    "sliding": (
        "none",
        {"palm.friction": 0.1, "palm.steep_deg": 10, "object.com_m": [0.03, 0.04]},
        0.0,
    ),
    "flush": ("none", WEDGE | {"palm.steep_deg": 10} | bump("left", -0.0415), 0.5),
    "tip": ("none", with_keel((0.066, 0.1), 0.0755) | {"palm.length_m": 0.161}, 0.0),
    "tipping": ("none", TALL | bump("right", 0.05), 0.5),
}
HELD: dict[str, tuple[str, dict[str, Any]]] = {
    "off-palm": ("none", {"robot.noise_m_s": 0.1}),
    "sliding": ("shared-sign", {"palm.friction": 0.05}),
    "tipping": (
        "centralized",
        {
            "robot.noise_m_s": 0.06,
            "palm.friction": 0.6,
            "palm.shallow_deg": 2,
            "palm.steep_deg": 30,
            "object.com_m": [0.01, 0.07],
        },
    ),
    "jammed": ("none", {"palm.heel_m": 0.012, "robot.noise_m_s": 0.08}),
    "lifting": (
        "shared-sign",
        WEDGE
        | {"palm.shallow_deg": 5, "palm.steep_deg": 10, "object.com_m": [0.03, 0.04]}
        | {"robot.noise_m_s": 0.0},
    ),
}


@pytest.mark.parametrize("event", PLACED)
def test_what_ends_a_carry_before_anything_moves(event: str) -> None:
    controller, keys, at_s = PLACED[event]
    carry = pb.carry("paper", controller, overrides=keys, record=False)
    assert TABLE[event][0] == ENDS
    assert (carry.outcome, carry.reason, carry.time_s) == ("dropped", event, at_s)
    assert f"{event}: " in str(carry)


@pytest.mark.parametrize("event", HELD)
def test_what_ends_a_carry_that_moves(event: str) -> None:
    controller, keys = HELD[event]
    carry = pb.carry("paper", controller, overrides=keys, record=False)
    assert TABLE[event][1] == ENDS
    assert (carry.outcome, carry.reason) == ("dropped", event) and carry.time_s > 0


@pytest.mark.parametrize(
    ("event", "controller", "keys"),
    [
        ("flush", "distributed", {"palm.shallow_deg": 0, "palm.length_m": 0.2}),
        ("tip", "none", with_keel((0.1, 0.15), 0.03) | {"robot.noise_m_s": 0.05}),
    ],
)
def test_a_carry_goes_on_with_further_contacts(
    event: str, controller: str, keys: dict[str, Any]
) -> None:
    found = []
    for seed in range(4):
        carry = pb.carry("paper", controller, seed=seed, overrides=keys, record=False)
        found += [one for one in carry.contact_events if one.kind == event]
        assert all(one.start_s < carry.time_s for one in found[-1:])
    assert TABLE[event][1] == GOES_ON and found


# --- jobs -----------------------------------------------------------------------------------------


def test_a_job_goes_on_where_contacts_leave_palms() -> None:
    """At its start both contact vertices are beside their palms; one palm touches first."""
    carry = pb.carry("lift", "shared-sign")
    assert carry.outcome == "delivered" and carry.trace is not None
    assert float(carry.trace["contact"][0].max()) < -0.075
    assert TABLE["off-palm"][2] == TABLE["lifting"][2] == GOES_ON


def job(seed: int, fall_m: float, **keys: Any) -> tuple[Any, set[str]]:
    """A random job, also one that the product would refuse, and the last phases of the task."""
    scene = load_scene("lift", random_lift(seed) | {"task.distance_m": 0.1} | keys)
    run = _core.run(
        to_spec(load_scene(scene, {"world.fall_m": fall_m})), "shared-sign", seed, "double", False
    )
    last = {robot: phase for robot, phase, *_ in run.phases}
    return run, {TASK_PHASES[phase] for phase in last.values()}


@pytest.mark.parametrize(("seed", "reason"), [(0, "fell"), (76, "toppled"), (98, "toppled")])
def test_a_low_object_falls_or_ends_the_job(seed: int, reason: str) -> None:
    assert any(TABLE[event][2] == f"falls, or {reason}" for event in ("sliding", "tipping"))
    run, phases = job(seed, 0.0)
    assert (run.outcome, run.reason, run.falls) == ("dropped", reason, [])
    assert "low" in phases
    longer, _ = job(seed, 1.0)
    time_s, height_m, _ = longer.falls[0]
    assert time_s == pytest.approx(run.time_s, abs=0.011) and height_m > 0
    assert longer.time_s > run.time_s


def test_the_report_of_a_job_that_fell() -> None:
    keys = {"robot.noise_m_s": 0.0, "object.edge_radius_m": 0.001, "world.fall_m": 0.0}
    carry = pb.carry("lift", "shared-sign", overrides=keys, record=False)
    assert carry.floor_job is not None and carry.reason == "fell"
    lines = [line.strip() for line in str(carry).splitlines()]
    assert lines[1:3] == ["did not get away from the object", reason_text("fell", "quasistatic")]


@pytest.mark.parametrize(
    ("seed", "reason", "keys"),
    [
        (39, "sliding", {}),
        (56, "lifting", {}),
        (17, "off-palm", {}),
        (3, "jammed", {"object.com_m": [0.05, 0.1]}),
    ],
)
def test_in_the_air_a_job_ends_as_a_carry_does(
    seed: int, reason: str, keys: dict[str, Any]
) -> None:
    run, phases = job(seed, 0.0, **{"robot.noise_m_s": 0.06, "task.distance_m": 1.0} | keys)
    assert phases == {"carried"}
    assert (run.outcome, run.reason, TABLE[reason][1]) == ("dropped", reason, ENDS)


def test_wheels_stall_where_nothing_can_move() -> None:
    """The same by hand ends the motion."""
    run, _ = job(33, 0.0)
    assert min(run.stalled_s) > 0 and run.reason == "fell"
    assert TABLE["jammed"][2] == STALLS
    plate = {"object.edge_radius_m": 0.003, "palm.thickness_m": 0.0003, "palm.heel_m": 0.012}
    world = FloorWorld(overrides=plate)
    assert world.move(0.18, -0.18).end == "jammed"
    assert TABLE["jammed"][3] == ENDS


# --- by hand --------------------------------------------------------------------------------------


def low_wall() -> FloorWorld:
    box = {"object.box_m": [0.12, 0.1], "object.edge_radius_m": 0.003}
    wall = {"floor.walls": [{"at_m": 0.08, "height_m": 0.03, "friction": 0.3}]}
    return FloorWorld("plate", palms_deg=(8, 15), gaps_m=(0.01, None), overrides=box | wall)


def test_by_hand_an_object_may_touch_one_palm_and_lie_flush() -> None:
    world = low_wall()
    state = world.move(0.15)
    assert not state.end and state.touched_m.right is None
    assert len(world.contact_modes(0.01).contacts) >= 3 and state.tilt_deg == pytest.approx(-8)
    assert not world.move(up_m=(0.02, 0)).end  # the bottom lies on the palm
    for event in ("flush", "tip", "off-palm", "lifting"):
        assert TABLE[event][3] == GOES_ON


def small_fall(radius_m: float, fall_m: float) -> tuple[str, list[float]]:
    """The right corner comes down from its nose while the left one is on a palm at 8°."""
    keys = {"object.edge_radius_m": radius_m, "world.fall_m": fall_m}
    world = FloorWorld("lift", overrides=keys)
    world.move(0.085, -0.085)
    world.move(palms_deg=(8, 15), follow_floor=True)
    state = world.move(-0.045, 0.045)
    return state.end, [fall.height_m for fall in state.falls]


@pytest.mark.parametrize("radius_m", [0.0005, 0.001])
def test_by_hand_an_object_falls_a_little(radius_m: float) -> None:
    """By what the other corner does not resist: r (1 − cos(φ + φ' + θ')) of the nose's height. It
    falls only if `world.fall_m` permits the part that friction does not slow."""
    end, (height,) = small_fall(radius_m, 0.003)
    lean = 1 - math.cos(2 * math.atan(0.3) + math.radians(8))
    nose = 0.0003 * math.cos(math.radians(15))
    assert end == "" and height == pytest.approx(nose - radius_m * lean, abs=0.1 * nose)
    assert small_fall(radius_m, 0.5 * height) == ("", [height])
    assert small_fall(radius_m, 0.03 * height) == ("fell", [])
    assert TABLE["sliding"][3] == FELL


def test_by_hand_an_object_topples_at_the_edge_of_a_stand() -> None:
    stand = {"floor.stands": [{"from_m": -0.4, "to_m": 0.1, "height_m": 0.1}]}
    world = FloorWorld("plate", palms_deg=(0, 0), gaps_m=(0.01, None), overrides=stand)
    assert world.move(0.3).end == "toppled" and TABLE["tipping"][3] == TOPPLED


@pytest.mark.parametrize("radius_m", [0.0, 0.0005])
@pytest.mark.parametrize("thickness_m", [0.003, 0.006])
def test_by_hand_a_flush_object_between_two_noses_is_jammed(
    radius_m: float, thickness_m: float
) -> None:
    """Level noses press against its sides, above the arcs, while its bottom lies flush."""
    keys = {
        "palm.thickness_m": thickness_m,
        "palm.nose_m": thickness_m,
        "palm.bevel_m": 0.0,
        "object.box_m": [0.12, 0.1],
        "object.edge_radius_m": radius_m,
    }
    world = FloorWorld("plate", palms_deg=(0, 0), gaps_m=(0.001, 0.01), overrides=keys)
    assert not world.move(0.005, 0.0).end  # the left nose pushes the object
    assert world.move(0.002, -0.02).end == "jammed" and TABLE["jammed"][3] == ENDS


# --- MuJoCo ---------------------------------------------------------------------------------------
# --- MuJoCo ---------------------------------------------------------------------------------------


def test_mujoco_asks_the_table() -> None:
    """What the worlds in MuJoCo notice, and what follows in the two phases that they know."""
    events = ("robot tipped", "off-palm", "tipping", "lifting")
    carried, low = ends_in("carried"), ends_in("low")
    assert [carried.get(event) for event in events] == list(events)
    assert [low.get(event) for event in events] == ["robot tipped", None, "toppled", None]
