# SPDX-License-Identifier: Apache-2.0
"""A server to which Foxglove connects: raw messages out, and nothing in.

The server has no capabilities, so a viewer cannot publish, call or set anything.
"""

import re
from typing import Any, Self

from palmbots._util.arguments import show
from palmbots._util.optional_imports import require
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import why_not


def place_of(address: str, option: str = "--serve") -> tuple[str, int]:
    """Host and port of an address that was given with this option.

    Raises:
        PalmbotsError: it is no such address.
    """
    host, _, port = address.rpartition(":")
    if not host or not (port.isascii() and port.isdecimal()) or len(port) > 5 or int(port) > 65535:
        raise PalmbotsError(f"{option}: value is {show(address)}; allowed: HOST:PORT")
    return host, int(port)


class FoxgloveServer:
    """Channels by topic. All are to be announced before the address is made known: a viewer that
    connects while a channel is announced can miss it.

    Args:
        address: ``HOST:PORT``; port 0: any that is free.
        name: what viewers show.

    Raises:
        MissingExtra: foxglove-sdk is not installed.
        PalmbotsError: the address is wrong or in use.
    """

    def __init__(self, address: str, name: str) -> None:
        host, port = place_of(address)
        self._sdk = require("foxglove", "station")
        self._context = self._sdk.Context()
        try:
            self._server = self._sdk.start_server(
                name=name, host=host, port=port, capabilities=[], context=self._context
            )
        except Exception as error:  # the package raises errors of its own
            number = re.search(r"os error (\d+)", str(error))
            why = why_not(OSError(int(number[1]), str(error))) if number else error
            raise PalmbotsError(f"live view: cannot listen at {address}: {why}") from None
        self.address = f"{host}:{self._server.port}"
        self._channels: dict[str, Any] = {}

    def add(self, topic: str, message_encoding: str, schema: tuple[str, str, bytes]) -> None:
        """Announce a channel; `schema` is name, encoding and text."""
        if topic in self._channels:
            return
        name, encoding, data = schema
        self._channels[topic] = self._sdk.Channel(
            topic,
            message_encoding=message_encoding,
            schema=self._sdk.Schema(name=name, encoding=encoding, data=data),
            context=self._context,
        )

    def send(self, topic: str, data: bytes, time_ns: int) -> None:
        """Send a message of an announced channel to all viewers; never waits."""
        self._channels[topic].log(data, log_time=time_ns)

    def add_type(self, topic: str, kind: Any) -> None:
        """Announce a channel of messages of this protobuf type."""
        from mcap_protobuf.schema import build_file_descriptor_set

        described = build_file_descriptor_set(kind).SerializeToString()
        self.add(topic, "protobuf", (kind.DESCRIPTOR.full_name, "protobuf", described))

    def send_message(self, topic: str, message: Any, time_ns: int) -> None:
        """Send a protobuf message of an announced channel."""
        self.send(topic, message.SerializeToString(), time_ns)

    def close(self) -> None:
        """End all connections."""
        self._server.stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
