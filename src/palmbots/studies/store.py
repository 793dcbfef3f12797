# SPDX-License-Identifier: Apache-2.0
"""The folder of a study: who may use it, what it holds, and in which state a kill leaves it.

    study.json      what is studied, with its identity; written first
    results.zarr    the results of every carry, and the statistics of the cells; opens with xarray
    chunks/N.npz    the mark of chunk N: checksum and exact sums; written after its results
    lock            held by the process that writes

A chunk without a mark is carried again, and its results are overwritten. Every file appears
completely or not at all. Errors are `PalmbotsError`, one line that names the folder.
"""

import contextlib
import errno
import fcntl
import io
import json
import os
import shutil
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import IO, Any

import numpy as np

from palmbots._util.arguments import show
from palmbots._util.atomic_files import folder, remove, write_whole
from palmbots._version import __version__
from palmbots.errors import PalmbotsError
from palmbots.studies.chunk_task import Block, checksum
from palmbots.studies.chunking import Chunk, ChunkGrid
from palmbots.studies.exact_sums import WIDTH, ExactSums
from palmbots.studies.points import Points
from palmbots.studies.zarr_arrays import FORMAT, StoreInvalid, ZarrArrays, make_arrays

_KEPT = "; completed chunks are kept: make room and run the command again"
RECORD, RESULTS = "study.json", "results.zarr"
_MARKS, _LOCK = "chunks", "lock"
_FORMAT_KEY = "palmbots study"


class Store:
    """The folder of a study that this process may write."""

    def __init__(self, root: Path, points: Points, layout: ChunkGrid, arrays: ZarrArrays) -> None:
        self.root = root
        self.points = points
        self.layout = layout
        self.arrays = arrays

    @property
    def results(self) -> Path:
        """The Zarr store."""
        return self.root / RESULTS

    def _mark(self, number: int) -> Path:
        return self.root / _MARKS / f"{number}.npz"

    def write(self, chunk: Chunk, block: Block, sums: ExactSums) -> None:
        """Write a chunk: its results first, then its mark."""
        with _one_line(self.root):
            self.arrays.write(chunk, block)
        stream = io.BytesIO()
        np.savez(stream, sums=sums, checksum=np.array(checksum(block)))
        try:
            write_whole(self._mark(chunk.number), stream.getvalue())
        except PalmbotsError as error:
            raise PalmbotsError(f"{self.root}: {error}{_KEPT}") from None

    def read(self, chunk: Chunk) -> Block | None:
        """The results of a chunk, or None if they cannot be read."""
        with _one_line(self.root):
            return self.arrays.read(chunk)

    def mark(self, number: int, cells: tuple[int, int]) -> tuple[ExactSums, str] | None:
        """Sums and checksum of a chunk that is marked; None if it is not, or if the mark is
        damaged."""
        try:
            data = io.BytesIO(self._mark(number).read_bytes())
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with np.load(data, allow_pickle=False) as mark:
                    sums, digest = mark["sums"], str(mark["checksum"])
        except Exception:  # readers of zip files, headers and arrays raise a dozen types
            return None
        is_sound = sums.shape == (*cells, WIDTH) and sums.dtype == np.int64
        return (sums, digest) if is_sound else None

    def remove_mark(self, number: int) -> None:
        """Remove the mark of a chunk, so that it is carried again."""
        remove(self._mark(number))

    def leave_out(self, chunk: Chunk) -> None:
        """State that the study does not carry a chunk, because its cells stopped early."""
        with _one_line(self.root):
            self.arrays.leave_out(chunk)

    def finish(self, values: Mapping[str, Any], attributes: Mapping[str, Any]) -> None:
        """Write the statistics and the attributes of the whole store, and mark it complete."""
        with _one_line(self.root):
            self.arrays.finish(values, attributes)


@contextlib.contextmanager
def open_store(root: Path, points: Points, layout: ChunkGrid, is_chosen: bool) -> Iterator[Store]:
    """The folder of a study, new or continued. No other process may write while it is open.

    A study that fails before its first chunk is complete leaves no folder behind.

    Args:
        root: the folder; created if it is missing.
        points: what is studied.
        layout: how to divide a new study into chunks. A continued study keeps its own layout.
        is_chosen: whether the user asked for this layout; a study with another one is then refused.

    Raises:
        PalmbotsError: the folder cannot be written, is no study's, holds another study, was begun
            with another version, or is in use.
    """
    place = folder(root)
    with _one_line(root):
        names = {entry.name for entry in place.iterdir()}
    if names and RECORD not in names and names != {_LOCK}:
        raise PalmbotsError(
            f"{root}: this is not the folder of a study (it holds {show(min(names))}); choose a "
            "new or empty folder, or that of a study"
        )
    with _lock(place):
        try:
            record = read_record(place) if RECORD in names else None
            if record is None:
                record = {
                    _FORMAT_KEY: FORMAT,
                    "identity": points.identity,
                    "name": points.plan.name,
                    "max_carries": points.max_carries,
                    "layout": asdict(layout),
                    "content": points.content,
                }
                write_whole(place / RECORD, json.dumps(record, indent=1))
            else:
                _refuse_another_study(root, record, points)
                own_layout = _layout(place, record["layout"], layout)
                if is_chosen and own_layout != layout:
                    raise PalmbotsError(
                        f"{root}: the study was begun with chunks of {own_layout.carries_a_chunk} "
                        "carries; use the same chunk size or none, or another folder"
                    )
                layout = own_layout
            folder(place / _MARKS)
            _remove_partial_files(place)
            with _one_line(root):
                if not (place / RESULTS).exists():
                    part = place / f"{RESULTS}.part"
                    shutil.rmtree(part, ignore_errors=True)
                    make_arrays(part, points, layout)
                    os.rename(part, place / RESULTS)
                arrays = _arrays(place, points, layout)
            yield Store(root, points, layout, arrays)
        except Exception:
            if RECORD not in names and not any((place / _MARKS).glob("*.npz")):
                shutil.rmtree(place, ignore_errors=True)  # else the corrected study is refused here
            raise


