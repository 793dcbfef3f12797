# SPDX-License-Identifier: Apache-2.0
"""The workbench of simulated robots as a process: robots connect one by one, and a person measures.

The person types a line for what a hand would do: ``left rod 12`` lays a rod on the palm of the left
robot, 12 mm outward of the pivot, ``left rod off`` takes it away, and ``left home`` puts the robot
back to the start of its tape. When a robot has come to rest, the bench prints what a tape and a
protractor say.
"""

import math
from collections.abc import Callable
from socket import socket

from palmbots._types import SIDES, Side
from palmbots._util.arguments import show
from palmbots.clocks.control_clock import ControlClock
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.simulation.bench_stage import BenchStage
from palmbots.simulation.imperfections import Imperfections
from palmbots.simulation.live_world import LiveRobots

_RESTS_S = 0.5
_FORM = "SIDE rod MM, SIDE rod off, SIDE home, or quit"


def run_bench(
    scene: Scene,
    door: socket,
    imperfections: Imperfections,
    *,
    lines: Callable[[], str | None],
    on_line: Callable[[str], None],
    seed: int = 0,
    rate: float = 1.0,
) -> None:
    """Run a workbench until ``quit`` is typed.

    Args:
        scene: speeds, noise and palms of the robots.
        door: where the programs connect.
        imperfections: what the robots really are.
        lines: returns the next line that was typed; None: there is none yet.
        on_line: called with each line about a robot.
        seed: of the noise.
        rate: multiple of real time.
    """
    stage = BenchStage(scene, seed, imperfections)
    period_s = scene.control.period_s
    robots = LiveRobots(scene, stage, door, rate)
    clock = ControlClock(period_s / rate)
    resting = dict.fromkeys(SIDES, 0)
    has_moved = dict.fromkeys(SIDES, False)
    on_line(f"type what a hand would do: {_FORM}")
    while True:
        clock.wait()
        line = lines()
        if line is not None and line.split() == ["quit"]:
            break
        if line is not None and line.strip():
            on_line(obey(stage, line))
        robots.tick()
        for side in SIDES:
            has_moved[side] = has_moved[side] or stage.moves[side]
            resting[side] = 0 if stage.moves[side] else resting[side] + 1
            if has_moved[side] and resting[side] * period_s >= _RESTS_S:
                on_line(stage.measured(side))
                has_moved[side] = False
    robots.end()


def obey(stage: BenchStage, line: str) -> str:
    """Do what a line says; returns what has been done, or what is allowed."""
    try:
        side, value = _parsed(line)
    except PalmbotsError as error:
        return str(error)
    if isinstance(value, str):  # home
        stage.put_down(side)
        return f"{side}: at the start of its tape"
    stage.rods[side] = value
    if value is None:
        return f"{side}: no rod on its palm"
    return f"{side}: rod at {1000 * value:g} mm"


def _parsed(line: str) -> tuple[Side, float | str | None]:
    refusal = PalmbotsError(f"value is {show(line.strip())}; allowed: {_FORM}")
    words = line.split()
    if not words or words[0] not in SIDES:
        raise refusal
    side: Side = "left" if words[0] == "left" else "right"
    if words[1:] == ["home"]:
        return side, "home"
    if len(words) != 3 or words[1] != "rod":
        raise refusal
    if words[2] == "off":
        return side, None
    try:
        place = float(words[2])
    except ValueError:
        raise refusal from None
    if not math.isfinite(place):
        raise refusal
    return side, place / 1000
