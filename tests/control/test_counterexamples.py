# SPDX-License-Identifier: Apache-2.0
"""Counterexamples of the model checker to Table 2, as carries: each counterexample of verify/ that
has a scene fails in the world with friction and geometry as in the model.
"""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import model_check as explore
import palmbots as pb

KEPT = explore.HERE / "counterexamples"
SCENES = sorted(KEPT.glob("*.toml"))


def hangs(*robots: str) -> Callable[[pb.simulation.Carry], bool]:
    """Whether these robots, and no others, wait at the end for a message that cannot arrive."""

    def check(carry: pb.simulation.Carry) -> bool:
        period = carry.scene.control.period_s
        end = carry.message_log[-1].sent_s + 0.5
        waits = {
            side
            for side, waited in carry.waiting_s.items()
            if waited > carry.time_s - end - period and _same_case(carry, side, end)
        }
        return waits == set(robots)

    return check


def _same_case(carry: pb.simulation.Carry, side: str, since_s: float) -> bool:
    assert carry.trace is not None
    cases = carry.trace["case"].sel(side=side).to_numpy()
    late = cases[carry.trace["time"].to_numpy() > since_s]
    return len(set(late)) == 1 and late[0] != " "


def drops(carry: pb.simulation.Carry) -> bool:
    """Whether a contact runs off its palm although no message is lost."""
    return (carry.outcome, carry.reason, carry.messages_lost) == ("dropped", "off-palm", 0)


def fights(carry: pb.simulation.Carry) -> bool:
    """Whether from some time to the end one robot moves away and the other closer, both faster or
    both slower than the nominal speed, so that no contact moves any more."""
    assert carry.trace is not None
    extra = carry.trace["commanded"].to_numpy() - carry.scene.robot.speed_m_s
    both = np.abs(extra.sum(axis=1)) > 1.5 * carry.scene.robot.correction_m_s
    last = carry.trace["time"].to_numpy() > 0.5 * carry.time_s
    still = np.ptp(carry.trace["contact"].to_numpy()[last], axis=0)
    return bool(both[last].all() and (still < 1e-6).all())


def cycles(carry: pb.simulation.Carry) -> bool:
    """Whether corrections of alternating sign follow each other without end."""
    return any(warning.startswith("limit cycle") for warning in carry.warnings)


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


def messages_in(transcript: str) -> dict[str, list[str]]:
    """The messages of each robot in a transcript, in order; lost ones are marked."""
    table: dict[str, list[str]] = {"left": [], "right": []}
    pattern = r"^ +(left|right) sends (\w+)(, lost)?"
    for sender, name, lost in re.findall(pattern, transcript, re.MULTILINE):
        table[sender].append(name + lost)
    return table


def messages_sent(carry: pb.simulation.Carry) -> dict[str, list[str]]:
    """The same for a carry."""
    sent: dict[str, list[str]] = {"left": [], "right": []}
    for m in carry.message_log:
        sent[m.sender].append(m.kind + (", lost" if m.received_s is None else ""))
    return sent


def test_every_counterexample_scene_has_an_expectation() -> None:
    assert [path.stem for path in SCENES] == sorted(FAILS)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_carry_fails_like_the_counterexample(path: Path) -> None:
    """With Table 2."""
    carry = pb.carry(str(path), "distributed")
    assert FAILS[path.stem](carry)


@pytest.mark.parametrize(
    "path", [p for p in SCENES if p.stem != "zone-narrow"], ids=lambda p: p.stem
)
def test_robots_send_the_messages_of_the_counterexample(path: Path) -> None:
    """Message by message, up to the end of the transcript."""
    result = messages_in((KEPT / f"{path.stem}.txt").read_text())
    sent = messages_sent(pb.carry(str(path), "distributed"))
    for robot, messages in result.items():
        assert sent[robot][: len(messages)] == messages


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_carry_without_the_fault_succeeds(path: Path) -> None:
    """Without its message fault the scene arrives, with both contacts back in the zero zone."""
    wider = {"tactile.zero_half_width_m": 0.005}
    carry = pb.carry(
        str(path), "distributed", overrides={"radio.script": [], "faults.script": []} | wider
    )
    assert not FAILS[path.stem](carry)
    assert carry.outcome == "delivered"
    assert carry.trace is not None
    assert (np.abs(carry.trace["contact"].to_numpy()[-1]) < 0.0055).all()
