"""Films and stills of a carry in the dynamic world, rendered off-screen by MuJoCo.

Nothing is simulated again: every frame is a state that the carry kept. Drawn into it are friction
cones and forces (`overlay`).
The camera goes with the pair and looks across it. On a curved path it turns with the pair, looks
more from above, and the path is drawn on the floor.
"""

import math
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from palmbots.dynamic.curved import Line, line_of
from palmbots.dynamic.edges import edges_of, fit_edges
from palmbots.dynamic.engine import check_offscreen, mujoco, offscreen
from palmbots.dynamic.model import layout, mjcf
from palmbots.dynamic.overlay import Overlay
from palmbots.errors import PalmbotsError
from palmbots.files import whole_file
from palmbots.geometry import SIDES
from palmbots.mp4 import encoder_for, write_mp4
from palmbots.style import DROP, HUE, INK, ZERO

if TYPE_CHECKING:
    from palmbots.result import Carry

__all__ = ["SIZE", "Studio", "check_film", "save_film", "save_still", "telling_row"]

SIZE = (854, 480)
_FPS = 20.0
_LAST_FRAME_S = 2.0
_LONGEST_S = 60.0  # a longer carry is shown faster
_INSTEAD = "install ffmpeg"
_FROM_ABOVE_DEG = -28.0  # on a curved path


