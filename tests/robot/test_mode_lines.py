# SPDX-License-Identifier: Apache-2.0
"""Lines about the modes of a robot."""

from types import SimpleNamespace

from palmbots.pair.fault_words import FAULT_WORDS
from palmbots.robot.mode_lines import ModeLines


def test_a_line_for_each_change_with_what_to_do() -> None:
    said: list[str] = []
    lines = ModeLines("right", said.append)
    states = [("disarmed", "none"), ("disarmed", "none"), ("carrying", "none"), ("fault", "driver")]
    for mode, fault in [*states, ("fault", "storage"), ("disarmed", "none")]:
        lines.take(SimpleNamespace(mode=mode, fault=fault))
    driver, storage = (FAULT_WORDS[fault] for fault in ("driver", "storage"))
    assert said == [
        "right: disarmed",
        "right: carrying",
        f"right: fault: {driver.meaning}; {driver.remedy}",
        f"right: fault: {storage.meaning}; {storage.remedy}",
        "right: disarmed",
    ]
