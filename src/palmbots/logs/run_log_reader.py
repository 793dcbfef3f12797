# SPDX-License-Identifier: Apache-2.0
"""Reads the logs of the programs of a pair (`run_log_writer` writes them).

The log of a program that was killed has no end. What is there is read, and `RunLog.is_cut` says so.
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.exceptions import McapError
from mcap.records import Channel, Message, Metadata
from mcap.stream_reader import StreamReader
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from palmbots._types import SIDES
from palmbots._util.user_paths import user_path
from palmbots._version import __version__
from palmbots.errors import PalmbotsError
from palmbots.logs.run_channels import (
    RUN_FORMAT,
    RUN_RECORD,
    LineEvent,
    PacketEvent,
    RobotTick,
    StatusEvent,
)
from palmbots.scene.file_kinds import LOG, refuse_other_kind
from palmbots.wire import KEY_SIZE, MAX_EPOCH, Role

_TYPES = {"ticks": RobotTick, "sent": PacketEvent, "received": StatusEvent, "lines": LineEvent}


class _Model(BaseModel):
    model_config = ConfigDict(strict=True)


class _Facts(_Model):
    """What the log of every program states about it."""

    end: Role
    epoch: int = Field(ge=1, le=MAX_EPOCH)
    pair: int = Field(ge=0, le=0xFFFF)


class _State(_Model):
    epoch: int = Field(ge=1, le=MAX_EPOCH)
    assists: bool
    carries: bool
    stop: bool
    holds: bool


class _RobotFacts(_Facts):
    """What the log of a robot states besides, with which its program starts again."""

    key: str = Field(pattern=f"^[0-9a-f]{{{2 * KEY_SIZE}}}$")
    scene: dict[str, Any]
    controller: str
    controller_source: dict[str, str | None] | None
    state: _State
    settings: dict[str, bool | int]


@dataclass(frozen=True)
class RunLog:
    """The log of one program."""

    path: Path
    end: Role
    """``left``, ``right`` or ``station``."""
    epoch: int
    """Number of the program's boots."""
    facts: dict[str, Any]
    messages: dict[str, list[tuple[float, Any]]]
    """For each kind (``ticks``; ``sent``, ``received``, ``lines``) the time on the program's clock
    [s], and the message."""
    is_cut: bool
    """The log has no end: its program was killed, or the disk was full."""


def is_run_log(path: str | os.PathLike[str]) -> bool:
    """Whether this is the log of a program of a pair. A file that cannot be read is none."""
    try:
        with open(user_path(path), "rb") as stream:
            return RUN_RECORD.encode() in stream.read(4096)
    except (OSError, ValueError):
        return False


def log_of_carry(place: Path) -> Path | None:
    """This file, or the only log in this folder, as `palmbots carry --out` wrote it; None: these
    are logs of robots.

    Raises:
        PalmbotsError: the folder has the logs of several carries.
    """
    if not place.is_dir():
        return None if is_run_log(place) else place
    logs = sorted(place.glob("*.mcap"))
    of_carries = [one for one in logs if not is_run_log(one)]
    if len(of_carries) > 1:
        raise PalmbotsError(
            f"{place}: has {len(of_carries)} logs that are not of robots; expected the log of one "
            f"carry, the logs of a pair of robots, or the files ({place / '*.mcap'})"
        )
    return of_carries[0] if len(logs) == len(of_carries) == 1 else None


def read_run_log(path: str | os.PathLike[str]) -> RunLog:
    """Read the log of a program of a pair.

    Raises:
        PalmbotsError: the file cannot be read, or is no such log of this format.
    """
    refuse_other_kind(path, LOG)
    facts: dict[str, Any] | None = None
    topics: dict[int, str] = {}
    messages: dict[str, list[tuple[float, Any]]] = {kind: [] for kind in _TYPES}
    is_cut = False
    try:
        with open(user_path(path), "rb") as stream:
            try:
                for record in StreamReader(stream, validate_crcs=True).records:
                    if isinstance(record, Message):
                        kind = topics[record.channel_id]
                        if kind in _TYPES:
                            message = _TYPES[kind].FromString(record.data)
                            messages[kind].append((record.log_time / 1e9, message))
                    elif isinstance(record, Channel):
                        topics[record.id] = record.topic.rpartition("/")[2]
                    elif isinstance(record, Metadata) and record.name == RUN_RECORD:
                        facts = {name: json.loads(text) for name, text in record.metadata.items()}
            except OSError:
                raise
            except McapError:  # also the end of a file that has none
                is_cut = True
            except Exception:  # also MemoryError: what a damaged file holds may raise anything
                is_cut = True
    except (OSError, ValueError) as error:
        why = (isinstance(error, OSError) and error.strerror) or error
        raise PalmbotsError(f"{path}: cannot be read: {why}") from None
    if facts is None:
        raise PalmbotsError(f"{path}: is no log of a robot or station")
    if facts.get("format") != RUN_FORMAT:
        raise PalmbotsError(
            f"{path}: a log of format {facts.get('format')}, written by palmbots "
            f"{facts.get('version', '(unknown)')}; palmbots {__version__} reads format {RUN_FORMAT}"
        )
    return run_log_of(Path(path), facts, messages, is_cut=is_cut)


def run_log_of(
    path: Path,
    facts: dict[str, Any],
    messages: dict[str, list[tuple[float, Any]]],
    *,
    is_cut: bool,
) -> RunLog:
    """A log with what it states about its program, which is checked.

    Raises:
        PalmbotsError: an entry is missing or wrong.
    """
    try:
        known = (_RobotFacts if facts.get("end") in SIDES else _Facts).model_validate(facts)
    except ValidationError as error:
        where = ".".join(str(part) for part in error.errors()[0]["loc"])
        raise PalmbotsError(f"{path}: is damaged: its entry {where} is wrong or missing") from None
    return RunLog(path, known.end, known.epoch, facts, messages, is_cut)
