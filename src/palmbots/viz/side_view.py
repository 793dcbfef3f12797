# SPDX-License-Identifier: Apache-2.0
"""Draws one frame of a carry from the side, quickly and with few colours, for animations.

The upper part shows the robots and the object to scale (`side_view_scene`). Below it are a gauge
for each palm (contact coordinate, zero zone, palm ends) and a time axis with all corrections.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import matplotlib
from PIL import Image, ImageDraw, ImageFont

from palmbots._types import SIDES, Side
from palmbots.scene.placement import Placement
from palmbots.viz.side_view_scene import WIDTH, Message, WorldView
from palmbots.viz.style import (
    BACKGROUND,
    DROP,
    FLOOR,
    HUE,
    INK,
    OBJECT,
    PALE,
    QUIET,
    SLIDES,
    ZERO,
)
from palmbots.viz.timeline import Bar

if TYPE_CHECKING:
    from palmbots._core import Spec

COLOURS = (
    BACKGROUND, INK, QUIET, ZERO, OBJECT, DROP, SLIDES, FLOOR, *HUE.values(), *PALE.values()
)  # fmt: skip

_TOP, _FOOT = 62, 128  # px above the scene for captions, below it for gauges and time axis
_LINE = (56, WIDTH - 56)  # px, ends of the time axis


@cache
def _font(size: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(f"{matplotlib.get_data_path()}/fonts/ttf/{name}", size)


@dataclass(frozen=True)
class Moment:
    """The content of one frame; pairs are (left, right)."""

    row: int  #: of the placement
    time: float  #: s
    case: tuple[str, str]  #: empty for none
    sign: tuple[int, int]
    motion: tuple[int, int]
    contact: tuple[float, float]  #: m; NaN: nothing is on this palm
    message: Message | None
    ending: str | None  #: text of the outcome in the last frame
    good: bool  #: whether the outcome is a delivery
    does: tuple[str, str] | None = None  #: text of the action of each robot that is in no case
    moved: float | None = None  #: by the object in a job, forward [m]


class Stage:
    """The parts that are equal in all frames, and `frame` to draw the others."""

    def __init__(
        self,
        spec: "Spec",
        placement: Placement,
        bars: Sequence[Bar],
        duration: float,
        title: str,
        cases: Mapping[str, str] | None = None,
    ) -> None:
        """`bars` are the corrections on the time axis, `duration` is its length in s, `cases` are
        the meanings of the cases."""
        self._spec, self._placement = spec, placement
        self._cases = cases or {}
        self._duration = max(duration, 1e-9)
        self._world = WorldView(spec, placement)
        self.size = (WIDTH, _TOP + self._world.height + _FOOT)  #: px, both even
        self._gauge_y = _TOP + self._world.height + 34
        self._line_y = self.size[1] - 32
        self._backdrop = self._draw_backdrop(bars, title)

    def frame(self, moment: Moment) -> Image.Image:
        """The image of one moment, RGB."""
        image = self._backdrop.copy()
        left, right = moment.case
        world, notes = self._world.draw(
            moment.row,
            (bool(left), bool(right)),
            [
                None if math.isnan(p) else motion
                for motion, p in zip(moment.motion, moment.contact, strict=True)
            ],
            moment.message,
        )
        image.paste(world, (0, _TOP))
        draw = ImageDraw.Draw(image)
        for note in notes:
            x, y = note.place
            draw.text((x, y + _TOP), note.text, QUIET, _font(11), anchor="ma")
        self._write(draw, moment)
        self._point(draw, moment)
        return image

    def move(self, placement: Placement) -> None:
        """Show another placement in the following frames, to the same scale."""
        self._placement = self._world.placement = placement

    # --- the constant parts ---------------------------------------------------------------------

    def _draw_backdrop(self, bars: Sequence[Bar], title: str) -> Image.Image:
        image = Image.new("RGB", self.size, BACKGROUND)
        draw = ImageDraw.Draw(image)
        draw.text((WIDTH / 2, 8), title, INK, _font(14), anchor="ma")
        for k, side in enumerate(SIDES):
            self._draw_gauge(draw, k, side)
        y = self._line_y
        draw.line((_LINE[0], y, _LINE[1], y), QUIET, 1)
        for bar in bars:
            self._draw_bar(draw, bar)
        for side, level in zip(SIDES, (y - 11, y + 11), strict=True):
            draw.text((_LINE[0] - 8, level), side, HUE[side], _font(11), anchor="rm")
        draw.text((_LINE[1] + 8, y), f"{self._duration:.1f} s", INK, _font(11), anchor="lm")
        return image

    def _time_x(self, time: float) -> float:
        return _LINE[0] + (_LINE[1] - _LINE[0]) * min(max(time / self._duration, 0.0), 1.0)

    def _draw_bar(self, draw: ImageDraw.ImageDraw, bar: Bar) -> None:
        """A correction with its label, if there is room; an empty bar if the robot assists."""
        low, high = (-18, -4) if bar.row == "left" else (4, 18)
        start = self._time_x(bar.start)
        end = max(self._time_x(bar.end), start + 2)
        box = (start, self._line_y + low, end, self._line_y + high)
        if bar.assists:
            draw.rectangle(box, BACKGROUND, HUE[bar.hue])
            return
        draw.rectangle(box, HUE[bar.hue], BACKGROUND)
        name = bar.text.split(" ")[0]
        if draw.textlength(name, _font(11, True)) + 3 <= end - start:
            middle = ((start + end) / 2, self._line_y + (low + high) / 2)
            draw.text(middle, name, BACKGROUND, _font(11, True), anchor="mm")

    def _gauge_x(self, k: int, p: float) -> float:
        """The position of a contact coordinate on its gauge, outward as in the image."""
        half = self._spec.palms[k].length / 2
        return WIDTH / 2 + (-1, 1)[k] * (235 + 105 * min(max(p / half, -1.15), 1.15))

    def _draw_gauge(self, draw: ImageDraw.ImageDraw, k: int, side: Side) -> None:
        y = self._gauge_y
        half = self._spec.palms[k].length / 2
        for sign, low, high in self._spec.zones:
            if sign == 0:
                ends = sorted(self._gauge_x(k, min(max(e, -half), half)) for e in (low, high))
                draw.rectangle((ends[0], y - 9, ends[1], y + 9), PALE["zero"])
        ends = self._gauge_x(k, -half), self._gauge_x(k, half)
        draw.line((ends[0], y, ends[1], y), HUE[side], 3)
        for end in ends:
            draw.line((end, y - 9, end, y + 9), HUE[side], 2)
        draw.text((self._gauge_x(k, -1.13 * half), y), "−", INK, _font(14), anchor="mm")
        draw.text((self._gauge_x(k, 1.13 * half), y), "+", INK, _font(14), anchor="mm")

    # --- the moving parts -----------------------------------------------------------------------

    def _write(self, draw: ImageDraw.ImageDraw, moment: Moment) -> None:
        """Time, distance, the action of each robot, and at the end the outcome."""
        distance = moment.moved
        if distance is None:
            distance = float(self._placement.pivot[moment.row, :, 0].mean()) * self._spec.direction
        draw.text((12, 8), f"t = {moment.time:5.2f} s", INK, _font(14, True))
        draw.text((WIDTH - 12, 8), f"{distance:.2f} m", INK, _font(14, True), anchor="ra")
        for k, side in enumerate(SIDES):
            case = moment.case[k]
            text = moment.does[k] if moment.does is not None else "carries on"
            text = f"({case})  {self._cases.get(case, '')}" if case else text
            place, anchor = ((12, 34), "la") if k == 0 else ((WIDTH - 12, 34), "ra")
            shade = HUE[side] if case else QUIET
            draw.text(place, f"{side}: {text}", shade, _font(14, bool(case)), anchor=anchor)

            x, y = self._world.body_middle(moment.row, k)
            name = f"({case})" if case else side[0].upper()
            font = _font(min(max(round(0.05 * self._world.scale), 9), 48), True)
            draw.text((x, y + _TOP), name, BACKGROUND if case else HUE[side], font, anchor="mm")
        if moment.ending is not None:
            colour = ZERO if moment.good else DROP
            draw.text((WIDTH / 2, 34), moment.ending, colour, _font(16, True), anchor="ma")

    def _point(self, draw: ImageDraw.ImageDraw, moment: Moment) -> None:
        """Pointers on the gauges and on the time axis."""
        for k, side in enumerate(SIDES):
            p, y = moment.contact[k], self._gauge_y
            where = "nothing on it"
            if not math.isnan(p):
                x = self._gauge_x(k, p)
                draw.polygon([(x, y - 2), (x - 6, y - 13), (x + 6, y - 13)], INK)
                where = f"p = {p * 1e3:+.1f} mm"
            sign = {-1: "−", 0: "0", 1: "+"}[moment.sign[k]]
            text = f"{where}   sensor {sign}".replace("-", "−")
            draw.text((self._gauge_x(k, 0.0), y - 18), text, HUE[side], _font(13), anchor="ms")
        x = self._time_x(moment.time)
        draw.line((x, self._line_y - 21, x, self._line_y + 21), INK, 2)
