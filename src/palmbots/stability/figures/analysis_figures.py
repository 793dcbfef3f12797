# SPDX-License-Identifier: Apache-2.0
"""The paper's Figures 2 to 7 of an analysis: one at a time, all together, or as files.

The functions of one figure are the entries of the registry of figures.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

from matplotlib.figure import Figure

from palmbots._util.arguments import one_of
from palmbots._util.atomic_files import folder as writable_folder
from palmbots._util.command import Option, writes
from palmbots._util.fork_join import both
from palmbots.stability.analysis import Analysis
from palmbots.stability.figures.cone_figures import figure3, figure4
from palmbots.stability.figures.drawn_state import State, state_of
from palmbots.stability.figures.geometry_figure import figure2
from palmbots.stability.figures.lifting_figure import lifting_forces
from palmbots.stability.figures.region_figures import figure5, figure6
from palmbots.stability.figures.sensor_figure import figure7
from palmbots.stability.problem import Pair
from palmbots.viz.save_figure import write_figure

# Default contacts, as shares of the negative end of the region (left) and the positive one (right).
_SHARE_OF_GEOMETRY = 0.6
_SHARE_OF_FORCES = 0.25


def geometry(analysis: Analysis, p_m: Pair | None = None) -> Figure:
    """Figure 2: geometry and symbols of one state, with contacts at `p_m` (left, right)."""
    return figure2(_state(analysis, p_m, _SHARE_OF_GEOMETRY))


def friction_cones(analysis: Analysis, p_m: Pair | None = None) -> Figure:
    """Figure 3: the tests of two contact modes with the friction cones."""
    return figure3(_state(analysis, p_m, _SHARE_OF_FORCES))


def meeting_points(analysis: Analysis, p_m: Pair | None = None) -> Figure:
    """Figure 4: the points on the line of gravity that decide property 1."""
    return figure4(_state(analysis, p_m, _SHARE_OF_FORCES))


def operating_region(analysis: Analysis) -> Figure:
    """Figure 5: where the properties hold in the plane of contacts."""
    return figure5(analysis)


def permitted_com(analysis: Analysis) -> Figure:
    """Figure 6: the centres of mass for which the properties hold."""
    return figure6(analysis)


def tactile_zones(analysis: Analysis) -> Figure:
    """Figure 7: the switches along both palms, and their readings."""
    return figure7(analysis.scene.tactile, analysis.problem.spec)


def _state(analysis: Analysis, p_m: Pair | None, share: float) -> State:
    problem = analysis.problem
    ends = problem.contacts[0][0], problem.contacts[1][1]
    return state_of(problem, p_m or (share * ends[0], share * ends[1]))


def draw_all(analysis: Analysis, p_m: Pair | None = None) -> dict[str, Figure]:
    """The figures by name, ``figure2`` to ``figure7``, and ``lifting-forces`` for a job that begins
    or ends on the floor.

    Args:
        analysis: of the scene to draw.
        p_m: contact coordinates (left, right) of the state in Figures 2 to 4; None: a quarter of
            the region's negative end on the left and of its positive end on the right, six tenths
            in Figure 2.

    Raises:
        PalmbotsError: a contact is beyond its palm, or the object cannot span the contacts.
    """
    return dict(_of_states(analysis, p_m)) | dict(_of_regions(analysis))


# Figures are made one after the other, so that each is saved while its texts are in the cache.
_Figures = Iterator[tuple[str, Figure]]


def _of_states(analysis: Analysis, p_m: Pair | None) -> _Figures:
    yield "figure2", geometry(analysis, p_m)
    yield "figure3", friction_cones(analysis, p_m)
    yield "figure4", meeting_points(analysis, p_m)


def _of_regions(analysis: Analysis) -> _Figures:
    yield "figure5", operating_region(analysis)
    yield "figure6", permitted_com(analysis)
    yield "figure7", tactile_zones(analysis)
    if analysis.lifting is not None and analysis.lifting.is_on_floor:
        yield "lifting-forces", lifting_forces(analysis)


@writes(
    "analyze",
    folder=Option("--out", metavar="DIR"),
    kind=Option("--format", metavar="NAME"),
)
def save_all(
    analysis: Analysis,
    folder: str | os.PathLike[str],
    kind: Literal["png", "svg", "pdf"] = "png",
    p_left_m: float | None = None,
    p_right_m: float | None = None,
) -> list[Path]:
    """Write the figures to a folder, each file whole or not at all.

    The same analysis gives the same files. Two processes draw, where a fork is safe.

    Args:
        analysis: of the scene to draw.
        folder: write Figures 2 to 7 to this folder, and the forces of lifting if the job begins or
            ends on the floor.
        kind: figure format: png, svg or pdf.
        p_left_m: left contact of the state in Figures 2 to 4. If only one is given, the other is 0.
        p_right_m: right contact of the state in Figures 2 to 4.

    Raises:
        PalmbotsError: the kind is unknown, a file cannot be written, or as `draw_all`.
    """
    one_of("kind", kind, ("png", "svg", "pdf"))
    p_m = None if p_left_m is p_right_m is None else (p_left_m or 0.0, p_right_m or 0.0)
    for share in (_SHARE_OF_GEOMETRY, _SHARE_OF_FORCES):
        _state(analysis, p_m, share)  # may raise, before anything is written
    place = writable_folder(folder)
    # Drawing takes most of the time, and each half takes about as long as the other.
    one, two = both(
        lambda: _save(_of_states(analysis, p_m), place, kind),
        lambda: _save(_of_regions(analysis), place, kind),
    )
    return one + two


def _save(figures: _Figures, folder: Path, kind: str) -> list[Path]:
    written: list[Path] = []
    for name, figure in figures:
        path = folder / f"{name}.{kind}"
        write_figure(path, figure)
        written.append(path)
    return written
