# SPDX-License-Identifier: Apache-2.0
"""The resilient algorithm in whole carries: the effect of losses, reboots and dead radios on it,
and on Table 2. tests/cpp/control/resilient_test.cpp checks the step by itself.
"""

from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from lossy_radio import lossy, many
from palmbots._util.confidence_intervals import wilson
from palmbots.simulation.result import Carry
from palmbots.simulation.unavoidable_drops import is_unavoidable

CALM: dict[str, Any] = {"robot.noise_m_s": 0.0}
BOX = pb.load_scene("paper")
DELIVERED, DROPPED, STALLED = 1, 2, 3


def carried(overrides: dict[str, Any], controller: str = "resilient", seed: int = 0) -> Carry:
    return pb.carry("paper", controller, seed=seed, overrides=overrides)


def column(carry: Carry, name: str) -> np.ndarray:
    assert carry.trace is not None
    return carry.trace[name].to_numpy()


@cache
def lossless_rms(n: int) -> float:
    return float(np.sqrt(np.mean(many({}, "distributed", n)["contact_rms_m"] ** 2)))


@pytest.mark.parametrize("loss", [0.0, 0.01, 0.05, 0.1, 0.2, 0.4])
def test_losses_and_a_reboot_neither_drop_nor_stop_a_carry(loss: float) -> None:
    """benchmarks/bench_loss.py does the same with 10 000 carries per cell."""
    n = 300
    cell = many(lossy(loss), "resilient", n)
    assert not np.any(cell["outcome"] == STALLED)
    for seed in np.nonzero(cell["outcome"] == DROPPED)[0]:
        assert loss > 0.05
        assert is_unavoidable(carried(lossy(loss), seed=int(seed)))
    if loss <= 0.1:
        rms = np.sqrt(np.mean(cell["contact_rms_m"] ** 2))
        assert rms < 1.5 * lossless_rms(n)
    sent = cell["messages"].sum()
    assert cell["messages_lost"].sum() / sent == pytest.approx(loss, abs=0.01)


def test_perfect_radio_costs_nothing() -> None:
    """The ratio of the contact rms to Table 2's, seed by seed: within 5 %, at 95 % confidence."""
    n = 400
    rms = {
        name: np.sqrt(np.mean(many({}, name, n)["contact_rms_m"] ** 2, axis=1))
        for name in ("distributed", "resilient")
    }
    ratio = np.log(rms["resilient"] / rms["distributed"])
    assert ratio.mean() + 1.96 * ratio.std() / np.sqrt(n) < np.log(1.05)


# --- Table 2, for comparison ---


@pytest.mark.parametrize("by_s", [4.0, 8.0, 16.0, 50.0])
def test_table_2_stalls_when_messages_are_lost(by_s: float) -> None:
    """A carry is affected as soon as one of its messages is lost; until then it sends what it would
    send on a perfect radio. At loss q, by any time, the affected fraction is 1 − (1 − q)^messages,
    averaged over the carries. benchmarks/bench_loss.py does the same with 10 000."""
    n, q = 2000, 0.01
    until = {"task.timeout_s": by_s}
    messages = many(until, "distributed", n)["messages"].astype(float)
    lost = many(until | {"radio.loss": q}, "distributed", n)["messages_lost"]
    expected = float(np.mean(1 - (1 - q) ** messages))
    assert min(by_s, 25) / 100 < expected < 0.5
    low, high = wilson(int(np.count_nonzero(lost)), n, z=4)
    assert low < expected < high


def test_table_2_waits_forever_after_the_first_loss() -> None:
    """From then on one robot never leaves its case, and waits at the end."""
    seen = 0
    for seed in range(60):
        carry = carried({"radio.loss": 0.03}, "distributed", seed)
        lost = [message.sent_s for message in carry.message_log if message.received_s is None]
        if not lost or carry.time_s - lost[0] < 1:
            continue
        seen += 1
        since = column(carry, "time")[:-1] > lost[0] + 0.005
        cases = column(carry, "case")[:-1][since]
        assert any(np.all(cases[:, side] != " ") for side in (0, 1))
        assert max(carry.waiting_s.values()) > 0.8 * (carry.time_s - lost[0]) - 1
    assert seen > 30


# --- silence ---


def alone_ticks(carry: Carry) -> int:
    """The longest run of ticks in which one robot is commanded to travel and the other is not."""
    travels = np.abs(column(carry, "commanded")) > 1e-9
    apart = travels[:, 0] != travels[:, 1]
    longest = run = 0
    for tick in apart[:-1]:
        run = run + 1 if tick else 0
        longest = max(longest, run)
    return longest


OUTAGES = {
    "both ways": ["left", "right"],
    "from the left only": ["left"],
    "from the right only": ["right"],
}


