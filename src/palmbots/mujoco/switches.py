# SPDX-License-Identifier: Apache-2.0
"""The membrane switches of one palm in MuJoCo.

A switch closes where a contact force of at least `mujoco.switch_force_n` acts. It opens when there
was no such force for `mujoco.switch_debounce_s`. Debouncing is necessary, because MuJoCo's contacts
push sliding bodies apart: a body that slides at several cm/s hops by hundredths of a millimetre. A
palm that reported 0 at each hop would end corrections too early.
"""

from collections.abc import Iterable, Sequence

from palmbots.scene.mujoco_section import MujocoParameters

_ROUNDING_S = 1e-9


class Switches:
    """The switches of one palm."""

    def __init__(self, keys: MujocoParameters) -> None:
        """All switches are open."""
        self._threshold, self._debounce = keys.switch_force_n, keys.switch_debounce_s
        self._pressed_s = -float("inf")
        self.place = 0.0
        """Contact coordinate at which the palm is pressed, or was pressed last [m]."""
        self.closed = False

    def update(self, time_s: float, loads: Iterable[Sequence[float]]) -> None:
        """The loads at a time: forces [N] and their moments about the foot of the pivot [N m].

        Of several sufficient loads the last one determines `place`.
        """
        for force, moment in loads:
            if force > 0 and force >= self._threshold:
                self._pressed_s, self.place = time_s, moment / force
        self.closed = time_s - self._pressed_s <= self._debounce + _ROUNDING_S
