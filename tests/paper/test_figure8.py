# SPDX-License-Identifier: Apache-2.0
"""Section 5.2 and Figure 8: the story of one run, retold by the built-in scene `figure8`.

The text says that "the robots executed 6 corrective actions in this time period" and then describes
seven, which the figure letters A to G. The scene follows the letters.
"""

import numpy as np
import pytest

from palmbots import carry
from palmbots.simulation import Carry

NOMINAL = 0.06


@pytest.fixture(scope="module")
def run() -> Carry:
    return carry("figure8", "distributed", seed=0)


def commanded(run: Carry, label: str, side: str) -> np.ndarray:
    """A robot's commanded speeds during a correction, less the nominal one."""
    assert run.trace is not None
    c = next(c for c in run.corrections if c.label == label)
    during = run.trace.sel(side=side).where(
        (run.trace.time >= c.start_s) & (run.trace.time < c.end_s), drop=True
    )
    return during.commanded.to_numpy() - NOMINAL


def test_figure8_is_delivered_in_six_and_a_half_seconds(run):
    assert run.outcome == "delivered"
    assert run.time_s == pytest.approx(6.5, abs=0.15)
    assert all(c.end_s < 6.5 for c in run.corrections)


def test_robots_cases_and_assistants(run):
    assert [(c.label, c.robot, c.case, c.assistant) for c in run.corrections] == [
        ("A", "right", "a", "left"),
        ("B", "right", "d", None),
        ("C", "right", "d", None),
        ("D", "right", "d", None),
        ("E", "left", "d", None),
        ("F", "right", "a", "left"),
        ("G", "left", "d", None),
    ]


def test_d_and_e_overlap_and_the_right_robot_finishes_first(run):
    d, e = run.corrections[3:5]
    assert d.start_s < e.start_s < d.end_s < e.end_s


def test_no_other_corrections_overlap(run):
    for first, second in zip(run.corrections, run.corrections[1:], strict=False):
        if (first.label, second.label) != ("D", "E"):
            assert first.end_s <= second.start_s


def test_left_goes_negative_early_in_f_but_assists_to_the_end(run):
    f, g = run.corrections[5:7]
    left = run.trace.sel(side="left")
    time = left.time.to_numpy()
    negative = time[(left.sign.to_numpy() == -1) & (time > f.start_s)][0]
    assert negative < f.start_s + 0.3 * (f.end_s - f.start_s)
    cases = left.case.to_numpy()[(time >= negative) & (time < g.start_s)]
    assisting = cases != " "
    assert set(cases[assisting]) == {"c"}
    assert assisting.sum() > 0.9 * len(cases)  # a tick of idling between (c) and (d)
    # The assistant is released before its own correction starts.
    released = [m.received_s for m in run.message_log if m.kind == "TiltDown"][-1]
    assert released is not None and released < g.start_s


def test_order_of_messages(run):
    assert [(m.sender, m.receiver, m.kind) for m in run.message_log] == 2 * [
        ("right", "left", "TiltUp"),
        ("left", "right", "Ack"),
        ("right", "left", "TiltDown"),
    ]
    for tilt_up, ack, tilt_down in (run.message_log[:3], run.message_log[3:]):
        assert tilt_up.sent_s < tilt_up.received_s < ack.sent_s < ack.received_s
        assert ack.received_s < tilt_down.sent_s


def test_correction_a_right_robot_moves_only_after_the_acknowledgment(run):
    speeds = run.trace.sel(side="right").commanded.to_numpy()
    moved = float(run.trace.time[np.flatnonzero(speeds != NOMINAL)[0]])
    ack = next(m for m in run.message_log if m.kind == "Ack")
    assert moved == pytest.approx(ack.received_s, abs=1e-9)
    # An Ack says that the palm has turned.
    left = run.trace.sel(side="left")
    at_ack = left.palm.to_numpy()[np.searchsorted(left.time.to_numpy(), ack.sent_s - 1e-9)]
    assert np.degrees(at_ack) == pytest.approx(5, abs=1e-9)


@pytest.mark.parametrize(
    ("label", "side", "sign"),
    [
        ("A", "right", 1),  # right speeds up: the separation grows
        ("B", "right", -1),  # right slows down: it shrinks
        ("C", "right", -1),
        ("D", "right", -1),
        ("E", "left", 1),  # left speeds up: it shrinks
        ("F", "right", 1),
        ("G", "left", 1),
    ],
)
def test_signs_of_the_speed_changes(run, label, side, sign):
    changes = commanded(run, label, side)
    assert set(np.sign(changes.round(12))) == {0, sign}
    assert np.abs(changes).max() == pytest.approx(0.03)


def test_palms_tilt_up_from_15_to_5_degrees(run):
    palms = np.degrees(run.trace.palm.to_numpy())
    assert palms.min() == pytest.approx(5)
    assert palms.max() == pytest.approx(15)
