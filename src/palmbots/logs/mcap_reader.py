# SPDX-License-Identifier: Apache-2.0
"""Reads carry logs (`mcap_writer` writes them).

The checksums of the file are verified first: a log that is truncated or changed is refused in one
line.
"""

import io
import json
import math
import os
import struct
import zlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from mcap.records import Channel, Metadata
from mcap.records import Message as McapMessage
from mcap.stream_reader import CRCValidationError, StreamReader
from pydantic import TypeAdapter

from palmbots._types import SIDES
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.result_schema import annotation_of
from palmbots._util.user_paths import user_path
from palmbots._version import __version__
from palmbots.errors import PalmbotsError
from palmbots.logs.channels import CorrectionEvent, MessageEvent, Variable, state_channels
from palmbots.logs.mcap_writer import FORMAT, JSON_FACTS, RECORD, TEXT_FACTS
from palmbots.logs.run_log_reader import is_run_log
from palmbots.scene.file_kinds import LOG, refuse_other_kind
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.result import Carry, Correction, Message
from palmbots.simulation.trace import with_pose

if TYPE_CHECKING:
    import xarray as xr

_MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _DATA_END = struct.Struct("<BQQQI"), struct.Struct("<BQI")


@dataclass(frozen=True, repr=False, kw_only=True)
class Log(Carry):
    """A carry that was read from a log."""

    trace: "xr.Dataset" = field(metadata=NOT_IN_JSON)  # a log always has one
    format: str
    """Version of the format of the log."""


def read_log(path: str | os.PathLike[str]) -> Log:
    """Read a carry log.

    Raises:
        PalmbotsError: the file cannot be read, is no carry log of this format, or is damaged.
    """
    refuse_other_kind(path, LOG)
    if is_run_log(path):
        raise PalmbotsError(
            f"{path}: is the log of one program of a pair; allowed: the log of a carry; commands "
            f"take the folder with the logs of all programs, {user_path(path).parent}"
        )
    try:
        with open(user_path(path), "rb") as stream:
            data = stream.read(len(_MAGIC))
            if data == _MAGIC:  # otherwise it is no log, and may be endless
                data += stream.read()
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = (isinstance(error, OSError) and error.strerror) or error
        raise PalmbotsError(f"{path}: cannot be read: {reason}") from None
    damage = _damage(data)
    if damage is not None:
        raise PalmbotsError(f"{path}: {damage}")
    try:
        return _parse(data)
    except PalmbotsError as error:
        raise PalmbotsError(f"{path}: {error}") from None
    except CRCValidationError:
        raise PalmbotsError(
            f"{path}: the log is damaged: a checksum of its data is wrong"
        ) from None
    except Exception:
        # The checksums show only that the file is complete, not which program wrote it. The parsers
        # may raise anything on a foreign file; for the user all of that is one error.
        raise PalmbotsError(
            f"{path}: not a carry log of palmbots: its records are incomplete or malformed"
        ) from None


def _damage(data: bytes) -> str | None:
    """What is wrong with the file as an MCAP file; None if its frame and checksums are right.

    A checksum of 0 means "not available" in MCAP: such a part of the file cannot be verified.
    """
    if data[: len(_MAGIC)] != _MAGIC:
        return f"is no log; allowed: {LOG.in_words}" if data else "the file is empty"
    end = len(data) - len(_MAGIC)
    footer_at = end - _FOOTER.size
    if data[end:] != _MAGIC or footer_at < len(_MAGIC) + _DATA_END.size:
        return "the log is cut short or damaged at its end"
    opcode, size, summary_at, _, summary_crc = _FOOTER.unpack_from(data, footer_at)
    summary_at = summary_at or footer_at  # 0: the file has no summary
    data_end_at = summary_at - _DATA_END.size
    if (opcode, size) != (0x02, 20) or not len(_MAGIC) <= data_end_at < footer_at:
        return "the log is damaged at its end, or was not written by palmbots"
    if summary_crc not in (0, zlib.crc32(data[summary_at : end - 4])):
        return "the log is damaged: the checksum of its summary is wrong"
    opcode, size, data_crc = _DATA_END.unpack_from(data, data_end_at)
    if (opcode, size) != (0x0F, 4):
        return "the log is damaged at its end, or was not written by palmbots"
    if data_crc not in (0, zlib.crc32(data[:data_end_at])):
        return "the log is damaged: the checksum of its data is wrong"
    return None


def _parse(data: bytes) -> Log:
    facts: dict[str, str] | None = None
    topics: dict[int, str] = {}
    messages: dict[str, list[bytes]] = {}
    for record in StreamReader(io.BytesIO(data), validate_crcs=True).records:
        if isinstance(record, McapMessage):
            messages.setdefault(topics[record.channel_id], []).append(record.data)
        elif isinstance(record, Channel):
            topics[record.id] = record.topic
        elif isinstance(record, Metadata) and record.name == RECORD:
            facts = record.metadata
    if facts is None:
        raise PalmbotsError("not a carry log of palmbots: it has no metadata record of that name")
    if facts["format"] != FORMAT:
        raise PalmbotsError(
            f"a carry log of format {facts['format']}, written by palmbots "
            f"{facts.get('version', '(unknown)')}; palmbots {__version__} reads format {FORMAT}"
        )
    return _assemble(facts, messages)


def _assemble(facts: dict[str, str], messages: dict[str, list[bytes]]) -> Log:
    fields: dict[str, Any] = {name: facts[name] for name in TEXT_FACTS}
    for name in JSON_FACTS:
        if name in facts:  # a log of an earlier version lacks some
            of_type = TypeAdapter(annotation_of(Carry, name))
            fields[name] = of_type.validate_python(json.loads(facts[name]))
    corrections = [CorrectionEvent.FromString(m) for m in messages.get("/corrections", [])]
    fields["corrections"] = tuple(
        Correction(c.label, c.robot, c.case, c.assistant or None, c.start_s, c.end_s)
        for c in corrections
    )
    sent = [MessageEvent.FromString(m) for m in messages.get("/messages", [])]
    fields["message_log"] = tuple(
        Message(
            m.sent_s,
            None if math.isnan(m.received_s) else m.received_s,
            m.sender,
            m.receiver,
            m.kind,
        )
        for m in sent
    )
    scene = load_scene(json.loads(facts["scene"]))
    return Log(
        scene=scene,
        trace=with_pose(_trace(facts, messages), to_spec(scene, unrolled=True)),
        format=facts["format"],
        **fields,
    )


def _trace(facts: dict[str, str], messages: dict[str, list[bytes]]) -> Any:
    """The trace, an `xarray.Dataset` with the variables in the order that the log states."""
    import xarray as xr  # here: it takes longer to import than a carry takes to run

    samples = json.loads(facts["samples"])
    variables = [Variable(**variable) for variable in json.loads(facts["variables"])]
    columns = {}
    for channel in state_channels(variables):
        counts = {topic: len(messages.get(topic, [])) for topic in channel.topics}
        if set(counts.values()) != {samples}:
            raise PalmbotsError(f"samples are missing: the log has {counts} of {samples}")
        columns |= channel.columns(messages)
    labelled = {
        v.name: (("time", "side") if v.by_side else ("time",), columns[v.name], v.attrs)
        for v in variables
    }
    time = labelled.pop("time")
    return xr.Dataset(labelled, coords={"time": time, "side": list(SIDES)})
