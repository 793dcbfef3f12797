# SPDX-License-Identifier: Apache-2.0
"""The kinds of links, and opening one.

Other distributions add kinds under the entry point group ``palmbots.links``: a class, or a
function, that takes `LinkSettings` and returns a `Link` (docs/guide/drivers.md).
"""

from typing import cast

from palmbots._util.entry_points import built_in_or_installed
from palmbots.links.link import Link, LinkMaker, LinkSettings
from palmbots.links.serial_link import SerialLink
from palmbots.links.udp import UdpLink

LINK_GROUP = "palmbots.links"
"""Group of the entry points."""
LINKS: dict[str, LinkMaker] = {
    "udp": lambda settings: UdpLink(settings.role, settings.addresses),
    "serial": SerialLink,
}
"""The kinds of this package."""


def open_link(kind: str, settings: LinkSettings) -> Link:
    """Open the link of one end.

    Raises:
        PalmbotsError: there is no such kind, or its address is wrong or cannot be used.
    """
    make = cast(LinkMaker, built_in_or_installed("link.kind", kind, LINKS, LINK_GROUP))
    return make(settings)
