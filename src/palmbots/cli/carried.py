# SPDX-License-Identifier: Apache-2.0
"""A carry with what the commands find out besides."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields

from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.simulation.carry_lines import carry_lines
from palmbots.simulation.result import Carry


@dataclass(frozen=True, repr=False)
class Carried(Carry):
    """A carry, the forecast of its lateral drift, and why it failed."""

    drift_forecast: DriftBudget | None = None
    """The forecast for a curved path in MuJoCo; None: there is none."""
    hint: str | None = field(default=None, metadata=NOT_IN_JSON)
    """On the reason of the outcome, with a command."""
    printed: int = field(default=0, metadata=NOT_IN_JSON)
    """How many of the warnings were printed before the carry."""

    @classmethod
    def of(
        cls,
        carry: Carry,
        printed: Sequence[str],
        forecast: DriftBudget | None = None,
        hint: str | None = None,
    ) -> "Carried":
        """The carry with these warnings, which are printed already, in front of its own."""
        known = {one.name: getattr(carry, one.name) for one in fields(carry)}
        late = (text for text in carry.warnings if text not in printed)
        known["warnings"] = (*printed, *late)
        return cls(**known, drift_forecast=forecast, hint=hint, printed=len(printed))

    def lines(self) -> Iterator[Item]:
        """The carry, without the warnings that are printed already."""
        return carry_lines(self, self.warnings[self.printed :], self.hint)