@pytest.mark.parametrize("way", OUTAGES)
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_dead_radio_stops_both_robots(way: str, noise: float) -> None:
    """Both stop, within the bound of each other, palms steep; the object is never dropped."""
    outages = [{"sender": s, "start_s": 5.0, "end_s": 1000.0} for s in OUTAGES[way]]
    carry = carried({"radio.outages": outages, "robot.noise_m_s": noise, "task.timeout_s": 60.0})
    assert carry.outcome == "stalled"
    assert carry.bounds is not None
    assert alone_ticks(carry) * BOX.control.period_s <= carry.bounds.alone_s
    end = column(carry, "time") > 10
    np.testing.assert_array_equal(column(carry, "speed")[end][:-1], 0)
    np.testing.assert_allclose(column(carry, "palm")[end], np.radians(15.0), rtol=1e-12)
    assert sum("robot stands" in warning for warning in carry.warnings) == 2


@pytest.mark.parametrize("way", OUTAGES)
@pytest.mark.parametrize("seed", range(5))
def test_carry_continues_when_the_radio_returns(way: str, seed: int) -> None:
    outages = [
        {"sender": s, "start_s": at, "end_s": at + 3.0} for s in OUTAGES[way] for at in (4.0, 12.0)
    ]
    carry = carried({"radio.outages": outages}, seed=seed)
    assert carry.outcome == "delivered"
    assert 28.0 < carry.time_s < 36.0  # 25 s, and most of six at rest
    assert carry.bounds is not None
    assert alone_ticks(carry) * BOX.control.period_s <= carry.bounds.alone_s


def test_outage_within_the_lease_stops_no_robot() -> None:
    outages = [{"sender": "left", "start_s": 5.0, "end_s": 5.25}]
    carry = carried(CALM | {"radio.outages": outages})
    moving = (column(carry, "time") > 1) & (column(carry, "time") < 24)
    assert np.all(column(carry, "commanded")[moving] > 0.02)


def back_at_work(carry: Carry, over_s: float) -> tuple[float, float, int]:
    """How long after a fault both robots travel again [s], how far both contacts together were off
    the zero zone in that time [m], and the number of corrections in it."""
    times = column(carry, "time")[:-1]
    after = times > over_s - 1e-9
    travel = np.all(np.abs(column(carry, "commanded")[:-1]) > 1e-9, axis=1)
    stood = float(times[travel & after][0]) - over_s
    off = np.maximum(np.abs(column(carry, "contact")[:-1]) - 0.005, 0.0)
    meanwhile = after & (times < over_s + stood + 1e-9)
    did = [c for c in carry.corrections if over_s < c.end_s and c.start_s < over_s + stood]
    return stood, float(off[meanwhile].max(axis=0, initial=0.0).sum()), len(did)


@pytest.mark.parametrize("robot", ["left", "right"])
@pytest.mark.parametrize("kind", ["reboot", "freeze"])
@pytest.mark.parametrize("duration_s", [0.05, 0.3, 2.0])
def test_robot_resumes_after_a_fault(robot: str, kind: str, duration_s: float) -> None:
    """After the fault both robots stand until they hear each other and have corrected the shift of
    the stop. This takes a round trip before and after, the distance at the correction speed, and
    for each correction a palm up and down, three messages and braking. Noise of 1 cm/s may take
    half of that speed. A contact at the edge of the zero zone moves in and out by hundredths of a
    millimetre as palms turn, which causes more corrections: in one fault of 500."""
    at = (3.0, 9.0, 15.0)
    faults = [{"kind": kind, "robot": robot, "at_s": s, "duration_s": duration_s} for s in at]
    turn, message, brakes = 0.2, 0.05 + 0.01, 0.06
    starts = {"start.left_m": 0.002, "start.right_m": -0.001}
    for keys, speed, most in ((CALM | starts, 0.03, 3), ({}, 0.015, 5)):
        numbers = []
        for seed in range(1 if keys else 4):
            carry = carried(keys | {"faults.script": faults}, seed=seed)
            assert carry.outcome == "delivered"
            assert carry.bounds is not None
            for start in at:
                stood, off, corrections = back_at_work(carry, start + duration_s)
                numbers.append(corrections)
                bound = 2 * carry.bounds.shortest_lease_s + off / speed
                assert stood <= bound + corrections * (2 * turn + 3 * message + brakes), start
        assert sum(number > most for number in numbers) <= (0 if keys else 1)


