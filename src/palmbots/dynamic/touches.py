"""When the object in MuJoCo rests on more, or on something else, than its two contact vertices.

What the quasistatic world finds in the outline (docs/contacts.md) is here what contact forces say:
a ball on a further edge of the object presses on a palm, or one at a palm's end on an edge. It is
`flush` where that edge lies along the palm: it is one of the two that meet in the palm's contact
vertex, which stands on the palm until something else takes its load, or it is parallel to the palm
but for what soft contacts give way. Else it is the palm's `tip`. Looked at once a tick, at its end.
What breaks for less than `_BOUNCE_S` only bounces.
"""

import math
from dataclasses import dataclass
from typing import Any, Literal

from palmbots.dynamic.model import Layout

__all__ = ["Further", "Kind", "Rests", "further_of"]

Kind = Literal["flush", "tip"]
_PARALLEL = math.radians(0.5)  # palms and object give way by some 0.3 mm over half a palm
_BOUNCE_S = 0.05


@dataclass(frozen=True)
class Further:
    """One way in which palm and object may touch besides by the contact vertex."""

    side: int
    along: tuple[float, float] | None
    """Direction of the edge that meets the palm's end, x and z in the object's frame; None where
    a further vertex stands on the palm."""
    own: bool
    """Whether that edge begins or ends at the palm's contact vertex."""

    def kind(self, palm: Any, thing: Any) -> Kind:
        """As seen with the orientations of palm and object (nine numbers each)."""
        if self.along is None or self.own:
            return "flush"
        x, z = self.along
        out = sum(
            (x * float(thing[3 * i]) + z * float(thing[3 * i + 2])) * float(palm[3 * i + 2])
            for i in range(3)
        )
        return "flush" if abs(out) < math.sin(_PARALLEL) else "tip"


def further_of(side: int, name: str, layout: Layout) -> Further:
    """What the object's shape of that name (``vertex_2_near``, ``edge_0``) is to a palm."""
    kind, number = name.split("_")[:2]
    if kind == "vertex":
        return Further(side, None, False)
    outline = layout.spec.outline
    start = int(number)
    end = (start + 1) % len(outline)
    (ax, _, az), (bx, _, bz) = outline[start], outline[end]
    long = math.hypot(bx - ax, bz - az)
    own = (0, layout.spec.contact_right)[side] in (start, end)
    return Further(side, ((bx - ax) / long, (bz - az) / long), own)


class Rests:
    """Keeps the times of one carry."""

    def __init__(self) -> None:
        self._done: list[tuple[int, Kind, float, float]] = []
        self._open: tuple[int, Kind, float] | None = None
        self._last_s = 0.0

    def see(self, time_s: float, found: list[tuple[int, Kind]]) -> None:
        """What further contacts press at a time [s]."""
        if found:
            self._last_s = time_s
            if self._open is None:
                # The palm with more of them counts, and on it what is flush.
                sides = [side for side, _ in found]
                side = max(sorted(set(sides)), key=sides.count)
                kinds = {kind for at, kind in found if at == side}
                self._open = (side, "flush" if "flush" in kinds else "tip", time_s)
        elif self._open is not None and time_s - self._last_s > _BOUNCE_S:
            self._done.append((*self._open, self._last_s))
            self._open = None

    def rows(self, until_s: float) -> list[tuple[int, Kind, float, float]]:
        """Side, kind, start and end of each [s]; what still lasts ends where it was seen last."""
        rows = list(self._done)
        if self._open is not None:
            rows.append((*self._open, self._last_s))
        return [
            (side, kind, min(start, until_s), min(end, until_s)) for side, kind, start, end in rows
        ]
