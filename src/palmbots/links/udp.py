# SPDX-License-Identifier: Apache-2.0
"""The link over UDP."""

import contextlib
import ipaddress
import socket
from collections.abc import Mapping

from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import why_not
from palmbots.wire import Role

_MOST_AT_ONCE = 256  # packets; a flood must not hold up the control loop
_LARGEST = 2048  # bytes; a packet that is too long is rejected by the decoder, not cut


class UdpLink:
    """One UDP datagram for each packet.

    Args:
        role: this end.
        addresses: ``HOST:PORT`` of each end.

    Raises:
        PalmbotsError: an address is wrong, or is used by another program.
    """

    def __init__(self, role: Role, addresses: Mapping[Role, str]) -> None:
        self._places = {end: _place(end, address) for end, address in addresses.items()}
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind(self._places[role])
        except OSError as error:
            self._socket.close()
            why = why_not(error)
            raise PalmbotsError(f"link.{role}: cannot use {addresses[role]}: {why}") from None

    def send(self, receiver: Role, data: bytes) -> None:
        """Send a packet. One that the network does not take is lost."""
        with contextlib.suppress(OSError):
            self._socket.sendto(data, self._places[receiver])

    def receive(self) -> list[bytes]:
        """The packets that have arrived. After a flood the rest waits for the next call."""
        arrived = []
        for _ in range(_MOST_AT_ONCE):
            try:
                arrived.append(self._socket.recv(_LARGEST))
            except BlockingIOError:
                break
            except OSError:  # a receiver of an earlier packet is gone
                continue
        return arrived

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


def _place(end: Role, address: str) -> tuple[str, int]:
    """The number of an address: to look up a name takes time, which a control loop has not."""
    host, _, port = address.rpartition(":")
    is_port = port.isascii() and port.isdecimal() and len(port) <= 5 and 0 < int(port) < 65536
    if not host or not is_port:
        raise PalmbotsError(
            f"link.{end}: address is {show(address)}; allowed: HOST:PORT, such as 192.168.1.12:7411"
        )
    try:
        found = socket.getaddrinfo(host, int(port), socket.AF_INET, socket.SOCK_DGRAM)
    except (OSError, ValueError) as error:  # ValueError: no name at all
        why = getattr(error, "strerror", None) or error
        raise PalmbotsError(f"link.{end}: cannot use {address}: {why}") from None
    number, place = found[0][4][:2]
    if number == "255.255.255.255" or ipaddress.ip_address(number).is_multicast:
        raise PalmbotsError(
            f"link.{end}: address is {show(address)}, which many computers receive; allowed: that "
            "of one computer"
        )
    return str(number), int(place)
