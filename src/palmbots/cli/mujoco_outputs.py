# SPDX-License-Identifier: Apache-2.0
"""What `palmbots carry --world mujoco` shows: the viewer, and the forecast of the drift."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from palmbots.cli._progress import progress
from palmbots.cli._warnings import warn
from palmbots.errors import SceneError

if TYPE_CHECKING:
    from palmbots.control.registry import ControllerEntry
    from palmbots.mujoco.drift_budget import DriftBudget
    from palmbots.scene.scene import Scene


@contextmanager
def viewer(wanted: bool) -> Iterator[Callable[[Any], None] | None]:
    """Open MuJoCo's viewer if wanted; yields the function that shows a world in it, or None."""
    if not wanted:
        yield None
        return
    from palmbots.mujoco.viewer import Viewer

    with Viewer() as window:
        yield window.show


def drift_budget(
    scene: "Scene", controller: "ControllerEntry", *, quiet: bool, accept_excess: bool
) -> "DriftBudget":
    """Forecast the lateral drift on a curved path, print it, and warn near the limit.

    Raises:
        SceneError: lips would jam, or the drift exceeds the budget and that is not accepted.
    """
    from palmbots.cli.console import report_console
    from palmbots.mujoco.drift_forecast import forecast_drift

    with progress("forecasting the drift", quiet) as report:
        budget = forecast_drift(scene, controller, on_progress=report)
    if budget.verdict == "beyond" and not accept_excess:
        raise SceneError(budget.refusal(scene, controller.name))
    if not quiet:
        report_console().print(budget.text(), style="dim")
    if budget.verdict != "kept":
        warn(
            f"with the worst seed, the object drifts sideways by {1e3 * budget.most_m:.0f} of the "
            f"permitted {1e3 * budget.budget_m:.0f} mm"
        )
    return budget
