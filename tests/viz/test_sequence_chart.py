# SPDX-License-Identifier: Apache-2.0
"""The message-sequence chart: every message and case of a carry is in it, where it belongs."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation

import palmbots as pb
from palmbots.simulation.result import Carry
from palmbots.viz.sequence_chart import draw_message_sequence

LOST_ACK = {
    "robot.noise_m_s": 0.0,
    "bumps.script": [{"robot": "right", "at_s": 0.4, "shift_m": 0.011}],
    "radio.script": [{"sender": "left", "message": 1, "effect": "lost"}],
    "task.distance_m": 0.3,
}


@pytest.fixture(scope="module")
def lost_ack() -> Carry:
    return pb.carry("paper", "distributed", overrides=LOST_ACK)


def arrows(panel: Axes) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """From where to where, (robot, time)."""
    found = []
    for text in panel.texts:
        if isinstance(text, Annotation) and text.arrow_patch is not None:
            found.append((tuple(text.xyann), tuple(text.xy)))
    return found


def names(figure: Any) -> list[str]:
    return [text.get_text() for panel in figure.axes for text in panel.texts if text.get_text()]


def test_every_message_is_an_arrow(lost_ack: Carry) -> None:
    """From its sender's line when it was sent to its receiver's when it comes; a lost one ends
    between them."""
    (panel,) = draw_message_sequence(lost_ack).axes
    assert [(m.sender, m.kind) for m in lost_ack.message_log] == [
        ("right", "TiltUp"),
        ("left", "Ack"),
    ]
    request, answer = lost_ack.message_log
    assert arrows(panel)[0] == ((1.0, request.sent_s), (0.0, request.received_s))
    (from_x, from_y), (to_x, to_y) = arrows(panel)[1]
    assert (from_x, from_y, to_y) == (0.0, answer.sent_s, answer.sent_s)
    assert 0.2 < to_x < 0.8
    assert names(panel.get_figure())[-2:] == ["TiltUp", "Ack lost"]


def test_cases_are_shaded_where_they_last(lost_ack: Carry) -> None:
    (panel,) = draw_message_sequence(lost_ack).axes
    assert sum(name in ("(a)", "(c)") for name in names(panel.get_figure())) == 2
    bars = [patch for patch in panel.patches if isinstance(patch, Rectangle)]
    starts = {round(bar.get_x() + bar.get_width() / 2): bar.get_y() for bar in bars}
    assert starts == {1: pytest.approx(0.4), 0: pytest.approx(0.45)}  # (a) right, (c) left


def test_names_of_cases_that_follow_at_once_do_not_overlap() -> None:
    """Where requests cross, (a) becomes (b) after a twentieth of a second."""
    crossing = pb.carry(overrides={"task.direction": "backward"})
    assert any(c.case == "b" for c in crossing.corrections)
    figure = draw_message_sequence(crossing)
    figure.canvas.draw()
    for panel in figure.axes:
        boxes = [t.get_window_extent() for t in panel.texts if t.get_text().startswith("(")]
        for k, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[k + 1 :])


@pytest.mark.slow
def test_no_arrow_crosses_the_name_of_a_message() -> None:
    """Where a contact comes back at once, TiltDown is sent as the Ack arrives."""
    at_once = 0
    for seed in (0, 1):
        done = pb.carry(overrides={"robot.noise_m_s": 0.02}, seed=seed)
        at_once += sum(
            after.sent_s - (before.received_s or 0.0) < 0.02
            for before, after in pairwise(done.message_log)
            if (before.kind, after.kind) == ("Ack", "TiltDown")
        )
        figure = draw_message_sequence(done)
        figure.canvas.draw()
        for panel in figure.axes:
            lines = [panel.transData.transform(ends) for ends in arrows(panel)]
            ways = [np.linspace(ends[0], ends[1], 300) for ends in lines]
            boxes = [
                text.get_window_extent().padded(-1)
                for text in panel.texts
                if text.get_text() in ("TiltUp", "TiltDown", "Ack")
            ]
            heads = [label.get_window_extent() for label in panel.get_xticklabels()]
            for k, box in enumerate(boxes):
                assert not any(box.contains(x, y) for way in ways for x, y in way)
                assert not any(box.overlaps(other) for other in boxes[k + 1 :] + heads)
    assert at_once > 1


def test_time_runs_on_from_column_to_column() -> None:
    done = pb.carry("paper", "distributed", seed=1)
    figure = draw_message_sequence(done)
    limits = [panel.get_ylim() for panel in figure.axes]
    assert len(limits) > 2
    for (end, _), (_, start) in pairwise(limits):
        assert end == pytest.approx(start)
    assert sum(len(arrows(panel)) for panel in figure.axes) == done.messages


def test_repeated_beacon_message_has_no_label() -> None:
    done = pb.carry("paper", "resilient", overrides={"task.distance_m": 0.3})
    figure = draw_message_sequence(done)
    assert sum(len(arrows(panel)) for panel in figure.axes) == len(done.message_log)
    last = {"left": "", "right": ""}
    news = 0
    for m in done.message_log:
        news += m.kind != last[m.sender]
        last[m.sender] = m.kind
    assert len([name for name in names(figure) if not name.startswith("(")]) == news
    assert news < len(done.message_log) / 4


def test_reboot_is_marked() -> None:
    broken = [{"kind": "reboot", "robot": "left", "at_s": 0.5, "duration_s": 0.2}]
    changes = LOST_ACK | {"faults.script": broken}
    figure = draw_message_sequence(pb.carry("paper", "distributed", overrides=changes))
    assert "reboot" in names(figure)


def test_scripted_duplicate_is_drawn() -> None:
    copied = [{"sender": "left", "message": 1, "effect": "duplicated", "delay_s": 0.3}]
    done = pb.carry("paper", "distributed", overrides=LOST_ACK | {"radio.script": copied})
    (panel,) = draw_message_sequence(done).axes
    ack = next(m for m in done.message_log if m.kind == "Ack")
    assert ack.received_s is not None
    assert arrows(panel)[-1] == ((0.0, ack.sent_s), (1.0, pytest.approx(ack.received_s + 0.3)))
    assert "Ack again" in [text.get_text() for text in panel.texts]


def test_many_messages_have_lanes_instead_of_arrows() -> None:
    far = {"task.distance_m": 6.0, "robot.noise_m_s": 0.03}
    carry = pb.carry("paper", "shared-sign", overrides=far)
    figure = draw_message_sequence(carry)
    panel = figure.axes[0]
    names = [text for text in panel.texts if text.get_text() in {m.kind for m in carry.message_log}]
    assert len(names) == len({text.get_text() for text in names}) > 3
    lanes = [one for axes in figure.axes for one in axes.collections]
    marks = sum(len(one.get_segments()) for one in lanes if isinstance(one, LineCollection))
    assert marks == len(carry.message_log)
