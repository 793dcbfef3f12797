"""A study's folder: who may use it, what it holds, and how a kill leaves it.

    study.json      what is studied, with its identity; written first
    results.zarr    every carry's results, and the statistics of the cells; opens with xarray
    chunks/N.npz    the mark of chunk N: checksum and tally, written once its results are kept
    lock            held by the process that carries

A chunk without its mark is carried again, over whatever is there. Files appear whole or not at all.
Errors: `PalmbotsError`, one line that names the folder.
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

from palmbots.errors import PalmbotsError, show
from palmbots.files import folder, remove, write_whole
from palmbots.studies.arrays import Arrays, Unsound, make_arrays
from palmbots.studies.design import Points
from palmbots.studies.layout import Chunk, Layout
from palmbots.studies.tally import WIDTH, Tally
from palmbots.studies.work import Block, checksum
from palmbots.version import __version__

__all__ = ["Store", "opened", "read_record"]

_KEPT = "; what was finished is kept: make room and run it again"
_RECORD, _RESULTS, _MARKS, _LOCK = "study.json", "results.zarr", "chunks", "lock"


class Store:
    """The folder of a study that this process may write."""

    def __init__(self, root: Path, points: Points, cut: Layout, arrays: Arrays) -> None:
        self.root = root
        self.points = points
        self.layout = cut
        self.arrays = arrays

    @property
    def results(self) -> Path:
        """The zarr store."""
        return self.root / _RESULTS

    def _mark(self, number: int) -> Path:
        return self.root / _MARKS / f"{number}.npz"

    def write(self, chunk: Chunk, block: Block, tally: Tally) -> None:
        """Keep a chunk: its results first, then its mark."""
        with _told(self.root):
            self.arrays.write(chunk, block)
        stream = io.BytesIO()
        np.savez(stream, tally=tally, checksum=np.array(checksum(block)))
        try:
            write_whole(self._mark(chunk.number), stream.getvalue())
        except PalmbotsError as error:
            raise PalmbotsError(f"{self.root}: {error}{_KEPT}") from None

    def read(self, chunk: Chunk) -> Block | None:
        """The results of a chunk, or None where they cannot be read."""
        with _told(self.root):
            return self.arrays.read(chunk)

    def kept(self, number: int, cells: tuple[int, int]) -> tuple[Tally, str] | None:
        """Tally and checksum of a chunk that is marked; None where it is not."""
        try:
            data = io.BytesIO(self._mark(number).read_bytes())
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with np.load(data, allow_pickle=False) as mark:
                    tally, told = mark["tally"], str(mark["checksum"])
        except Exception:  # readers of zip, of headers and of arrays fail in a dozen ways
            return None  # not there, or damaged from outside: carried again
        whole = tally.shape == (*cells, WIDTH) and tally.dtype == np.int64
        return (tally, told) if whole else None

    def forget(self, number: int) -> None:
        """Take the mark of a chunk away."""
        remove(self._mark(number))

    def conclude(self, values: Mapping[str, Any], attributes: Mapping[str, Any]) -> None:
        """Write the statistics, and what the whole store says of itself."""
        with _told(self.root):
            self.arrays.conclude(values, attributes)


@contextlib.contextmanager
def opened(root: Path, points: Points, cut: Layout, chosen: bool) -> Iterator[Store]:
    """The folder of a study, begun or taken up again; nobody else may while it is open.

    Args:
        root: the folder; made if missing.
        points: what is studied.
        cut: how to cut a new study. One that was begun keeps its cut.
        chosen: whether the user asked for that cut; then a study with another one is refused.

    Raises:
        PalmbotsError: the folder cannot be written, belongs to something else, holds another
            study, was begun with another version, or is in use.
    """
    place = folder(root)
    with _told(root):
        there = {entry.name for entry in place.iterdir()}
    if there and _RECORD not in there and there != {_LOCK}:
        raise PalmbotsError(
            f"{root}: is no study's folder (it holds {show(min(there))}); allowed: a new or empty "
            "folder, or one that a study began"
        )
    with _lock(place):
        record = read_record(place) if _RECORD in there else None
        if record is None:
            record = {
                "palmbots study": 1,
                "identity": points.identity,
                "name": points.plan.name,
                "layout": asdict(cut),
                "content": points.content,
            }
            write_whole(place / _RECORD, json.dumps(record, indent=1))
        else:
            _same(root, record, points)
            there_cut = _cut(place, record["layout"], cut)
            if chosen and there_cut != cut:
                raise PalmbotsError(
                    f"{root}: was begun with chunks of {there_cut.carries_a_chunk} carries; "
                    "allowed: the same --chunk, none, or another --out"
                )
            cut = there_cut
        folder(place / _MARKS)
        _tidy(place)
        with _told(root):
            if not (place / _RESULTS).exists():
                part = place / f"{_RESULTS}.part"
                shutil.rmtree(part, ignore_errors=True)
                make_arrays(part, points, cut)
                os.rename(part, place / _RESULTS)
            arrays = _arrays(place, points, cut)
        yield Store(root, points, cut, arrays)


def _cut(place: Path, told: Mapping[str, Any], expected: Layout) -> Layout:
    """The cut that a record tells of: one of the same study as the expected one."""
    try:
        cut = Layout(**{**told, "shape": tuple(told["shape"]), "block": tuple(told["block"])})
        sizes = (*cut.block, cut.seeds_a_chunk)
        room = (*expected.shape, expected.seeds)
        fits = all(type(n) is int and 1 <= n <= m for n, m in zip(sizes, room, strict=True))
    except (TypeError, KeyError, ValueError):
        raise _no_study(place) from None
    whole = (expected.shape, expected.controllers, expected.seeds)
    if not fits or (cut.shape, cut.controllers, cut.seeds) != whole:
        raise _no_study(place)
    return cut


def _arrays(place: Path, points: Points, cut: Layout) -> Arrays:
    """The store, opened. What it says of its arrays follows from the study: where that is damaged
    it is written anew, and the results stay; the marks tell which of them are sound."""
    path, part = place / _RESULTS, place / f"{_RESULTS}.part"
    with contextlib.suppress(Unsound):
        return Arrays(path, points, cut)
    shutil.rmtree(part, ignore_errors=True)
    make_arrays(part, points, cut)
    shutil.copytree(part, path, dirs_exist_ok=True)
    shutil.rmtree(part)
    return Arrays(path, points, cut)


def _tidy(place: Path) -> None:
    """Remove what a killed process had begun to write and not yet given its name."""
    with _told(place):
        for pattern in (
            f"{_RESULTS}/**/*.partial",
            f"{_MARKS}/.palmbots-*.part",
            ".palmbots-*.part",
        ):
            for path in place.glob(pattern):
                path.unlink(missing_ok=True)


def read_record(place: Path) -> dict[str, Any]:
    """What a study's folder says of itself."""
    try:
        record = json.loads((place / _RECORD).read_text("utf-8"))
        if record["palmbots study"] != 1 or not isinstance(record["content"], dict):
            raise ValueError
        _ = record["identity"], record["layout"]["seeds_a_chunk"], record["name"]
    except (OSError, ValueError, KeyError, TypeError):
        raise _no_study(place) from None
    return record


