"""The arrays of a study as a zarr store that xarray opens: every carry, and every cell.

Zarr's format 2, which readers in many languages know. Carries have the dimensions of the design,
``controller``, ``seed`` and, where there are two, ``side``; their chunks are those of the study.
Statistics have the dimensions of the design and ``controller``; their intervals one more, ``end``.
"""

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from palmbots.errors import show
from palmbots.studies.design import Points
from palmbots.studies.layout import Chunk, Layout
from palmbots.studies.needs import needed
from palmbots.studies.statistics import STATISTICS
from palmbots.studies.work import VARIABLES, Block
from palmbots.units import unit_of

__all__ = ["Arrays", "Unsound", "make_arrays"]

_DIMS = "_ARRAY_DIMENSIONS"


def make_arrays(path: Path, points: Points, cut: Layout) -> None:
    """Make the store with all of its arrays, empty but for the coordinates."""
    zarr = needed("zarr", "study")
    group = zarr.open_group(str(path), mode="w", zarr_format=2)
    dims = (*points.dims, "controller", "seed")
    shape = (*cut.shape, cut.controllers, cut.seeds)
    chunks = (*cut.block, cut.controllers, cut.seeds_a_chunk)
    for name, variable in VARIABLES.items():
        both = (2,) if variable.by_side else ()
        group.create_array(
            name,
            shape=(*shape, *both),
            chunks=(*chunks, *both),
            dtype=variable.kind,
            fill_value=None,  # xarray takes a fill value for "missing", and 0 is a result
            chunk_key_encoding={"name": "v2", "separator": "/"},
            attributes={
                _DIMS: [*dims, *(["side"] if both else [])],
                "units": variable.unit,
                "long_name": variable.meaning,
            },
        )
    cells = (*cut.shape, cut.controllers)
    for name, statistic in STATISTICS.items():
        told = {_DIMS: [*points.dims, "controller"], "units": statistic.unit}
        _small(group, name, cells, told | {"long_name": statistic.meaning})
        if statistic.has_interval:
            told = {_DIMS: [*points.dims, "controller", "end"], "units": statistic.unit}
            what = f"95 % interval: {statistic.meaning}"
            _small(group, f"{name}_interval", (*cells, 2), told | {"long_name": what})
    _coordinates(group, points, cut)
    group.attrs.update({"study": points.plan.name, "identity": points.identity})
    if not points.is_grid:  # the keys are no dimensions: xarray wants to be told what they are
        group.attrs["coordinates"] = " ".join(points.plan.keys)
    zarr.consolidate_metadata(group.store, zarr_format=2)


def _small(group: Any, name: str, shape: tuple[int, ...], attributes: dict[str, Any]) -> None:
    group.create_array(
        name, shape=shape, dtype="<f8", fill_value=np.nan, chunks=shape, attributes=attributes
    )


def _coordinates(group: Any, points: Points, cut: Layout) -> None:
    for key in points.plan.keys:
        dim = key if points.is_grid else "point"
        values = points.levels(key) if points.is_grid else points.column(key)
        told = {_DIMS: [dim], "units": unit_of(key) or "1", "long_name": key}
        _put(group, key, _labels(values), told)
    if not points.is_grid or not points.plan.keys:
        _put(group, "point", np.arange(len(points.values)), {_DIMS: ["point"]})
    _put(group, "controller", np.array(points.plan.study.controllers), {_DIMS: ["controller"]})
    _put(group, "side", np.array(["left", "right"]), {_DIMS: ["side"]})
    _put(group, "end", np.array(["low", "high"]), {_DIMS: ["end"]})
    piece = 1 << 20  # so that many seeds need little memory
    seeds = group.create_array(
        "seed", shape=(cut.seeds,), dtype="<u8", chunks=(min(piece, cut.seeds),),
        attributes={_DIMS: ["seed"]}, fill_value=None,
    )  # fmt: skip
    first = np.uint64(points.plan.study.seeds.first)
    for start in range(0, cut.seeds, piece):
        stop = min(start + piece, cut.seeds)
        seeds[start:stop] = first + np.arange(start, stop, dtype=np.uint64)


