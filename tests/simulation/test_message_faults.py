# SPDX-License-Identifier: Apache-2.0
"""Faults of messages: `radio.script` affects chosen messages, `radio.corruption` any."""

from typing import Any

import pytest

import palmbots as pb
from palmbots._util.confidence_intervals import wilson

ASSISTED: dict[str, Any] = {
    "robot.noise_m_s": 0.0,
    "bumps.script": [{"robot": "right", "at_s": 0.4, "shift_m": 0.011}],
    "task.distance_m": 0.3,
}


def carried(*script: dict[str, Any], **overrides: Any) -> pb.simulation.Carry:
    return pb.carry(
        "paper", "distributed", overrides=ASSISTED | {"radio.script": script} | overrides
    )


def transits(done: pb.simulation.Carry) -> list[tuple[str, str, float | None]]:
    """Sender, kind, and transit time of each message."""
    return [
        (m.sender, m.kind, None if m.received_s is None else round(m.received_s - m.sent_s, 6))
        for m in done.message_log
    ]


def test_empty_script_changes_nothing() -> None:
    assert transits(carried()) == [
        ("right", "TiltUp", 0.05),
        ("left", "Ack", 0.05),
        ("right", "TiltDown", 0.05),
    ]


def test_scripted_loss_removes_the_message() -> None:
    carry = carried({"sender": "right", "message": 2, "effect": "lost"})
    assert transits(carry)[:2] == transits(carried())[:2]
    assert transits(carry)[2] == ("right", "TiltDown", None)
    assert carry.messages_lost == 1


def test_scripted_delay_delays_the_message() -> None:
    carry = carried({"sender": "left", "message": 1, "effect": "delayed", "delay_s": 0.7})
    assert transits(carry) == [
        ("right", "TiltUp", 0.05),
        ("left", "Ack", 0.75),
        ("right", "TiltDown", 0.05),
    ]
    assert carry.waiting_s["right"] == pytest.approx(carried().waiting_s["right"] + 0.7)


def test_scripted_duplicate_repeats_the_message() -> None:
    """On the bare channel a second TiltUp raises the assistant's palm again, although no robot
    needs it. With sessions the copy is rejected."""
    mishap = {"sender": "right", "message": 1, "effect": "duplicated", "delay_s": 1.5}
    keys = {"radio.reorder": True}  # what follows does not wait for the copy
    ignored = carried(mishap, **keys)
    assert transits(ignored) == transits(carried())
    assert ignored.links["right_to_left"].duplicated == 1
    assert ignored.links["right_to_left"].rejected == 1
    assert ignored.trace_hash == carried().trace_hash
    carry = carried(mishap, **keys, **{"radio.sessions": False})
    assert carry.links["right_to_left"].rejected == 0
    assert transits(carry)[:3] == transits(carried())
    assert transits(carry)[3:] == [("left", "Ack", 0.05)]
    assert carry.messages_lost == 0
    assert carry.trace is not None
    assert carry.trace["case"].sel(side="left").to_numpy()[-1] == "c"


@pytest.mark.parametrize("robot", ["left", "right"])
def test_message_after_a_reboot_is_answered_by_a_hello(robot: str) -> None:
    """Neither robot has said anything since the reboot, so the first message has no session. On the
    bare channel it is acted upon."""
    reboot = {"kind": "reboot", "robot": robot, "at_s": 0.1, "duration_s": 0.1}
    carry = carried(**{"faults.script": [reboot]})
    assert transits(carry) == [("right", "TiltUp", 0.05), ("left", "Hello", 0.05)]
    assert carry.messages == 2
    assert carry.links["right_to_left"].rejected == 1
    assert carry.links["left_to_right"].rejected == 0
    (warning,) = carry.warnings
    assert warning.startswith("the right robot has waited since 0.4 s for an Ack")
    assert warning.endswith("that does not arrive (a message had no session after a reboot)")
    bare = carried(**{"faults.script": [reboot], "radio.sessions": False})
    assert transits(bare) == transits(carried())
    assert not bare.warnings


def test_sessions_change_nothing_without_copies_overtaking_and_boots() -> None:
    keys = {"radio.jitter_s": 0.04, "radio.loss": 0.02, "radio.corruption": 0.02}
    for controller in ("centralized", "distributed"):
        with_sessions, bare = (
            pb.carry("paper", controller, overrides=keys | {"radio.sessions": is_on})
            for is_on in (True, False)
        )
        assert with_sessions.trace_hash == bare.trace_hash
        assert with_sessions.links == bare.links


# --- the packets of a station: one from and to each robot in each control period ---


def commanded(*script: dict[str, Any]) -> pb.simulation.Carry:
    return pb.carry("paper", "centralized", overrides=ASSISTED | {"radio.script": script})


