# SPDX-License-Identifier: Apache-2.0
"""The station's loop: how it ends, and what it does for a script and for operators' screens."""

from pathlib import Path
from typing import Any

import pytest

from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air, SimulatedPair
from palmbots.station.station import PERIOD_S
from palmbots.station.station_loop import _Loop

STEP = 5  # ticks in a period of the station
CARRYING = ("carrying", "holding")


class Screens:
    """What the loop sees of its server."""

    had_operator = has_operator = False

    def __init__(self) -> None:
        self.typed: list[str] = []

    def wishes(self) -> list[str]:
        typed, self.typed = self.typed, []
        return typed

    def publish(self, frame: Any) -> None:
        assert set(frame["robots"]) == {"left", "right"}


class LoopedPair(SimulatedPair):
    """Its station runs in the loop."""

    def __init__(self, folder: Path, *, auto: bool = False, for_screen: bool = False) -> None:
        super().__init__(folder, "resilient", Air(), UP | {"limits.station_lost": "carry-on"})
        self.screens: Any = Screens()
        self.loop = _Loop(self.station, self.screens, self.pair, auto=auto, for_screen=for_screen)
        self._step = self.station.step
        self.station.step = self._one

    def _one(self) -> None:
        self.station.step = self._step
        if self.loop.done is None:
            self.loop.step()
        self.station.step = self._one

    def ends(self, within_s: float) -> bool | None:
        """How the loop ends; None: it does not in time."""
        for _ in range(round(within_s / PERIOD_S)):
            if self.loop.done is not None:
                break
            self.run(STEP)
        return self.loop.done


@pytest.mark.parametrize("mode", ["armed", "carrying"])
def test_robots_that_may_move_are_stopped_at_the_end(mode: str, tmp_path: Path) -> None:
    pair = LoopedPair(tmp_path)
    pair.wish("arm", "armed")
    if mode == "carrying":
        pair.wish("start", *CARRYING)
    pair.run(3 * STEP)  # until the station knows
    pair.loop.quit()
    assert pair.ends(2) is True
    assert pair.modes() == ("stopped", "stopped")


def test_a_station_that_is_not_heard_ends_all_the_same(tmp_path: Path) -> None:
    pair = LoopedPair(tmp_path)
    pair.start()
    pair.run(3 * STEP)
    pair.air.cut(("station", "left"), ("station", "right"))
    pair.loop.quit()
    assert pair.ends(2.5) is None
    assert pair.ends(1) is True


def test_an_operator_takes_over_from_the_script_which_then_ends(tmp_path: Path) -> None:
    """A station that is started again does not go on with that carry."""
    pair = LoopedPair(tmp_path, auto=True)
    pair.run_until(CARRYING)
    pair.run(3 * STEP)
    pair.screens.typed.append("disarm")
    assert pair.ends(4) is False
    assert pair.modes() == ("disarmed", "disarmed")
    pair.station.close()
    pair.restart_station()
    assert not pair.station.was_carrying


@pytest.mark.parametrize(
    ("auto", "for_screen", "done"),
    [(True, False, False), (False, True, True), (False, False, None)],
)
def test_robots_stop_when_the_last_operator_is_gone(
    auto: bool, for_screen: bool, done: bool | None, tmp_path: Path
) -> None:
    """A station with a script, or that was started for a screen, then ends."""
    pair = LoopedPair(tmp_path, auto=auto, for_screen=for_screen)
    pair.screens.had_operator = pair.screens.has_operator = True
    if auto:
        pair.run_until(CARRYING)
    else:
        pair.start()
    pair.run(3 * STEP)
    pair.screens.has_operator = False
    assert pair.ends(4) is done
    assert pair.modes() == ("stopped", "stopped")
