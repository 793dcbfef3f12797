"""What befalls messages on the way: `radio.script` one that is chosen, `radio.corruption` any."""

from typing import Any

import pytest

import palmbots as pb
from palmbots.compare import wilson

ASSISTED: dict[str, Any] = {
    "robot.noise_m_s": 0.0,
    "bumps.script": [{"robot": "right", "at_s": 0.4, "shift_m": 0.011}],
    "task.distance_m": 0.3,
}


def carried(*script: dict[str, Any], **overrides: Any) -> pb.Carry:
    return pb.carry(
        "paper", "distributed", overrides=ASSISTED | {"radio.script": script} | overrides
    )


def told(done: pb.Carry) -> list[tuple[str, str, float | None]]:
    """Sender, letter, and how long it took."""
    return [
        (m.sender, m.letter, None if m.received_s is None else round(m.received_s - m.sent_s, 6))
        for m in done.letters
    ]


def test_nothing_planned() -> None:
    assert told(carried()) == [
        ("right", "TiltUp", 0.05),
        ("left", "Ack", 0.05),
        ("right", "TiltDown", 0.05),
    ]


def test_lost() -> None:
    done = carried({"sender": "right", "message": 2, "fate": "lost"})
    assert told(done)[:2] == told(carried())[:2]
    assert told(done)[2] == ("right", "TiltDown", None)
    assert done.messages_lost == 1


def test_late() -> None:
    done = carried({"sender": "left", "message": 1, "fate": "late", "late_s": 0.7})
    assert told(done) == [
        ("right", "TiltUp", 0.05),
        ("left", "Ack", 0.75),
        ("right", "TiltDown", 0.05),
    ]
    assert done.waiting_s["right"] == pytest.approx(carried().waiting_s["right"] + 0.7)


def test_copied() -> None:
    """A TiltUp that comes again brings the assistant's palm up again, for nobody."""
    mishap = {"sender": "right", "message": 1, "fate": "copied", "late_s": 1.5}
    done = carried(mishap, **{"radio.reorder": True})  # what follows does not wait for the copy
    assert told(done)[:3] == told(carried())
    assert told(done)[3:] == [("left", "Ack", 0.05)]
    assert done.messages_lost == 0
    assert done.trace is not None
    assert done.trace["case"].sel(side="left").to_numpy()[-1] == "c"


def test_the_mirror_image_has_it_mirrored() -> None:
    scene = pb.load_scene(
        "paper",
        ASSISTED | {"radio.script": [{"sender": "left", "message": 1, "fate": "lost"}]},
    )
    there = pb.carry(scene, "distributed")
    back = pb.carry(scene.mirrored(), "distributed")
    exchanged = {"left": "right", "right": "left"}
    assert [(exchanged[s], letter, took) for s, letter, took in told(back)] == told(there)


@pytest.mark.parametrize(
    ("mishap", "says"),
    [
        ({"sender": "left", "message": 0, "fate": "lost"}, "message.*is too small"),
        ({"sender": "left", "message": 1, "fate": "late"}, "does not say how late"),
        ({"sender": "left", "message": 1, "fate": "lost", "late_s": 1.0}, "says how late"),
        ({"sender": "left", "message": 1, "fate": "eaten"}, "fate"),
        ({"sender": "station", "message": 1, "fate": "lost"}, "sender"),
    ],
)
def test_bad_input_is_one_line(mishap: dict[str, Any], says: str) -> None:
    with pytest.raises(pb.SceneError, match=says) as error:
        pb.load_scene("paper", {"radio.script": [mishap]})
    assert "radio.script" in str(error.value)
    assert "\n" not in str(error.value)


# --- damaged packets ---


@pytest.mark.parametrize("controller", ["centralized", "distributed", "resilient"])
def test_a_damaged_packet_is_delivered_counted_and_ignored(controller: str) -> None:
    """All damaged: each is delivered, none lost, all rejected, and the robots do what they do on a
    radio that loses all."""
    damaged = pb.carry("paper", controller, overrides={"radio.corruption": 1.0})
    lost = pb.carry("paper", controller, overrides={"radio.loss": 1.0})
    assert damaged.messages > 0
    assert damaged.messages_lost == 0
    for link in damaged.links.values():
        assert link.rejected == link.delivered == link.sent
        assert (link.lost, link.duplicated, link.late) == (0, 0, 0)
    assert {letter.received_s for letter in damaged.letters} <= {None}
    assert damaged.trace_hash == lost.trace_hash


@pytest.mark.parametrize("controller", ["centralized", "resilient"])
def test_as_many_packets_are_damaged_as_said(controller: str) -> None:
    """Binomial; nothing else is rejected where nothing is doubled or overtakes."""
    carry = pb.carry("paper", controller, overrides={"radio.corruption": 0.1})
    assert carry.outcome == "delivered"
    for link in carry.links.values():
        low, high = wilson(link.rejected, link.sent, z=4)
        assert low < 0.1 < high
        assert link.delivered == link.sent
    unread = sum(letter.received_s is None for letter in carry.letters)
    if carry.letters:
        assert unread == sum(link.rejected for link in carry.links.values())


def test_a_damaged_letter_hangs_table_2_like_a_lost_one() -> None:
    hung = 0
    for seed in range(12):
        carry = pb.carry("paper", seed=seed, overrides={"radio.corruption": 0.1})
        warned = [w for w in carry.warnings if "does not come (a letter came damaged)" in w]
        damaged = sum(link.rejected for link in carry.links.values())
        assert damaged == sum(letter.received_s is None for letter in carry.letters)
        assert bool(damaged) or not warned
        hung += bool(warned)
    assert hung > 6


def test_damage_leaves_other_chances_as_they_are() -> None:
    """It has random numbers of its own: the same reports, one a tick, are lost and doubled with it
    and without."""
    keys = {"radio.loss": 0.1, "radio.duplicate": 0.1, "task.timeout_s": 5.0}
    plain, damaged = (
        pb.carry("paper", "centralized", overrides=keys | {"radio.corruption": share}).links
        for share in (0.0, 0.2)
    )
    for name in ("left_to_station", "right_to_station"):
        assert plain[name].sent == damaged[name].sent == 500
        assert plain[name].lost == damaged[name].lost > 20
        assert plain[name].duplicated == damaged[name].duplicated > 20
        assert plain[name].rejected == 0 < damaged[name].rejected