def test_reboot_while_assisting_keeps_the_palm_up() -> None:
    """The left robot assists, and is off for 50 ms. Its palm stays up for a partner that moves."""
    start = {"start.right_m": 0.03}
    plain = carried(CALM | start)
    palm = column(plain, "palm")[:, 0]
    up = column(plain, "time")[:-1][np.isclose(palm[:-1], np.radians(5.0))][0]
    reboot = [{"kind": "reboot", "robot": "left", "at_s": float(up) + 0.2, "duration_s": 0.05}]
    carry = carried(CALM | start | {"faults.script": reboot})
    assert carry.outcome == "delivered"
    times, palm = column(carry, "time"), column(carry, "palm")[:, 0]
    after = (times > up + 0.2) & (times < up + 0.5)
    np.testing.assert_allclose(palm[after], np.radians(5.0), rtol=1e-9)
    # At rest, with a partner that moves away on an Ack alone.
    away = column(carry, "case")[:, 1] == "a"
    assert away[after].any()


def test_standing_robots_settle_contacts_at_the_edge_of_the_zero_zone() -> None:
    """Palms that turn shift contacts by a tenth of a millimetre across the edge and back. Without
    noise, requests and withdrawals could alternate forever."""
    edges = [sign * (0.0048 + 0.0001 * k) for k in range(7) for sign in (1, -1)]
    short = CALM | {"task.distance_m": 0.1, "task.timeout_s": 30.0}
    for left, right in product(edges, edges):
        start = {"start.left_m": left, "start.right_m": right}
        carry = pb.carry("paper", "resilient", overrides=short | start, record=False)
        assert carry.outcome == "delivered", start


@pytest.mark.parametrize("latency", [0.0, 0.02, 0.05])
@pytest.mark.parametrize(("left", "right"), [(-0.02, 0.02), (0.02, -0.02), (0.02, 0.02)])
def test_motions_do_not_overlap(latency: float, left: float, right: float) -> None:
    """While the wheels of one standing robot turn, braking included, the other's do not, also where
    the radio is faster than braking, which takes 0.06 s."""
    start = {"start.left_m": left, "start.right_m": right, "radio.latency_s": latency}
    carry = carried(CALM | start | {"task.distance_m": 0.1})
    runs = column(carry, "speed") != 0
    at_work = column(carry, "case") != " "
    begin = int(np.argmax(np.all(runs, axis=1)))  # of the travel
    assert np.all(np.any(runs[:begin] & at_work[:begin], axis=0))
    np.testing.assert_allclose(column(carry, "contact")[begin], 0, atol=0.006)


def test_drifting_clocks_are_tolerated() -> None:
    for ppm in (-20000.0, 20000.0):
        overrides = lossy(0.1) | {"robot.left.clock_ppm": ppm, "robot.right.clock_ppm": -ppm}
        cell = many(overrides, "resilient", 60)
        assert np.all(cell["outcome"] == DELIVERED)


def test_collisions_cost_beacons() -> None:
    """Synchronous robots collide with probability 1 − (1 − a)², where a is the airtime in ticks."""
    carry = carried(CALM | {"radio.airtime_s": 0.002})
    assert carry.outcome == "delivered"
    rate = carry.messages_lost / carry.messages
    assert rate == pytest.approx(1 - 0.8**2, abs=0.08)
    assert carry.links["left_to_right"].lost == carry.links["right_to_left"].lost


def test_link_counts_add_up() -> None:
    carry = carried(lossy(0.2), seed=3)
    assert set(carry.links) == {"left_to_right", "right_to_left"}
    for link in carry.links.values():
        assert link.delivered == link.sent - link.lost + link.duplicated
        assert 0.1 < link.lost / link.sent < 0.3
        assert link.duplicated / (link.sent - link.lost) == pytest.approx(0.05, abs=0.03)
        assert link.rejected > 0.5 * link.duplicated
    assert (
        sum(link.sent for link in carry.links.values()) == carry.messages == len(carry.message_log)
    )
    assert sum(link.lost for link in carry.links.values()) == carry.messages_lost
    assert {message.kind for message in carry.message_log} <= {
        "TiltUp", "TiltDown", "Ack", "Closing", "Raised",
    }  # fmt: skip


def test_beacons_are_periodic_and_immediate_on_a_new_message() -> None:
    carry = carried({})
    for side in ("left", "right"):
        values = [(m.sent_s, m.kind) for m in carry.message_log if m.sender == side]
        gaps = np.diff([at for at, _ in values])
        assert gaps.max() <= 0.05 + 1e-9
        early = [b for (_, a), (_, b), gap in zip(values, values[1:], gaps, strict=False)
                 if gap < 0.05 - 1e-9 and a == b]  # fmt: skip
        assert len(early) <= 2  # a start or a stop is news too


def test_sensor_that_never_reads_zero_keeps_the_robots_standing() -> None:
    stuck = [{"kind": "stuck", "robot": "left", "at_s": 0.0, "duration_s": 1000.0, "stuck_at": "-"}]
    carry = carried({"faults.script": stuck, "task.timeout_s": 5.0})
    assert set(column(carry, "sign")[:-1, 0]) == {-1}
    assert carry.distance_m < 0.05
