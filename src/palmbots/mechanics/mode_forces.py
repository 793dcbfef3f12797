# SPDX-License-Identifier: Apache-2.0
"""Forces and margin of a contact mode, with any number of contacts.

Forces are in units of the weight. The core computes both (`mechanics/mode_forces.hpp`). Source:
docs/theory/contacts.md.
"""

from __future__ import annotations

from dataclasses import dataclass

from palmbots._types import MaybeNaN

Range = tuple[MaybeNaN, MaybeNaN]
Support = tuple[int, float, float, float, float, float]
"""Side of the tangent (0: as on the left palm), point from the COM [m], normal into the object,
friction coefficient."""


@dataclass(frozen=True, slots=True)
class ContactForce:
    """The force of one contact on the object in one contact mode, in units of the weight.

    Both components are ranges (least, greatest), because several forces may balance the weight. An
    end is infinite where the contacts can press against each other without limit.
    """

    normal: Range
    friction: Range
    """Along the surface, positive to the left for someone who stands on it."""


@dataclass(frozen=True, slots=True)
class ConsistentMode:
    """A contact mode that is kinematically possible and in balance. Lists are in the order of the
    contacts."""

    motions: tuple[str, ...]
    """ST, SL, SR or BR for each contact."""
    forces: tuple[ContactForce, ...]
    margin_deg: MaybeNaN
    """The mode stays consistent as long as the friction angle of each surface changes by less than
    this, each in its own direction; infinite: no change ends it."""
    at_limit: tuple[str, ...] | None
    """What the forces permit at the end of the margin: a contact that is SL or SR there, but not in
    `motions`, is at the edge of its friction cone, and one that is BR carries nothing. The
    inequality that decides is the one for this contact. None: the margin is infinite."""