def _layout(place: Path, recorded: Mapping[str, Any], expected: ChunkGrid) -> ChunkGrid:
    """The layout in a record. It has to divide the same study as the expected one."""
    try:
        shape, block = tuple(recorded["shape"]), tuple(recorded["block"])
        given: dict[str, Any] = {**recorded, "shape": shape, "block": block}
        layout = ChunkGrid(**given)
        sizes = (*layout.block, layout.seeds_a_chunk)
        limits = (*expected.shape, expected.seeds)
        fits = all(type(n) is int and 1 <= n <= m for n, m in zip(sizes, limits, strict=True))
    except (TypeError, KeyError, ValueError):
        raise _not_a_study(place) from None
    carries = (expected.shape, expected.controllers, expected.seeds)
    if not fits or (layout.shape, layout.controllers, layout.seeds) != carries:
        raise _not_a_study(place)
    return layout


def _arrays(place: Path, points: Points, layout: ChunkGrid) -> ZarrArrays:
    """The arrays of the store.

    Damaged metadata is written again, because it follows from the study. The results stay: the
    marks state which of them are sound.
    """
    path, part = place / RESULTS, place / f"{RESULTS}.part"
    with contextlib.suppress(StoreInvalid):
        return ZarrArrays(path, points, layout)
    shutil.rmtree(part, ignore_errors=True)
    make_arrays(part, points, layout)
    shutil.copytree(part, path, dirs_exist_ok=True)
    shutil.rmtree(part)
    return ZarrArrays(path, points, layout)


def _remove_partial_files(place: Path) -> None:
    """Remove the files that a killed process had not finished."""
    patterns = (f"{RESULTS}/**/*.partial", f"{_MARKS}/.palmbots-*.part", ".palmbots-*.part")
    with _one_line(place):
        for pattern in patterns:
            for path in place.glob(pattern):
                path.unlink(missing_ok=True)


def read_record(place: Path) -> dict[str, Any]:
    """The record of a study's folder.

    Raises:
        PalmbotsError: this is not the folder of a study, or one of another format.
    """
    try:
        record = json.loads((place / RECORD).read_text("utf-8"))
        number = record[_FORMAT_KEY]
        if type(number) is not int:
            raise ValueError
        if number != FORMAT:
            raise other_format(place, number, record.get("content", {}).get("version"))
        if not isinstance(record["content"], dict):
            raise ValueError
        _ = record["identity"], record["layout"]["seeds_a_chunk"], record["name"]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise _not_a_study(place) from None
    return record


def other_format(place: Path, number: object, version: object = None) -> PalmbotsError:
    """The error about a study of another format."""
    writer = f" (palmbots {version})" if isinstance(version, str) else ""
    return PalmbotsError(
        f"{place}: this study has format {number}{writer}, and palmbots {__version__} uses format "
        f"{FORMAT}; run the study again in another folder"
    )


def _not_a_study(place: Path) -> PalmbotsError:
    return PalmbotsError(
        f"{place}: this is not the folder of a study ({RECORD} is missing or damaged); choose a "
        "new or empty folder, or that of a study"
    )


def _refuse_another_study(root: Path, record: Mapping[str, Any], points: Points) -> None:
    """Refuse a folder that holds another study than this one."""
    if record["identity"] == points.identity:
        return
    recorded, content = record["content"], points.content
    if recorded.get("version") != content["version"]:
        raise PalmbotsError(
            f"{root}: the study was begun with palmbots {recorded.get('version')}, and this is "
            f"palmbots {__version__}; use that version, or another folder"
        )
    key, old, new = _difference("", recorded, content) or ("study", "another", "this one")
    raise PalmbotsError(
        f"{root}: this folder holds another study: {key} is {show(old)} there and {show(new)} "
        "here; run the study as it was begun, or use another folder"
    )


def _difference(prefix: str, old: Any, new: Any) -> tuple[str, Any, Any] | None:
    """The first key in which two tables differ, with both values."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*new, *(k for k in old if k not in new)]:
            name = f"{prefix}.{key}" if prefix else key
            difference = _difference(name, old.get(key), new.get(key))
            if difference:
                return difference
        return None
    return None if old == new else (prefix, _short(old), _short(new))


def _short(value: Any) -> Any:
    """Whole numbers without a decimal point: in the record every number is a float."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


@contextlib.contextmanager
def _lock(place: Path) -> Iterator[IO[bytes]]:
    """Lock the folder. The system releases the lock when the process ends, in any way."""
    with _one_line(place):
        stream = open(place / _LOCK, "ab")  # noqa: SIM115 (open for as long as the block runs)
    with stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise PalmbotsError(
                f"{place}: another palmbots study is using this folder; wait until it ends"
            ) from None
        yield stream


@contextlib.contextmanager
def _one_line(root: Path) -> Iterator[None]:
    """Report an error of the file system in one line."""
    try:
        yield
    except OSError as error:
        is_full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
        hint = _KEPT if is_full else ""
        raise PalmbotsError(f"{root}: cannot be written: {error.strerror or error}{hint}") from None