def _no_study(place: Path) -> PalmbotsError:
    return PalmbotsError(
        f"{place}: is no study's folder ({_RECORD} is missing or not of a study); allowed: a "
        "new or empty folder, or one that a study began"
    )


def _same(root: Path, record: Mapping[str, Any], points: Points) -> None:
    """Refuse a folder that holds something else than this study."""
    if record["identity"] == points.identity:
        return
    was, now = record["content"], points.content
    if was.get("version") != now["version"]:
        raise PalmbotsError(
            f"{root}: was begun with palmbots {was.get('version')}, this is {__version__}; "
            "allowed: that version, or another --out"
        )
    key, old, new = _difference("", was, now) or ("study", "another one", "this one")
    raise PalmbotsError(
        f"{root}: holds another study: {key} is {show(old)} there, {show(new)} here; allowed: the "
        "study as it was begun, or another --out"
    )


def _difference(inside: str, was: Any, now: Any) -> tuple[str, Any, Any] | None:
    if isinstance(was, dict) and isinstance(now, dict):
        for key in [*now, *(k for k in was if k not in now)]:
            name = f"{inside}.{key}" if inside else key
            found = _difference(name, was.get(key), now.get(key))
            if found:
                return found
        return None
    return None if was == now else (inside, _short(was), _short(now))


def _short(value: Any) -> Any:
    """Whole numbers as such: in the record every number is a float."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


@contextlib.contextmanager
def _lock(place: Path) -> Iterator[IO[bytes]]:
    """Hold the folder: the system lets go when the process ends, however it ends."""
    with _told(place):
        stream = open(place / _LOCK, "ab")  # noqa: SIM115 (held for as long as the block runs)
    with stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise PalmbotsError(
                f"{place}: is in use by another palmbots study; allowed: to wait until it ends"
            ) from None
        yield stream


@contextlib.contextmanager
def _told(root: Path) -> Iterator[None]:
    """One line for what the system refuses."""
    try:
        yield
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
        hint = _KEPT if full else ""
        raise PalmbotsError(f"{root}: cannot be written: {error.strerror or error}{hint}") from None
