# SPDX-License-Identifier: Apache-2.0
"""Further contacts of the object in MuJoCo, besides its two contact vertices.

The quasistatic world derives them from the outline (docs/theory/contacts.md). Here they follow from
the contact forces: a further vertex of the object presses on a palm, or the end of a palm presses
on an edge. The contact is `flush` if that edge lies along the palm: it is one of the two edges at
the contact vertex, or it is parallel to the palm within the compliance of the contacts. Otherwise
it is the `tip` of the palm. Contacts are evaluated at the end of every tick. An interruption
shorter than `_BOUNCE_S` is ignored.
"""

import math
from dataclasses import dataclass
from typing import Any, Literal

from palmbots.mujoco.mjcf import Layout

Kind = Literal["flush", "tip"]
_PARALLEL = math.radians(0.5)  # contacts are compressed by about 0.3 mm over half a palm
_BOUNCE_S = 0.05


@dataclass(frozen=True)
class ExtraContact:
    """A possible contact of a palm and the object besides the contact vertex."""

    side: int
    along: tuple[float, float] | None
    """Direction of the edge at the end of the palm, x and z in the frame of the object; None: a
    further vertex is on the palm."""
    own: bool
    """Whether that edge begins or ends at the contact vertex of the palm."""
    on_heel: bool = False
    """Whether it is the heel of the palm that touches. No switch feels a heel."""

    def kind(self, palm: Any, obj: Any) -> Kind:
        """The kind, from the orientations of palm and object (nine numbers each)."""
        if self.along is None or self.own:
            return "flush"
        x, z = self.along
        out = sum(
            (x * float(obj[3 * i]) + z * float(obj[3 * i + 2])) * float(palm[3 * i + 2])
            for i in range(3)
        )
        return "flush" if abs(out) < math.sin(_PARALLEL) else "tip"


def extra_contact(side: int, name: str, layout: Layout) -> ExtraContact:
    """The contact of a palm with the shape of the object of this name (``vertex_2_near``,
    ``edge_0``)."""
    kind, number = name.split("_")[:2]
    if kind == "vertex":
        return ExtraContact(side, None, False)
    outline = layout.spec.outline
    start = int(number)
    end = (start + 1) % len(outline)
    (ax, _, az, _), (bx, _, bz, _) = outline[start], outline[end]
    length = math.hypot(bx - ax, bz - az)
    own = (0, layout.spec.contact_right)[side] in (start, end)
    return ExtraContact(side, ((bx - ax) / length, (bz - az) / length), own)


class ContactEventTracker:
    """Tracks the further contacts of one carry."""

    def __init__(self) -> None:
        self._closed: list[tuple[int, Kind, float, float]] = []
        self._open: tuple[int, Kind, float] | None = None
        self._last_s = 0.0

    def update(self, time_s: float, contacts: list[tuple[int, Kind]]) -> None:
        """The further contacts (palm, kind) that carry load at a time [s]."""
        if contacts:
            self._last_s = time_s
            if self._open is None:
                # The palm with more contacts counts; on it, flush has priority.
                sides = [side for side, _ in contacts]
                side = max(sorted(set(sides)), key=sides.count)
                kinds = {kind for at, kind in contacts if at == side}
                self._open = (side, "flush" if "flush" in kinds else "tip", time_s)
        elif self._open is not None and time_s - self._last_s > _BOUNCE_S:
            self._closed.append((*self._open, self._last_s))
            self._open = None

    def rows(self, until_s: float) -> list[tuple[int, Kind, float, float]]:
        """Palm, kind, start and end [s] of each; one that is still open ends when last seen."""
        rows = list(self._closed)
        if self._open is not None:
            rows.append((*self._open, self._last_s))
        return [
            (side, kind, min(start, until_s), min(end, until_s)) for side, kind, start, end in rows
        ]
