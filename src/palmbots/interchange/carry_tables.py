# SPDX-License-Identifier: Apache-2.0
"""Carries as a Parquet table: a row for each tick.

The columns are the logged variables of the trace, with the names that they have in logs, one for
each robot where each has a value: ``left_contact_m``. Before them stand ``episode``, ``seed`` and
``time_s``. Each column states its unit and meaning as metadata, and the table states the scene, the
controller, and how each carry ended. Needs the extra ``parquet``.
"""

import json
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from palmbots._types import SIDES
from palmbots._util.atomic_files import whole_file
from palmbots._util.optional_imports import require
from palmbots.logs.channels import variables_of
from palmbots.simulation.result import Carry

RECORD = "palmbots"
"""Key of the table's metadata: a JSON object."""


def write_table(carries: Iterable[Carry], path: Path) -> None:
    """Write carries to one table; each is a row group, so that few are in memory at once.

    Raises:
        PalmbotsError: pyarrow is missing, or the file cannot be written.
    """
    arrow, parquet = require("pyarrow", "parquet"), require("pyarrow.parquet", "parquet")
    ends: list[dict[str, Any]] = []
    facts: dict[str, Any] = {"carries": ends}
    with whole_file(path) as stream, ExitStack() as closing:
        writer: Any = None
        for episode, carry in enumerate(carries):
            if writer is None:
                schema = _schema(arrow, carry)
                writer = closing.enter_context(parquet.ParquetWriter(stream, schema))
                facts |= {"version": carry.version, "controller": carry.controller}
                facts |= {"world": carry.world, "scene": carry.scene.to_toml()}
            columns = {name: values for name, values, _ in _columns(carry, episode)}
            writer.write_table(arrow.table(columns, schema=writer.schema))
            ends.append(
                {"episode": episode, "seed": carry.seed, "outcome": carry.outcome}
                | {"reason": carry.reason, "time_s": carry.time_s, "distance_m": carry.distance_m}
                | {"trace_hash": carry.trace_hash}
            )
        writer.add_key_value_metadata({RECORD: json.dumps(facts)})


def _columns(carry: Carry, episode: int) -> Iterator[tuple[str, Any, dict[str, str]]]:
    """Name, values and metadata of each column."""
    trace = carry.trace
    assert trace is not None
    count = trace.sizes["time"]
    yield "episode", np.full(count, episode), {"long_name": "number of the carry, from 0"}
    yield "seed", np.full(count, carry.seed, np.uint64), {"long_name": "random seed of the carry"}
    for one in variables_of(trace):
        values = trace[one.name].to_numpy()
        notes = {key: one.attrs[key] for key in ("units", "long_name") if key in one.attrs}
        name = one.field.replace("/", "_")
        if one.by_side:
            for k, side in enumerate(SIDES):
                yield f"{side}_{name}", values[:, k], notes
        else:
            yield name, values, notes


def _schema(arrow: Any, carry: Carry) -> Any:
    fields = [
        arrow.field(name, arrow.array(values[:1]).type, metadata=notes)
        for name, values, notes in _columns(carry, 0)
    ]
    return arrow.schema(fields)
