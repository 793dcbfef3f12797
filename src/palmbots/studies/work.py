"""What a chunk asks for and gives: a pure function from plain data to columns of results.

The same call gives the same bytes on any number of threads and any machine with the same version of
the package, so a chunk may be done twice, or by whoever is at hand.
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots.batch import run_table
from palmbots.errors import PalmbotsError
from palmbots.lowering import lower
from palmbots.scene import Scene
from palmbots.version import __version__

__all__ = ["VARIABLES", "Block", "Variable", "Work", "build", "carry_chunk", "checksum"]

Block = dict[str, NDArray[Any]]
"""The columns of a chunk: [points, controllers, seeds] or [points, controllers, seeds, side]."""


@dataclass(frozen=True)
class Variable:
    """One column of results, as it is kept."""

    kind: str
    by_side: bool
    unit: str
    meaning: str


VARIABLES: Mapping[str, Variable] = {
    "outcome": Variable("u1", False, "1", "0 not carried, 1 delivered, 2 dropped, 3 stalled"),
    "reason": Variable(
        "u1", False, "1",
        "0 none, 1 off-palm, 2 sliding, 3 flush, 4 tip, 5 tipping, 6 jammed, 7 lifting",
    ),
    "time_s": Variable("<f8", False, "s", "when the carry ended"),
    "contact_rms_m": Variable("<f4", True, "m", "root mean square of the contact coordinate"),
    "contact_peak_m": Variable("<f4", True, "m", "largest absolute contact coordinate"),
    "waiting_s": Variable("<f4", True, "s", "how long a robot waited for messages"),
    "corrections": Variable("<u4", False, "1", "number of corrections"),
    "messages": Variable("<u4", False, "1", "number of messages sent"),
}  # fmt: skip


@dataclass(frozen=True)
class Work:
    """A chunk of carries, in plain data that travels."""

    build: str
    """Of whom it is asked (`build`)."""
    table: bytes
    """The specs of the points, one after the other."""
    points: int
    controllers: tuple[str, ...]
    active: NDArray[np.bool_]
    """[points, controllers]: what is to be carried."""
    first_seed: int
    seeds: int
    precision: str


@cache
def build() -> str:
    """Version and fingerprint of this build: the default scene as it is laid out in memory."""
    told = hashlib.blake2b(lower(Scene()).to_bytes(), digest_size=6).hexdigest()
    return f"{__version__} ({told})"


def carry_chunk(work: Work, threads: int = 1, watch: Callable[[int], None] | None = None) -> Block:
    """Carry everything of a chunk.

    Args:
        work: what to carry.
        threads: results do not depend on it.
        watch: called now and then with the number of carries that are done.

    Raises:
        PalmbotsError: the work was cut by another version of the package.
        KeyboardInterrupt: Ctrl-C; the chunk is lost.
    """
    if work.build != build():
        raise PalmbotsError(
            f"study: this worker has palmbots {build()}, the study palmbots {work.build}; "
            "allowed: the same version on every machine"
        )
    shape = (work.points, len(work.controllers), work.seeds)
    block: Block = {
        name: np.zeros((*shape, 2) if v.by_side else shape, v.kind) for name, v in VARIABLES.items()
    }
    before = 0
    for c, controller in enumerate(work.controllers):
        chosen = np.nonzero(work.active[:, c])[0]
        if not len(chosen):
            continue
        which = np.repeat(chosen.astype(np.uint32), work.seeds)
        seeds = np.arange(work.seeds, dtype=np.uint64) + np.uint64(work.first_seed)
        run = run_table(
            work.table,
            which,
            np.tile(seeds, len(chosen)),
            controller,
            work.precision,
            threads=threads,
            watch=None if watch is None else lambda n, before=before: watch(before + n),
        )
        for name, column in block.items():
            column[chosen, c] = run[name].reshape(len(chosen), *column.shape[2:])
        before += len(which)
    return block


def checksum(block: Block) -> str:
    """A hash of the bytes of a chunk."""
    told = hashlib.blake2b(digest_size=16)
    for name in VARIABLES:
        told.update(np.ascontiguousarray(block[name]).data)
    return told.hexdigest()
