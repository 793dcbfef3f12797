# SPDX-License-Identifier: Apache-2.0
"""The object and the palms, fitted to logs of carries (`fit_object`)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palmbots._types import SIDES
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.results import Result
from palmbots._util.text import plural
from palmbots.errors import PalmbotsError
from palmbots.fitting.fitted_values import Estimate, FittedPart, Source
from palmbots.fitting.object_slides import FRICTION, Slides, objects_with, slides_in
from palmbots.fitting.palm_readings import Readings, palm_estimates, readings_of
from palmbots.probing.object_set import ObjectSet, Prior
from palmbots.probing.slip_comparison import DOWN, UP
from palmbots.scene.object_frame import ObjectFrame, object_frame
from palmbots.scene.scene import Scene
from palmbots.scene.spec import contact_radii, to_spec
from palmbots.simulation.result import Carry

Floats = NDArray[np.float64]

LEAST_SLIDES = 100
_NARROW_COM = 0.25  # of the distance between the contacts
_NARROW_FRICTION = 2.0  # high over low
_SHOWN = 2000  # slides in the figure


class NothingIdentified(PalmbotsError):
    """The logs identify neither the object nor the palms."""


@dataclass(frozen=True)
class Touch:
    """What a log shows of the object and of the palms."""

    name: str
    scene: Scene
    slides: Slides | None
    readings: Readings
    reason: str
    """Why the slides do not count; empty: they do."""


@dataclass(frozen=True)
class ObjectData:
    """What the figure shows."""

    boxes: Floats
    """The set: shape (n, 3, 2), COM from the left contact [m] and friction angles [rad]."""
    leads: Floats
    """By how much the left contact of the fitted object slides first, in some slides [1]."""
    sides: NDArray[np.int64]
    """Which contact slid in these: left is 0, right 1."""
    contacts_m: Floats
    signs: NDArray[np.int64]
    half_width_m: float | None


@dataclass(frozen=True, repr=False)
class ObjectFit(FittedPart, Result):
    """COM and friction of an object, and what the palms do.

    The intervals of COM and friction are bounds: they contain the value if the slides obey the
    quasistatic model.
    """

    figure = "object-fit"
    name = "object"

    carries: int
    slides: int
    """Slides that differ, of one contact while the other one sticks."""
    data: ObjectData = field(metadata=NOT_IN_JSON)

    def basis(self) -> str:
        """What the keys were fitted to, as a part of a sentence."""
        return (
            f"of object and palms to {plural(self.slides, 'slide')} of "
            f"{plural(self.carries, 'carry')}"
        )


def touch_of(carry: Carry, name: str) -> Touch:
    """What a carry shows of object and palms.

    Args:
        carry: with a trace.
        name: of its log.
    """
    reason, slides = "", None
    if carry.world != "quasistatic":
        reason = {
            "mujoco": "contacts creep in MuJoCo, so its logs do not show which contact slides",
        }.get(carry.world, "robots do not know which contact slides")
    elif any(contact_radii(to_spec(carry.scene))):
        reason = "a contact vertex is rounded: it rolls as well as slides"
    elif carry.floor_job is not None:
        reason = "in a job on the floor the object does not always lie on both palms"
    else:
        slides = slides_in(carry)
    return Touch(name, carry.scene, slides, readings_of(carry), reason)


def fit_object(
    touches: Sequence[Touch],
    sources: tuple[Source, ...],
    on_progress: Callable[[float], None] = lambda part: None,
) -> ObjectFit:
    """Fit object and palms.

    Args:
        touches: of each log.
        sources: the files.
        on_progress: called with the completed fraction.

    Raises:
        NothingIdentified: the logs identify nothing.
        PalmbotsError: they are of several objects.
    """
    first = touches[0]
    for one in touches[1:]:
        a, b = (each.scene.object for each in (first, one))
        if (a.vertices_m, a.contacts) != (b.vertices_m, b.contacts):
            raise PalmbotsError(
                f"{one.name}: its object has another outline than that of {first.name}; expected "
                "carries of one object, or --motion or --radio"
            )
    used = [one.slides for one in touches if one.slides is not None]
    joined = Slides.joined(used) if used else None
    frame = _frame(first.scene)
    palms = palm_estimates([one.readings for one in touches])
    if first.scene.tactile.zones is not None:
        given = "the sensor has other zones than that one (tactile.zones)"
        palms[-1] = Estimate(palms[-1].key, reason=given)
    found = None
    why = next((one.reason for one in touches if one.reason), "")
    if joined is not None and len(joined) >= LEAST_SLIDES:
        found = _objects(joined, frame, on_progress)
        estimates = [*_of_object(found, first.scene, frame), *palms]
    else:
        count = 0 if joined is None else len(joined)
        reason = why or f"the logs show {plural(count, 'slide')}; it needs {LEAST_SLIDES}"
        keys = ("object.com_m", *(f"palm.{side}.friction" for side in SIDES))
        estimates = [*(Estimate(key, reason=reason) for key in keys), *palms]
    if not any(one.is_identified for one in estimates):
        raise NothingIdentified(f"object and palms: {estimates[0].reason}")
    estimates.sort(key=lambda one: (not one.is_key, one.key.rpartition(".")[0]))
    return ObjectFit(
        sources=sources,
        carries=len(touches),
        slides=0 if joined is None else len(joined),
        estimates=tuple(estimates),
        replay=None,
        data=_shown(found, joined, touches, palms[-1]),
    )


def _frame(scene: Scene) -> ObjectFrame:
    body = scene.object
    return object_frame(body.vertices_m, body.contacts, body.com_m)


def _objects(slides: Slides, frame: ObjectFrame, on_progress: Callable[[float], None]) -> ObjectSet:
    heights = [corner.height for corner in frame.outline]
    prior = Prior(
        frame.width, (0.0, frame.width), (min(heights), max(heights)), (FRICTION, FRICTION)
    )
    found = objects_with(slides, prior, on_progress)
    if found.misfits:
        raise PalmbotsError(
            "fit: no object explains the slides of all logs; expected carries of one object on the "
            "same palms, or --motion or --radio"
        )
    return found


def _of_object(found: ObjectSet, scene: Scene, frame: ObjectFrame) -> list[Estimate]:
    """COM and friction: the middle of the set, and its ends."""
    centre, hull, prior = _centre(found), found.hull(), found.prior
    body = scene.object
    left, right = (body.vertices_m[number] for number in body.contacts)
    low, high = (float(end) for end in hull[0])
    bounded = f"the slides bound it to {1e3 * low:.3g} to {1e3 * high:.3g} mm from the left contact"
    com = Estimate("object.com_m", reason=bounded)
    if high - low < _NARROW_COM * prior.width:
        if abs(right[1] - left[1]) < 1e-9:
            place = (left[0] + float(centre[0]), left[1] + frame.com.height)
            com = Estimate("object.com_m", place, left[0] + low, left[0] + high)
        else:
            com = Estimate("com_from_left_contact_m", float(centre[0]), low, high)
    estimates = [com]
    for number, side in enumerate(SIDES, 1):
        low, high = map(math.tan, hull[number].tolist())
        estimates.append(_level(f"palm.{side}.friction", math.tan(centre[number]), low, high))
    boxes = found.boxes
    low, high = (
        math.degrees(one)
        for one in (
            (boxes[:, 2, 0] - boxes[:, 1, 1]).min(),
            (boxes[:, 2, 1] - boxes[:, 1, 0]).max(),
        )
    )
    middle = math.degrees(centre[2] - centre[1])
    apart = Estimate("friction_angle_difference_deg", middle, low, high)
    return [*estimates, apart, _of_equal_palms(boxes)]


def _of_equal_palms(boxes: Floats) -> Estimate:
    """The friction of both palms, if they have the same surface."""
    key = "friction_if_palms_are_equal"
    low, high = boxes[:, 1:, 0].max(axis=1), boxes[:, 1:, 1].min(axis=1)
    is_equal = low <= high
    if not is_equal.any():
        return Estimate(key, reason="the palms differ")
    ends = math.tan(low[is_equal].min()), math.tan(high[is_equal].max())
    return _level(key, 0.5 * (ends[0] + ends[1]), *ends)


def _level(key: str, value: float, low: float, high: float) -> Estimate:
    """A coefficient of friction, if its bounds are narrow."""
    reason = ""
    if high > _NARROW_FRICTION * low:
        reason = (
            f"the slides bound it to {low:.2g} to {high:.2g}; they compare both palms, and hardly "
            "show the level"
        )
    return Estimate(key, value, low, high, reason)


def _centre(found: ObjectSet) -> Floats:
    """The middle of the box that is nearest to the mean of the set."""
    boxes = found.boxes
    middles = boxes.mean(axis=2)
    sizes = np.prod(boxes[:, :, 1] - boxes[:, :, 0], axis=1)
    mean = np.average(middles, axis=0, weights=sizes)
    scale = np.maximum(np.ptp(middles, axis=0), 1e-12)
    return middles[int((((middles - mean) / scale) ** 2).sum(axis=1).argmin())]


def _shown(
    found: ObjectSet | None, slides: Slides | None, touches: Sequence[Touch], edge: Estimate
) -> ObjectData:
    contacts, signs = (
        np.concatenate([getattr(one.readings, name) for one in touches])
        for name in ("contacts_m", "signs")
    )
    half_width_m = float(edge.value) if isinstance(edge.value, float) else None
    none = np.zeros(0)
    if found is None or slides is None:
        return ObjectData(
            np.zeros((0, 3, 2)), none, none.astype(np.int64), contacts, signs, half_width_m
        )
    point = np.repeat(_centre(found)[None, :, None], 2, axis=2)
    rows = np.arange(0, len(slides), max(1, len(slides) // _SHOWN))
    leads = np.zeros(len(rows))
    for way in (UP, DOWN):
        those = slides.way[rows] == way
        low, high = found.compared(point, slides.poses(rows[those]), (way, way))
        leads[those] = way * 0.5 * (low + high) / found.prior.width
    return ObjectData(found.boxes, leads, slides.side[rows], contacts, signs, half_width_m)
