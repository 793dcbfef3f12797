"""What the model checker found wrong with Table 2, carried: each counterexample of verify/ that
has a scene fails in the world with friction and geometry as it does in the model."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import explore
import palmbots as pb

KEPT = explore.HERE / "counterexamples"
SCENES = sorted(KEPT.glob("*.toml"))


def hangs(*robots: str) -> Callable[[pb.Carry], bool]:
    """Whether these robots, and no other, wait at the end for a letter that cannot come."""

    def check(done: pb.Carry) -> bool:
        period = done.scene.control.period_s
        end = done.letters[-1].sent_s + 0.5
        waits = {
            side
            for side, waited in done.waiting_s.items()
            if waited > done.time_s - end - period and _same_case(done, side, end)
        }
        return waits == set(robots)

    return check


def _same_case(done: pb.Carry, side: str, since_s: float) -> bool:
    assert done.trace is not None
    cases = done.trace["case"].sel(side=side).to_numpy()
    late = cases[done.trace["time"].to_numpy() > since_s]
    return len(set(late)) == 1 and late[0] != " "


def drops(done: pb.Carry) -> bool:
    """Whether a contact runs off its palm, no message lost."""
    return (done.outcome, done.reason, done.messages_lost) == ("dropped", "off-palm", 0)


def fights(done: pb.Carry) -> bool:
    """Whether one robot moves away and the other closer from some time to the end, both faster or
    both slower than they travel, so that no contact moves any more."""
    assert done.trace is not None
    extra = done.trace["commanded"].to_numpy() - done.scene.robot.speed_m_s
    both = np.abs(extra.sum(axis=1)) > 1.5 * done.scene.robot.correction_m_s
    last = done.trace["time"].to_numpy() > 0.5 * done.time_s
    still = np.ptp(done.trace["contact"].to_numpy()[last], axis=0)
    return bool(both[last].all() and (still < 1e-6).all())


def cycles(done: pb.Carry) -> bool:
    """Whether corrections of alternating sign follow each other without end."""
    return any(warning.startswith("limit cycle") for warning in done.warnings)


FAILS = {
    "copied-ack": fights,
    "late-ack": drops,
    "late-tilt-down": drops,
    "lost-a-tilt-down": hangs("left"),
    "lost-a-tilt-up": hangs("right"),
    "lost-b-ack": hangs("left", "right"),
    "lost-b-tilt-down": hangs("right"),
    "lost-c-ack": hangs("left", "right"),
    "reboot-fight": fights,
    "reboot-hang": hangs("right"),
    "zone-narrow": cycles,
}


def letters_told(transcript: str) -> dict[str, list[str]]:
    """What each robot sends in a transcript, one letter after the other; lost ones are marked."""
    told: dict[str, list[str]] = {"left": [], "right": []}
    pattern = r"^ +(left|right) sends (\w+)(, lost)?"
    for sender, letter, lost in re.findall(pattern, transcript, re.MULTILINE):
        told[sender].append(letter + lost)
    return told


def letters_sent(done: pb.Carry) -> dict[str, list[str]]:
    """The same of a carry."""
    sent: dict[str, list[str]] = {"left": [], "right": []}
    for m in done.letters:
        sent[m.sender].append(m.letter + (", lost" if m.received_s is None else ""))
    return sent


def test_every_scene_is_known() -> None:
    assert [path.stem for path in SCENES] == sorted(FAILS)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_carry_fails_the_same_way(path: Path) -> None:
    """With Table 2 it does."""
    done = pb.carry(str(path), "distributed")
    assert FAILS[path.stem](done)


@pytest.mark.parametrize(
    "path", [p for p in SCENES if p.stem != "zone-narrow"], ids=lambda p: p.stem
)
def test_the_robots_say_the_same(path: Path) -> None:
    """Letter by letter, up to the transcript's end, what the model's robots said."""
    told = letters_told((KEPT / f"{path.stem}.txt").read_text())
    sent = letters_sent(pb.carry(str(path), "distributed"))
    for robot, letters in told.items():
        assert sent[robot][: len(letters)] == letters


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_without_the_mishap_nothing_fails(path: Path) -> None:
    """The scene without its mishap arrives, with both contacts back in the zero zone."""
    wider = {"tactile.zero_half_width_m": 0.005}
    done = pb.carry(
        str(path), "distributed", overrides={"radio.script": [], "faults.script": []} | wider
    )
    assert not FAILS[path.stem](done)
    assert done.outcome == "delivered"
    assert done.trace is not None
    assert (np.abs(done.trace["contact"].to_numpy()[-1]) < 0.0055).all()
