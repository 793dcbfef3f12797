# SPDX-License-Identifier: Apache-2.0
"""The link through a serial line: a radio bridge, or a modem that passes bytes on.

Each end opens the device of its own address. The bridge sends to everybody in range; an end drops
what is for others.
"""

from typing import Any

from palmbots.links.link import LinkSettings
from palmbots.links.serial_line import SerialLine
from palmbots.wire import Role
from palmbots.wire.serial_frames import FRAME_NUMBERS, BridgeReport, content_of, encode_frame

_PACKET = FRAME_NUMBERS["packet"]


class SerialLink:
    """One frame for each packet.

    Raises:
        PalmbotsError: the device of this end cannot be opened.
    """

    def __init__(self, settings: LinkSettings) -> None:
        key, device = f"link.{settings.role}", settings.addresses[settings.role]
        self._line = SerialLine(key, device, settings.baud, settings.on_line)
        self._report: BridgeReport | None = None
        self._unknown = 0

    def send(self, receiver: Role, data: bytes) -> None:
        """Send a packet. One that the line does not take is lost."""
        self._line.send(encode_frame("packet", data))

    def receive(self) -> list[bytes]:
        """The packets that have arrived."""
        packets = []
        for kind, content in self._line.receive():
            if kind == _PACKET:
                packets.append(content)
            elif isinstance(report := content_of(kind, content), BridgeReport):
                self._report = report
            else:
                self._unknown += 1
        return packets

    @property
    def details(self) -> dict[str, Any]:
        """What the line, and the bridge at its end, have lost."""
        return {
            "open": self._line.is_open,
            "times_opened": self._line.times_opened,
            "dropped": self._line.dropped,
            "damaged": self._line.damaged,
            "unknown": self._unknown,
            "bridge": self._report,
        }

    def close(self) -> None:
        """Close the device."""
        self._line.close()
