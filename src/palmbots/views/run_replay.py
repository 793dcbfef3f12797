# SPDX-License-Identifier: Apache-2.0
"""Verifies the log of a robot: with the logged inputs, the core's program must decide the same.

The program is built from the scene, the controller and the settings in the log. Every command, mode
and packet is compared, to the last bit.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.command import Option, command
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, verdict
from palmbots._util.results import Result
from palmbots._util.user_paths import user_path
from palmbots.control.python_source import ControllerSource
from palmbots.control.registry import recover
from palmbots.errors import PalmbotsError
from palmbots.logs.replaying import ReplayResult, replay
from palmbots.logs.run_log_reader import RunLog, log_of_carry, read_run_log
from palmbots.robot.logged_steps import READING
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.views.log_alignment import ClockFit, align, from_station
from palmbots.views.logged_carries import LoggedCarry, logged_carries

_CARRIES = ("run", "carry in", "start", "time", "covered", "end")


@dataclass(frozen=True)
class Verified:
    """What was found in one log."""

    file: str
    end: str
    boots: int
    is_cut: bool
    """Whether the log has no end, because its program was killed or the disk was full."""
    ticks: int
    """Ticks in the log; 0 for a station."""
    verified: int
    """Ticks, from the first one on, whose decisions are equal."""
    difference: str | None
    """The first difference, or why the rest cannot be verified; None: everything is equal."""


@dataclass(frozen=True, repr=False)
class RunReplay(Result):
    """The verification of the logs of one run, and how their clocks fit together."""

    logs: tuple[Verified, ...]
    clocks: tuple[ClockFit, ...]
    """For each log, how its clock relates to that of the station of its run or, without its
    log, of the first one."""
    carries: tuple[LoggedCarry, ...] = ()
    """When each robot carried, and why its carry ended."""
    run: tuple[RunLog, ...] = field(default=(), metadata=NOT_IN_JSON)
    """What the logs contain."""

    @derived
    def identical(self) -> bool:
        """Whether all decisions of all robots equal the logged ones."""
        return all(log.difference is None for log in self.logs)

    def lines(self) -> Iterator[Item]:
        """For each log whether the program decides the same, and how its clock relates."""
        ticks = sum(log.verified for log in self.logs)
        count = f"  {ticks} decisions agree bit for bit" if self.identical else ""
        yield Line(verdict(self.identical, "IDENTICAL", "DIFFERS"), count)
        is_one = all(clock.run == 1 for clock in self.clocks)
        left_out = 1 if is_one else 0  # the number of the run
        rows = [
            (
                str(clock.run),
                Path(log.file).name + (" (cut off)" if log.is_cut else ""),
                str(log.ticks) if log.ticks else "",
                "" if log.end == "station" else str(log.verified),
                _clock(clock),
            )[left_out:]
            for log, clock in sorted(
                zip(self.logs, self.clocks, strict=True), key=lambda pair: pair[1].run
            )
        ]
        named = {Path(c.file).name for c in self.clocks if c.packets == 0}
        first = f"clock against {named.pop()}" if is_one else "clock against the log without one"
        yield Table(rows, ("run", "log", "ticks", "equal", first)[left_out:], ("ticks",))
        if self.carries:
            carries = [one.row[left_out:] for one in self.carries]
            yield Table(carries, _CARRIES[left_out:], ("start", "time", "covered"))
        for log in self.logs:
            if log.difference is not None:
                yield Line(f"{Path(log.file).name}: {log.difference}", is_whole=True)


def _clock(clock: ClockFit) -> str:
    if clock.packets == 0:
        return ""
    ppm = 1e6 * (clock.rate - 1)
    return f"{clock.offset_s:+.3f} ± {clock.uncertainty_s:.3f} s, rate {ppm:+.0f} ppm"


@command(
    "replay",
    order=130,
    example="palmbots replay out/carry.mcap",
    failure=("identical", "something differs from the log"),
    logs=Option(is_argument=True, is_file=True, metavar="LOG..."),
)
def replay_logs(logs: Sequence[str | PathLike[str]]) -> ReplayResult | RunReplay:
    """Run a logged carry again and compare every bit.

    Logs of robots and of a station are verified: each robot's program gets the logged readings and
    packets again, and has to make the same decisions. The packets that the programs exchanged align
    the clocks of their logs. A table states when each robot carried, how far, and why its carry
    ended.

    Args:
        logs: MCAP logs, or folders with them.

    Raises:
        PalmbotsError: a log cannot be read or run again, or the logs are of different pairs.
    """
    paths = [user_path(log) for log in logs]
    if len(paths) == 1 and (file := log_of_carry(paths[0])) is not None:
        return replay(file)
    return replay_run(read_run(paths))


def replay_run(logs: list[RunLog]) -> RunReplay:
    """Verify the logs of a pair, and align the clocks of each run.

    Raises:
        PalmbotsError: the logs are of different pairs, or a controller cannot be found.
    """
    pairs = {log.facts["pair"] for log in logs}
    if len(pairs) > 1:
        numbers = ", ".join(str(pair) for pair in sorted(pairs))
        raise PalmbotsError(f"logs: are of the pairs {numbers}; allowed: logs of one pair")
    clocks = from_station(align(logs), logs)
    carries = logged_carries(logs, clocks)
    return RunReplay(tuple(verify(log) for log in logs), clocks, carries, tuple(logs))


def read_run(paths: list[Path]) -> list[RunLog]:
    """The logs of one run; a folder stands for all logs in it.

    Raises:
        PalmbotsError: a log cannot be read, or a folder has none.
    """
    files: list[Path] = []
    for path in paths:
        found = sorted(path.glob("*.mcap")) if path.is_dir() else [path]
        if not found:
            raise PalmbotsError(f"{path}: has no logs (*.mcap)")
        files += found
    return [read_run_log(file) for file in files]


def verify(log: RunLog) -> Verified:
    """Give the program of the robot the logged inputs, and compare what it decides.

    Raises:
        PalmbotsError: its controller cannot be found or has changed, or its scene is refused.
    """
    ticks = [message for _, message in log.messages["ticks"]]
    verified, difference = 0, None
    if log.end != "station":
        robot = _program(log)
        for tick in ticks:
            if tick.number != verified + 1:
                difference = f"the ticks {verified + 1} to {tick.number - 1} are missing"
                break
            difference = _difference(robot, tick)
            if difference is not None:
                break
            verified += 1
    return Verified(str(log.path), log.end, log.epoch, log.is_cut, len(ticks), verified, difference)


def _program(log: RunLog) -> Any:
    facts, state = log.facts, log.facts["state"]
    source = facts["controller_source"]
    try:
        scene = load_scene(facts["scene"])
        known = None if source is None else ControllerSource(**source)
        entry = recover(facts["controller"], known, str(log.path.parent))
        spec = to_spec(scene)
        return _core.runtime.Robot(
            spec,
            entry.for_core(spec),
            SIDES.index(log.end),
            bytes.fromhex(facts["key"]),
            facts["pair"],
            epoch=state["epoch"],
            assists=state["assists"],
            settings=_core.runtime.RuntimeSettings(**facts["settings"]),
            stored_carries=state["carries"],
            stored_stop=state["stop"],
            holds=state["holds"],
        )
    except PalmbotsError as error:
        raise PalmbotsError(f"{log.path}: cannot be verified: {error}") from None
    except (TypeError, ValueError, OverflowError):  # of the core and of the controller's source
        raise PalmbotsError(f"{log.path}: is damaged: its program cannot be started") from None


def _difference(robot: Any, tick: Any) -> str | None:
    """What the robot decides otherwise in this tick, or None."""
    try:
        reading = _core.runtime.Reading(
            tick.sign, tick.palm_at_target, **{name: getattr(tick, name) for name in READING}
        )
        answer = robot.step(tick.elapsed, reading, list(tick.received))
    except (TypeError, ValueError, IndexError, OverflowError):
        return f"tick {tick.number}: what the robot read is out of range"
    palm, move, rests, packets, case, *_, assists = answer
    now = {
        "palm": palm,
        "move": move,
        "rests": rests,
        "case": chr(case),
        "assists": assists,
        "phase": robot.phase,
        "mode": robot.mode,
        "fault": robot.fault,
        "wheels": robot.wheels,
        "receivers": [to for to, _, _ in packets],
        "words": [message for *_, message in packets],
        "sent": [data for _, data, _ in packets],
    }
    for name, value in now.items():
        logged = getattr(tick, name)
        logged = list(logged) if isinstance(value, list) else logged
        if logged != value:
            return f"tick {tick.number}: {name} was {_shown(logged)}, is {_shown(value)}"
    return None


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_shown(one) for one in value) + "]"
    return value.hex() if isinstance(value, bytes) else repr(value)
