# SPDX-License-Identifier: Apache-2.0
"""The picture of a carry: everything is there, nothing overlaps, the file is always the same."""

import dataclasses
import itertools

import numpy as np
import pytest

import palmbots as pb
from palmbots.control import registry
from palmbots.viz import carry_figure as figure8
from palmbots.viz.timeline import assign_label_rows, correction_bars, message_news, runs


@pytest.fixture(scope="module")
def delivered():
    return pb.carry("paper", "distributed", seed=0)


@pytest.fixture(scope="module")
def dropped():
    carries = (pb.carry("paper", "none", seed=k) for k in itertools.count())
    return next(c for c in carries if c.outcome == "dropped")


def texts(figure):
    return [t.get_text() for axes in figure.axes for t in axes.texts]


def overlaps(figure):
    """Pairs of texts in the top panel whose boxes overlap."""
    figure.canvas.draw()
    boxes = [(t.get_text(), t.get_window_extent()) for t in figure.axes[0].texts if t.get_text()]
    return [(a, b) for (a, x), (b, y) in itertools.combinations(boxes, 2) if x.overlaps(y)]


def test_every_correction_is_labelled(delivered):
    figure = figure8.draw_carry(delivered)
    labels = [f"{c.label} ({c.case})" for c in delivered.corrections]
    assert len(labels) > 20
    assert set(labels) <= set(texts(figure))
    assert overlaps(figure) == []


def test_assistance_is_marked_from_the_trace(delivered):
    assists = [bar for bar in correction_bars(delivered) if bar.assists]
    assert assists
    case = delivered.trace["case"]
    for bar in assists:
        during = case.sel(side=bar.row, time=slice(bar.start, bar.end - 1e-9))
        assert set(during.to_numpy()) == {"c"}
    assert "(c)" in texts(figure8.draw_carry(delivered))


def test_time_window_shows_its_corrections_only(delivered):
    figure = figure8.draw_carry(delivered, window=(0.0, 6.5))
    shown = {text.split(" ")[0] for text in texts(figure)}
    for c in delivered.corrections:
        assert (c.label in shown) == (c.start_s <= 6.5)
    assert figure.axes[0].get_xlim() == (0.0, 6.5)
    assert overlaps(figure) == []


def test_axes_carry_units_and_share_time(delivered):
    figure = figure8.draw_carry(delivered)
    labels = " ".join(axes.get_ylabel() for axes in figure.axes).replace("\n", " ")
    contacts = "left contact [mm]", "right contact [mm]"
    for wanted in (*contacts, "angle [°]", "[mm]", "speed (thick: commanded) [cm/s]"):
        assert wanted in labels
    assert figure.axes[-1].get_xlabel() == "time [s]"
    assert len({axes.get_xlim() for axes in figure.axes}) == 1


def test_drop_is_stated_in_the_figure(dropped):
    figure = figure8.draw_carry(dropped)
    assert f"dropped: {dropped.reason}" in texts(figure)
    assert "no corrections" in texts(figure)
    assert any("ends of the palm" in text for text in texts(figure))
    assert overlaps(figure) == []


def test_figure_of_a_centralized_carry_shows_its_cases():
    figure = figure8.draw_carry(pb.carry("paper", "centralized", seed=0))
    assert any(text.endswith("(1)") for text in texts(figure))
    assert overlaps(figure) == []


@pytest.mark.parametrize("overrides", [{"task.slope_deg": 20.0}, {"start.left_m": 0.075}])
def test_carry_that_ends_in_the_first_tick_is_handled(overrides):
    done = pb.carry("paper", "none", overrides=overrides)
    assert done.outcome == "dropped"
    assert done.time_s < 1e-9
    figure = figure8.draw_carry(done)
    assert f"dropped: {done.reason}" in texts(figure)
    assert overlaps(figure) == []


@pytest.mark.parametrize("controller", registry.shipped_names())
def test_every_controller_is_drawn(controller):
    """With each kind of message it says, and a mark for it in the key; repeated beacons are not."""
    done = pb.carry("figure8", controller, overrides={"radio.loss": 0.02})
    kinds = {m.kind for m in done.message_log}
    entry = registry.resolve(controller)
    assert (len(kinds) > 1) == (entry.team == "robots" and entry.uses_radio)
    figure = figure8.draw_carry(done)
    keys = [axes.get_legend() for axes in figure.axes] + figure.legends
    assert kinds <= {t.get_text() for key in keys if key for t in key.get_texts()}
    figure.canvas.draw()
    assert all(key.get_window_extent().x1 < figure.bbox.x1 for key in figure.legends)
    news = [m for m, new in message_news(done) if new]
    if entry.is_periodic:
        for side in ("left", "right"):
            said = [m.kind for m in done.message_log if m.sender == side]
            changes = [kind for kind, _ in itertools.groupby(said)]
            assert [m.kind for m in news if m.sender == side] == changes
        assert 10 < len(news) < len(done.message_log)
    else:
        assert news == list(done.message_log)


def test_too_many_corrections_are_not_labelled(delivered):
    many = [
        dataclasses.replace(c, start_s=c.start_s + k * 1e-3, end_s=c.end_s + k * 1e-3)
        for k in range(8)
        for c in delivered.corrections
    ]
    crowded = dataclasses.replace(delivered, corrections=tuple(many))
    assert not any("(" in text for text in texts(figure8.draw_carry(crowded)))


def test_label_rows_do_not_overlap():
    assert assign_label_rows([1.0, 3.0, 5.0], [1.0, 1.0, 1.0], 2) == [0, 0, 0]
    assert assign_label_rows([1.0, 1.5, 2.1], [1.0, 1.0, 1.0], 2) == [0, 1, 0]
    assert assign_label_rows([1.0, 1.1, 1.2], [1.0, 1.0, 1.0], 2) == [0, 1, None]


def test_runs():
    assert runs(np.array([], bool)) == []
    assert runs(np.array([True, True, False, True])) == [(0, 2), (3, 3)]
    assert runs(np.array([False, True, False])) == [(1, 2)]


def test_limits_are_those_of_the_scene():
    """The usable part of the palm, and the lips even where the object stays away from them."""
    short = {"task.distance_m": 0.1, "palm.usable_m": 0.1, "start.left_m": 0.049}
    figure = figure8.draw_carry(pb.carry("paper", "none", overrides=short))
    assert "ends of the usable palm, ±50 mm" in texts(figure)
    curved = {"task.path.kind": "arc", "task.path.lead_in_m": 0.0, "task.distance_m": 0.1}
    lips = {"palm.lip_height_m": 0.03, "palm.lip_clearance_m": 0.02}
    carry = pb.carry("paper", "silent", world="mujoco", overrides={**curved, **lips})
    assert "lips, ±20 mm" in texts(figure8.draw_carry(carry))
