# SPDX-License-Identifier: Apache-2.0
"""The counts that a robot reports to the station, one with each status (docs/reference/wire.md)."""

from palmbots.wire import Status

_MODULUS = 65536
_OF_NOW = ("progress", "battery", "overruns")  # no counts


class ReportedCounts:
    """Adds up counts that are reported modulo 65536."""

    def __init__(self) -> None:
        self._newest: dict[str, int] = {}
        self.totals: dict[str, int] = {}
        """How many packets the robot has sent, and received with each verdict."""

    def note(self, status: Status) -> None:
        """A status has arrived."""
        if status.item in _OF_NOW:
            return
        before = self._newest.get(status.item, 0)
        self._newest[status.item] = status.value
        # A robot that has rebooted begins anew at 0: the difference would be nearly the modulus.
        rise = (status.value - before) % _MODULUS
        rise = status.value if rise > _MODULUS // 2 else rise
        self.totals[status.item] = self.totals.get(status.item, 0) + rise
