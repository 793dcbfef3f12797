# SPDX-License-Identifier: Apache-2.0
"""Statics of one state, or of arrays of states.

`palmbots` exports the functions; this room exports the types of their results.
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.mechanics.contact_points import Contact as Contact
    from palmbots.mechanics.mode_analysis import CONTACT_MODES as CONTACT_MODES
    from palmbots.mechanics.mode_analysis import ContactModes as ContactModes
    from palmbots.mechanics.mode_analysis import ContactModesBatch as ContactModesBatch
else:
    __getattr__, __dir__ = lazy_names(__name__)
