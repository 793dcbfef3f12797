# SPDX-License-Identifier: Apache-2.0
"""The task as the peers run it: the shipped controllers over any engine that moves two palms.

Everything but the contact mechanics is done here, the same for every engine: sensors, radio delay,
controllers (the shipped code, stepped from Python), wheels with noise, wrists.
"""

import math
import time
from collections import deque
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

import palmbots as pb

PERIOD = 0.01
SECONDS = 25.0
DELAY = 5  # ticks of radio latency
STEEP, SHALLOW = math.radians(15), math.radians(5)
TURN = math.radians(50) * PERIOD
HALF_PALM, ZONE = 0.075, 0.005
WIDTH, HEIGHT, COM_HEIGHT, MASS, FRICTION = 0.25, 0.16, 0.04, 0.5, 0.3
SPEED, CORRECTION, GAIN = 0.06, 0.03, 0.5 * PERIOD
NOISE, TAU = 0.01, 0.5


class Engine(Protocol):
    """Two kinematic palms and one dynamic box; starts with palms steep and contacts at p = 0."""

    def drive(self, side: int, speed: float, turn_rate: float) -> None:
        """Sets how a palm moves [m/s] and turns [rad/s, counter-clockwise] from now on."""
        ...

    def step(self, seconds: float) -> None:
        """Advances the engine."""
        ...

    def palm(self, side: int) -> tuple[float, float]:
        """Pivot's x and the palm's counter-clockwise angle."""
        ...

    def corner(self, side: int) -> tuple[float, float]:
        """The box's lower left (0) or right (1) corner."""
        ...


@dataclass(frozen=True)
class Result:
    """How a carry went and what it took."""

    outcome: str
    rms_m: float
    engine_s: float
    total_s: float


def carry(engine: Engine, seed: int, controlled: bool = True) -> Result:
    """One carry of 25 s with the distributed controller, or with none."""
    rng = np.random.default_rng(seed)
    memory = math.exp(-PERIOD / TAU)
    noise = rng.normal(0, NOISE, 2)
    controllers = (pb.control.DistributedController(), pb.control.DistributedController())
    inbox: tuple[deque[tuple[int, Any]], deque[tuple[int, Any]]] = (deque(), deque())
    speed, angle, target = [0.0, 0.0], [STEEP, STEEP], [STEEP, STEEP]
    squares, in_engine, outcome, ticks = 0.0, 0.0, "delivered", 0
    started = time.process_time()
    for tick in range(int(SECONDS / PERIOD)):
        ticks = tick + 1
        wanted = [SPEED, SPEED]
        p = [coordinate(engine, side) for side in (0, 1)]
        squares += 0.5 * (p[0] ** 2 + p[1] ** 2)
        if max(map(abs, p)) > HALF_PALM or min(engine.corner(s)[1] for s in (0, 1)) < -0.05:
            outcome = "dropped"
            break
        for side in (0, 1) if controlled else ():
            sign = 1 if p[side] > ZONE else (-1 if p[side] < -ZONE else 0)
            due = inbox[side] and inbox[side][0][0] <= tick
            message = inbox[side][0][1] if due else None
            turned = angle[side] == target[side]
            out = controllers[side].step(pb.control.StepInput(sign, message, turned))
            if due and out.consume:
                inbox[side].popleft()
            if out.send is not None:
                inbox[1 - side].append((tick + DELAY, out.send))
            target[side] = SHALLOW if out.palm == "shallow" else STEEP
            away = -CORRECTION if side == 0 else CORRECTION
            wanted[side] += {"hold": 0.0, "away": away, "closer": -away}[out.move]
        noise = memory * noise + NOISE * math.sqrt(1 - memory**2) * rng.normal(0, 1, 2)
        for side in (0, 1):
            speed[side] += min(GAIN, max(-GAIN, wanted[side] - speed[side]))
            turn = min(TURN, max(-TURN, target[side] - angle[side]))
            angle[side] = target[side] if abs(turn) < TURN * 0.999 else angle[side] + turn
            if abs(angle[side] - target[side]) < 1e-9:
                angle[side] = target[side]
            outward = -1.0 if side == 0 else 1.0
            engine.drive(side, speed[side] + float(noise[side]), outward * turn / PERIOD)
        before = time.process_time()
        engine.step(PERIOD)
        in_engine += time.process_time() - before
    return Result(outcome, math.sqrt(squares / ticks), in_engine, time.process_time() - started)


def coordinate(engine: Engine, side: int) -> float:
    """The contact coordinate p, outward from the pivot."""
    x, turned = engine.palm(side)
    cx, cy = engine.corner(side)
    outward = -1.0 if side == 0 else 1.0
    return outward * ((cx - x) * math.cos(turned) + cy * math.sin(turned))
