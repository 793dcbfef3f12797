# SPDX-License-Identifier: Apache-2.0
"""A carry as a recording of Rerun, with a layout: shapes, contact points, and forces as arrows.

Rerun draws no `foxglove.SceneUpdate`, so contact points and forces of a log are invisible there.
Here they are points and arrows. Forces are those that the MuJoCo world records.
"""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from palmbots._types import SIDES
from palmbots._util.optional_imports import require
from palmbots._util.xml_attributes import parts_of
from palmbots.errors import PalmbotsError
from palmbots.scene.placement import Placement, placements
from palmbots.scene.spec import to_spec
from palmbots.viz.solids import WORLD, Box, Cylinder, Prism, Solid, poses, solids
from palmbots.viz.style import DROP, SLIDES, ZERO

if TYPE_CHECKING:
    from palmbots.simulation.result import Carry

APPLICATION = "palmbots"
BLUEPRINT = Path(__file__).with_name("data") / "layout.rbl"
"""A layout that Rerun opens beside a recording of this application."""
_INTERVAL_S = 0.04
_METRES_PER_NEWTON = 0.02
_TIME = "time"


def save_recording(carry: "Carry", path: str | os.PathLike[str]) -> None:
    """Write a carry as ``.rrd``, for ``rerun FILE``.

    Raises:
        MissingExtra: rerun-sdk is not installed.
        PalmbotsError: the carry has no trace, or the path cannot be written.
    """
    rr = require("rerun", "rerun")
    if carry.trace is None:
        raise PalmbotsError("recording: this carry has no trace; run it with record=True")
    recording = rr.RecordingStream(APPLICATION)
    try:
        recording.save(os.fspath(path), default_blueprint=_layout())
    except Exception as error:  # the package raises errors of its own
        raise PalmbotsError(f"{path}: cannot be written: {error}") from None
    spec = to_spec(carry.scene, unrolled=True)
    for number, part in enumerate(solids(carry.scene, spec)):
        _log_solid(rr, recording, part, number)
    times = carry.trace["time"].to_numpy()
    step = max(1, round(_INTERVAL_S / spec.period))
    rows = np.array(sorted({*range(0, len(times), step), len(times) - 1}))
    place = placements(spec, carry.trace, rows)
    for k, row in enumerate(rows.tolist()):
        recording.set_time(_TIME, duration=float(times[row]))
        _log_instant(rr, recording, carry.trace, place, k, row)
    for correction in carry.corrections:
        recording.set_time(_TIME, duration=correction.start_s)
        text = f"{correction.label}: {correction.robot} corrects ({correction.case})"
        recording.log("events", rr.TextLog(text))
    recording.flush()


def save_blueprint(path: str | os.PathLike[str]) -> None:
    """Write the layout alone (``.rbl``).

    Raises:
        MissingExtra: rerun-sdk is not installed.
    """
    require("rerun", "rerun")
    _layout().save(APPLICATION, os.fspath(path))


def _layout() -> Any:
    """The carry in three dimensions, and below it what both robots sense and do."""
    rrb = require("rerun.blueprint", "rerun")
    plots = [
        rrb.TimeSeriesView(origin=f"/plots/{name}", name=title)
        for name, title in (
            ("contact_mm", "contact [mm]"),
            ("sign", "sign"),
            ("palm_deg", "palm [deg]"),
        )
    ]
    return rrb.Blueprint(
        rrb.Vertical(
            rrb.Spatial3DView(origin="/", name="carry", contents=[f"/{WORLD}/**"]),
            rrb.Horizontal(*plots, rrb.TextLogView(origin="/events", name="corrections")),
            row_shares=[2, 1],
        ),
        rrb.TimePanel(state="collapsed"),
        collapse_panels=False,
    )


def _path(frame: str) -> str:
    return WORLD if frame == WORLD else f"{WORLD}/{frame}"


def _log_solid(rr: Any, recording: Any, part: Solid, number: int) -> None:
    shape, colour = part.shape, part.colour
    place = f"{_path(part.frame)}/solid{number}"
    if isinstance(shape, Box):
        turn = rr.Quaternion(xyzw=[0, -np.sin(shape.turn / 2), 0, np.cos(shape.turn / 2)])
        box = rr.Boxes3D(
            centers=[shape.centre], sizes=[shape.size], quaternions=[turn],
            colors=[parts_of(colour)], fill_mode="solid",
        )  # fmt: skip
        recording.log(place, box, static=True)
    elif isinstance(shape, Cylinder):
        half = float(np.sqrt(0.5))
        wheel = rr.Cylinders3D(
            lengths=[shape.length], radii=[shape.radius], centers=[shape.centre],
            quaternions=[rr.Quaternion(xyzw=[half, 0, 0, half])], colors=[parts_of(colour)],
            fill_mode="solid",
        )  # fmt: skip
        recording.log(place, wheel, static=True)
    elif isinstance(shape, Prism):
        corners, faces = shape.mesh()
        mesh = rr.Mesh3D(
            vertex_positions=corners,
            triangle_indices=faces,
            vertex_colors=[parts_of(colour)] * len(corners),
        )
        recording.log(place, mesh, static=True)


def _log_instant(rr: Any, recording: Any, trace: Any, place: Placement, k: int, row: int) -> None:
    for frame, (origin, turn) in poses(place, k).items():
        rotation = rr.Quaternion(xyzw=[0, -np.sin(turn / 2), 0, np.cos(turn / 2)])
        recording.log(_path(frame), rr.Transform3D(translation=origin, quaternion=rotation))
    motion = trace["motion"].to_numpy()[row]
    colours = [parts_of(ZERO if moves == 0 else SLIDES) for moves in motion]
    points = np.array([[x, 0.0, y] for x, y in place.contact[k]])
    recording.log(f"{WORLD}/contacts", rr.Points3D(points, radii=0.008, colors=colours))
    if "force" in trace:
        arrows = _forces(trace, place, k, row)
        shown = rr.Arrows3D(
            origins=points, vectors=arrows, colors=[parts_of(DROP)] * 2, radii=0.003
        )
        recording.log(f"{WORLD}/forces", shown)
    values = {
        "contact_mm": 1e3 * trace["contact"].to_numpy()[row],
        "sign": trace["sign"].to_numpy()[row],
        "palm_deg": np.degrees(trace["palm"].to_numpy()[row]),
    }
    for name, pair in values.items():
        for side, value in zip(SIDES, pair.tolist(), strict=True):
            recording.log(f"plots/{name}/{side}", rr.Scalars(float(value)))


def _forces(trace: Any, place: Placement, k: int, row: int) -> Any:
    """Forces of the object on the palms, drawn as lengths [m]."""
    arrows = []
    for number, turn in enumerate(place.palm_turn[k].tolist()):
        outward = (-1.0, 1.0)[number]
        normal = np.array([-np.sin(turn), 0.0, np.cos(turn)])
        along = outward * np.array([np.cos(turn), 0.0, np.sin(turn)])
        pressed = float(trace["force"].to_numpy()[row, number])
        rubbed = float(trace["friction_force"].to_numpy()[row, number])
        arrows.append(_METRES_PER_NEWTON * (rubbed * along - pressed * normal))
    return np.array(arrows)
