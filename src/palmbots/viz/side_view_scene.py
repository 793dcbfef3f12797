# SPDX-License-Identifier: Apache-2.0
"""Draws the scene of the side view to scale: floor, robots, palms, object, contacts.

Shapes are drawn at twice their size and reduced, which smooths their edges. The camera follows the
midpoint of the pivots. A sloping floor is drawn with its slope.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from palmbots._types import SIDES, Side
from palmbots.scene.placement import Placement, floor_level
from palmbots.scene.robot_dimensions import (
    BODY_GAP,
    BODY_SIZE,
    GROUND_CLEARANCE,
)
from palmbots.scene.surroundings import drawn_blocks
from palmbots.viz import solids
from palmbots.viz.style import (
    BACKGROUND,
    FLOOR,
    HUE,
    INK,
    OBJECT,
    QUIET,
    SLIDES,
    ZERO,
)

if TYPE_CHECKING:
    from palmbots._core import Spec

WIDTH = 900  # px
_TALLEST = 400  # px
_FINE = 2  # drawn this many times larger, then reduced
_MARGIN = 0.05  # m, around robots and object

Pixel = tuple[float, float]


@dataclass(frozen=True)
class Note:
    """A text at a position of the image, which is written at the final size."""

    place: Pixel  # top middle, in pixels of the reduced image
    text: str


@dataclass(frozen=True)
class Message:
    """A message from one robot to the other."""

    sender: Side
    receiver: Side
    text: str


class WorldView:
    """Draws the scene at any row of a placement."""

    def __init__(self, spec: "Spec", placement: Placement) -> None:
        self.spec, self.placement = spec, placement
        self.floor = floor_level(spec)
        self.blocks = drawn_blocks(spec)
        self.robots = {side: solids.robot(side, self.floor) for side in SIDES}
        self._measure()

    def _measure(self) -> None:
        """Choose the scale so that both robots and the whole object stay in view."""
        place, spec = self.placement, self.spec
        centre = place.pivot[..., 0].mean(axis=1)[:, None]
        palms = max(palm.length / 2 for palm in spec.palms)
        pivots = float(np.abs(place.pivot[..., 0] - centre).max())
        thing = float(np.abs(place.outline[..., 0] - centre).max())
        half_wide = max(pivots + BODY_GAP + BODY_SIZE, pivots + palms, thing) + _MARGIN
        tall = max(float(place.outline[..., 1].max()), palms) - self.floor + _MARGIN
        slope = abs(spec.slope)
        self.scale = min(WIDTH / 2 / half_wide, _TALLEST / (tall + 2 * slope * half_wide))
        # A slope lifts one side and lowers the other by so many pixels.
        self._rise = slope * half_wide * self.scale
        self.height = 2 * math.ceil((tall * self.scale + 2 * self._rise) / 2)
        angle = math.atan(spec.slope)  # > 0: the floor rises forward
        self._cos, self._sin = math.cos(angle), math.sin(angle)

    def draw(
        self,
        row: int,
        busy: tuple[bool, bool],
        motion: Sequence[int | None],
        message: Message | None,
    ) -> tuple[Image.Image, list[Note]]:
        """The picture of one row, WIDTH by `height` pixels, and what is to be written into it. The
        motion of a contact is None where there is none."""
        camera = float(self.placement.pivot[row, :, 0].mean())
        image = Image.new("RGB", (WIDTH * _FINE, self.height * _FINE), BACKGROUND)
        brush = _Brush(ImageDraw.Draw(image), self, row, camera)
        notes = brush.floor_marks()
        for k, side in enumerate(SIDES):
            brush.robot(k, side, busy[k])
        brush.object()
        for k, side in enumerate(SIDES):
            brush.palm(k, side)
        for k, moves in enumerate(motion):
            if moves is not None:
                brush.contact(k, moves)
        if message is not None:
            notes.append(brush.message(message))
        return image.reduce(_FINE), notes

    def body_middle(self, row: int, k: int) -> Pixel:
        """Where a robot's body shows its name, in pixels of the reduced picture."""
        pivots = self.placement.pivot[row, :, 0]
        x = pivots[k] + (-1, 1)[k] * (BODY_GAP + 0.62 * BODY_SIZE)
        middle = np.array([[x, self.floor + GROUND_CLEARANCE + 0.6 * BODY_SIZE]])
        (px, py) = self.project(float(pivots.mean()), middle)[0]
        return px / _FINE, py / _FINE

    def project(self, camera: float, points: np.ndarray) -> list[Pixel]:
        """Pixels of the enlarged picture for world points (n, 2)."""
        x, y = points[:, 0] - camera, points[:, 1] - self.floor
        across = self._cos * x - self._sin * y
        up = self._sin * x + self._cos * y
        bottom = self.height - 0.04 * self.scale - self._rise
        px = (WIDTH / 2 + across * self.scale) * _FINE
        py = (bottom - up * self.scale) * _FINE
        return list(zip(px.tolist(), py.tolist(), strict=True))


