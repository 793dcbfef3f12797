# SPDX-License-Identifier: Apache-2.0
"""What a robot must remember over a reboot (`StoredState`), in a file.

The boot counter makes every stamp on the wire unique (docs/reference/wire.md), so it must never go
back. A file that is missing, damaged, or of another robot is therefore refused, and never replaced
by a new one. The file is written completely or not at all, and flushed to the disk before the first
packet of a boot.
"""

import contextlib
import fcntl
import hashlib
import json
import math
import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Self

from palmbots._util.atomic_files import read_regular, write_whole
from palmbots.drivers.arm import NEW_ARM, StoredArm
from palmbots.errors import PalmbotsError
from palmbots.wire import MAX_EPOCH, Role


@dataclass(frozen=True)
class StateFile:
    """Where one end of a pair stores its state. The file says whose it is."""

    path: Path
    pair: int
    """Number of the pair."""
    end: Role

    def __str__(self) -> str:
        return str(self.path)


@dataclass(frozen=True)
class StoredState:
    """The content of the file."""

    epoch: int = 0
    """Number of boots so far."""
    assists: bool = False
    """The palm was up for the partner."""
    carries: bool = False
    """A carry was under way."""
    stop: bool = False
    """A stop was in force."""
    covered_m: float = 0.0
    """What the carry had covered when this was last written [m]; behind by up to a step."""
    holds: bool = False
    """In a job on the floor: the arms may be up, so the robot holds everything after a boot."""
    arm: StoredArm = NEW_ARM
    """Where the arm is."""
    approached_m: float = 0.0
    """How far the robot has driven towards an object on a stand [m]; as `covered_m`."""

    def booted(self) -> Self:
        """The state to store at a boot.

        Raises:
            PalmbotsError: the epochs are used up.
        """
        if self.epoch >= MAX_EPOCH:
            raise PalmbotsError(
                f"boot counter: all {MAX_EPOCH} boots are used up; the pair needs a new key"
            )
        return replace(self, epoch=self.epoch + 1)


def _check(content: dict[str, object]) -> str:
    text = json.dumps(content, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _is_state(content: dict[str, object]) -> bool:
    """The content has the fields of a state, of their types and within their limits."""
    usual = _plain({"pair": 0, "end": ""} | asdict(StoredState()))
    if {name: type(value) for name, value in content.items()} != {
        name: type(value) for name, value in usual.items()
    }:
        return False
    epoch, arm = content["epoch"], content["arm"]
    assert isinstance(epoch, int) and isinstance(arm, list)
    lengths = [*arm, content["covered_m"], content["approached_m"]]
    are_finite = all(type(one) is float and math.isfinite(one) for one in lengths)
    return 0 <= epoch <= MAX_EPOCH and len(arm) == len(NEW_ARM) and are_finite


def _plain(content: dict[str, Any]) -> dict[str, Any]:
    """As it is read from a file."""
    return json.loads(json.dumps(content))


def write_state(file: StateFile, state: StoredState, *, new: bool = False) -> None:
    """Write the file; with `new` only if there is none.

    Raises:
        PalmbotsError: it cannot be written.
    """
    content = {"pair": file.pair, "end": file.end} | asdict(state)
    write_whole(file.path, json.dumps(content | {"check": _check(content)}) + "\n", new=new)


def read_state(file: StateFile) -> StoredState:
    """Read the file.

    Raises:
        PalmbotsError: it is missing, damaged, or of another robot; the message says what to do.
    """
    path = file.path
    remedy = "with a new key, palmbots init pair begins a new count"
    try:
        content = json.loads(read_regular(path))
        check = content.pop("check")
    except FileNotFoundError:
        raise PalmbotsError(f"{path}: the boot counter is missing; {remedy}") from None
    except OSError as error:
        raise PalmbotsError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (ValueError, KeyError, AttributeError, TypeError, RecursionError):
        raise PalmbotsError(f"{path}: the boot counter is damaged; {remedy}") from None
    if check != _check(content) or not _is_state(content):
        raise PalmbotsError(f"{path}: the boot counter is damaged; {remedy}")
    owner = (content.pop("pair"), content.pop("end"))
    if owner != (file.pair, file.end):
        raise PalmbotsError(
            f"{path}: the boot counter is that of end {owner[1]} of pair {owner[0]}; "
            f"allowed: that of end {file.end} of pair {file.pair}"
        )
    return StoredState(**content | {"arm": StoredArm(*content["arm"])})


class CounterInUse(PalmbotsError):
    """Another program uses a boot counter. `process` is its number, or ``?``."""

    def __init__(self, file: StateFile, process: str) -> None:
        super().__init__(
            f"{file}: process {process} uses this boot counter; allowed: one program at a time; "
            "end that one first"
        )
        self.process = process


@contextlib.contextmanager
def held(file: StateFile) -> Iterator[None]:
    """Keep the counter from all other programs as long as the block runs.

    Otherwise a second program of the same end would take the next epoch, and the first one would
    set the counter back when it stores its own. The system ends the lock with the process.

    Raises:
        CounterInUse: another program uses it.
        PalmbotsError: the file is missing, damaged or of another robot, or the lock cannot be
            written.
    """
    read_state(file)
    lock = file.path.with_suffix(".lock")
    try:
        stream = lock.open("a+b")
    except OSError as error:
        raise PalmbotsError(f"{lock}: cannot be written: {error.strerror or error}") from None
    with stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            stream.seek(0)
            number = stream.read(20)
            raise CounterInUse(file, number.decode() if number.isdigit() else "?") from None
        stream.truncate(0)
        with contextlib.suppress(OSError):  # a full disk: the number only helps people
            stream.write(str(os.getpid()).encode())
            stream.flush()
        yield


@contextlib.contextmanager
def booted(file: StateFile) -> Iterator[StoredState]:
    """Count a boot, and hold the counter as long as the block runs.

    Raises:
        PalmbotsError: as for `held`, or the counter cannot be written.
    """
    with held(file):
        state = read_state(file).booted()
        write_state(file, state)
        yield state
