# SPDX-License-Identifier: Apache-2.0
"""Videos and stills of a carry in MuJoCo, rendered off-screen.

Nothing is simulated again: every frame shows a recorded state, with friction cones and forces drawn
into it (`overlay`). The camera follows the pair from the side. On a curved path it turns with the
pair and looks down at a steeper angle, and the path is drawn on the floor.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from palmbots._types import SIDES
from palmbots._util.atomic_files import whole_file
from palmbots.errors import PalmbotsError
from palmbots.mujoco.curved_world import Line, line_of
from palmbots.mujoco.edge_contacts import edges_of, fit_edges
from palmbots.mujoco.engine import check_offscreen, mujoco, offscreen
from palmbots.mujoco.mjcf import camera_height, mjcf
from palmbots.mujoco.overlay import Overlay
from palmbots.simulation.floor_job import phase_at
from palmbots.viz.style import BACKGROUND, DROP, HUE, INK, ZERO
from palmbots.viz.video_files import check_video, write_video

if TYPE_CHECKING:
    from palmbots.simulation.result import Carry

SIZE = (854, 480)
"""Width and height of a video in pixels."""
_FPS = {".mp4": 20.0, ".gif": 10.0}
_COLOURS = (BACKGROUND, INK, ZERO, DROP, HUE["left"], HUE["right"])  # of the labels
_LONGEST_S = 60.0  # a longer carry is shown faster
_FROM_ABOVE_DEG = -28.0  # on a curved path


class VideoRenderer:
    """Renders the states of a carry.

    Use it as a context manager: the renderer holds graphics memory.
    """

    def __init__(self, carry: Carry, size: tuple[int, int] = SIZE, shadows: bool = False) -> None:
        if carry.mujoco_record is None or carry.trace is None:
            raise PalmbotsError(
                'video: this carry has no states; run it with world="mujoco" and record=True'
            )
        self._mj = mujoco()
        self._states, trace = carry.mujoco_record.states, carry.trace
        self._walls = carry.mujoco_record.walls_m
        self._model: Any = self._mj.MjModel.from_xml_string(
            mjcf(carry.scene, carry.mujoco_record.engine)
        )
        self._data: Any = self._mj.MjData(self._model)
        self._kind = int(self._mj.mjtState.mjSTATE_INTEGRATION)
        self._palms = [self._model.body(f"{side}_palm").id for side in SIDES]
        self._height = camera_height(carry.scene)
        self._times = trace["time"].to_numpy()
        self._motion, self._sign, self._case = (
            trace[name].transpose("time", "side").to_numpy() for name in ("motion", "sign", "case")
        )
        self._ending = carry.outcome if carry.reason is None else f"{carry.outcome}: {carry.reason}"
        self._good = carry.outcome == "delivered"
        self._job = carry.floor_job
        self.name = f"{carry.controller}, seed {carry.seed}, MuJoCo" + _sloped(carry)
        self._size = size
        self._renderer = offscreen(self._model, size)
        # Without a graphics card, shadows take two thirds of the time.
        self._renderer.scene.flags[int(self._mj.mjtRndFlag.mjRND_SHADOW)] = shadows
        self._overlay = Overlay(self._model, self._data, carry.scene)
        self._camera = self._mj.MjvCamera()
        self._camera.azimuth, self._camera.elevation = 96.0, -10.0
        self._camera.distance = float(trace["separation"].max()) + 0.55
        self._edges = edges_of(self._model, carry.scene)
        self._line: Line | None = None
        if carry.scene.task.path.is_curved:
            self._line = line_of(carry.scene)
            self._distance = trace["midpoint"].to_numpy()
            self._camera.elevation = _FROM_ABOVE_DEG
            self._camera.distance += 0.15
        self._ahead = np.array([1.0, 0.0, 0.0])
        self._font = ImageFont.truetype(_font(), size[1] // 27)

    def __enter__(self) -> VideoRenderer:
        return self

    def __exit__(self, *_: object) -> None:
        self._renderer.close()

    def picture(self, row: int, note: str = "") -> Image.Image:
        """Render the state at a row of the trace."""
        d, m = self._data, self._model
        self._mj.mj_setState(m, d, self._states[row], self._kind)
        self._mj.mj_forward(m, d)
        fit_edges(m, d, self._edges)
        self._mj.mj_forward(m, d)
        one, two = (d.xpos[palm] for palm in self._palms)
        self._camera.lookat[:] = (0.5 * (one[0] + two[0]), 0.0, self._height)
        if self._line is not None:
            self._camera.lookat[1] = 0.5 * (one[1] + two[1])
            heading = math.atan2(two[1] - one[1], two[0] - one[0])
            self._camera.azimuth = 96.0 + math.degrees(heading)
            self._ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
        self._renderer.update_scene(d, self._camera)
        into = self._renderer.scene
        if self._line is not None:
            self._overlay.path(into, self._line, float(self._distance[row]))
        for wall in self._walls:
            self._overlay.wall(into, wall)
        left, right = self._motion[min(row, len(self._motion) - 1)].tolist()
        self._overlay.contacts(into, (left, right), self._camera.lookat, self._ahead)
        image = Image.fromarray(self._renderer.render())
        self._label(image, row, note)
        return image

    def _label(self, image: Image.Image, row: int, note: str) -> None:
        draw = ImageDraw.Draw(image)
        left, right = (self._robot_text(row, k) for k in (0, 1))
        width, height = self._size
        pad = height // 40
        draw.text((pad, pad), f"{self._times[row]:6.2f} s   {self.name}{note}", INK, self._font)
        line = height // 18
        draw.text((pad, pad + line), left, HUE["left"], self._font)
        draw.text((width - pad, pad + line), right, HUE["right"], self._font, anchor="ra")
        if row == len(self._times) - 1:
            colour = ZERO if self._good else DROP
            draw.text((width - pad, pad), self._ending, colour, self._font, anchor="ra")

    def _robot_text(self, row: int, k: int) -> str:
        case = str(self._case[row, k]).strip()
        sign = "−0+"[int(self._sign[row, k]) + 1]
        phase = ""
        if self._job is not None:
            name = phase_at(self._job, SIDES[k], float(self._times[row]))
            phase = f"{name.replace('_', ' ') or 'stands aside'}, "
        return f"{SIDES[k]}: {phase}sensor {sign}" + (f", case ({case})" if case else "")


def check_film(path: str | os.PathLike[str]) -> None:
    """Check that a video can be written to `path`, before the carry.

    Raises:
        PalmbotsError: as `palmbots.viz.video_files.check_video`, or nothing can be rendered here.
    """
    check_video(path)
    check_offscreen()


def save_video(
    carry: Carry,
    path: str | os.PathLike[str],
    *,
    size: tuple[int, int] = SIZE,
    on_progress: Callable[[float], None] | None = None,
) -> None:
    """Write the carry as MP4 or GIF, by the suffix. The file appears only when it is complete.

    A carry of up to a minute is shown in real time, a longer one faster.

    Raises:
        PalmbotsError: the carry has no states, as `check_film`, or the path cannot be written.
    """
    check_video(path)
    suffix = Path(path).suffix.lower()
    fps = _FPS[suffix]
    with VideoRenderer(carry, size) as renderer:
        rows, speedup = _rows(carry, fps)
        moments = (rows[0], most_informative_row(carry), rows[-1]) if suffix == ".gif" else ()
        samples = [renderer.picture(row) for row in moments]
        frames = _frames(rows, speedup, renderer, on_progress)
        write_video(path, frames, size=size, fps=fps, colours=_COLOURS, samples=samples)


def save_still(
    carry: Carry,
    path: str | os.PathLike[str],
    row: int | None = None,
    size: tuple[int, int] = SIZE,
) -> None:
    """Write one moment as PNG: a row of the trace; None: the middle of the first correction."""
    with VideoRenderer(carry, size) as renderer, whole_file(path) as stream:
        renderer.picture(most_informative_row(carry) if row is None else row).save(
            stream, format="png"
        )


def most_informative_row(carry: Carry) -> int:
    """The row in the middle of the first correction; without corrections, of the carry."""
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    if not carry.corrections:
        return len(times) // 2
    first = carry.corrections[0]
    return int(np.searchsorted(times, 0.5 * (first.start_s + first.end_s)))


def _rows(carry: Carry, fps: float) -> tuple[list[int], int]:
    """The rows of the trace to show, and the speedup."""
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    duration = float(times[-1])
    speedup = max(1, math.ceil(duration / _LONGEST_S))
    wanted = np.arange(int(duration * fps / speedup) + 1) * speedup / fps
    rows = np.searchsorted(times, wanted + 1e-9, side="right") - 1
    return np.unique(np.append(rows, len(times) - 1)).tolist(), speedup


def _frames(
    rows: list[int],
    speedup: int,
    renderer: VideoRenderer,
    on_progress: Callable[[float], None] | None,
) -> Iterator[Image.Image]:
    note = f", {speedup} × real time" if speedup > 1 else ""
    for number, row in enumerate(rows, start=1):
        yield renderer.picture(row, note)
        if on_progress is not None:
            on_progress(number / len(rows))


def _sloped(carry: Carry) -> str:
    """The slope in words, because it tilts gravity and is not visible."""
    slope = carry.scene.task.slope_deg
    if slope == 0:
        return ""
    return f", {abs(slope):g}° {'uphill' if slope > 0 else 'downhill'}"


def _font() -> str:
    import matplotlib

    return str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf")
