# SPDX-License-Identifier: Apache-2.0
"""What a robot's program says while it waits."""

from pathlib import Path

from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.robot.waiting_notices import Silence, hardware_text, reading_text


def test_unheard_ends_are_named_once_and_then_when_they_are_heard() -> None:
    lines: list[str] = []
    silence = Silence("left", {"right": "a:1", "station": "b:2"}, 3, lines.append)
    silence.step(())
    silence.step(("station",))
    silence.step(("station",))
    assert lines == ["left: has not heard the right robot (a:1) yet; check program and address"]
    silence.step(("right", "station"))
    silence.step(("right", "station"))
    assert lines[1:] == ["left: now hears the right robot (a:1)"]


def test_nothing_is_said_of_ends_that_are_heard_in_time() -> None:
    lines: list[str] = []
    silence = Silence("left", {"right": "a:1"}, 3, lines.append)
    for _ in range(5):
        silence.step(("right",))
    assert lines == []


def test_the_printed_commands_are_those_of_this_pair(tmp_path: Path) -> None:
    """A world with another scene would be refused."""
    file = init_pair(tmp_path / "own.toml", scene="figure8", address="127.0.0.1:7499")[0]
    pair = load_pair(file)
    assert hardware_text(pair, "left").endswith(
        "run: palmbots world figure8 --serve 127.0.0.1:7499"
    )
    assert reading_text(pair, "left").endswith(f"run: palmbots robot {file} --side right")
