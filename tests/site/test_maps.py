# SPDX-License-Identifier: Apache-2.0
"""The maps and intervals of the page's core are those of the package."""

import math

import numpy as np
import pytest
from playwright.sync_api import Page

import palmbots as pb
from palmbots._util.confidence_intervals import rate_interval
from palmbots.mechanics.contact_modes import contact_modes_batch
from palmbots.scene.scene import load_scene
from palmbots.stability.problem import stability_problem
from site_pages import Open


def exports(page: Page, call: str) -> list[float]:
    """The numbers that an export of the page's core returns for the scene `paper`."""
    return page.evaluate(
        """async call => {
          const url = performance.getEntriesByType('resource').map(e => e.name)
            .find(name => name.endsWith('.wasm'));
          const stop = () => { throw new Error('stopped'); };
          const wasi = { fd_close: stop, fd_seek: stop, fd_write: stop };
          const { instance } = await WebAssembly.instantiateStreaming(
            fetch(url), { wasi_snapshot_preview1: wasi });
          const m = instance.exports;
          m._initialize();
          const inf = Infinity;
          const palm = [0.15, 0, 0.3, NaN, 5, 15, 50];
          const robot = [0.06, 0.03, 0.5, 0.2, 0.01, 0.5, 0, 0];
          const scene = [4, 0, 0, .25, 0, .25, .16, 0, .16, 0, 1, .125, .04, ...palm, ...palm,
            ...robot, ...robot, 3, -1, -inf, -.005, 0, -.005, .005, 1, .005, inf, 0, .01, 1, 0, .1,
            .05, 0, 0, 0, 0, 0, 1, 0, .1, 0, .05, 0, 0, 0, 0, 0, .5, 0, 0, 0, .004, 0, 0, 1.5, 1,
            0, 1, .05, NaN];
          new Float64Array(m.memory.buffer, m.input(), scene.length).set(scene);
          m.set_scene();
          const at = eval(call)(m);
          return Array.from(new Float64Array(m.memory.buffer, at, m.length()));
        }""",
        call,
    )


def test_maps_equal_those_of_the_package(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    shallow, steep = math.radians(5), math.radians(15)
    places = 0.075 * 2.6 * ((np.arange(20) + 0.5) / 10 - 1)
    left, right = np.meshgrid(places, places)
    found = contact_modes_batch(
        width=0.25, com_x=0.125, com_y=0.04, theta_left=shallow, theta_right=steep,
        p_left=left, p_right=right, friction_left=0.3, friction_right=0.3,
    )  # fmt: skip
    for closing, modes in ((1, found.closing), (0, found.opening)):
        seen = exports(page, f"m => m.contact_mode_map({shallow}, {steep}, {closing}, 20, 2.6)")
        assert seen == modes.ravel().tolist()
    problem = stability_problem(load_scene("paper"))
    grid = np.radians(np.arange(0.0, 40.0, 4.0))
    tolerance, clearance = problem.envelope().map(
        grid, grid, (0.125, 0.125), 0, 10.0, np.empty((0, 0))
    )
    step = math.radians(4.0)
    seen = np.array(exports(page, f"m => m.tolerance_map(0, {step}, 10, 0, 10, 0.075)")).reshape(
        -1, 2
    )
    np.testing.assert_allclose(seen[:, 0], tolerance.ravel(), rtol=1e-9)
    np.testing.assert_allclose(seen[:, 1], clearance.ravel(), rtol=1e-9)
    for k, n in ((0, 50), (3, 50), (50, 50), (17, 1000)):
        np.testing.assert_allclose(
            exports(page, f"m => m.rate_interval({k}, {n})"), rate_interval(k, n), rtol=1e-12
        )


@pytest.mark.parametrize(("shallow", "steep"), [(5, 15), (3, 21), (8, 12)])
def test_the_permitted_coms_are_those_of_analyze(
    open_page: Open, shallow: float, steep: float
) -> None:
    """At these angles, whatever those of the scene are."""
    page = open_page("#carry?t=1")
    angles = ", ".join(map(str, np.radians([shallow, steep, shallow, steep])))
    bits = exports(page, f"m => m.com_map(0, 0.25, 0.0399, 0.0401, 1000, 1, {angles})")
    both = [k * 0.25 / 1000 for k, bit in enumerate(bits) if bit == 3]
    found = pb.analyze(
        "paper", overrides={"palm.shallow_deg": shallow, "palm.steep_deg": steep}
    ).com_x_m
    assert found is not None
    assert (both[0], both[-1]) == pytest.approx(found, abs=3e-4)
