# SPDX-License-Identifier: Apache-2.0
"""The kinds of links, and opening one.

Other distributions add kinds under the entry point group ``palmbots.links``: a class, or a
function, that takes `LinkSettings` and returns a `Link` (docs/guide/drivers.md).
"""

from palmbots._util.named_registry import Registry
from palmbots.links.link import Link, LinkMaker, LinkSettings
from palmbots.links.serial_link import SerialLink
from palmbots.links.udp import UdpLink

_LINKS: Registry[LinkMaker] = Registry(
    "link.kind",
    {"udp": lambda settings: UdpLink(settings.role, settings.addresses), "serial": SerialLink},
    "palmbots.links",
)


def open_link(kind: str, settings: LinkSettings) -> Link:
    """Open the link of one end.

    Raises:
        PalmbotsError: there is no such kind, or its address is wrong or cannot be used.
    """
    return _LINKS.get(kind)(settings)
