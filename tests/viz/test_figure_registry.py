# SPDX-License-Identifier: Apache-2.0
"""The registry of figures, the public names of `palmbots.viz`, and the looks of controllers."""

import inspect
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import palmbots as pb
from palmbots import viz
from palmbots.control import registry
from palmbots.control.interface import StepOutput
from palmbots.simulation.result import Carry
from palmbots.viz.save_figure import write_figure
from palmbots.viz.style import controller_looks


class Holding:
    """A controller that never corrects."""

    def step(self, seen):
        return StepOutput()


@pytest.fixture(scope="module")
def short():
    return pb.carry("paper", overrides={"task.distance_m": 0.2})


@pytest.fixture(scope="module")
def sweep():
    return pb.compare("paper", key="radio.latency_s", values=[0.0, 0.2], carries=4)


def pixels(figure: Figure) -> np.ndarray:
    """The drawn figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


def test_figures_of_a_log_equal_those_of_its_carry(short, tmp_path):
    pb.write_log(short, tmp_path / "c.mcap")
    log = pb.read_log(tmp_path / "c.mcap")
    for name in ("timeline", "side_view"):
        draw = viz.FIGURES.get(name)
        assert (pixels(draw(log)) == pixels(draw(short))).all()


def test_save_figure_writes_the_figure_of_plot(short, tmp_path):
    short.save_figure(tmp_path / "carry.png", window=(0.0, 1.0))
    viz.write_figure(tmp_path / "same.png", short.plot(window=(0.0, 1.0)))
    assert (tmp_path / "carry.png").read_bytes() == (tmp_path / "same.png").read_bytes()


def test_figure_from_outside_is_drawn_by_plot(short):
    class Own(Carry):
        figure = "own"

        def plot(self, figure="own", **options):
            return viz.FIGURES.get(str(figure))(self, **options)

    def draw(result, colour="red"):
        figure = Figure()
        figure.subplots().plot(result.trace["time"], result.trace["separation"], color=colour)
        return figure

    viz.FIGURES.register("own", draw)
    try:
        own = Own(**{name: getattr(short, name) for name in short.__dataclass_fields__})
        (line,) = own.plot(colour="#123456").axes[0].lines
        assert line.get_color() == "#123456"
        assert (line.get_ydata() == short.trace["separation"]).all()
        with pytest.raises(pb.PalmbotsError, match="registered already"):
            viz.FIGURES.register("own", lambda result: Figure())
    finally:
        viz.FIGURES.unregister("own")
    with pytest.raises(pb.PalmbotsError, match="figure"):
        viz.FIGURES.get("own")


def test_results_draw_their_own_figure(short, sweep):
    assert len(short.plot().axes) == len(viz.draw_carry(short).axes) > 5
    assert len(sweep.plot().axes) == 4


def test_public_names_are_documented_functions():
    for name in set(dir(viz)) - {"FIGURES"}:
        value = getattr(viz, name)
        assert callable(value), name
        assert inspect.getdoc(value), name


def test_looks_follow_the_order_of_the_registry():
    shipped = controller_looks(registry.controller_names())
    assert list(shipped) == list(registry.controller_names())
    assert len(set(shipped.values())) == len(shipped)
    # The look of a controller does not depend on the others in the figure.
    assert controller_looks(["resilient"])["resilient"] == shipped["resilient"]
    mixed = controller_looks(["Mine", "distributed", "Other", "Mine"])
    assert list(mixed) == ["Mine", "distributed", "Other"]
    assert mixed["distributed"] == shipped["distributed"]
    assert not {mixed["Mine"], mixed["Other"]} & set(shipped.values())
    assert mixed["Mine"] != mixed["Other"]


def test_registered_controller_has_a_look_of_its_own():
    registry.register("holding", Holding)
    try:
        assert (
            controller_looks(["holding"])["holding"]
            not in controller_looks(set(registry.controller_names()) - {"holding"}).values()
        )
    finally:
        registry.unregister("holding")


def test_curves_of_a_sweep_have_the_looks_of_their_controllers(sweep):
    axes: Any = sweep.plot().axes[0]
    looks = controller_looks(row.controller for row in sweep.rows)
    drawn = {
        container.get_label(): to_hex(container.lines[0].get_color()).upper()
        for container in axes.containers
    }
    assert drawn == {name: look.colour for name, look in looks.items()}


BEGINS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF", ".PNG": b"\x89PNG"}


def tiny() -> Figure:
    drawn = Figure(figsize=(2, 1))
    drawn.add_subplot().plot([0, 1], [1, 0])
    return drawn


@pytest.mark.parametrize("suffix", BEGINS)
def test_the_same_figure_is_the_same_file(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for k, second in enumerate(("1000000000", "1700000000")):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", second)  # the time, as far as matplotlib knows
        write_figure(tmp_path / f"{k}{suffix}", tiny())
    one, two = ((tmp_path / f"{k}{suffix}").read_bytes() for k in (0, 1))
    assert one == two
    assert one.startswith(BEGINS[suffix])
