# SPDX-License-Identifier: Apache-2.0
"""Results of the room: short text, notebook table and figures; the room exports its names."""

import inspect
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

import palmbots as pb
from palmbots import stability
from palmbots._util.results import FIGURES, Result


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    design = pb.design("paper", maximize="com", controller=None, resolution_deg=1.0)
    path = tmp_path_factory.mktemp("certificate") / "design.json"
    design.certificate.save(path)
    analysis = pb.analyze("paper")
    return {
        "analysis": analysis,
        "clearance": analysis.clearance,
        "certificate": design.certificate,
        "check": pb.check(path),
        "design": design,
    }


@pytest.mark.parametrize(
    ("name", "phrases"),
    [
        ("analysis", ("HOLDS", "108.5 to 141.5 mm", "0.094 to 1.046")),
        ("clearance", ("clear", "0.55°")),
        ("certificate", ("CERTIFIED TO HOLD", "property 1")),
        ("check", ("VALID", "250 × 160 mm")),
        ("design", ("9° and 30°", "±2", "certified")),
    ],
)
def test_text_is_short_and_states_the_result(
    name: str, phrases: tuple[str, ...], results: dict[str, Any]
) -> None:
    result = results[name]
    assert isinstance(result, Result)
    text = repr(result)
    assert 1 < len(text.splitlines()) <= 40
    for phrase in phrases:
        assert phrase in text, text


def test_results_draw_their_figures(results: dict[str, Any]) -> None:
    names = ("stability-geometry", "friction-cones", "meeting-points")
    names += ("operating-region", "permitted-com", "tactile-zones")
    assert {*names, "palm-angles"} <= set(FIGURES.names())
    titles = {}
    for name in names:
        figure = results["analysis"].plot(name)
        assert isinstance(figure, Figure)
        titles[name] = figure.axes[0].get_title(loc="left")
    assert titles["operating-region"].startswith("(a) property 1")
    assert isinstance(results["analysis"].plot(), Figure)
    assert isinstance(results["design"].plot(), Figure)
    drawn = results["analysis"].plot("stability-geometry", p_m=(-0.01, 0.02))
    assert any("p = −10.0 mm" in text.get_text() for text in drawn.texts)
    with pytest.raises(pb.PalmbotsError, match="there is no figure of a CheckResult"):
        results["check"].plot()


@pytest.mark.parametrize("name", ["analyze", "certify", "check", "design", "self_check"])
def test_signatures_are_short(name: str) -> None:
    signature = inspect.signature(getattr(pb, name, None) or getattr(stability, name))
    assert len(str(signature)) <= 400
    for position, parameter in enumerate(signature.parameters.values()):
        annotation = parameter.annotation
        shown = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
        assert len(shown) <= 40, (name, parameter)
        is_keyword = parameter.kind in (parameter.KEYWORD_ONLY, parameter.VAR_KEYWORD)
        assert is_keyword == (position >= 1) or name == "check"


def test_importing_the_room_loads_no_slow_package() -> None:
    import subprocess
    import sys

    code = (
        "import sys, palmbots.stability\n"
        "assert not {'matplotlib', 'xarray', 'flint'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parent)
