# SPDX-License-Identifier: Apache-2.0
"""The stability properties, state by state, from the contact modes alone: an oracle for ranges."""

import numpy as np
from numpy.typing import NDArray

import palmbots as pb
from palmbots import load_scene
from palmbots._types import SIDES, Side
from palmbots.mechanics.array_arguments import FloatArray
from palmbots.mechanics.contact_modes import CONTACT_MODES
from palmbots.stability.problem import StabilityProblem, stability_problem

CLOSING = {"left": CONTACT_MODES.index(("SL", "ST")), "right": CONTACT_MODES.index(("ST", "SR"))}
OPENING = {"left": CONTACT_MODES.index(("ST", "SL")), "right": CONTACT_MODES.index(("SR", "ST"))}
BOTH_STICK = CONTACT_MODES.index(("ST", "ST"))
STEEP_CASES: list[tuple[int, Side]] = [(1, "left"), (1, "right"), (2, "left"), (2, "right")]


def happens(
    at: StabilityProblem,
    number: int,
    shallow: Side,
    angles: tuple[FloatArray, FloatArray],
    p: tuple[NDArray[np.float64], NDArray[np.float64]],
    **changed: FloatArray,
) -> NDArray[np.bool_]:
    """Whether the property holds at these contacts, state by state."""
    given = {
        "width": at.width,
        "com_x": at.com[0],
        "com_y": at.com[1],
        "friction_left": at.friction[0],
        "friction_right": at.friction[1],
        "slope": at.slope,
    } | changed
    surface = [offset - radius for offset, radius in zip(at.offset, at.radius, strict=True)]
    found = pb.contact_modes_batch(
        theta_left=angles[0],
        theta_right=angles[1],
        p_left=p[0],
        p_right=p[1],
        offset_left=surface[0],
        offset_right=surface[1],
        **(given | touched(at, angles, p, given["com_x"], given["com_y"])),
    )
    if number == 0:
        return found.feasible[..., BOTH_STICK]
    if number == 1:
        return found.closing == CLOSING[shallow]
    return found.opening == OPENING[shallow]


def touched(
    at: StabilityProblem,
    angles: tuple[FloatArray, FloatArray],
    p: tuple[NDArray[np.float64], NDArray[np.float64]],
    x: FloatArray,
    y: FloatArray,
) -> dict[str, FloatArray]:
    """Width and COM of the object with its contacts where its arcs touch the palms: points of the
    complex plane, from the centre of the left arc. Nothing for sharp vertices."""
    if not any(at.radius):
        return {}
    theta = [np.asarray(angle) for angle in angles]
    normal = [np.exp(1j * (np.pi / 2 + turn)) for turn in (-theta[0], theta[1])]
    heights = [p[i] * np.sin(theta[i]) + at.offset[i] * np.cos(theta[i]) for i in (0, 1)]
    turned = np.exp(1j * np.arcsin((heights[1] - heights[0]) / at.width))
    left = -at.radius[0] * normal[0]
    span = at.width * turned - at.radius[1] * normal[1] - left
    com = ((np.asarray(x) + 1j * np.asarray(y)) * turned - left) * np.conj(span) / np.abs(span)
    return {"width": np.abs(span), "com_x": com.real, "com_y": com.imag}


def contacts(
    at: StabilityProblem, number: int, shallow: Side, n: int = 7
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A grid over the property's region, corners included."""
    ends = [list(c) for c in at.contacts]
    side = SIDES.index(shallow)
    if number == 1:
        ends[side][1] = min(ends[side][1], at.beyond)
    if number == 2:
        ends[1 - side][0] = max(ends[1 - side][0], -at.beyond)
    left, right = (np.linspace(low, high, n) for low, high in ends)
    across, up = np.meshgrid(left, right)
    return across, up


def held_everywhere(at: StabilityProblem, x: float) -> bool:
    """Whether ST–ST balances with this c_x at all angles and contacts that are passed through."""
    every = True
    for shallow in SIDES:
        first, last = at.angles[SIDES.index(shallow)]
        for turn in np.linspace(0, 1, 9):
            palms = list(at.palms(shallow))
            palms[SIDES.index(shallow)] = first + turn * (last - first)
            for number in (1, 2):
                grid = contacts(at, number, shallow)
                every &= bool(happens(at, 0, shallow, (palms[0], palms[1]), grid, com_x=x).all())
    for k in (0, 1):
        palms = (at.angles[0][k], at.angles[1][k])
        every &= bool(happens(at, 0, "left", palms, contacts(at, 0, "left"), com_x=x).all())
    return every


def random_situation(rng: np.random.Generator, radius_m: float = 0.0) -> StabilityProblem:
    """A scene with a box. Its contact vertices have radii up to `radius_m`."""
    half = rng.uniform(0.02, 0.08)
    shallow, steep = np.sort(rng.uniform(-5, 35, 2))
    radii = [*rng.uniform(0, radius_m, 2), 0.0, 0.0] if radius_m else 0.0
    scene = load_scene(
        {
            "object": {
                "com_m": [
                    radius_m + (0.25 - 2 * radius_m) * rng.uniform(0.1, 0.9),
                    radius_m + (1 - radius_m / 0.15) * rng.uniform(0.005, 0.15),
                ],
                "edge_radius_m": radii,
            },
            "palm": {
                "length_m": 2 * half,
                "shallow_deg": float(shallow),
                "steep_deg": float(steep) + 0.5,
                "friction": rng.uniform(0.05, 0.9),
                "right": {"friction": rng.uniform(0.05, 0.9)},
                "pivot_offset_m": float(rng.choice([0.0, 0.01])),
            },
            "task": {"slope_deg": float(rng.choice([0.0, rng.uniform(-4, 4)]))},
        }
    )
    return stability_problem(scene)


def uneven(rng: np.random.Generator) -> StabilityProblem:
    """As designs have it: corrections run on past p = 0; and no two ends of the region alike."""
    at = random_situation(rng)
    half = min(at.half_length)
    at = at.with_(beyond=float(rng.choice([0.0, rng.uniform(0.0, half)])))
    if rng.random() < 0.5:
        return at
    low, high = -half * rng.uniform(0, 1, 2), half * rng.uniform(0, 1, 2)
    return at.with_(contacts=((low[0], high[0]), (low[1], high[1])))
