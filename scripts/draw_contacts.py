# SPDX-License-Identifier: Apache-2.0
"""Draws docs/images/contacts.png: the five kinds of contact with a palm, and a small fall."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots import load_scene
from palmbots._types import SIDES, Side
from palmbots.mechanics import SurfaceContact
from palmbots.shapes.fitting import boundary
from palmbots.simulation import FloorWorld
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import FLOOR, HUE, INK, OBJECT, QUIET, footnote, styled

Point = tuple[float, float]

KEYS = {"object.edge_radius_m": 0.003}
THICK = {"palm.thickness_m": 0.008, "palm.nose_m": 0.008, "palm.bevel_m": 0.0}
SLANTED = {
    "object.vertices_m": [[0, 0], [0.25, 0], [0.17, 0.16], [0.08, 0.16]],
    "object.mass_kg": 0.5,
}
HEEL_M = 0.003  # drawn thickness
MM = 1000.0


class View(NamedTuple):
    """A contact of a state, and how much of its surroundings is shown."""

    title: str
    world: FloorWorld
    keys: dict[str, Any]
    side: Side
    at: Point  # of the contact
    half_m: float


def draw(path: Path) -> None:
    """Write the picture."""
    write_figure(path, figure())


def figure() -> Figure:
    """One panel for each kind of contact."""
    with styled():
        drawn = Figure(figsize=(7.2, 5.0), layout="constrained")
        for axes, view in zip(drawn.subplots(2, 3).flat, views(), strict=True):
            panel(axes, view)
        footnote(drawn, "cones: forces that a sticking contact permits; lengths in mm")
    return drawn


def contact_of(world: FloorWorld, side: Side, farthest: bool = False) -> SurfaceContact:
    """The innermost contact of a palm, or the outermost one."""
    of_palm = [
        one for one in world.contact_modes(0.0, 0.0).contacts if one.surface == f"{side} palm"
    ]
    outward = -1 if side == "left" else 1
    return sorted(of_palm, key=lambda one: outward * one.point_m[0])[-1 if farthest else 0]


def view(
    title: str, world: FloorWorld, keys: dict[str, Any], side: Side, half_m: float,
    *, farthest: bool = False, shift_m: float = 0.0,
) -> View:  # fmt: skip
    """A contact of a palm, in the middle of its picture."""
    assert not world.state.end, (title, world.state.end)
    (x, y), (u, v) = world.state.com_m, contact_of(world, side, farthest).point_m
    return View(title, world, keys, side, (x + u + shift_m, y + v), half_m)


def driven(world: FloorWorld, left: float, right: float, steps: int = 20) -> FloorWorld:
    """The world after both palms moved along the floor [m]."""
    for _ in range(steps):
        world.move(left / steps, right / steps)
    return world


def views() -> Iterator[View]:
    """The states, one after the other."""
    world = driven(FloorWorld("plate", palms_deg=(8, 15), overrides=KEYS), 0.09, 0.0)
    yield view("vertex: an arc that rolls", world, KEYS, "right", 0.009)
    level = FloorWorld("plate", overrides=KEYS)
    driven(level, 0.08, -0.08)
    level.move(up_m=(0.1, 0.1))
    level.move(palms_deg=(0, 0))
    yield view("flush: an edge with two ends", level, KEYS, "left", 0.06, shift_m=-0.03)
    level.move(palms_deg=(0, 15))
    yield view("tip: on a straight edge", level, KEYS, "left", 0.009)
    world = driven(FloorWorld("plate", palms_deg=(15, 45), overrides=KEYS), 0.012, 0.0)
    yield view("tip: on an arc", world, KEYS, "left", 0.004)
    keys = KEYS | THICK | SLANTED
    world = FloorWorld("plate", palms_deg=(15, 15), gaps_m=(0.01, None), overrides=keys)
    yield view("nose: against a vertex", driven(world, 0.03, 0.0), keys, "left", 0.014)
    keys = KEYS | SLANTED
    world = driven(FloorWorld("plate", palms_deg=(8, 15), overrides=keys), 0.19, 0.0, 60)
    yield view("heel: against a vertex", world, keys, "right", 0.014, farthest=True)


def panel(axes: Axes, one: View) -> None:
    """Object, palm, floor and cones around a contact."""
    state, half = one.world.state, one.half_m
    scene = load_scene("plate", one.keys)
    thing = scene.object
    corners = np.array(thing.vertices_m) - thing.com_m
    radius = thing.edge_radius_m
    radii = np.array(radius if isinstance(radius, tuple) else (radius,) * len(corners))
    c, s = (f(math.radians(state.tilt_deg)) for f in (math.cos, math.sin))
    outline = boundary(corners, radii) @ np.array([[c, s], [-s, c]]) + state.com_m
    axes.fill(*(MM * outline).T, facecolor=OBJECT, edgecolor=INK, lw=1.0)
    axes.axhspan(-MM, 0, color=FLOOR, lw=0, zorder=0)
    axes.axhline(0, color=QUIET, lw=1.0)
    for side in SIDES:
        if side == one.side:
            axes.fill(*(MM * palm_outline(one, scene, side)).T, color=HUE[side], alpha=0.75, lw=0)
    for contact in one.world.contact_modes(0.0, 0.0).contacts:
        x, y = (MM * (a + b) for a, b in zip(state.com_m, contact.point_m, strict=True))
        lean, spread = math.atan2(*contact.normal), math.atan(contact.friction)
        size = 0.62 * half * MM
        ends = [lean - spread, lean + spread]
        colour = HUE["left" if "left" in contact.surface else "right"]
        colour = colour if "palm" in contact.surface else QUIET
        axes.fill(
            [x, *(x + size * math.sin(end) for end in ends)],
            [y, *(y + size * math.cos(end) for end in ends)],
            facecolor=colour, alpha=0.35, edgecolor=colour, lw=0.8, zorder=3,
        )  # fmt: skip
        axes.plot(x, y, "o", color=INK, markersize=3.5, zorder=4)
    x, y = (MM * value for value in one.at)
    axes.set_xlim(x - half * MM, x + half * MM)
    axes.set_ylim(y - 0.6 * half * MM, y + 0.9 * half * MM)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.locator_params(nbins=4)
    axes.set_title(one.title)


def palm_outline(one: View, scene: Any, side: Side) -> Any:
    """The section of a palm with its heel [m]."""
    palm, state = scene.palm_of(side), one.world.state
    half, thick = palm.length_m / 2, palm.thickness_m
    nose = thick if palm.nose_m is None else palm.nose_m
    points = [(-half, 0.0), (half, 0.0)]
    if palm.heel_m > 0:
        points += [(half, palm.heel_m), (half + HEEL_M, palm.heel_m), (half + HEEL_M, -thick)]
    points += [(half, -thick), (-half + palm.bevel_m, -thick), (-half, -nose)]
    out, angle = (-1 if side == "left" else 1), math.radians(state.palms_deg[side])
    x, y = state.pivots_m[side]
    c, s = math.cos(angle), math.sin(angle)
    return np.array([(x + out * (u * c - v * s), y + u * s + v * c) for u, v in points])
