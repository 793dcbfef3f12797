# SPDX-License-Identifier: Apache-2.0
"""The JSON Schema of the records of logs (draft 2020-12), made from the types that write them.

A record is one message, as a table with ``topic`` and ``message``. The message is in the JSON form
of protobuf with the names of the fields as they are: 64-bit whole numbers are text, bytes are
Base64, and a number that is not finite is "NaN", "Infinity" or "-Infinity".
"""

from collections.abc import Mapping
from typing import Any

from google.protobuf.descriptor import Descriptor, FieldDescriptor

from palmbots.logs.channels import CorrectionEvent, MessageEvent, channels_of_worlds
from palmbots.logs.run_channels import LineEvent, PacketEvent, RobotTick, StatusEvent

_NUMBER = {"anyOf": [{"type": "number"}, {"enum": ["NaN", "Infinity", "-Infinity"]}]}
_LONG = {"type": "string", "pattern": "^-?[0-9]+$"}
_F = FieldDescriptor
_KINDS: dict[int, dict[str, Any]] = {
    _F.TYPE_DOUBLE: _NUMBER,
    _F.TYPE_FLOAT: _NUMBER,
    _F.TYPE_BOOL: {"type": "boolean"},
    _F.TYPE_STRING: {"type": "string"},
    _F.TYPE_BYTES: {"type": "string", "contentEncoding": "base64"},
}
_OF_64_BITS = (
    _F.TYPE_INT64, _F.TYPE_UINT64, _F.TYPE_SINT64, _F.TYPE_FIXED64, _F.TYPE_SFIXED64,
)  # fmt: skip
_OF_32_BITS = (
    _F.TYPE_INT32, _F.TYPE_UINT32, _F.TYPE_SINT32, _F.TYPE_FIXED32, _F.TYPE_SFIXED32,
)  # fmt: skip
_KINDS |= dict.fromkeys(_OF_64_BITS, _LONG)
_KINDS |= {kind: {"type": "integer"} for kind in _OF_32_BITS}
_AS_TEXT = ("google.protobuf.Timestamp", "google.protobuf.Duration")


def log_schema(more: Mapping[str, Mapping[str, str]] | None = None) -> dict[str, Any]:
    """The schema of one record of a carry log, or of the log of a robot or station.

    Args:
        more: attributes of the variables that worlds add to the trace, by name.
    """
    from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    kinds: dict[str, Any] = {
        "/messages": MessageEvent,
        "/corrections": CorrectionEvent,
        "/tf": FrameTransforms,
        "/solids": SceneUpdate,
        "/contacts": SceneUpdate,
        "/left/ticks": RobotTick,
        "/right/ticks": RobotTick,
        "/station/sent": PacketEvent,
        "/station/received": StatusEvent,
        "/station/lines": LineEvent,
    }
    definitions: dict[str, Any] = {}
    records = [
        _record(topic, _table(kind.DESCRIPTOR, definitions)) for topic, kind in kinds.items()
    ]
    for channel in channels_of_worlds(more):
        state = _table(channel.descriptor, definitions)
        records += [_record(topic, state) for topic in channel.topics]
    records.append(_record("/robot_description", {"type": "string"}))
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Record of a log of palmbots",
        "oneOf": records,
        "$defs": definitions,
    }


def _record(topic: str, message: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {"topic": {"const": topic}, "message": message},
        "required": ["topic", "message"],
        "additionalProperties": False,
    }


def _table(kind: Descriptor, definitions: dict[str, Any]) -> dict[str, Any]:
    """A reference to the schema of a message type, which is added to the definitions."""
    if kind.full_name in _AS_TEXT:
        return {"type": "string"}
    name = kind.full_name
    if name not in definitions:
        definitions[name] = {}  # so that a type that contains itself ends
        definitions[name] = {
            "type": "object",
            "properties": {field.name: _field(field, definitions) for field in kind.fields},
            "additionalProperties": False,
        }
    return {"$ref": f"#/$defs/{name}"}


def _field(field: FieldDescriptor, definitions: dict[str, Any]) -> dict[str, Any]:
    if field.message_type is not None:
        schema = _table(field.message_type, definitions)
    elif field.enum_type is not None:
        schema = {"enum": [value.name for value in field.enum_type.values]}
    else:
        schema = _KINDS[field.type]
    return {"type": "array", "items": schema} if field.is_repeated else schema