class Studio:
    """A carry's states as pictures. Use as a context: the renderer holds graphics memory."""

    def __init__(self, carry: "Carry", size: tuple[int, int] = SIZE, shadows: bool = False) -> None:
        if carry.physics is None or carry.trace is None:
            raise PalmbotsError(
                "film: this carry has no states; allowed: world mujoco, with record=True"
            )
        self._mj = mujoco()
        self._states, trace = carry.physics.states, carry.trace
        self._model: Any = self._mj.MjModel.from_xml_string(mjcf(carry.scene, carry.physics.engine))
        self._data: Any = self._mj.MjData(self._model)
        self._kind = int(self._mj.mjtState.mjSTATE_INTEGRATION)
        self._palms = [self._model.body(f"{side}_palm").id for side in SIDES]
        self._height = layout(carry.scene).height
        self._times = trace["time"].to_numpy()
        self._motion, self._sign, self._case = (
            trace[name].transpose("time", "side").to_numpy() for name in ("motion", "sign", "case")
        )
        self._ending = carry.outcome if carry.reason is None else f"{carry.outcome}: {carry.reason}"
        self._good = carry.outcome == "delivered"
        self.name = f"{carry.controller}, seed {carry.seed}, MuJoCo" + _sloped(carry)
        self._size = size
        self._renderer = offscreen(self._model, size)
        # Without a graphics card shadows take two thirds of the time.
        self._renderer.scene.flags[int(self._mj.mjtRndFlag.mjRND_SHADOW)] = shadows
        self._overlay = Overlay(self._model, self._data, carry.scene)
        self._camera = self._mj.MjvCamera()
        self._camera.azimuth, self._camera.elevation = 96.0, -10.0
        self._camera.distance = float(trace["separation"].max()) + 0.55
        self._edges = edges_of(self._model, carry.scene)
        self._line: Line | None = None
        if carry.scene.task.path.is_curved:
            self._line = line_of(carry.scene)
            self._way = trace["midpoint"].to_numpy()
            self._camera.elevation = _FROM_ABOVE_DEG
            self._camera.distance += 0.15
        self._ahead = np.array([1.0, 0.0, 0.0])
        self._font = ImageFont.truetype(_font(), size[1] // 27)

    def __enter__(self) -> "Studio":
        return self

    def __exit__(self, *_: object) -> None:
        self._renderer.close()

    def picture(self, row: int, note: str = "") -> Image.Image:
        """The state at a row of the trace."""
        d, m = self._data, self._model
        self._mj.mj_setState(m, d, self._states[row], self._kind)
        self._mj.mj_forward(m, d)
        fit_edges(m, d, self._edges)
        self._mj.mj_forward(m, d)
        one, two = (d.xpos[palm] for palm in self._palms)
        self._camera.lookat[:] = (0.5 * (one[0] + two[0]), 0.0, self._height - 0.04)
        if self._line is not None:
            self._camera.lookat[1] = 0.5 * (one[1] + two[1])
            heading = math.atan2(two[1] - one[1], two[0] - one[0])
            self._camera.azimuth = 96.0 + math.degrees(heading)
            self._ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
        self._renderer.update_scene(d, self._camera)
        into = self._renderer.scene
        if self._line is not None:
            self._overlay.path(into, self._line, float(self._way[row]))
        left, right = self._motion[min(row, len(self._motion) - 1)].tolist()
        self._overlay.contacts(into, (left, right), self._camera.lookat, self._ahead)
        image = Image.fromarray(self._renderer.render())
        self._label(image, row, note)
        return image

    def _label(self, image: Image.Image, row: int, note: str) -> None:
        draw = ImageDraw.Draw(image)
        left, right = (self._told(row, k) for k in (0, 1))
        wide, high = self._size
        pad = high // 40
        draw.text((pad, pad), f"{self._times[row]:6.2f} s   {self.name}{note}", INK, self._font)
        line = high // 18
        draw.text((pad, pad + line), left, HUE["left"], self._font)
        draw.text((wide - pad, pad + line), right, HUE["right"], self._font, anchor="ra")
        if row == len(self._times) - 1:
            colour = ZERO if self._good else DROP
            draw.text((wide - pad, pad), self._ending, colour, self._font, anchor="ra")

    def _told(self, row: int, k: int) -> str:
        case = str(self._case[row, k]).strip()
        sign = "−0+"[int(self._sign[row, k]) + 1]
        return f"{SIDES[k]}: sensor {sign}" + (f", case ({case})" if case else "")


def check_film(path: str | os.PathLike[str]) -> None:
    """Raise `PalmbotsError` where no film could be made, before there is anything to film."""
    encoder_for(path, _INSTEAD)
    check_offscreen()


def save_film(
    carry: "Carry",
    path: str | os.PathLike[str],
    *,
    size: tuple[int, int] = SIZE,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write the carry as MP4, in real time up to a minute; the file appears whole or not at all.

    Raises `PalmbotsError` for a carry without states, without ffmpeg, or where nothing renders.
    """
    encoder = encoder_for(path, _INSTEAD)
    with Studio(carry, size) as studio, whole_file(path) as stream:
        images = _frames(carry, studio, progress)
        write_mp4(encoder, size, images, stream, _FPS, path, _LAST_FRAME_S)


def save_still(
    carry: "Carry",
    path: str | os.PathLike[str],
    row: int | None = None,
    size: tuple[int, int] = SIZE,
) -> None:
    """Write one moment as PNG: a row of the trace, or one in which something goes on."""
    with Studio(carry, size) as studio, whole_file(path) as stream:
        studio.picture(telling_row(carry) if row is None else row).save(stream, format="png")


def telling_row(carry: "Carry") -> int:
    """The middle of the first correction; of the carry, where there is none."""
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    if not carry.corrections:
        return len(times) // 2
    first = carry.corrections[0]
    return int(np.searchsorted(times, 0.5 * (first.start_s + first.end_s)))


def _frames(
    carry: "Carry", studio: Studio, progress: Callable[[float], None] | None
) -> Iterator[Image.Image]:
    assert carry.trace is not None
    times = carry.trace["time"].to_numpy()
    lasts = float(times[-1])
    faster = max(1, math.ceil(lasts / _LONGEST_S))
    wanted = np.arange(int(lasts * _FPS / faster) + 1) * faster / _FPS
    rows = np.searchsorted(times, wanted + 1e-9, side="right") - 1
    rows = np.unique(np.append(rows, len(times) - 1))
    note = f", {faster} × real time" if faster > 1 else ""
    for done, row in enumerate(rows.tolist(), start=1):
        yield studio.picture(row, note)
        if progress is not None:
            progress(done / len(rows))


def _sloped(carry: "Carry") -> str:
    """The slope in words: it turns gravity, so that no picture shows it."""
    slope = carry.scene.task.slope_deg
    if slope == 0:
        return ""
    return f", {abs(slope):g}° {'uphill' if slope > 0 else 'downhill'}"


def _font() -> str:
    import matplotlib

    return str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf")
