# SPDX-License-Identifier: Apache-2.0
"""Closed forms of a job that one robot does alone, against a linear program over forces that shares
no code with them, and against the exact world."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from tests.conftest import is_soak

from palmbots.mechanics.lone import LoneLift
from palmbots.mechanics.lone_refusals import lone_lift
from palmbots.scene.scene import load_scene

STATES = 10_000 if is_soak() else 200
TRIALS = 100 if is_soak() else 12


def random_keys(seed: int) -> dict[str, Any]:
    """A random box before a wall; some of them jam."""
    u = np.random.default_rng(seed).uniform
    width, high = u(0.06, 0.13), u(0.02, 0.12)
    return {
        "object.vertices_m": [[0, 0], [width, 0], [width, high], [0, high]],
        "object.com_m": [u(0.35, 0.65) * width, u(0.3, 0.6) * high],
        "object.edge_radius_m": u(0.003, 0.006),
        "object.mass_kg": u(0.05, 0.4),
        "palm.friction": u(0.2, 0.6),
        "palm.shallow_deg": u(4, 9),
        "floor.friction": u(0.1, 0.6),
        "floor.walls": [{"at_m": -width, "friction": u(0.0, 1.0)}],
    }


def found(keys: dict[str, Any]) -> LoneLift:
    lone = lone_lift(load_scene("lone", keys))
    assert lone is not None
    return lone


def most_squeeze(keys: dict[str, Any], nose: float) -> float:
    """The largest push of a nose whose contact slips up, with which the object may be in balance;
    inf: any. The near side is the right one; x towards it from the wall."""
    (_, (width, _), (_, high), _) = keys["object.vertices_m"]
    r, phi = keys["object.edge_radius_m"], math.atan(keys["palm.friction"])
    theta = math.radians(keys["palm.shallow_deg"])
    lean = max(math.acos(1 - nose / r), theta)
    weight = keys["object.mass_kg"] * 9.80665
    near = (width - r + r * math.sin(lean), r - r * math.cos(lean))
    push = (-math.sin(lean + phi), math.cos(lean + phi))
    mu_wall, mu = keys["floor.walls"][0]["friction"], keys["floor.friction"]
    forces = [(near, push)]
    forces += [((0.0, y), (1.0, s * mu_wall)) for y in (r, high) for s in (-1, 1)]
    forces += [((r, 0.0), (s * mu, 1.0)) for s in (-1, 1)]
    rays = np.array([(fx, fy, x * fy - y * fx) for (x, y), (fx, fy) in forces]).T
    load = [0.0, weight, weight * keys["object.com_m"][0]]
    size = np.zeros(len(forces))
    size[0] = -math.sin(lean + phi)
    best = linprog(size, A_eq=rays, b_eq=load, bounds=(0, None))
    return math.inf if best.status == 3 else -best.fun


def test_the_squeeze_and_the_jam_are_those_of_the_linear_program() -> None:
    jams = 0
    for seed in range(STATES):
        keys = random_keys(seed)
        closed = found(keys)
        if closed.nose_height_m >= closed.thickest_m:
            continue
        most = most_squeeze(keys, closed.nose_height_m)
        assert closed.self_locking == math.isinf(most), (seed, closed, most)
        jams += closed.self_locking
        if not closed.self_locking:
            assert closed.squeeze_n == pytest.approx(most, rel=1e-6), (seed, closed, most)
    assert 0 < jams < STATES / 2
