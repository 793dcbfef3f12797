# SPDX-License-Identifier: Apache-2.0
"""Both robots without their world: with the quasistatic world they equal the carry, bit for bit."""

from itertools import product
from typing import Any

import pytest

import palmbots._core as _core
from palmbots.control.registry import shipped_names
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec

BUSY = load_scene(
    {
        "object": {"com_m": [0.118, 0.06]},
        "palm": {"pivot_offset_m": 0.01, "left": {"friction": 0.25}},
        "robot": {"noise_m_s": 0.012, "left": {"clock_ppm": 900.0}, "right": {"bias_m_s": 0.002}},
        "tactile": {"false_rate": 0.005},
        "radio": {"jitter_s": 0.04, "loss": 0.02, "duplicate": 0.1, "airtime_s": 0.001},
        "faults": {
            "random_reboots": 1,
            "script": [
                {"kind": "freeze", "robot": "left", "at_s": 2.0, "duration_s": 0.3},
                {
                    "kind": "intermittent",
                    "robot": "right",
                    "at_s": 8.0,
                    "duration_s": 1.0,
                    "probability": 0.2,
                },
                {"kind": "station-down", "at_s": 11.0, "duration_s": 0.2},
            ],
        },
        "task": {"slope_deg": 0.5, "direction": "backward"},
    }
)
FALLS = load_scene({"robot": {"noise_m_s": 0.03}})
CONTROLLERS = shipped_names()
RESULTS = (
    "outcome", "reason", "time_s", "distance_m", "contact_rms_m", "contact_peak_m", "corrections",
    "messages", "messages_lost", "links", "waiting_s", "waits_since_s", "message_log",
    "trace_hash",
)  # fmt: skip


def seen(world: Any, midpoint: float, motion: tuple[int, int], end: str, part: float) -> Any:
    return _core.WorldObservation(
        world.contacts, world.lift, world.contacts, (True, True), world.palms, world.palms,
        world.separation, midpoint, world.contact_vector[1], motion, end, part,
    )  # fmt: skip


def trace_of(crew: Any) -> Any:
    return crew.run().trace


def driven(scene: Scene, controller: str, seed: int) -> Any:
    """A carry whose world this test moves."""
    spec = to_spec(scene)
    world = _core.World(spec)
    midpoint = 0.0
    crew = _core.CoSimulation(spec, controller, seed, seen(world, 0.0, (0, 0), world.check(), 1.0))
    while not crew.done:
        _, angles, change, push, travel = crew.step_controllers()
        end, part, left, right, _ = world.advance(change, angles, push)
        midpoint += travel * part if end else travel
        crew.observe(seen(world, midpoint, (left, right), end, part))
    return crew.run()


@pytest.mark.parametrize(
    ("scene", "controller", "seed"), list(product((Scene(), BUSY, FALLS), CONTROLLERS, (0, 1)))
)
def test_cosimulation_with_the_quasistatic_world_equals_the_carry(
    scene: Scene, controller: str, seed: int
) -> None:
    whole: Any = _core.run(to_spec(scene), controller, seed, "double", True)
    crew = driven(scene, controller, seed)
    if not whole.contact_events:
        for name in RESULTS:
            assert repr(getattr(crew, name)) == repr(getattr(whole, name)), name
        for name, values in whole.trace.items():
            assert values.tobytes() == crew.trace[name].tobytes(), name


def test_few_compared_carries_have_further_contacts() -> None:
    """The comparison above leaves out carries in which the object rests on more than two
    vertices."""
    touching = [
        bool(_core.run(to_spec(scene), controller, seed, "double", False).contact_events)
        for scene, controller, seed in product((Scene(), BUSY, FALLS), CONTROLLERS, (0, 1))
    ]
    assert sum(touching) <= 4


def test_sensor_without_pressure_reads_zero() -> None:
    spec = to_spec(load_scene("paper", {"start.left_m": 0.03}))
    world = _core.World(spec)
    commands = []
    for pressed in ((True, True), (False, True)):
        first = _core.WorldObservation(
            world.contacts, world.lift, world.contacts, pressed, world.palms, world.palms,
            world.separation, 0.0, 0.0, (0, 0),
        )  # fmt: skip
        crew = _core.CoSimulation(spec, "distributed", 0, first)
        for _ in range(3):
            crew.step_controllers()
            crew.observe(first)
        commands.append(trace_of(crew)["sign"][0, 0])
    assert commands == [1, 0]


def test_wrist_within_the_slack_counts_as_turned() -> None:
    """Case (d) moves only after its palm has turned. With slack, a wrist a little short counts."""
    spec = to_spec(load_scene("paper", {"start.left_m": -0.03}))
    world = _core.World(spec)
    shallow = spec.palms[0].shallow

    def moves(slack: float) -> bool:
        def sight(wrist: float) -> Any:
            return _core.WorldObservation(
                world.contacts, world.lift, world.contacts, (True, True), world.palms,
                (wrist, world.palms[1]), world.separation, 0.0, 0.0, (0, 0),
            )  # fmt: skip

        crew = _core.CoSimulation(spec, "distributed", 0, sight(world.palms[0]), slack)
        for _ in range(60):
            crew.step_controllers()
            crew.observe(sight(shallow + 0.002))
        commanded = trace_of(crew)["commanded_m_s"][:, 0]
        return bool(commanded.max() > 0.07)

    assert moves(0.003)
    assert not moves(0.001)


def test_invalid_observations_are_refused() -> None:
    spec = to_spec(Scene())
    world = _core.World(spec)
    with pytest.raises(ValueError, match="reason: no such reason"):
        seen(world, 0.0, (0, 0), "exploded", 1.0)
    with pytest.raises(IndexError, match="motion"):
        seen(world, 0.0, (2, 0), "", 1.0)
    dropped = _core.CoSimulation(spec, "none", 0, seen(world, 0.0, (0, 0), "off-palm", 1.0))
    assert dropped.done
    with pytest.raises(RuntimeError, match="over"):
        dropped.step_controllers()
    with pytest.raises(ValueError, match="controller"):
        _core.CoSimulation(spec, "nobody", 0, seen(world, 0.0, (0, 0), "", 1.0))
    run = dropped.run()
    assert (run.outcome, run.reason, run.time_s) == ("dropped", "off-palm", 0.0)