def _put(group: Any, name: str, values: Any, attributes: dict[str, Any]) -> None:
    values = np.asarray(values)
    made = group.create_array(
        name, shape=values.shape, dtype=values.dtype, fill_value=None, attributes=attributes
    )
    made[...] = values


def _labels(values: list[Any]) -> Any:
    """Numbers as numbers, booleans as such, all else as text."""
    if all(isinstance(v, bool) for v in values):
        return np.array(values)
    if all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
        return np.array(values, np.float64)
    return np.array([v if isinstance(v, str) else show(v) for v in values])


class Unsound(Exception):
    """The store does not have the arrays of the study: what it says of them is damaged."""


class Arrays:
    """The store, open for reading and writing.

    Raises `Unsound` where an array is missing or is another one.
    """

    def __init__(self, path: Path, points: Points, cut: Layout) -> None:
        zarr = needed("zarr", "study")
        self._zarr = zarr
        self._path = path
        try:
            group = zarr.open_group(str(path), mode="r+", zarr_format=2, use_consolidated=False)
            ends = [f"{name}_interval" for name, s in STATISTICS.items() if s.has_interval]
            cells = [group[name] for name in (*STATISTICS, *ends)]
            for name in (*points.plan.keys, "controller", "seed", "side", "end"):
                _ = group[name].shape
            self._columns = {name: group[name] for name in VARIABLES}
            self._group = group
        except (KeyError, ValueError, TypeError, FileNotFoundError) as error:
            raise Unsound from error
        dims, chunks = (*cut.shape, cut.controllers), (*cut.block, cut.controllers)
        for name, column in self._columns.items():
            both = (2,) if VARIABLES[name].by_side else ()
            told = (column.shape, column.chunks, column.dtype)
            shape, parts = (*dims, cut.seeds, *both), (*chunks, cut.seeds_a_chunk, *both)
            if told != (shape, parts, np.dtype(VARIABLES[name].kind)):
                raise Unsound
        if any(one.shape[: len(dims)] != dims for one in cells):
            raise Unsound

    def write(self, chunk: Chunk, block: Block) -> None:
        """Write the results of a chunk, and force them to the disk."""
        sizes = tuple(part.stop - part.start for part in chunk.region)
        for name, column in self._columns.items():
            values = block[name]
            region = (*chunk.region, slice(None), chunk.seeds)
            column[region] = values.reshape(*sizes, *values.shape[1:])
            self._sync(name, column, chunk)

    def _sync(self, name: str, column: Any, chunk: Chunk) -> None:
        """Only what is on the disk may be marked as kept. A chunk of nothing but 0 has no file."""
        places = [part.start // b for part, b in zip(chunk.region, column.chunks, strict=False)]
        parts = [*places, 0, chunk.column, *([0] if VARIABLES[name].by_side else [])]
        file = self._path.joinpath(name, *map(str, parts))
        for path in (file, file.parent):
            with contextlib.suppress(FileNotFoundError):
                handle = os.open(path, os.O_RDONLY)
                try:
                    os.fsync(handle)
                finally:
                    os.close(handle)

    def read(self, chunk: Chunk) -> Block | None:
        """The results of a chunk; None where a file of theirs is damaged."""
        region = (*chunk.region, slice(None), chunk.seeds)
        block: Block = {}
        for name, column in self._columns.items():
            try:
                values = np.asarray(column[region])
            except (RuntimeError, ValueError):  # the decompressor cannot make sense of it
                return None
            block[name] = values.reshape(len(chunk.points), *values.shape[len(chunk.region) :])
        return block

    def conclude(self, values: Mapping[str, Any], attributes: Mapping[str, Any]) -> None:
        """Write statistics over cells [points, controllers] and the attributes of the store."""
        for name, (numbers, ends) in values.items():
            target = self._group[name]
            target[...] = numbers.reshape(target.shape)
            if ends is not None:
                target = self._group[f"{name}_interval"]
                target[...] = ends.reshape(target.shape)
        self._group.attrs.update(dict(attributes))
        self._zarr.consolidate_metadata(self._group.store, zarr_format=2)
