# SPDX-License-Identifier: Apache-2.0
"""Types of protobuf messages, made at run time from a list of fields.

A robot's program makes its types here, so this module imports nothing that it does not need.
"""

from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

FIELD = descriptor_pb2.FieldDescriptorProto
"""Has the constants of the types of fields, such as ``FIELD.TYPE_DOUBLE``."""


def message_type(name: str, fields: dict[str, Any], repeated: tuple[str, ...] = ()) -> Any:
    """A protobuf message type with these fields, made at run time."""
    file = descriptor_pb2.FileDescriptorProto(
        name=f"palmbots/{name}.proto", package="palmbots", syntax="proto3"
    )
    message = file.message_type.add(name=name)
    for number, (field, kind) in enumerate(fields.items(), start=1):
        label = FIELD.LABEL_REPEATED if field in repeated else FIELD.LABEL_OPTIONAL
        message.field.add(name=field, number=number, type=kind, label=label)
    pool = descriptor_pool.DescriptorPool()  # its own, so that no name clashes with other packages
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(f"palmbots.{name}"))
