# SPDX-License-Identifier: Apache-2.0
"""The arrays of a study as a Zarr store that xarray opens: results of carries, statistics of cells.

The store has Zarr's format 3. Every chunk ends with a CRC-32C checksum, which each reader of Zarr
verifies. Results of carries have the dimensions of the design, ``controller``, ``seed`` and, for
variables of each robot, ``side``; their chunks are those of the study. Statistics have the
dimensions of the design and ``controller``, and intervals also ``end``.

A chunk without a file reads as "missing": NaN, or `MISSING` for a code. No result has these values.
"""

import contextlib
import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from palmbots._types import SIDES
from palmbots._util.arguments import show
from palmbots._util.optional_imports import require
from palmbots.scene.key_units import unit_of
from palmbots.studies.chunk_task import Block
from palmbots.studies.chunking import Chunk, ChunkGrid
from palmbots.studies.points import Points
from palmbots.studies.variables import NOT_CARRIED, STATISTICS, VARIABLES, Variable

FORMAT = 2
"""Of a study's folder and its store. Format 1 (palmbots 0.1.0) had no checksums."""


class StoreInvalid(Exception):
    """The arrays of the store are not those of the study: its metadata is damaged."""


def make_arrays(path: Path, points: Points, layout: ChunkGrid) -> None:
    """Create the store with all of its arrays. Only the coordinates have values."""
    zarr = require("zarr", "study")
    # In memory first: Zarr asks another thread for each of the many small files.
    files: dict[str, Any] = {}
    group = zarr.open_group(zarr.storage.MemoryStore(files), mode="w", zarr_format=3)
    carries = (*layout.shape, layout.controllers, layout.seeds)
    chunks = (*layout.block, layout.controllers, layout.seeds_a_chunk)
    dims = (*points.dims, "controller", "seed")
    for name, variable in VARIABLES.items():
        _create(
            group,
            name,
            (*dims, "side") if variable.by_side else dims,
            shape=variable.shape(carries),
            chunks=variable.shape(chunks),
            dtype=variable.dtype,
            fill_value=variable.missing,
            attributes=_attributes(variable),
        )
    cells, dims = (*layout.shape, layout.controllers), (*points.dims, "controller")
    for name, statistic in STATISTICS.items():
        attributes = {"units": statistic.unit, "long_name": statistic.meaning}
        _create_statistic(group, name, dims, cells, attributes)
        if statistic.has_interval:
            attributes["long_name"] = f"95 % interval: {statistic.meaning}"
            _create_statistic(group, f"{name}_interval", (*dims, "end"), (*cells, 2), attributes)
    _create_coordinates(group, points, layout)
    group.attrs.update(
        {
            "palmbots_study_format": FORMAT,
            "study": points.plan.name,
            "identity": points.identity,
            "max_carries": points.max_carries,
            "stops_early": points.plan.study.stop is not None,
            "is_complete": False,
        }
    )
    if not points.is_grid:  # the keys are no dimensions: xarray needs to know that they are labels
        group.attrs["coordinates"] = " ".join(points.plan.keys)
    _consolidate(group)
    for name, content in files.items():
        file = path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content.to_bytes())


def _attributes(variable: Variable) -> dict[str, Any]:
    attributes: dict[str, Any] = {"units": variable.unit, "long_name": variable.long_name}
    if variable.codes is not None:  # the conventions for codes (CF 3.5)
        attributes["flag_values"] = list(variable.codes.values())
        attributes["flag_meanings"] = " ".join(n.replace(" ", "_") for n in variable.codes)
    elif not np.isnan(variable.missing):  # xarray reads it as NaN, as a float
        attributes["_FillValue"] = int(variable.missing)
    return attributes


def _create(group: Any, name: str, dims: tuple[str, ...], **options: Any) -> Any:
    codecs = require("zarr.codecs", "study")
    return group.create_array(
        name,
        dimension_names=dims,
        compressors=[codecs.ZstdCodec(level=0), codecs.Crc32cCodec()],
        # Every chunk that was written has a file, also one of nothing but fill values: a missing
        # file is a lost one.
        config={"write_empty_chunks": True},
        **options,
    )


def _create_statistic(
    group: Any,
    name: str,
    dims: tuple[str, ...],
    shape: tuple[int, ...],
    attributes: Mapping[str, Any],
) -> None:
    _create(
        group, name, dims, shape=shape, chunks=shape, dtype="<f8", fill_value=np.nan,
        attributes=dict(attributes),
    )  # fmt: skip


def _create_coordinates(group: Any, points: Points, layout: ChunkGrid) -> None:
    for key in points.plan.keys:
        dim = key if points.is_grid else "point"
        values = points.levels(key) if points.is_grid else points.column(key)
        attributes = {"units": unit_of(key) or "1", "long_name": key}
        _put(group, key, dim, _labels(values), attributes)
    if not points.is_grid or not points.plan.keys:
        _put(group, "point", "point", np.arange(len(points.values)))
    _put(group, "controller", "controller", np.array(points.plan.controller_names))
    _put(group, "side", "side", np.array(SIDES))
    _put(group, "end", "end", np.array(["low", "high"]))
    length = 1 << 20  # written in pieces, so that many seeds take little memory
    seeds = _create(
        group, "seed", ("seed",), shape=(layout.seeds,), chunks=(min(length, layout.seeds),),
        dtype="<u8", fill_value=0,
    )  # fmt: skip
    first = np.uint64(points.plan.study.seeds.first)
    for start in range(0, layout.seeds, length):
        stop = min(start + length, layout.seeds)
        seeds[start:stop] = first + np.arange(start, stop, dtype=np.uint64)


