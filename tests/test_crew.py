"""Both robots without their world: with the quasistatic one they are the carry, bit for bit."""

from itertools import product
from typing import Any

import pytest

from palmbots import _core
from palmbots.lowering import lower
from palmbots.scene import Scene, load_scene

BUSY = load_scene(
    {
        "object": {"com_m": [0.118, 0.06]},
        "palm": {"pivot_offset_m": 0.01, "left": {"friction": 0.25}},
        "robot": {"noise_m_s": 0.012, "left": {"clock_ppm": 900.0}, "right": {"bias_m_s": 0.002}},
        "tactile": {"false_rate": 0.005},
        "radio": {"jitter_s": 0.04, "loss": 0.02, "duplicate": 0.1, "airtime_s": 0.001},
        "faults": {
            "reboots": 1,
            "script": [
                {"kind": "freeze", "robot": "left", "at_s": 2.0, "for_s": 0.3},
                {"kind": "flicker", "robot": "right", "at_s": 8.0, "for_s": 1.0, "rate": 0.2},
                {"kind": "station", "at_s": 11.0, "for_s": 0.2},
            ],
        },
        "task": {"slope_deg": 0.5, "direction": "backward"},
    }
)
FALLS = load_scene({"robot": {"noise_m_s": 0.03}})
CONTROLLERS = ("none", "centralized", "distributed", "resilient")
RESULTS = (
    "outcome", "reason", "time_s", "distance_m", "contact_rms_m", "contact_peak_m", "corrections",
    "messages", "messages_lost", "links", "waiting_s", "hanging", "limit_cycle", "rests", "letters",
    "trace_hash",
)  # fmt: skip


def seen(world: Any, midpoint: float, motion: tuple[int, int], end: str, part: float) -> Any:
    return _core.Sight(
        world.contacts, world.lift, world.contacts, (True, True), world.palms, world.palms,
        world.separation, midpoint, world.span[1], motion, end, part,
    )  # fmt: skip


def trace_of(crew: Any) -> Any:
    return crew.run().trace


def driven(scene: Scene, controller: str, seed: int) -> Any:
    """A carry whose world is moved from here."""
    spec = lower(scene)
    world = _core.World(spec)
    midpoint = 0.0
    crew = _core.Crew(spec, controller, seed, seen(world, 0.0, (0, 0), world.check(), 1.0))
    while not crew.done:
        _, angles, change, push, travel = crew.command()
        end, part, left, right, _ = world.advance(change, angles, push)
        midpoint += travel * part if end else travel
        crew.observe(seen(world, midpoint, (left, right), end, part))
    return crew.run()


@pytest.mark.parametrize(
    ("scene", "controller", "seed"), list(product((Scene(), BUSY, FALLS), CONTROLLERS, (0, 1)))
)
def test_with_the_quasistatic_world_it_is_the_carry(
    scene: Scene, controller: str, seed: int
) -> None:
    whole: Any = _core.run(lower(scene), controller, seed, "double", True)
    crew = driven(scene, controller, seed)
    if whole.touch_count == 0:
        for name in RESULTS:
            assert repr(getattr(crew, name)) == repr(getattr(whole, name)), name
        for name, values in whole.trace.items():
            assert values.tobytes() == crew.trace[name].tobytes(), name


def test_most_of_those_carries_are_compared() -> None:
    """The comparison above leaves out carries that rest upon more than two vertices."""
    touching = [
        _core.run(lower(scene), controller, seed, "double", False).touch_count > 0
        for scene, controller, seed in product((Scene(), BUSY, FALLS), CONTROLLERS, (0, 1))
    ]
    assert sum(touching) <= 4


def test_where_nothing_presses_the_sensor_reads_zero() -> None:
    spec = lower(load_scene("paper", {"start.left_m": 0.03}))
    world = _core.World(spec)
    commands = []
    for pressed in ((True, True), (False, True)):
        first = _core.Sight(
            world.contacts, world.lift, world.contacts, pressed, world.palms, world.palms,
            world.separation, 0.0, 0.0, (0, 0),
        )  # fmt: skip
        crew = _core.Crew(spec, "distributed", 0, first)
        for _ in range(3):
            crew.command()
            crew.observe(first)
        commands.append(trace_of(crew)["sign"][0, 0])
    assert commands == [1, 0]


def test_a_wrist_has_turned_within_the_slack() -> None:
    """(d) moves only once its palm has turned; a wrist a little short counts with slack."""
    spec = lower(load_scene("paper", {"start.left_m": -0.03}))
    world = _core.World(spec)
    shallow = spec.palms[0].shallow

    def moves(slack: float) -> bool:
        def sight(wrist: float) -> Any:
            return _core.Sight(
                world.contacts, world.lift, world.contacts, (True, True), world.palms,
                (wrist, world.palms[1]), world.separation, 0.0, 0.0, (0, 0),
            )  # fmt: skip

        crew = _core.Crew(spec, "distributed", 0, sight(world.palms[0]), slack)
        for _ in range(60):
            crew.command()
            crew.observe(sight(shallow + 0.002))
        commanded = trace_of(crew)["commanded_m_s"][:, 0]
        return bool(commanded.max() > 0.07)

    assert moves(0.003)
    assert not moves(0.001)


def test_what_makes_no_sense_is_refused() -> None:
    spec = lower(Scene())
    world = _core.World(spec)
    with pytest.raises(ValueError, match="end: no such reason"):
        seen(world, 0.0, (0, 0), "exploded", 1.0)
    with pytest.raises(IndexError, match="motion"):
        seen(world, 0.0, (2, 0), "", 1.0)
    dropped = _core.Crew(spec, "none", 0, seen(world, 0.0, (0, 0), "off-palm", 1.0))
    assert dropped.done
    with pytest.raises(RuntimeError, match="over"):
        dropped.command()
    with pytest.raises(ValueError, match="controller"):
        _core.Crew(spec, "nobody", 0, seen(world, 0.0, (0, 0), "", 1.0))
    run = dropped.run()
    assert (run.outcome, run.reason, run.time_s) == ("dropped", "off-palm", 0.0)
