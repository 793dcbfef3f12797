"""`radio.script`: what befalls a chosen message, and no other."""

from typing import Any

import pytest

import palmbots as pb

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
