# SPDX-License-Identifier: Apache-2.0
"""Pictures of curved paths: the plan view, the panel across, films; their content is looked at."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Polygon
from PIL import Image

import palmbots as pb
from palmbots.mujoco.figures import plan_view
from palmbots.mujoco.film import VideoRenderer
from palmbots.mujoco.overlay import Overlay
from palmbots.simulation.result import Carry
from palmbots.viz import carry_figure as figure8

ARC = {"task.path.kind": "arc", "task.path.radius_m": 0.5, "task.distance_m": 0.7}
SMALL = (480, 270)


@pytest.fixture(scope="module")
def done() -> Carry:
    return pb.carry("paper", world="mujoco", seed=1, overrides=ARC)


def test_the_plan_shows_tracks_and_object_where_they_were(done: Carry) -> None:
    figure = plan_view.draw_plan_view(done)
    (panel,) = figure.axes
    tracks = {line.get_linestyle(): line for line in panel.lines if np.size(line.get_xdata()) > 500}
    assert done.trace is not None
    left = tracks["-"]
    assert np.asarray(left.get_xdata()) == pytest.approx(done.trace["pivot_x"].sel(side="left"))
    outlines = [p for p in panel.patches if isinstance(p, Polygon)]
    assert len(outlines) == 7
    first, last = (np.asarray(p.get_xy())[:4] for p in (outlines[0], outlines[-1]))
    assert first.mean(axis=0) == pytest.approx((0.0, 0.0), abs=2e-3)
    middle = [float(done.trace[f"vertex_{n}"][-1].mean()) for n in "xy"]
    assert last.mean(axis=0) == pytest.approx(middle, abs=2e-3)
    edge = last[1] - last[0]
    assert np.hypot(*edge) == pytest.approx(0.25, abs=2e-3)
    assert edge[1] > 0.1  # it has turned with its path
    assert panel.get_aspect() == 1.0


def test_plan_view_is_written_as_an_image(done: Carry, tmp_path: Path) -> None:
    plan_view.save(done, tmp_path / "plan.png")
    with Image.open(tmp_path / "plan.png") as image:
        pixels = np.asarray(image.convert("RGB"), dtype=int)
    for colour in ((0, 114, 178), (213, 94, 0), (176, 0, 32)):  # tracks, arrows
        assert (np.abs(pixels - colour).max(axis=2) < 30).sum() > 50


def test_lateral_panel_exists_on_curved_paths_only(done: Carry) -> None:
    panels = {axes.get_ylabel(): axes for axes in figure8.draw_carry(done).axes}
    across = panels["across\npalm [mm]"]
    drawn = np.concatenate([line.get_ydata() for line in across.lines[:2]])
    assert done.lateral_peak_m is not None
    peak = 1e3 * max(map(abs, done.lateral_peak_m.values()))
    assert np.abs(drawn).max() == pytest.approx(peak, rel=0.01)
    straight = pb.carry("paper", world="mujoco", overrides={"task.distance_m": 0.05})
    assert "across\npalm [mm]" not in {a.get_ylabel() for a in figure8.draw_carry(straight).axes}


def test_the_film_turns_with_the_pair_and_shows_the_path(
    done: Carry, monkeypatch: pytest.MonkeyPatch
) -> None:
    with VideoRenderer(done, SMALL) as studio:
        image = studio.picture(len(studio._times) - 1)
        turned = studio._camera.azimuth - 96.0
        monkeypatch.setattr(Overlay, "path", lambda *_: None)
        bare = studio.picture(len(studio._times) - 1)
    assert done.trace is not None
    assert turned == pytest.approx(np.degrees(done.trace["yaw"][-1].mean()), abs=2)
    assert turned > 20
    box = np.abs(np.asarray(image, dtype=int) - (212, 180, 100)).max(axis=2) <= 40
    assert 0.35 < np.nonzero(box)[1].mean() / SMALL[0] < 0.65  # the box is in the middle
    changed = np.abs(np.asarray(image, dtype=int) - np.asarray(bare, dtype=int)).max(axis=2) > 30
    assert changed.sum() > 200
    assert changed.sum() < 0.1 * SMALL[0] * SMALL[1]
