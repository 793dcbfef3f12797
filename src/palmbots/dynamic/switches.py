"""The membrane switches of one palm as dynamics has them.

A switch closes where contact force presses with at least `dynamic.press_n`, and opens once nothing
has for `dynamic.debounce_s`. Drivers of switches debounce, and here it matters: MuJoCo's contacts
push sliding bodies apart, so that one that slides by several cm/s hops by hundredths of a
millimetre. A palm that read 0 at each hop would end corrections that are not done.
"""

from collections.abc import Iterable, Sequence

from palmbots.bodies import Dynamic

__all__ = ["Switches"]

_ROUNDING_S = 1e-9


class Switches:
    """Where one palm is pressed, and whether a switch there is closed."""

    def __init__(self, keys: Dynamic) -> None:
        """All open."""
        self._least, self._debounce = keys.press_n, keys.debounce_s
        self._pressed_s = -float("inf")
        self.place = 0.0
        """p of where it is pressed, or was last [m]."""
        self.closed = False

    def feel(self, time_s: float, loads: Iterable[Sequence[float]]) -> None:
        """What presses at a time: forces [N] and their moments about the pivot's foot [N m], the
        one that counts most last."""
        for force, moment in loads:
            if force > 0 and force >= self._least:
                self._pressed_s, self.place = time_s, moment / force
        self.closed = time_s - self._pressed_s <= self._debounce + _ROUNDING_S