class _Brush:
    """Draws the parts of one enlarged picture."""

    def __init__(self, draw: ImageDraw.ImageDraw, view: WorldView, row: int, camera: float) -> None:
        self._draw, self._view, self._row, self._camera = draw, view, row, camera
        self._place = view.placement
        self._floor = view.floor

    def _pixels(self, *points: object) -> list[Pixel]:
        return self._view.project(self._camera, np.array(points, dtype=float))

    def _disc(self, centre: Pixel, radius: float, fill: str, edge: str, width: int) -> None:
        x, y = centre
        self._draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill, edge, width)

    def _outlined(self, corners: list[Pixel], fill: str, edge: str, width: int) -> None:
        self._draw.polygon(corners, fill)
        self._draw.line([*corners, corners[0]], edge, width, joint="curve")

    def floor_marks(self) -> list[Note]:
        """The floor with a mark every 10 cm, and a flag where the carry ends."""
        floor, camera, spec = self._floor, self._camera, self._view.spec
        reach = WIDTH / self._view.scale
        left, right = (camera - reach, floor), (camera + reach, floor)
        self._draw.polygon(
            self._pixels(left, right, (right[0], floor - 1), (left[0], floor - 1)), FLOOR
        )
        self._draw.line(self._pixels(left, right), QUIET, 3)
        for low, high, foot, top in self._view.blocks:
            corners = self._pixels((low, foot), (high, foot), (high, top), (low, top))
            self._outlined(corners, FLOOR, QUIET, 3)
        notes = []
        for tenth in range(math.floor(left[0] * 10), math.ceil(right[0] * 10) + 1):
            whole = tenth % 5 == 0
            x, deep = tenth / 10, 0.016 if whole else 0.008
            top, foot = self._pixels((x, floor), (x, floor - deep))
            self._draw.line((top, foot), QUIET, 3 if whole else 2)
            if whole and 25 <= foot[0] / _FINE <= WIDTH - 25:  # room for the text
                place = (foot[0] / _FINE, foot[1] / _FINE + 1)
                notes.append(Note(place, f"{x:g} m".replace("-", "−")))
        goal = spec.distance * spec.direction
        pole = self._pixels((goal, floor), (goal, floor + 0.12))
        self._draw.line(pole, INK, 3)
        flag = self._pixels((goal + 0.04, floor + 0.105), (goal, floor + 0.09))
        self._draw.polygon([pole[1], *flag], ZERO)
        return notes

    def robot(self, k: int, side: Side, busy: bool) -> None:
        """Body, the arm that holds the pivot, and wheels that turn as they roll."""
        pivot = self._place.pivot[self._row, k]
        base = np.array([pivot[0], 0.0])  # of the robot, which does not rise with the pivot
        scale = self._view.scale * _FINE
        for solid in self._view.robots[side]:
            shape = solid.shape
            if isinstance(shape, solids.Cylinder):
                self._wheel(shape, base)
            elif isinstance(shape, solids.Box):
                corners = self._pixels(*(base + np.array(shape.corners())))
                if not shape.turn:
                    self._outlined(corners, HUE[side] if busy else solid.colour, HUE[side], 4)
        ends = self._pixels(base + np.array(solids.shoulder(side, self._floor)), pivot)
        self._draw.line(ends, QUIET, round(solids.ARM_WIDTH * scale))
        for joint, radius in zip(ends, (0.011, 0.009), strict=True):
            self._disc(joint, radius * scale, QUIET, INK, 2)

    def _wheel(self, shape: solids.Cylinder, pivot: np.ndarray) -> None:
        """A wheel with three spokes."""
        hub = pivot + np.array([shape.centre[0], shape.centre[2]])
        angles = -pivot[0] / shape.radius + np.arange(3) * 2 * math.pi / 3
        rim = hub + 0.8 * shape.radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        centre, *ends = self._pixels(hub, *rim)
        self._disc(centre, shape.radius * self._view.scale * _FINE, INK, INK, 1)
        for end in ends:
            self._draw.line((centre, end), QUIET, 5)

    def object(self) -> None:
        """The outline and the centre of mass."""
        self._outlined(self._pixels(*self._place.outline[self._row]), OBJECT, INK, 3)
        (x, y), r = self._pixels(self._place.com[self._row])[0], 12
        self._disc((x, y), r, BACKGROUND, INK, 2)
        for start in (0, 180):
            self._draw.pieslice((x - r, y - r, x + r, y + r), start, start + 90, INK)

    def palm(self, k: int, side: Side) -> None:
        """The plate, its upper face where the contact lies, and the pivot."""
        # A heel is thin.
        self._outlined(self._pixels(*self._place.plate[self._row, k]), HUE[side], HUE[side], 5)
        self._disc(self._pixels(self._place.pivot[self._row, k])[0], 7, BACKGROUND, INK, 2)

    def contact(self, k: int, motion: int) -> None:
        """A green disc where the contact sticks, a yellow triangle that points where it slides."""
        point = self._place.contact[self._row, k]
        turn = self._place.palm_turn[self._row, k]
        if motion == 0:
            self._disc(self._pixels(point)[0], 9, ZERO, BACKGROUND, 2)
            return
        size = 9 / self._view.scale
        along = motion * (-1.0, 1.0)[k] * size * np.array([math.cos(turn), math.sin(turn)])
        across = np.array([-along[1], along[0]])
        back = point - along
        marks = self._pixels(point + 1.5 * along, back + across, back - across)
        self._outlined(marks, SLIDES, INK, 3)

    def message(self, message: Message) -> Note:
        """An arrow from body to body; the note says what is sent."""
        y = self._floor + 0.5 * BODY_SIZE
        pivots = self._place.pivot[self._row, :, 0]
        gap = BODY_GAP - 0.012
        ends = {"left": pivots[0] - gap, "right": pivots[1] + gap}
        start, end = ends[message.sender], ends[message.receiver]
        neck = end - math.copysign(0.014, end - start)
        tail, tip, *head = self._pixels((start, y), (end, y), (neck, y + 0.008), (neck, y - 0.008))
        self._draw.line((tail, tip), INK, 3)
        self._draw.polygon([tip, *head], INK)
        place = ((tail[0] + tip[0]) / 2 / _FINE, min(tail[1], tip[1]) / _FINE - 18)
        return Note(place, message.text)
