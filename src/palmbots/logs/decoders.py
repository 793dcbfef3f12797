# SPDX-License-Identifier: Apache-2.0
"""Decoders for the package mcap, with which it reads every channel of a carry log.

All channels are protobuf, except ``/robot_description``: Rerun reads a robot description only as a
ROS 2 string, which the protobuf decoder of mcap does not read.
"""

import struct
from collections.abc import Callable
from typing import Any

from mcap.decoder import DecoderFactory
from mcap.records import Schema
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoderFactory

_STRING = "std_msgs/msg/String"


class RosStringDecoderFactory(DecoderFactory):
    """Decodes ROS 2 strings (``std_msgs/msg/String``, CDR little-endian) as Python strings."""

    def decoder_for(
        self, message_encoding: str, schema: Schema | None
    ) -> Callable[[bytes], Any] | None:
        """The decoder of a channel; None for channels of another type."""
        if message_encoding != "cdr" or schema is None or schema.name != _STRING:
            return None
        return _ros_string


def decoder_factories() -> list[DecoderFactory]:
    """The decoder factories for ``mcap.reader.make_reader``.

    >>> with open("carry.mcap", "rb") as stream:  # doctest: +SKIP
    ...     reader = make_reader(stream, decoder_factories=decoder_factories())
    ...     for _, channel, _, message in reader.iter_decoded_messages():
    ...         print(channel.topic, message)
    """
    return [ProtobufDecoderFactory(), RosStringDecoderFactory()]


def _ros_string(data: bytes) -> str:
    (length,) = struct.unpack_from("<I", data, 4)  # after the header; counts the closing zero
    return data[8 : 7 + length].decode()
