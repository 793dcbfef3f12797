# SPDX-License-Identifier: Apache-2.0
"""Statics of one state, or of arrays of states.

`palmbots` exports the functions; this room exports the types of their results.
"""

from palmbots.mechanics.contact_points import Contact as Contact
from palmbots.mechanics.mode_analysis import CONTACT_MODES as CONTACT_MODES
from palmbots.mechanics.mode_analysis import ContactModes as ContactModes
from palmbots.mechanics.mode_analysis import ContactModesBatch as ContactModesBatch

__all__ = [
    "CONTACT_MODES",
    "Contact",
    "ContactModes",
    "ContactModesBatch",
]


def __dir__() -> list[str]:
    return sorted(__all__)
