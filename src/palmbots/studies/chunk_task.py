# SPDX-License-Identifier: Apache-2.0
"""The carries of one chunk: a pure function from plain data to columns of results.

The same call returns the same bytes for any number of threads and on any machine with the same
version of the package. A chunk may therefore be carried twice, by any worker.
"""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots._version import __version__
from palmbots.control.registry import ControllerEntry
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_batch
from palmbots.simulation.single import carry
from palmbots.studies.variables import NOT_CARRIED, OUTCOMES, REASONS, VARIABLES, is_carried

Block = dict[str, NDArray[Any]]
"""The columns of a chunk: [points, controllers, seeds] or [points, controllers, seeds, side]."""


@dataclass(frozen=True)
class ChunkTask:
    """The carries of a chunk, as data that can be sent to another process."""

    build: str
    """The build that has to carry it (`build_id`)."""
    table: bytes
    """The specs of the points, one after the other."""
    points: int
    controllers: tuple[str, ...]
    active: NDArray[np.bool_]
    """[points, controllers]: the cells to carry."""
    first_seed: int
    seeds: int
    precision: str
    makers: Mapping[str, Callable[[], Any]] = field(default_factory=dict)
    """What makes the controllers in Python, by name."""
    policies: Mapping[str, ControllerEntry] = field(default_factory=dict)
    """The controllers from policy files, by name."""
    scenes: tuple[Scene, ...] = ()
    """The scenes of the points; given only if there are controllers in Python."""


@cache
def build_id() -> str:
    """Version and fingerprint of this build. The fingerprint is that of the default spec."""
    digest = hashlib.blake2b(to_spec(Scene()).to_bytes(), digest_size=6).hexdigest()
    return f"{__version__} ({digest})"


def check_build(build: str) -> None:
    """Refuse a task of another build.

    Raises:
        PalmbotsError: this is not the build with this `build_id`.
    """
    if build != build_id():
        raise PalmbotsError(
            f"study: this worker has palmbots {build_id()}, and the study has palmbots {build}; "
            "every machine needs the same version"
        )


def empty_block(shape: tuple[int, int, int]) -> Block:
    """Columns for [points, controllers, seeds] in which every carry is left out."""
    block = {
        name: np.full(variable.shape(shape), variable.missing, variable.dtype)
        for name, variable in VARIABLES.items()
    }
    block["outcome"][...] = NOT_CARRIED
    return block


def carry_chunk(
    task: ChunkTask, threads: int = 1, on_progress: Callable[[int], None] | None = None
) -> Block:
    """Run all the carries of a chunk.

    Args:
        task: the carries.
        threads: number of threads; results do not depend on it. Controllers in Python use one.
        on_progress: called now and then with the number of completed carries.

    Raises:
        PalmbotsError: the task was made by another version of the package, or a controller in
            Python failed.
        KeyboardInterrupt: Ctrl-C; the chunk is lost.
    """
    check_build(task.build)
    block = empty_block((task.points, len(task.controllers), task.seeds))
    seeds = np.arange(task.seeds, dtype=np.uint64) + np.uint64(task.first_seed)
    before = 0
    for c, controller in enumerate(task.controllers):
        chosen = np.nonzero(task.active[:, c])[0]
        if not len(chosen):
            continue
        report = None if on_progress is None else _offset(on_progress, before)
        if controller in task.makers:
            _carry_singly(task, c, chosen, seeds, block, report)
        else:
            spec_index = np.repeat(chosen.astype(np.uint32), task.seeds)
            run = run_batch(
                task.table,
                spec_index,
                np.tile(seeds, len(chosen)),
                task.policies.get(controller, controller),
                task.precision,
                threads=threads,
                watch=report,
            )
            for name, column in block.items():
                column[chosen, c] = run[name].reshape(len(chosen), *column.shape[2:])
        before += len(chosen) * task.seeds
    return block


def _offset(on_progress: Callable[[int], None], before: int) -> Callable[[int], None]:
    return lambda n: on_progress(before + n)


def _carry_singly(
    task: ChunkTask,
    c: int,
    points: NDArray[np.intp],
    seeds: NDArray[np.uint64],
    block: Block,
    on_progress: Callable[[int], None] | None,
) -> None:
    """Run the carries of a controller in Python one by one."""
    maker = task.makers[task.controllers[c]]
    count = 0
    for point in points:
        for k, seed in enumerate(seeds.tolist()):
            result = carry(
                task.scenes[point], maker, seed=seed, precision=task.precision, record=False
            )
            for name, value in _numbers(result).items():
                block[name][point, c, k] = value
            count += 1
            if on_progress is not None:
                on_progress(count)


def _numbers(result: Any) -> dict[str, float | Sequence[float]]:
    """The result of one carry as the variables of a study."""
    return {
        "outcome": OUTCOMES[result.outcome],
        "reason": REASONS[result.reason or "none"],
        "time_s": result.time_s,
        "contact_rms_m": tuple(result.contact_rms_m.values()),
        "contact_peak_m": tuple(result.contact_peak_m.values()),
        "waiting_s": tuple(result.waiting_s.values()),
        "corrections": result.correction_count,
        "messages": result.messages,
    }


def checksum(block: Block) -> str:
    """A hash of the bytes of a chunk."""
    digest = hashlib.blake2b(digest_size=16)
    for name in VARIABLES:
        digest.update(np.ascontiguousarray(block[name]).data)
    return digest.hexdigest()


class ResultsHash:
    """The hash of all results of a study. It does not depend on the division into chunks.

    Every cell has a digest over its carries in the order of their seeds. Carries that were left out
    are not part of it.
    """

    def __init__(self, identity: str) -> None:
        self._total = hashlib.blake2b(identity.encode(), digest_size=8)
        self._cells: list[Any] = []

    def add(self, block: Block) -> None:
        """Add the next chunk of a row; chunks are added in the order of their seeds."""
        parts = []
        for name in VARIABLES:
            column = np.ascontiguousarray(block[name])
            parts.append(column.view(np.uint8).reshape(*column.shape[:3], -1))
        records = np.concatenate(parts, axis=-1)
        counts = np.count_nonzero(is_carried(block["outcome"]), axis=2).reshape(-1)
        if not self._cells:
            self._cells = [hashlib.blake2b(digest_size=16) for _ in counts]
        cells = records.reshape(len(self._cells), *records.shape[2:])
        for digest, cell, n in zip(self._cells, cells, counts, strict=True):
            digest.update(np.ascontiguousarray(cell[:n]).data)

    def end_row(self) -> None:
        """End a row of chunks."""
        for digest in self._cells:
            self._total.update(digest.digest())
        self._cells = []

    def hexdigest(self) -> str:
        """The hash."""
        return self._total.hexdigest()
