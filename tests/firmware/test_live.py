# SPDX-License-Identifier: Apache-2.0
"""Two boards in real time, without a station: buttons, faults, resets."""

import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import palmbots._core as _core
from emulator.board import Image
from emulator.live import A, B, LivePair
from emulator.processor import CYCLES_PER_US
from flash_records import flash_record
from live_faults import SHORT_WAY
from palmbots.boards.pair_settings import BoardPair, board_pair
from palmbots.control.registry import shipped_names
from palmbots.pair.pair_file import init_pair, load_pair
from sampled import in_soak

MakeBoards = Callable[..., BoardPair]
RESTING = ("disarmed", "armed", "done", "stopped", "fault")
WITHIN_S = 9.0


def modes(pair: LivePair) -> tuple[str, ...]:
    return tuple(robot.mode for robot in pair.robots)


def at_rest(pair: LivePair) -> bool:
    return all(robot.command()[2] and robot.command()[1] == 0 for robot in pair.robots)


@pytest.mark.parametrize("controller", ["resilient", "silent"])
def test_two_boards_carry_by_their_buttons(
    image: Image, boards: MakeBoards, controller: str
) -> None:
    pair = LivePair(image, boards(controller), seed=3)
    assert pair.start(), pair.state()
    assert pair.run_until("done", within_s=WITHIN_S), pair.state()
    assert pair.is_held
    assert pair.world.sight().midpoint == pytest.approx(0.3, rel=0.1)
    assert [robot.board.leds_lit for robot in pair.robots] == [1, 1]  # one row at a time


@pytest.mark.soak
@pytest.mark.parametrize("controller", shipped_names("robots"))
def test_the_pair_of_the_guide_carries(image: Image, tmp_path: Path, controller: str) -> None:
    """With the one change of docs/guide/firmware.md, all the way of the paper's box."""
    values = {"limits.station_lost": "carry-on"}
    file = init_pair(tmp_path / "pair.toml", controller=controller, values=values)[0]
    pair = LivePair(image, board_pair(load_pair(file)), seed=5)
    assert pair.start(), pair.state()
    assert pair.run_until("done", within_s=60.0), pair.state()
    assert pair.is_held
    assert pair.world.sight().midpoint == pytest.approx(1.5, rel=0.05)


ARM = {"hardware.arm_floor_deg": 50.0, "hardware.arm_top_deg": 150.0, "limits.time_limit_s": 300.0}
STAND_SWITCH: dict[str, Any] = {"board.stand_switch": True}


def job(image: Image, boards: MakeBoards, scene: str) -> LivePair:
    overrides = SHORT_WAY.get(scene, {"task.distance_m": 0.3}) | {"robot.noise_m_s": 0.002}
    values = ARM | (STAND_SWITCH if scene == "stand" else {})
    made = boards("shared-sign", overrides, values, scene=scene)
    pair = LivePair(image, made, seed=3)
    assert pair.start(), pair.state()
    return pair


@pytest.mark.parametrize("scene", ["stand", "lone", in_soak("lift"), in_soak("handover")])
def test_boards_do_a_job_by_their_buttons(image: Image, boards: MakeBoards, scene: str) -> None:
    """Without encoders each travels for a time, and a switch states that it is below a stand."""
    pair = job(image, boards, scene)
    assert pair.run_until("done", within_s=120.0), pair.state()
    assert pair.job is not None and pair.job.is_put_down
    assert pair.job.carried_m == pytest.approx(pair.scene.task.distance_m, rel=0.05)


def test_boards_put_the_object_down_if_one_that_hands_it_over_restarts(
    image: Image, boards: MakeBoards
) -> None:
    pair = job(image, boards, "handover")
    giver, taker = pair.robots
    while _core.lift_state_numbers[64 + taker.note("phase")] != "ahead":
        pair.run(0.1)
    assert pair.job is not None and max(pair.job.heights_m) > 0.14
    pair.cut_power(taker, 0.2)
    assert pair.run_until("fault", within_s=10.0), pair.state()
    assert {_core.wire.fault_codes[robot.note("code")] for robot in (giver, taker)} == {"job"}
    assert max(pair.job.heights_m) < 0.05 and pair.is_held


