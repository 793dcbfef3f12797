# SPDX-License-Identifier: Apache-2.0
"""Statics of one state, or of arrays of states.

`palmbots` exports the functions; this room exports the types of their results.
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.mechanics.consistent_modes import ConsistentModes as ConsistentModes
    from palmbots.mechanics.consistent_modes import SurfaceContact as SurfaceContact
    from palmbots.mechanics.contact_modes import CONTACT_MODES as CONTACT_MODES
    from palmbots.mechanics.contact_modes import ContactModes as ContactModes
    from palmbots.mechanics.contact_modes import ContactModesBatch as ContactModesBatch
    from palmbots.mechanics.contact_points import Contact as Contact
    from palmbots.mechanics.load_limits import LoadLimit as LoadLimit
    from palmbots.mechanics.load_limits import LoadLimits as LoadLimits
    from palmbots.mechanics.mode_forces import ConsistentMode as ConsistentMode
    from palmbots.mechanics.mode_forces import ContactForce as ContactForce
else:
    __getattr__, __dir__ = lazy_names(__name__)
