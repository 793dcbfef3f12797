# SPDX-License-Identifier: Apache-2.0
"""What the LEDs of a robot show (docs/guide/firmware.md)."""

from collections.abc import Callable
from dataclasses import replace

from emulator.__main__ import dongle_image
from emulator.board import Board, Image
from emulator.live import A, B, LivePair
from emulator.processor import CYCLES_PER_US
from palmbots.boards.pair_settings import BoardPair
from palmbots.boards.settings_page import PAGE_ADDRESS, settings_page

MakeBoards = Callable[..., BoardPair]
PICTURES = {
    "disarmed": ".....|..#..|.....",
    "armed": ".###.|.#.#.|.###.",
    "ready": ".###.|.###.|.###.",
    "carrying": "..#..|.###.|#.#.#",
    "holding": ".#.#.|.#.#.|.#.#.",
    "done": "....#|#..#.|.##..",
    "stopped": "#####|#####|#####",
    "fault": ".#.#.|..#..|.#.#.",
}


def rows(board: Board) -> list[str]:
    """The rows of the LEDs from above."""
    picture = board.led_picture
    return ["".join(".#"[picture >> 5 * y + x & 1] for x in range(5)) for y in range(5)]


def test_each_mode_has_a_picture(image: Image, boards: MakeBoards) -> None:
    pair = LivePair(image, boards(), seed=3)
    seen: dict[str, str] = {}
    signs: set[tuple[int, str]] = set()
    steady = [0, 0]
    modes = ["", ""]

    def look() -> None:
        """A mode and a contact count once they have been there for some ticks."""
        for n, (robot, seen_by) in enumerate(zip(pair.robots, pair.world.seen(), strict=True)):
            state = f"{robot.mode} {seen_by[0]}"
            steady[n] = steady[n] + 1 if state == modes[n] else 0
            modes[n] = state
            if steady[n] < 8:
                continue
            shown = rows(robot.board)
            assert seen.setdefault(robot.mode, "|".join(shown[:3])) == "|".join(shown[:3])
            if not robot.is_unplugged:
                signs.add((seen_by[0], shown[4]))

    inner = pair.tick

    def tick() -> None:
        inner()
        look()

    pair.tick = tick
    pair.run(0.3)
    assert pair.start(), pair.state()
    assert pair.run_until("done", within_s=9.0), pair.state()
    pair.run(0.3)
    pair.press(A)
    pair.press(B, 0)  # it is ready, and waits for the other
    pair.run(0.3)
    pair.press(A, 0)  # it may have moved, so this stops both
    pair.run(0.3)
    pair.press(A)
    pair.run(0.3)
    assert pair.start(), pair.state()
    pair.robots[0].is_unplugged = True
    pair.run(2.0)
    assert seen.items() <= PICTURES.items()
    assert len(set(PICTURES.values())) == len(PICTURES)
    assert set(PICTURES) - {"holding"} <= set(seen), seen
    assert signs == {(-1, "#...."), (0, "..#.."), (1, "....#")}


def code(board: Board) -> int:
    """The number of the board's fault in the fourth row."""
    row = rows(board)[3]
    assert row[0] == "#", "no fault of the board"
    return int(row[1:].replace("#", "1").replace(".", "0"), 2)


def test_an_image_without_settings_shows_it(image: Image) -> None:
    for program in (image, dongle_image()):
        board = Board(program)
        board.boot()
        board.run_us(50_000)
        assert "|".join(rows(board)[:3]) == PICTURES["fault"]
        assert code(board) == 6
        assert board.pwm.pulses is None
        assert board.radio.sent_packets == 0


def test_an_image_without_boots_shows_it(image: Image, boards: MakeBoards) -> None:
    settings = replace(boards().settings("left", 1), last_epoch=2)
    board = Board(replace(image, flash=image.flash[:PAGE_ADDRESS] + settings_page(settings)))
    for _ in range(2):
        board.boot()
        board.run_us(50_000)
        assert "|".join(rows(board)[:3]) == PICTURES["disarmed"]
        board.cut_power()
    board.boot()
    board.run_us(100_000)
    assert "|".join(rows(board)[:3]) == PICTURES["fault"]
    assert code(board) == 5
    assert board.radio.sent_packets == 0


def test_ticks_that_come_too_late_are_a_fault(image: Image, boards: MakeBoards) -> None:
    """A program that is slow in three of four ticks: the robots come to rest, and it is shown."""
    pair = LivePair(image, boards(), seed=4)
    assert pair.start(), pair.state()
    robot = pair.robots[0]
    shown = set[str]()
    for _ in range(30):
        robot.board.halt += 38_000 * CYCLES_PER_US
        pair.run(0.04)
        shown.add(rows(robot.board)[3])
    assert robot.board.resets == []
    assert robot.mode == "fault", pair.state()
    # First as a fault of the board, and then, at rest, as what has stopped the robot: overrun.
    assert shown == {".....", "##...", ".#..."}
    assert robot.note("code") == 8
    assert robot.command()[1:] == (0, True)
    assert pair.is_held