def _put(
    group: Any, name: str, dim: str, values: Any, attributes: Mapping[str, Any] | None = None
) -> None:
    is_text = values.dtype.kind == "U"
    array = _create(
        group, name, (dim,), shape=values.shape, chunks=values.shape,
        dtype="string" if is_text else values.dtype,
        fill_value="" if is_text else values.dtype.type(0), attributes=dict(attributes or {}),
    )  # fmt: skip
    array[...] = values


def _labels(values: list[Any]) -> Any:
    """Numbers as numbers, booleans as booleans, all else as text."""
    if all(isinstance(v, bool) for v in values):
        return np.array(values)
    if all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
        return np.array(values, np.float64)
    return np.array([v if isinstance(v, str) else show(v) for v in values])


def _consolidate(group: Any) -> None:
    """Copy the metadata of all arrays into that of the group, which xarray reads."""
    with warnings.catch_warnings():
        # Consolidated metadata is not yet part of the specification of format 3. A reader that does
        # not know it reads the metadata of each array.
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        require("zarr", "study").consolidate_metadata(group.store, zarr_format=3)


class ZarrArrays:
    """The store of a study, open for reading and writing.

    Raises `StoreInvalid` if an array is missing or is not that of the study.
    """

    def __init__(self, path: Path, points: Points, layout: ChunkGrid) -> None:
        zarr = require("zarr", "study")
        self._path = path
        try:
            group = zarr.open_group(str(path), mode="r+", zarr_format=3, use_consolidated=False)
            self._arrays = dict(group.arrays())  # at once, which is faster than one by one
            ends = [f"{name}_interval" for name, s in STATISTICS.items() if s.has_interval]
            cells = [self._arrays[name] for name in (*STATISTICS, *ends)]
            for name in (*points.plan.keys, "controller", "seed", "side", "end"):
                labels = self._arrays[name]
                if labels.nchunks_initialized != labels.nchunks:
                    raise StoreInvalid
                _ = labels[...]  # the checksum
            self._columns = {name: self._arrays[name] for name in VARIABLES}
            self._group = group
        except (KeyError, ValueError, TypeError, RuntimeError, FileNotFoundError) as error:
            raise StoreInvalid from error
        dims, chunks = (*layout.shape, layout.controllers), (*layout.block, layout.controllers)
        for name, column in self._columns.items():
            variable = VARIABLES[name]
            expected = (
                variable.shape((*dims, layout.seeds)),
                variable.shape((*chunks, layout.seeds_a_chunk)),
                np.dtype(variable.dtype),
                _attributes(variable),
            )
            if (column.shape, column.chunks, column.dtype, dict(column.attrs)) != expected:
                raise StoreInvalid
        if any(one.shape[: len(dims)] != dims for one in cells):
            raise StoreInvalid
        if self._group.attrs.get("palmbots_study_format") != FORMAT:
            raise StoreInvalid

    def write(self, chunk: Chunk, block: Block) -> None:
        """Write the results of a chunk, and force them to the disk."""
        for name, column in self._columns.items():
            self._write_column(column, chunk, block[name])
            self._sync(name, column, chunk)

    def leave_out(self, chunk: Chunk) -> None:
        """State that the study does not carry a chunk, because its cells stopped early."""
        column = self._columns["outcome"]
        shape = (len(chunk.points), column.shape[-2], chunk.seeds.stop - chunk.seeds.start)
        self._write_column(column, chunk, np.full(shape, NOT_CARRIED, column.dtype))

    def _write_column(self, column: Any, chunk: Chunk, values: Any) -> None:
        sizes = tuple(part.stop - part.start for part in chunk.region)
        column[(*chunk.region, slice(None), chunk.seeds)] = values.reshape(
            *sizes, *values.shape[1:]
        )

    def _sync(self, name: str, column: Any, chunk: Chunk) -> None:
        """Only what is on the disk may be marked as kept."""
        places = [part.start // b for part, b in zip(chunk.region, column.chunks, strict=False)]
        parts = [*places, 0, chunk.column, *([0] if VARIABLES[name].by_side else [])]
        file = self._path.joinpath(name, "c", *map(str, parts))
        for path in (file, file.parent):
            with contextlib.suppress(FileNotFoundError):
                handle = os.open(path, os.O_RDONLY)
                try:
                    os.fsync(handle)
                finally:
                    os.close(handle)

    def read(self, chunk: Chunk) -> Block | None:
        """The results of a chunk; None if one of their files is damaged."""
        region = (*chunk.region, slice(None), chunk.seeds)
        block: Block = {}
        for name, column in self._columns.items():
            try:
                values = np.asarray(column[region])
            except (RuntimeError, ValueError):  # the checksum, or the decompressor
                return None
            block[name] = values.reshape(len(chunk.points), *values.shape[len(chunk.region) :])
        return block

    def finish(self, values: Mapping[str, Any], attributes: Mapping[str, Any]) -> None:
        """Write the statistics of the cells [points, controllers], and mark the store complete."""
        for name, (numbers, ends) in values.items():
            cells = self._arrays[name]
            cells[...] = numbers.reshape(cells.shape)
            if ends is not None:
                interval = self._arrays[f"{name}_interval"]
                interval[...] = ends.reshape(interval.shape)
        self._group.attrs.update({**attributes, "is_complete": True})
        _consolidate(self._group)
