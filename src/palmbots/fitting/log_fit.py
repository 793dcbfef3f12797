# SPDX-License-Identifier: Apache-2.0
"""Robots, radio and object together, fitted to logs of carries (`fit_logs`)."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from palmbots._util.report import Item, Line
from palmbots._util.results import Result
from palmbots._util.text import plural
from palmbots.errors import PalmbotsError
from palmbots.fitting.fitted_values import Value, refuse_twice
from palmbots.fitting.motion_fit import MotionFit, fit_recorded
from palmbots.fitting.object_fit import NothingIdentified, ObjectFit, fit_object
from palmbots.fitting.radio_fit import RadioFit, fit_packets
from palmbots.fitting.recorded_logs import LEAST_ARRIVED, RecordedCarry, read_carry


@dataclass(frozen=True, repr=False)
class LogFit(Result):
    """Robots, radio and object of some carries. Both robots of a pair count as robots of one
    kind."""

    carries: int
    robot: MotionFit | None
    radio: RadioFit | None
    object: ObjectFit | None
    not_fitted: tuple[str, ...]
    """Why some of them are missing."""

    @property
    def keys(self) -> dict[str, Value]:
        """What was fitted, as overrides of a scene."""
        return {key: one for part in self.parts.values() for key, one in part.keys.items()}

    @property
    def parts(self) -> dict[str, MotionFit | RadioFit | ObjectFit]:
        """What was fitted, by name."""
        fitted = (self.robot, self.radio, self.object)
        return {one.name: one for one in fitted if one is not None}

    def lines(self) -> Iterator[Item]:
        """What was fitted, with intervals, and what the logs do not show."""
        yield f"fitted to {plural(self.carries, 'carry')}"
        for part in self.parts.values():
            yield from part.lines()
        for reason in self.not_fitted:
            yield Line(reason, is_whole=True)


def fit_logs(
    files: Sequence[str | os.PathLike[str]],
    *,
    motion: bool,
    radio: bool,
    on_progress: Callable[[float], None] | None = None,
) -> LogFit:
    """Fit the robots, the radio, or both with the object and the palms.

    Args:
        files: logs of carries, and folders with the logs of robots.
        motion: fit the robots.
        radio: fit the radio; with `motion`, the object and the palms as well.
        on_progress: called with the completed fraction.

    Raises:
        PalmbotsError: a log cannot be read, or they identify nothing.
    """
    report = on_progress or (lambda fraction: None)
    carries: list[RecordedCarry] = []
    for run, file in enumerate(files):
        report(0.5 * run / len(files))
        carries.append(read_carry(file, run))
    sources = tuple(source for one in carries for source in one.sources)
    refuse_twice(sources)
    why: list[str] = []
    of_robot = of_radio = of_object = None
    share = 0.3 if motion and radio else 0.5  # of the time: the robots
    if motion:
        stretches = [stretch for one in carries for stretch in one.stretches]
        try:
            of_robot = fit_recorded(
                stretches,
                sources,
                len(carries),
                steps=[step for one in carries for step in one.steps],
                on_progress=lambda part: report(0.5 + share * part),
            )
        except PalmbotsError as error:
            why.append(str(error).removesuffix("; nothing is written"))
    if radio:
        packets = [one for carry in carries for one in carry.packets]
        if packets:
            of_radio = fit_packets(packets, sources)
        else:
            why.append(
                f"--radio: the logs show fewer than {LEAST_ARRIVED} packets of each direction"
            )
    if motion and radio:
        touches = [one.touch for one in carries]
        try:
            of_object = fit_object(
                touches, sources, on_progress=lambda part: report(0.5 + share + 0.2 * part)
            )
        except NothingIdentified as error:
            why.append(str(error))
    if of_robot is None and of_radio is None and of_object is None:
        raise PalmbotsError(f"fit: nothing is identified, and nothing is written; {'; '.join(why)}")
    return LogFit(len(carries), of_robot, of_radio, of_object, tuple(why))
