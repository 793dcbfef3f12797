"""One picture of a carry from the side, as an animation needs it: quick to draw, few colours.

Shapes are drawn at twice the size and halved, which smooths their edges; text is drawn afterwards
at the final size. The upper part shows the world as it is, to scale; below it stand a gauge for
each palm (contact coordinate, zero zone, palm ends) and a line of time with all the corrections.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from palmbots.figure8_story import Bar
from palmbots.geometry import (
    BODY_GAP,
    BODY_SIZE,
    PALM_THICKNESS,
    WHEEL_RADIUS,
    Placement,
    floor_level,
)
from palmbots.style import DROP, HUE, INK, OBJECT, PALE, QUIET, SLIDES, ZERO

if TYPE_CHECKING:
    from palmbots._core import Spec

__all__ = ["SIDES", "WIDTH", "Moment", "Stage", "palette_image"]

SIDES = ("left", "right")
WIDTH = 900  # px
_TOP, _FOOT = 62, 128  # px above the world for captions, below it for gauges and line of time
_TALLEST = 400  # px the world itself may take
_FINE = 2  # drawn this many times larger, then reduced

_FLOOR = "#EFEFEF"
_BLENDS = 160

CASE_TEXT = {
    "a": "(a)  p > 0: moves away",
    "b": "(b)  both p > 0: moves away in turn",
    "c": "(c)  assists: palm up",
    "d": "(d)  p < 0: moves closer",
}


@cache
def _font(size: int, bold: bool = False) -> ImageFont.FreeTypeFont:
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / name, size)


@dataclass(frozen=True)
class Moment:
    """What one frame shows; pairs are (left, right)."""

    row: int  # of the stage's placement
    time: float  # s
    case: tuple[str, str]
    sign: tuple[int, int]
    motion: tuple[int, int]
    contact: tuple[float, float]  # m
    message: tuple[str, str, str] | None  # sender, receiver, text
    ending: str | None  # what to say of the outcome, once it is reached
    good: bool = True  # whether that ending is a delivery


def palette_image(stage: "Stage", samples: Sequence[Image.Image]) -> Image.Image:
    """A palette for all frames: the plain colours, and between them the blends the samples have.

    At most 255 colours, so that a GIF has one left for "unchanged".
    """
    plain = [_rgb(c) for c in (*stage.colours, "#FFFFFF")]
    sheet = Image.new("RGB", (WIDTH, sum(s.height for s in samples)))
    for k, sample in enumerate(samples):
        sheet.paste(sample, (0, k * sample.height))
    learnt = sheet.quantize(_BLENDS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    values = (learnt.getpalette() or [])[: 3 * _BLENDS]
    blends = list(zip(values[::3], values[1::3], values[2::3], strict=True))
    # Pillow finds the nearest entry only roughly: a blend close to a plain colour would replace it.
    far = [b for b in blends if all(max(abs(x - y) for x, y in zip(b, p)) > 12 for p in plain)]
    palette = Image.new("P", (1, 1))
    palette.putpalette([v for colour in (*plain, *far) for v in colour])
    return palette


def _rgb(colour: str) -> tuple[int, int, int]:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


class Stage:
    """Everything that stays the same from frame to frame, and `frame` to draw the rest."""

    def __init__(
        self,
        spec: "Spec",
        placement: Placement,
        bars: Sequence[Bar],
        duration: float,
        title: str,
    ) -> None:
        self.spec, self.placement = spec, placement
        self.duration = max(duration, 1e-9)
        self.floor = floor_level(spec)
        self._measure()
        self.colours = (
            INK,
            QUIET,
            ZERO,
            OBJECT,
            DROP,
            SLIDES,
            _FLOOR,
            *HUE.values(),
            *PALE.values(),
        )
        self._backdrop = self._draw_backdrop(bars, title)

    def _measure(self) -> None:
        """Choose the scale so that both robots and the whole object stay in view."""
        place, spec = self.placement, self.spec
        centre = place.pivot[..., 0].mean(axis=1)
        body = np.abs(place.pivot[..., 0] - centre[:, None]).max() + BODY_GAP + BODY_SIZE
        thing = np.abs(place.outline[..., 0] - centre[:, None]).max()
        palms = max(palm.length / 2 for palm in spec.palms)
        half_wide = max(body, thing, np.ptp(place.pivot[..., 0], axis=1).max() / 2 + palms) + 0.05
        self._ceiling = max(float(place.outline[..., 1].max()), palms) + 0.02
        tall = self._ceiling - self.floor + 0.04
        slope = abs(spec.slope)
        self.scale = min(WIDTH / 2 / half_wide, _TALLEST / (tall + 2 * slope * half_wide))
        self._rise = (
            slope * half_wide * self.scale
        )  # px the slope lifts one side and lowers the other
        self._world_px = 2 * math.ceil((tall * self.scale + 2 * self._rise) / 2)
        self.size = (WIDTH, _TOP + self._world_px + _FOOT)
        angle = math.atan(spec.slope)  # > 0: the floor rises forward
        self._cos, self._sin = math.cos(angle), math.sin(angle)

    def _to_screen(self, camera: float, points: np.ndarray) -> list[tuple[float, float]]:
        """Pixels of the enlarged world picture for world points (…, 2); the floor follows the slope."""
        x, y = points[..., 0] - camera, points[..., 1] - self.floor
        across = self._cos * x - self._sin * y
        up = self._sin * x + self._cos * y
        bottom = self._world_px - 0.04 * self.scale - self._rise
        px = (WIDTH / 2 + across * self.scale) * _FINE
        py = (bottom - up * self.scale) * _FINE
        return list(zip(px.tolist(), py.tolist(), strict=True))

    # --- what never changes -------------------------------------------------------------------

    def _draw_backdrop(self, bars: Sequence[Bar], title: str) -> Image.Image:
        image = Image.new("RGB", self.size, "white")
        draw = ImageDraw.Draw(image)
        draw.text((WIDTH / 2, 8), title, INK, _font(14), anchor="ma")
        self._gauge_y = _TOP + self._world_px + 34
        self._line_y = self.size[1] - 32
        for k, side in enumerate(SIDES):
            self._draw_gauge(draw, k, side)
        left, right = self._line_ends
        draw.line((left, self._line_y, right, self._line_y), QUIET, 1)
        for bar in bars:
            self._draw_bar(draw, bar)
        draw.text((left - 8, self._line_y - 11), "left", HUE["left"], _font(11), anchor="rm")
        draw.text((left - 8, self._line_y + 11), "right", HUE["right"], _font(11), anchor="rm")
        draw.text((right + 8, self._line_y), f"{self.duration:.3g} s", INK, _font(11), anchor="lm")
        return image

    _line_ends = (56, WIDTH - 56)

    def _time_x(self, time: float) -> float:
        left, right = self._line_ends
        return left + (right - left) * min(max(time / self.duration, 0.0), 1.0)

    def _draw_bar(self, draw: ImageDraw.ImageDraw, bar: Bar) -> None:
        low, high = (-18, -4) if bar.row == "left" else (4, 18)
        x0 = self._time_x(bar.start)
        x1 = max(self._time_x(bar.end), x0 + 2)
        box = (x0, self._line_y + low, x1, self._line_y + high)
        if bar.assists:
            draw.rectangle(box, "white", HUE[bar.hue])
            return
        draw.rectangle(box, HUE[bar.hue])
        name = bar.text.split(" ")[0]
        if draw.textlength(name, _font(11, True)) + 3 <= x1 - x0:
            middle = ((x0 + x1) / 2, self._line_y + (low + high) / 2)
            draw.text(middle, name, "white", _font(11, True), anchor="mm")

    def _gauge_x(self, k: int, p: float) -> float:
        """Where a contact coordinate stands on its gauge: outward is to the outer side, as it is."""
        outward = -1 if k == 0 else 1
        half = self.spec.palms[k].length / 2
        return WIDTH / 2 + outward * (235 + 105 * min(max(p / half, -1.15), 1.15))

    def _draw_gauge(self, draw: ImageDraw.ImageDraw, k: int, side: str) -> None:
        y = self._gauge_y
        half = self.spec.palms[k].length / 2
        for sign, low, high in self.spec.zones:
            if sign == 0:
                ends = sorted(self._gauge_x(k, min(max(e, -half), half)) for e in (low, high))
                draw.rectangle((ends[0], y - 9, ends[1], y + 9), PALE["zero"])
        ends = self._gauge_x(k, -half), self._gauge_x(k, half)
        draw.line((ends[0], y, ends[1], y), HUE[side], 3)
        for end in ends:
            draw.line((end, y - 9, end, y + 9), HUE[side], 2)
        inner, outer = -1.13 * half, 1.13 * half
        draw.text((self._gauge_x(k, inner), y), "−", INK, _font(14), anchor="mm")
        draw.text((self._gauge_x(k, outer), y), "+", INK, _font(14), anchor="mm")

    # --- what moves -----------------------------------------------------------------------------

    def frame(self, moment: Moment) -> Image.Image:
        """The picture of one moment, WIDTH wide, RGB."""
        image = self._backdrop.copy()
        world, names = self._draw_world(moment)
        image.paste(world.reduce(_FINE), (0, _TOP))
        draw = ImageDraw.Draw(image)
        for place, text in names:
            draw.text(place, text, QUIET, _font(11), anchor="ma")
        self._name_robots(draw, moment)
        self._write(draw, moment)
        self._point(draw, moment)
        return image

    def _name_robots(self, draw: ImageDraw.ImageDraw, moment: Moment) -> None:
        """The case, or else the robot's initial, on each body."""
        pivots = self.placement.pivot[moment.row]
        camera = float(pivots[:, 0].mean())
        for k, side in enumerate(SIDES):
            case = moment.case[k].strip()
            outward = (-1, 1)[k] * (BODY_GAP + 0.62 * BODY_SIZE)
            centre = np.array([[pivots[k, 0] + outward, self.floor + 0.02 + 0.6 * BODY_SIZE]])
            (x, y) = self._to_screen(camera, centre)[0]
            text = f"({case})" if case in CASE_TEXT else case or side[0].upper()
            colour = "white" if case else HUE[side]
            size = max(round(0.05 * self.scale), 10)
            place = (x / _FINE, y / _FINE + _TOP)
            draw.text(place, text, colour, _font(size, True), anchor="mm")

    def _write(self, draw: ImageDraw.ImageDraw, moment: Moment) -> None:
        """Captions of the robots, time, message and ending."""
        gone = float(self.placement.pivot[moment.row, :, 0].mean())
        draw.text((12, 8), f"t = {moment.time:5.2f} s", INK, _font(14, True))
        draw.text((WIDTH - 12, 8), f"{gone:.2f} m", INK, _font(14, True), anchor="ra")
        for k, (side, x, anchor) in enumerate((("left", 12, "la"), ("right", WIDTH - 12, "ra"))):
            case = moment.case[k].strip()
            text = CASE_TEXT.get(case, f"case {case}") if case else "carries on"
            shade = HUE[side] if case else QUIET
            draw.text((x, 34), f"{side}: {text}", shade, _font(14, bool(case)), anchor=anchor)
        if moment.ending is not None:
            colour = ZERO if moment.good else DROP
            draw.text((WIDTH / 2, 34), moment.ending, colour, _font(16, True), anchor="ma")

    def _point(self, draw: ImageDraw.ImageDraw, moment: Moment) -> None:
        """Pointers on the gauges and on the line of time."""
        for k, side in enumerate(SIDES):
            x, y, p = self._gauge_x(k, moment.contact[k]), self._gauge_y, moment.contact[k] * 1e3
            draw.polygon([(x, y - 2), (x - 6, y - 13), (x + 6, y - 13)], INK)
            sign = {-1: "−", 0: "0", 1: "+"}[moment.sign[k]]
            text = f"p = {p:+.1f} mm   sensor {sign}".replace("-", "−")
            middle = self._gauge_x(k, 0.0)
            draw.text((middle, y - 18), text, HUE[side], _font(13), anchor="ms")
        x = self._time_x(moment.time)
        draw.line((x, self._line_y - 21, x, self._line_y + 21), INK, 2)

    def _draw_world(
        self, moment: Moment
    ) -> tuple[Image.Image, list[tuple[tuple[float, float], str]]]:
        """The enlarged picture of floor, robots and object, and the names of the floor's marks."""
        place, row = self.placement, moment.row
        camera = float(place.pivot[row, :, 0].mean())
        image = Image.new("RGB", (WIDTH * _FINE, self._world_px * _FINE), "white")
        draw = ImageDraw.Draw(image)
        names = self._draw_floor(draw, camera)
        for k, side in enumerate(SIDES):
            self._draw_robot(draw, camera, row, k, side, bool(moment.case[k].strip()))
        outline = self._to_screen(camera, place.outline[row])
        draw.polygon(outline, OBJECT)
        draw.line([*outline, outline[0]], INK, 3, joint="curve")
        (x, y), r = self._to_screen(camera, place.com[row][None])[0], 12
        draw.ellipse((x - r, y - r, x + r, y + r), "white", INK, 2)
        for start in (0, 180):
            draw.pieslice((x - r, y - r, x + r, y + r), start, start + 90, INK)
        for k, side in enumerate(SIDES):
            self._draw_palm(draw, camera, row, k, side)
        for k in range(2):
            self._draw_contact(draw, camera, row, k, moment.motion[k])
        if moment.message is not None:
            names += self._draw_message(draw, camera, row, moment.message)
        return image, names

    def _draw_floor(
        self, draw: ImageDraw.ImageDraw, camera: float
    ) -> list[tuple[tuple[float, float], str]]:
        reach = WIDTH / self.scale
        strip = np.array([[-reach, 0], [reach, 0], [reach, -1], [-reach, -1]]) + [
            camera,
            self.floor,
        ]
        draw.polygon(self._to_screen(camera, strip), _FLOOR)
        draw.line(self._to_screen(camera, strip[:2]), QUIET, 3)
        names = []
        goal = self.spec.distance * (1 if self.spec.direction > 0 else -1)
        first, last = math.floor((camera - reach) * 10), math.ceil((camera + reach) * 10)
        for tenth in range(first, last + 1):
            whole = tenth % 5 == 0
            top = np.array([tenth / 10, self.floor])
            ends = self._to_screen(camera, np.array([top, top - [0, 0.016 if whole else 0.008]]))
            draw.line(ends, QUIET, 3 if whole else 2)
            if whole:
                x, y = ends[1][0] / _FINE, ends[1][1] / _FINE + _TOP + 1
                names.append(((x, y), f"{tenth / 10:g} m".replace("-", "−")))
        pole = np.array(
            [
                [goal, self.floor],
                [goal, self.floor + 0.12],
                [goal + 0.04, self.floor + 0.105],
                [goal, self.floor + 0.09],
            ]
        )
        flag = self._to_screen(camera, pole)
        draw.line(flag[:2], INK, 3)
        draw.polygon(flag[1:], ZERO)
        return names

    def _draw_robot(
        self, draw: ImageDraw.ImageDraw, camera: float, row: int, k: int, side: str, busy: bool
    ) -> None:
        """Body on two wheels, and the arm that holds the pivot."""
        outward = -1.0 if k == 0 else 1.0
        pivot = self.placement.pivot[row, k]
        near = pivot[0] + outward * BODY_GAP
        far = near + outward * BODY_SIZE
        top, low = self.floor + 0.02 + BODY_SIZE, self.floor + 0.02
        corners = np.array([[near, low], [far, low], [far, top], [near, top]])
        shoulder = np.array([near + outward * 0.03, top - 0.03])
        body = self._to_screen(camera, corners)
        draw.polygon(body, HUE[side] if busy else PALE[side])
        draw.line([*body, body[0]], HUE[side], 4, joint="curve")
        thick = round(0.014 * self.scale * _FINE)
        arm = self._to_screen(camera, np.array([shoulder, pivot]))
        draw.line(arm, QUIET, thick)
        for (x, y), r in zip(arm, (0.011, 0.009), strict=True):
            size = r * self.scale * _FINE
            draw.ellipse((x - size, y - size, x + size, y + size), QUIET, INK, 2)
        turned = -(pivot[0]) / WHEEL_RADIUS
        for share in (0.25, 0.75):
            hub = np.array([near + share * (far - near), self.floor + WHEEL_RADIUS])
            spokes = turned + np.arange(3) * 2 * math.pi / 3
            rim = hub + 0.8 * WHEEL_RADIUS * np.stack([np.cos(spokes), np.sin(spokes)], axis=-1)
            (x, y), *ends = self._to_screen(camera, np.vstack([hub, rim]))
            size = WHEEL_RADIUS * self.scale * _FINE
            draw.ellipse((x - size, y - size, x + size, y + size), INK)
            for end in ends:
                draw.line((x, y, *end), QUIET, 5)

    def _draw_palm(
        self, draw: ImageDraw.ImageDraw, camera: float, row: int, k: int, side: str
    ) -> None:
        place = self.placement
        inner, outer = place.palm_inner[row, k], place.palm_outer[row, k]
        turn = place.palm_turn[row, k]
        down = PALM_THICKNESS * np.array([math.sin(turn), -math.cos(turn)])
        plate = self._to_screen(camera, np.array([inner, outer, outer + down, inner + down]))
        draw.polygon(plate, HUE[side])
        (x, y), r = self._to_screen(camera, place.pivot[row, k][None])[0], 7
        draw.ellipse((x - r, y - r, x + r, y + r), "white", INK, 2)

    def _draw_contact(
        self, draw: ImageDraw.ImageDraw, camera: float, row: int, k: int, motion: int
    ) -> None:
        """A green disc where the contact sticks, a yellow triangle that points where it slides."""
        point, turn = self.placement.contact[row, k], self.placement.palm_turn[row, k]
        if motion == 0:
            (x, y), r = self._to_screen(camera, point[None])[0], 9
            draw.ellipse((x - r, y - r, x + r, y + r), ZERO, "white", 2)
            return
        outward = -1.0 if k == 0 else 1.0
        along = motion * outward * np.array([math.cos(turn), math.sin(turn)])
        across = np.array([-along[1], along[0]])
        size = 9 / self.scale
        tip = np.array(
            [
                point + 1.5 * size * along,
                point - size * along + size * across,
                point - size * along - size * across,
            ]
        )
        marks = self._to_screen(camera, tip)
        draw.polygon(marks, SLIDES)
        draw.line([*marks, marks[0]], INK, 3, joint="curve")

    def _draw_message(
        self, draw: ImageDraw.ImageDraw, camera: float, row: int, message: tuple[str, str, str]
    ) -> list[tuple[tuple[float, float], str]]:
        """An arrow with the message between the robots' bodies."""
        sender, receiver, text = message
        y = self.floor + 0.5 * BODY_SIZE
        near = [self.placement.pivot[row, k, 0] + (-1, 1)[k] * (BODY_GAP - 0.012) for k in range(2)]
        ends = dict(zip(SIDES, near, strict=True))
        start, end = ends[sender], ends[receiver]
        head = 0.014 * math.copysign(1.0, end - start)
        shape = np.array(
            [
                [start, y],
                [end - head, y],
                [end, y],
                [end - head, y + 0.008],
                [end - head, y - 0.008],
            ]
        )
        marks = self._to_screen(camera, shape)
        draw.line(marks[:2], INK, 3)
        draw.polygon(marks[2:], INK)
        x = (marks[0][0] + marks[2][0]) / 2 / _FINE
        return [((x, min(marks[0][1], marks[2][1]) / _FINE + _TOP - 18), text)]
