# SPDX-License-Identifier: Apache-2.0
"""Types of protobuf messages, made at run time from a list of fields.

A robot's program makes its types here, so this module imports nothing that it does not need.
"""

from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

# Their classes are made at run time, or compiled.
_CLASSES: Any = descriptor_pb2
_POOLS: Any = descriptor_pool
FIELD = _CLASSES.FieldDescriptorProto
"""Has the constants of the types of fields, such as ``FIELD.TYPE_DOUBLE``."""


def message_type(name: str, fields: dict[str, Any], repeated: tuple[str, ...] = ()) -> Any:
    """A protobuf message type with these fields, made at run time."""
    file = _CLASSES.FileDescriptorProto(
        name=f"palmbots/{name}.proto", package="palmbots", syntax="proto3"
    )
    message = file.message_type.add(name=name)
    for number, (field, kind) in enumerate(fields.items(), start=1):
        label = FIELD.LABEL_REPEATED if field in repeated else FIELD.LABEL_OPTIONAL
        message.field.add(name=field, number=number, type=kind, label=label)
    # A pool of its own, so that no name clashes with other packages.
    pool = _POOLS.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(f"palmbots.{name}"))