def shallow_since_s(carry: pb.simulation.Carry, side: str) -> float:
    """When the command to tilt the palm up arrives: the palm leaves its steep angle."""
    assert carry.trace is not None
    palm = carry.trace["palm"].sel(side=side).to_numpy()
    return float(carry.trace["time"].to_numpy()[(palm < palm[0] - 1e-9).argmax()])


@pytest.mark.parametrize(
    ("name", "link"),
    [
        ({"sender": "left"}, "left_to_station"),
        ({"sender": "right"}, "right_to_station"),
        ({"sender": "station", "receiver": "left"}, "station_to_left"),
        ({"sender": "station", "receiver": "right"}, "station_to_right"),
    ],
)
def test_a_packet_of_each_link_is_lost(name: dict[str, Any], link: str) -> None:
    """Nothing changes when a packet is lost that only repeats the one before."""
    carry = commanded({**name, "message": 20, "effect": "lost"})
    assert {key: counts.lost for key, counts in carry.links.items()} == {
        key: int(key == link) for key in carry.links
    }
    assert carry.trace_hash == commanded().trace_hash


def test_a_late_command_holds_up_those_after_it() -> None:
    """The left robot assists. The station's first command leaves after the latency, in the sixth
    control period, so its command 31 leaves at 0.35 s, before the bump."""
    fault = {"sender": "station", "message": 31, "effect": "delayed", "delay_s": 0.6}
    usual = shallow_since_s(commanded(), "left")
    assert 0.45 < usual < 0.6
    late = commanded({**fault, "receiver": "left"})
    assert shallow_since_s(late, "left") == pytest.approx(0.35 + 0.05 + 0.6, abs=0.0101)
    other = commanded({**fault, "receiver": "right"})
    assert shallow_since_s(other, "left") == usual


# --- damaged packets ---


@pytest.mark.parametrize("controller", ["centralized", "distributed", "resilient"])
def test_damaged_packet_is_delivered_counted_and_ignored(controller: str) -> None:
    """With all packets damaged, each is delivered, none lost, all rejected, and the robots behave
    as with a radio that loses everything."""
    damaged = pb.carry("paper", controller, overrides={"radio.corruption": 1.0})
    lost = pb.carry("paper", controller, overrides={"radio.loss": 1.0})
    assert damaged.messages > 0
    assert damaged.messages_lost == 0
    for link in damaged.links.values():
        assert link.rejected == link.delivered == link.sent
        assert (link.lost, link.duplicated, link.expired) == (0, 0, 0)
    assert {message.received_s for message in damaged.message_log} <= {None}
    assert damaged.trace_hash == lost.trace_hash


@pytest.mark.parametrize("controller", ["centralized", "resilient"])
def test_packets_are_damaged_with_the_given_probability(controller: str) -> None:
    """Binomial. Without duplicates and reordering nothing else is rejected."""
    carry = pb.carry("paper", controller, overrides={"radio.corruption": 0.1})
    assert carry.outcome == "delivered"
    for link in carry.links.values():
        low, high = wilson(link.rejected, link.sent, z=4)
        assert low < 0.1 < high
        assert link.delivered == link.sent
    unread = sum(message.received_s is None for message in carry.message_log)
    if carry.message_log:
        assert unread == sum(link.rejected for link in carry.links.values())


def test_damaged_message_leaves_table_2_waiting_like_a_lost_one() -> None:
    hung = 0
    for seed in range(12):
        carry = pb.carry("paper", seed=seed, overrides={"radio.corruption": 0.1})
        warned = [w for w in carry.warnings if "does not arrive (a message arrived damaged)" in w]
        damaged = sum(link.rejected for link in carry.links.values())
        assert damaged == sum(message.received_s is None for message in carry.message_log)
        assert bool(damaged) or not warned
        hung += bool(warned)
    assert hung > 6


def test_corruption_does_not_change_other_random_events() -> None:
    """Corruption has its own random numbers: with and without it the same reports, one per tick,
    are lost and duplicated."""
    keys = {"radio.loss": 0.1, "radio.duplicate": 0.1, "task.timeout_s": 5.0}
    plain, damaged = (
        pb.carry("paper", "centralized", overrides=keys | {"radio.corruption": share}).links
        for share in (0.0, 0.2)
    )
    for name in ("left_to_station", "right_to_station"):
        assert plain[name].sent == damaged[name].sent == 500
        assert plain[name].lost == damaged[name].lost > 20
        assert plain[name].duplicated == damaged[name].duplicated > 20
        stale = plain[name].rejected  # the copies that have arrived, and nothing else
        assert plain[name].duplicated - 5 <= stale <= plain[name].duplicated
        assert damaged[name].rejected > stale + 20