def test_packets_leave_at_random_instants(image: Image, boards: MakeBoards) -> None:
    """All over the tick, so that robots with equal clocks do not collide for long."""
    pair = LivePair(image, boards(), seed=3)
    assert pair.start(), pair.state()
    phases: list[int] = []
    board = pair.robots[0].board
    period = 10_000 * CYCLES_PER_US
    inner = board.on_send

    def note(data: bytes) -> None:
        assert board.timer.started_at is not None
        phases.append(4 * ((board.now - board.timer.started_at) % period) // period)
        inner(data)

    board.on_send = note
    pair.collided = 0
    pair.run(12.0)
    assert len(phases) > 450
    quarters = [phases.count(n) / len(phases) for n in range(4)]
    assert all(0.15 < share < 0.35 for share in quarters), quarters
    # A packet is on the air for 0.34 ms, so two in 9 ms overlap once in 13 times.
    assert 0.02 < pair.collided / (2 * len(phases)) < 0.15


@pytest.mark.parametrize("clocks", [(1.02, 0.98), (0.98, 1.02)])
def test_clocks_that_differ(image: Image, boards: MakeBoards, clocks: tuple[float, float]) -> None:
    ppm = {f"robot.{side}.clock_ppm": 20000.0 * s for side, s in (("left", 1), ("right", -1))}
    pair = LivePair(image, boards(overrides=ppm), seed=4, clocks=clocks)
    assert pair.start(), pair.state()
    assert pair.run_until("done", within_s=WITHIN_S), pair.state()
    assert pair.is_held


def test_losses_and_bit_errors(image: Image, boards: MakeBoards) -> None:
    pair = LivePair(image, boards(), seed=5, loss=0.1, bit_errors=0.1)
    assert pair.start(), pair.state()
    assert pair.run_until("done", within_s=WITHIN_S), pair.state()
    assert pair.is_held
    assert pair.damaged >= 30


def test_a_flood_of_bit_errors_rests_the_wheels(image: Image, boards: MakeBoards) -> None:
    """A wrong bit in every packet: none of them counts, so the robots hear nobody and rest."""
    pair = LivePair(image, boards(), seed=5)
    assert pair.start(), pair.state()
    pair.run(0.5)
    pair.bit_errors = 1.0
    pair.run(1.0)
    for robot in pair.robots:
        robot.sent_epochs.clear()
    pair.run(2.0)
    assert [robot.sent_epochs for robot in pair.robots] == [{1}, {1}]  # they go on to send
    assert at_rest(pair), pair.state()
    assert pair.is_held
    pair.bit_errors = 0.0
    assert pair.run_until("done", within_s=WITHIN_S), pair.state()


@pytest.mark.parametrize("button", [A, B])
@pytest.mark.parametrize("side", [0, 1])
def test_any_button_stops_both(image: Image, boards: MakeBoards, side: int, button: int) -> None:
    pair = LivePair(image, boards(), seed=6)
    assert pair.start(), pair.state()
    pair.run(0.7)
    pair.press(button, side)
    assert pair.run_until("stopped", within_s=0.5), pair.state()
    assert at_rest(pair)
    assert pair.is_held
    # It stays latched over a power cut, and until both are released, armed and started again.
    pair.cut_power(pair.robots[side], 0.2)
    pair.run(0.6)
    assert modes(pair) == ("stopped", "stopped")
    pair.press(B)
    assert modes(pair) == ("stopped", "stopped")
    pair.press(A)
    assert pair.run_until("disarmed"), pair.state()
    assert pair.start(), pair.state()


def test_buttons_held_at_power_up_do_nothing(image: Image, boards: MakeBoards) -> None:
    pair = LivePair(image, boards(), seed=7, held_at_power_up=A | B)
    pair.run(1.0)
    assert modes(pair) == ("disarmed", "disarmed")
    for robot in pair.robots:
        robot.board.hold_buttons(0)
    pair.run(0.2)
    assert modes(pair) == ("disarmed", "disarmed")
    assert pair.start(), pair.state()


def unplugged(pair: LivePair) -> str:
    pair.robots[0].is_unplugged = True
    return "palm"


def stuck(pair: LivePair) -> str:
    pair.robots[0].stuck = 1 << 7 | 1 << 8  # both ends of the palm at once
    return "switches"


def brown_out(pair: LivePair) -> str:
    pair.robots[0].board.power.breaks_down()
    return "supply"


@pytest.mark.parametrize("fault", [unplugged, stuck, brown_out])
def test_a_fault_rests_the_wheels_and_is_shown(
    image: Image, boards: MakeBoards, fault: Callable[[LivePair], str]
) -> None:
    pair = LivePair(image, boards(), seed=8)
    assert pair.start(), pair.state()
    pair.run(0.3)
    code = fault(pair)
    assert pair.run_until("fault", within_s=2.0), pair.state()
    assert pair.robots[0].fault == code
    assert at_rest(pair)
    assert pair.is_held
    # The fourth row of the LEDs: the left one, for a fault of the board, and the code.
    number = ("none", "switches", "palm", "motor", "supply").index(code)
    row = pair.robots[0].board.led_picture >> 15 & 31
    assert row == 1 | sum((number >> 3 - i & 1) << 1 + i for i in range(4))
    pair.press(A)
    assert pair.robots[0].mode != "armed" or code == "supply"


def test_robots_with_motor_boards_carry(image: Image, boards: MakeBoards) -> None:
    values = {"board.wheels": "motor-board", "board.motor_timeout_s": 0.1}
    pair = LivePair(image, boards(values=values), seed=9)
    assert pair.start(), pair.state()
    pair.run(1.0)
    # They face each other, so one drives forward and the other one backward.
    newest = [robot.board.twi.newest or b"" for robot in pair.robots]
    assert [(speeds[1], speeds[3]) for speeds in newest] == [(0, 0), (1, 1)]
    assert pair.run_until("done", within_s=WITHIN_S), pair.state()
    assert pair.is_held
    assert pair.world.sight().midpoint == pytest.approx(0.3, rel=0.1)
    assert [robot.board.twi.newest for robot in pair.robots] == [bytes(5), bytes(5)]


@pytest.mark.parametrize("hangs", [False, True])
def test_a_silent_motor_board_is_a_fault(image: Image, boards: MakeBoards, hangs: bool) -> None:
    values = {"board.wheels": "motor-board", "board.motor_timeout_s": 0.1}
    pair = LivePair(image, boards(values=values), seed=9)
    pair.run(0.3)
    twi = pair.robots[0].board.twi
    assert twi.newest == bytes(5)  # speed 0 on both sides
    pair.press(A)
    pair.press(B)
    assert pair.run_until("carrying", "holding"), pair.state()
    assert any(twi.newest or b"")
    twi.answers, twi.hangs = hangs, hangs
    assert pair.run_until("fault", within_s=1.0), pair.state()
    assert pair.robots[0].fault == "motor"


@pytest.mark.parametrize("is_debounced", [True, False])
def test_switches_that_bounce(image: Image, boards: MakeBoards, is_debounced: bool) -> None:
    """A debounced switch changes once for each change of the contact, any other one chatters."""
    pair = LivePair(image, boards(values={"board.bounce_s": 0.02 * is_debounced}), seed=10)
    for robot in pair.robots:
        robot.bounces_us = 15_000
    assert pair.start(), pair.state()
    felt = shown = 0
    before = signs_of(pair)
    for _ in range(500):
        pair.tick()
        now = signs_of(pair)
        felt += sum(a != b for a, b in zip(before[0], now[0], strict=True))
        shown += sum(a != b for a, b in zip(before[1], now[1], strict=True))
        before = now
    assert felt >= 8
    # What changed just before the count began is shown in it, once per robot at most.
    assert (shown <= felt + 2) == is_debounced, (shown, felt)
    assert pair.is_held
    if is_debounced:
        assert pair.run_until("done", within_s=WITHIN_S), pair.state()
        assert pair.is_held


def signs_of(pair: LivePair) -> tuple[list[int], list[int]]:
    """The contact signs in the world, and the bottom rows of the LEDs, which show them."""
    return [seen[0] for seen in pair.world.seen()], [
        robot.board.led_picture >> 20 & 31 for robot in pair.robots
    ]


def test_another_key_is_shown(image: Image, boards: MakeBoards) -> None:
    mine = boards()
    pair = LivePair(image, mine, seed=11)
    stranger = LivePair(image, mine, seed=12)
    other = bytearray(mine.settings("right", 1).packed())
    other[8:24] = bytes(16)
    other[-4:] = zlib.crc32(bytes(other[:-4])).to_bytes(4, "little")
    pair.ends[1] = pair.robots[1] = stranger.robots[1]
    pair.robots[1].board.set_bytes(0xF000, bytes(other))
    pair.run(4.0)
    assert [robot.fault for robot in pair.robots] == ["stranger", "stranger"]
    pair.press(A)
    assert modes(pair) == ("disarmed", "disarmed")


def test_a_page_is_erased_while_the_robot_is_disarmed(image: Image, boards: MakeBoards) -> None:
    """One page is full and the other half full after the boot. The erase halts the processor for
    longer than eight ticks, which the watchdog admits."""
    pair = LivePair(image, boards(), seed=13)
    board = pair.robots[0].board
    full = b"".join(flash_record(n, 1) for n in range(1, 342))
    half = b"".join(flash_record(n, 2) for n in range(342, 511))
    board.set_bytes(0x7E000, full)
    board.set_bytes(0x7F000, half)
    pair.run(0.5)
    assert board.nvmc.erases == {0x7E000: 1}
    assert board.resets == []
    missed = pair.robots[0].note("missed")
    assert 7 <= missed <= 8  # of nine ticks the first is on time
    assert pair.robots[0].sent_epochs == {3}
