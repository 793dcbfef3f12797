# SPDX-License-Identifier: Apache-2.0
"""How far an object may drift, and will, on a curved path (`palmbots.mujoco.drift_forecast`)."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Table
from palmbots._util.results import Result
from palmbots._util.text import millimetres as _mm

_NEAR = 0.8  # fraction of the budget above which there is a warning


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
    askew_deg: float
    """The largest β of the path."""
    lips: bool
    lip_room_m: float
    """The smallest clearance at which lips do not jam."""

    @derived
    def verdict(self) -> str:
        """``kept``, ``near`` the budget for some seeds, or ``beyond`` it."""
        if self.lips:
            return "kept"
        if self.mean_m > self.budget_m:
            return "beyond"
        return "near" if self.most_m > _NEAR * self.budget_m else "kept"

    def lines(self) -> Iterator[Item]:
        """One line that states the verdict, then drift, budget and misalignment."""
        verdicts = {
            "kept": "is within the budget",
            "near": "comes near the budget for some seeds",
            "beyond": "exceeds the budget",
        }
        yield f"the forecast lateral drift {verdicts[self.verdict]}"
        yield Table(self.value_rows("mean_m", "most_m", "seeds", "budget_m", "askew_deg", "lips"))

    def text(self) -> str:
        """The forecast in one line."""
        limit = "the lips allow" if self.lips else "the object tips at"
        return (
            f"lateral drift, forecast over {self.seeds} seeds: mean {_mm(self.mean_m)}, "
            f"at most {_mm(self.most_m)}; {limit} {_mm(self.budget_m)} (palms misaligned by up to "
            f"{self.askew_deg:.1f}°)"
        )

    def refusal(self) -> str:
        """The error message for a path beyond the budget."""
        return (
            f"task.path: the object would drift {_mm(self.mean_m)} sideways and tip at "
            f"{_mm(self.budget_m)}; allowed: larger radii, a shorter path, wider palms, lips "
            f"(palm.lip_height_m=0.03 palm.lip_clearance_m={self._clearance():g}), or "
            "--allow-drift-beyond-budget"
        )

    def _clearance(self) -> float:
        """A clearance for lips, with a margin."""
        return math.ceil(1e3 * (1.25 * self.lip_room_m + 2e-3)) / 1e3
