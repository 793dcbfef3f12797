# SPDX-License-Identifier: Apache-2.0
"""A link of your own: packets over Zenoh (https://zenoh.io), from peer to peer.

Install it on the robots and the station, pip install ./examples/zenoh_link; then in pair.toml:

[link]
kind = "zenoh"
left = "tcp/192.168.1.11:7447"
right = "tcp/192.168.1.12:7447"
station = "tcp/192.168.1.10:7447"
"""

import json
from collections import deque

import zenoh

from palmbots.errors import PalmbotsError
from palmbots.links.link import LinkSettings
from palmbots.wire import Role


class ZenohLink:
    """Each end listens at its own address, and connects to those of the others."""

    def __init__(self, settings: LinkSettings) -> None:
        own, listens = settings.role, settings.addresses[settings.role]
        others = [address for end, address in settings.addresses.items() if end != own]
        config = zenoh.Config()
        for key, value in {
            "mode": "peer",
            "scouting/multicast/enabled": False,
            "listen/endpoints": [listens],
            "connect/endpoints": others,
        }.items():
            config.insert_json5(key, json.dumps(value))
        self._arrived: deque[bytes] = deque(maxlen=256)  # Zenoh fills it in a thread of its own
        try:
            self._session = zenoh.open(config)
        except zenoh.ZError as error:
            raise PalmbotsError(f"link.{own}: cannot use {listens}: {error}") from None
        self._topic = f"palmbots/{settings.pair}"
        self._session.declare_subscriber(
            f"{self._topic}/{own}", lambda sample: self._arrived.append(sample.payload.to_bytes())
        )

    def send(self, receiver: Role, data: bytes) -> None:
        """Send a packet at once; Zenoh drops it if the network is busy."""
        drop = zenoh.CongestionControl.DROP
        self._session.put(f"{self._topic}/{receiver}", data, congestion_control=drop, express=True)

    def receive(self) -> list[bytes]:
        """The packets that have arrived."""
        return [self._arrived.popleft() for _ in range(len(self._arrived))]

    def close(self) -> None:
        """Leave the network."""
        self._session.close()
