# SPDX-License-Identifier: Apache-2.0
"""Channels, fields and metadata of logs, from a log and from the types that write it."""

import tempfile
from pathlib import Path
from typing import Any

from google.protobuf.descriptor import FieldDescriptor
from mcap.reader import make_reader

import palmbots as pb
from palmbots.logs.channels import CorrectionEvent, MessageEvent, state_channels, variables_of
from palmbots.logs.run_channels import LineEvent, PacketEvent, RobotTick, StatusEvent
from palmbots.mujoco.trace_columns import COLUMNS

_TYPES = {
    FieldDescriptor.TYPE_DOUBLE: "double",
    FieldDescriptor.TYPE_SINT64: "sint64",
    FieldDescriptor.TYPE_UINT64: "uint64",
    FieldDescriptor.TYPE_STRING: "string",
    FieldDescriptor.TYPE_BOOL: "bool",
    FieldDescriptor.TYPE_BYTES: "bytes",
}


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    carry = pb.carry("paper", overrides={"task.distance_m": 0.2})
    return {
        "channels": _channels(carry),
        "states": _states(carry),
        "events": _fields({"/messages": MessageEvent, "/corrections": CorrectionEvent}),
        "runs": _fields(
            {
                "/left/ticks": RobotTick,
                "/station/sent": PacketEvent,
                "/station/received": StatusEvent,
                "/station/lines": LineEvent,
            }
        ),
    }


def _table(*rows: tuple[str, ...]) -> str:
    lines = [f"| {' | '.join(row)} |" for row in rows]
    lines.insert(1, f"|{'---|' * len(rows[0])}")
    return "\n".join(lines)


def _channels(carry: pb.simulation.Carry) -> str:
    """The channels of a log with their schemas, and the keys of its metadata record."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "carry.mcap"
        pb.write_log(carry, path)
        with path.open("rb") as stream:
            reader = make_reader(stream)
            summary = reader.get_summary()
            assert summary is not None
            (record,) = reader.iter_metadata()
    rows = [
        (f"`{channel.topic}`", f"`{summary.schemas[channel.schema_id].name}`",
         channel.message_encoding)
        for channel in sorted(summary.channels.values(), key=lambda channel: channel.topic)
    ]  # fmt: skip
    keys = ", ".join(f"`{key}`" for key in record.metadata)
    format_ = record.metadata["format"]
    text = (
        f"The metadata record `{record.name}` has format {format_}. All of its values are texts; "
        f"lists and tables are JSON. Its keys: {keys}."
    )
    return f"{_table(('channel', 'schema', 'encoding'), *rows)}\n\n{text}"


def _states(carry: pb.simulation.Carry) -> str:
    assert carry.trace is not None
    rows = [("channels", "field", "type", "unit", "meaning", "in the trace")]
    for channel in state_channels(variables_of(carry.trace)):
        topics = ", ".join(f"`{topic}`" for topic in channel.topics)
        types = dict(zip((v.name for v in channel.variables), _types(channel.message({})),
                         strict=True))  # fmt: skip
        rows += [
            (topics, f"`{v.field}`", types[v.name], v.attrs["units"], v.attrs["long_name"],
             f"`{v.name}`")
            for v in channel.variables
        ]  # fmt: skip
    for name, attrs in COLUMNS.items():
        group, _, field = attrs["log_field"].rpartition("/")
        if group:
            topics = f"`/left/{group}`, `/right/{group}`"
            rows.append((topics, f"`{field}`", "double", attrs["units"], attrs["long_name"],
                         f"`{name}`"))  # fmt: skip
    return _table(*rows)


def _types(message: Any) -> list[str]:
    """The types of the fields of a message, in their order."""
    return [
        ("repeated " if field.is_repeated else "") + _TYPES[field.type]
        for field in message.DESCRIPTOR.fields
    ]


def _fields(messages: dict[str, Any]) -> str:
    rows = [("channel", "schema", "fields")]
    for topic, kind in messages.items():
        names = [field.name for field in kind.DESCRIPTOR.fields]
        fields = ", ".join(
            f"`{name}` ({what})" for name, what in zip(names, _types(kind), strict=True)
        )
        rows.append((f"`{topic}`", f"`{kind.DESCRIPTOR.full_name}`", fields))
    return _table(*rows)
