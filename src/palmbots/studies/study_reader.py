# SPDX-License-Identifier: Apache-2.0
"""Open the results of a study, after checking that they are complete and undamaged.

The check reads everything once. Each chunk has a CRC-32C checksum. The hash of all results and the
statistics of the cells are computed again and compared with those in the store.
"""

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from palmbots._util.optional_imports import require
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.studies.chunk_task import Block, ResultsHash
from palmbots.studies.chunking import Chunk, ChunkGrid
from palmbots.studies.exact_sums import WIDTH, exact_sums_of
from palmbots.studies.statistics import statistics_of
from palmbots.studies.store import RECORD, RESULTS, other_format, read_record
from palmbots.studies.variables import MISSING, STATISTICS, VARIABLES, is_carried
from palmbots.studies.zarr_arrays import FORMAT

if TYPE_CHECKING:
    import xarray as xr

_READ_ERRORS = (ValueError, RuntimeError, KeyError, TypeError, OSError)
"""What Zarr raises for a wrong checksum, a file that cannot be decompressed, or a bad array."""
Arrays = Mapping[str, Any]
"""The arrays of a store, by name."""


def open_study(
    path: str | os.PathLike[str], *, verify: bool = True, allow_incomplete: bool = False
) -> "xr.Dataset":
    """Open the results of a study; arrays are read from the disk when they are used.

    Args:
        path: the folder of the study, or the store ``results.zarr`` in it.
        verify: read everything once, and check it against its checksums and hash.
        allow_incomplete: open a study that has not finished. Carries without a result have
            ``outcome`` 255 and NaN elsewhere, so take means over ``outcome < 255`` only.

    Raises:
        PalmbotsError: these are no results of a study, they are damaged, they are incomplete, or
            another version of palmbots wrote them.
    """
    place = user_path(path)
    results = place / RESULTS if (place / RESULTS).exists() else place
    if (results.parent / RECORD).exists():
        read_record(results.parent)
    group, attributes = _open_group(results)
    is_complete = attributes["is_complete"]
    n = _verified(results, _arrays(results, group), attributes) if verify else None
    if not is_complete and not allow_incomplete:
        n = _count(results, _arrays(results, group)) if n is None else n
        limit = "at most " if attributes["stops_early"] else ""
        raise PalmbotsError(
            f"{place}: incomplete: {n} of {limit}{attributes['max_carries']} carries; run the same "
            "study again to finish it, or open it with allow_incomplete=True"
        )
    return _dataset(results)


def _dataset(results: Path) -> "xr.Dataset":
    require("zarr", "study")
    import xarray as xr  # here: slow to import

    try:
        dataset = xr.open_zarr(results, chunks=None, zarr_format=3)
    except _READ_ERRORS as error:
        raise _no_results(results, error) from None
    texts = {
        name: (labels.dims, np.array(labels.values.tolist(), "U"), labels.attrs)
        for name, labels in dataset.coords.items()
        if labels.dtype.kind in "TO"
    }
    flags = {name: int(one) for name, one in dataset.attrs.items() if isinstance(one, bool)}
    # The encoding is that of Zarr: netCDF has neither its codecs nor all of its types.
    return dataset.assign_coords(texts).assign_attrs(flags).drop_encoding()


def _open_group(results: Path) -> tuple[Any, dict[str, Any]]:
    zarr = require("zarr", "study")
    if (results / ".zgroup").exists():  # Zarr's format 2, which format 1 of a study used
        raise other_format(results, 1)
    try:
        group = zarr.open_group(str(results), mode="r", zarr_format=3, use_consolidated=False)
        attributes = dict(group.attrs)
        number = attributes["palmbots_study_format"]
        if type(number) is int and number != FORMAT:
            raise other_format(results, number)
        is_complete = attributes["is_complete"]
        types = {"identity": str, "max_carries": int, "stops_early": bool, "is_complete": bool}
        types |= {"carries": int, "hash": str} if is_complete is True else {}
        if number != FORMAT or any(type(attributes[key]) is not t for key, t in types.items()):
            raise ValueError("its attributes are damaged")
    except _READ_ERRORS as error:
        raise _no_results(results, error) from None
    return group, attributes


def _no_results(place: Path, error: Exception) -> PalmbotsError:
    reason = str(error).strip().split("\n")[0] or type(error).__name__
    return PalmbotsError(f"{place}: these are not the results of a study: {reason}")


def _damaged(results: Path, what: str) -> PalmbotsError:
    return PalmbotsError(
        f"{results}: the results are damaged: {what}; run the same study again: it carries the "
        "damaged chunks again and keeps the others"
    )


def _arrays(results: Path, group: Any) -> Arrays:
    """All arrays by name, opened at once: one by one takes several times as long."""
    try:
        return dict(group.arrays())
    except _READ_ERRORS as error:
        raise _damaged(results, f"the metadata cannot be read ({error})") from None


