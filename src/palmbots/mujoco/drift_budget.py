# SPDX-License-Identifier: Apache-2.0
"""How far an object may drift, and will, on a curved path (`palmbots.mujoco.drift_forecast`)."""

from collections.abc import Iterator
from dataclasses import dataclass

from palmbots._util.confidence_intervals import rate_text
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Table
from palmbots._util.results import Result
from palmbots._util.text import millimetres as _mm
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene

NEAR = 0.8  # fraction of the budget above which there is a warning


@dataclass(frozen=True, repr=False)
class DriftBudget(Result):
    """The allowed and the expected lateral drift of an object on a path [m]."""

    budget_m: float
    """Half of the width of the narrower palm, at which the object tips; with lips, their clearance.
    """
    mean_m: float
    """The largest absolute drift of a carry, averaged over the seeds."""
    most_m: float
    """The same for the worst seed."""
    seeds: int
    tips: int
    """Seeds with which the drift exceeds the budget."""
    askew_deg: float
    """The largest β of the path."""
    lips: bool

    @derived
    def verdict(self) -> str:
        """``kept``, ``near`` the budget for some seeds, or ``beyond`` it."""
        if self.lips:
            return "kept"
        if self.mean_m > self.budget_m:
            return "beyond"
        return "near" if self.most_m > NEAR * self.budget_m else "kept"

    def lines(self) -> Iterator[Item]:
        """One line that states the verdict, then drift, budget and misalignment."""
        verdicts = {
            "kept": "is within the budget",
            "near": "comes near the budget for some seeds",
            "beyond": "exceeds the budget",
        }
        yield f"the forecast lateral drift {verdicts[self.verdict]}"
        yield Table(
            self.value_rows("mean_m", "most_m", "tips", "seeds", "budget_m", "askew_deg", "lips")
        )

    def text(self) -> str:
        """The forecast in one line. With lips there is none of the drift: they stop it."""
        askew = f"(palms misaligned by up to {self.askew_deg:.1f}°)"
        if self.lips:
            return f"lateral drift: lips stop it after {_mm(self.budget_m)} {askew}"
        drops = rate_text(self.tips, self.seeds)
        return (
            f"lateral drift, forecast over {self.seeds} seeds: mean {_mm(self.mean_m)}, "
            f"at most {_mm(self.most_m)}; the object tips at {_mm(self.budget_m)}, which {drops} "
            f"of carries reach {askew}"
        )

    def warning(self) -> str:
        """What is said of a path near the budget, or beyond it."""
        return (
            f"with the worst seed, the object drifts sideways by {1e3 * self.most_m:.0f} of the "
            f"permitted {1e3 * self.budget_m:.0f} mm"
        )

    def refusal(self, scene: Scene, controller: str) -> str:
        """The error message for a path beyond the budget."""
        command = command_text("curve", scene.spelled, controller=controller)
        return (
            f"task.path: the object would drift {_mm(self.mean_m)} sideways and tip at "
            f"{_mm(self.budget_m)}; allowed: less, or --allow-drift-beyond-budget; to try lips, "
            f"other palms and radii, run: {command}"
        )
