# SPDX-License-Identifier: Apache-2.0
"""The analyses that the tests of the figures share."""

import pytest
from matplotlib.figure import Figure

import palmbots as pb
from palmbots.stability.analysis import Analysis
from palmbots.stability.figures.analysis_figures import draw_all
from stability_figures import SCENES

SHORT = ("phi below theta", "phi above theta")  # the others take long


@pytest.fixture(
    scope="session",
    params=[*SHORT, *(pytest.param(s, marks=pytest.mark.soak) for s in SCENES if s not in SHORT)],
)
def analysis(request: pytest.FixtureRequest) -> Analysis:
    source, overrides = SCENES[request.param]
    return pb.analyze(source, overrides=overrides)


@pytest.fixture(scope="session")
def figures(analysis: Analysis) -> dict[str, Figure]:
    return draw_all(analysis)


@pytest.fixture(scope="session")
def paper() -> Analysis:
    return pb.analyze("paper")