def _verified(results: Path, arrays: Arrays, attributes: Mapping[str, Any]) -> int:
    """The number of carries in a store.

    Raises:
        PalmbotsError: something in the store is damaged, or a file is missing.
    """
    _check_metadata(results, arrays)
    layout = _layout(results, arrays)
    results_hash = ResultsHash(attributes["identity"])
    sums = np.zeros((int(np.prod(layout.shape)), layout.controllers, WIDTH), np.int64)
    n, row = 0, 0
    for chunk, block in _blocks(results, arrays, layout):
        if chunk.row != row:
            results_hash.end_row()
            row = chunk.row
        carried = is_carried(block["outcome"])
        n += int(np.count_nonzero(carried))
        if carried.any():
            results_hash.add(block)
        gaps = [
            name
            for name, variable in VARIABLES.items()
            if variable.is_missing(block[name])[carried].any()
        ]
        if attributes["is_complete"] and (block["outcome"] == MISSING).any():
            gaps = ["outcome"]
        if gaps:
            raise _damaged(results, f"{', '.join(gaps)}: values are missing")
        sums[chunk.points] += exact_sums_of(block)
    results_hash.end_row()
    if not attributes["is_complete"]:
        return n
    if n != attributes["carries"] or results_hash.hexdigest() != attributes["hash"]:
        raise _damaged(
            results,
            f"{n} carries with hash {results_hash.hexdigest()} instead of {attributes['carries']} "
            f"with hash {attributes['hash']}",
        )
    for name, (values, ends) in statistics_of(sums).items():
        for array, expected in ((name, values), (f"{name}_interval", ends)):
            if expected is None:
                continue
            stored = _read(results, arrays, array, ())
            if not np.allclose(
                stored.reshape(-1), expected.reshape(-1), rtol=1e-9, atol=0, equal_nan=True
            ):
                raise _damaged(results, f"{array} does not follow from the carries")
    return n


def _check_metadata(results: Path, arrays: Arrays) -> None:
    """Compare the metadata of each array with the copy that xarray reads, and read all labels."""
    zarr = require("zarr", "study")
    try:
        copy = zarr.open_group(str(results), mode="r", zarr_format=3, use_consolidated=True)
        copies = copy.metadata.consolidated_metadata.metadata
    except (*_READ_ERRORS, AttributeError) as error:
        raise _damaged(results, f"the metadata cannot be read ({error})") from None
    names = set(arrays)
    intervals = [f"{name}_interval" for name, one in STATISTICS.items() if one.has_interval]
    data = {*VARIABLES, *STATISTICS, *intervals}
    labels = {"controller", "seed", "side", "end"}
    if not data | labels <= names or names != set(copies):
        lost = sorted((data | labels | set(copies)) - names) or sorted(names - set(copies))
        raise _damaged(results, f"{', '.join(lost)}: the array is missing")
    for name in sorted(names):
        if _text(arrays[name].metadata) != _text(copies[name]):
            raise _damaged(results, f"{name}: the metadata was changed")
    for name in sorted(names - data):
        if arrays[name].nchunks_initialized != arrays[name].nchunks:
            raise _damaged(results, f"{name}: a file is missing")
        _read(results, arrays, name, ())


def _text(metadata: Any) -> str:
    return json.dumps(metadata.to_dict(), sort_keys=True, default=str)


def _layout(results: Path, arrays: Arrays) -> ChunkGrid:
    """The division into chunks, which is that of the arrays."""
    column = arrays["outcome"]
    *shape, controllers, seeds = column.shape
    *block, _, length = column.chunks
    for name, variable in VARIABLES.items():
        expected = variable.shape(column.shape), variable.shape(column.chunks)
        if (arrays[name].shape, arrays[name].chunks) != expected:
            raise _damaged(results, f"{name}: the shape is not that of outcome")
    return ChunkGrid(tuple(shape), tuple(block), controllers, seeds, length)


def _blocks(results: Path, arrays: Arrays, layout: ChunkGrid) -> Iterator[tuple[Chunk, Block]]:
    for number in range(layout.chunks):
        chunk = layout.chunk(number)
        region = (*chunk.region, slice(None), chunk.seeds)
        block: Block = {}
        for name in VARIABLES:
            values = _read(results, arrays, name, region)
            block[name] = values.reshape(len(chunk.points), *values.shape[len(chunk.region) :])
        yield chunk, block


def _read(results: Path, arrays: Arrays, name: str, region: tuple[slice, ...]) -> Any:
    try:
        return np.asarray(arrays[name][region if region else ...])
    except _READ_ERRORS as error:
        # zarr quotes the bytes of both checksums
        reason = str(error).partition(" Stored:")[0].rstrip(".")
        raise _damaged(results, f"{name}: {reason}") from None


def _count(results: Path, arrays: Arrays) -> int:
    """The number of carries in a store, without any other check."""
    layout, n = _layout(results, arrays), 0
    for number in range(layout.chunks):
        chunk = layout.chunk(number)
        outcome = _read(results, arrays, "outcome", (*chunk.region, slice(None), chunk.seeds))
        n += int(np.count_nonzero(is_carried(outcome)))
    return n
