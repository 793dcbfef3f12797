# SPDX-License-Identifier: Apache-2.0
"""A carry with what a report says of it besides."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item, Line, quiet, written_file
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.simulation.carry_lines import carry_lines
from palmbots.simulation.outcome_counts import SceneStatistics
from palmbots.simulation.result import Carry


@dataclass(frozen=True, repr=False)
class Carried(Carry):
    """A carry, the forecast of its lateral drift, why it failed, and how often the scene does."""

    drift_forecast: DriftBudget | None = None
    """The forecast for a curved path in MuJoCo; None: there is none."""
    scene_statistics: SceneStatistics | None = None
    """How often this scene fails with this controller, and which do better; None: it takes long."""
    hint: str | None = field(default=None, metadata=NOT_IN_JSON)
    """On the reason of the outcome, with a command."""
    to_measure: tuple[str, str] = field(default=("", ""), metadata=NOT_IN_JSON)
    """The command that counts how often the scene fails, and how long it takes, in words."""
    printed: int = field(default=0, metadata=NOT_IN_JSON)
    """How many of the warnings were printed before the carry."""
    written: tuple[Path, ...] = field(default=(), metadata=NOT_IN_JSON)
    removed: tuple[Path, ...] = field(default=(), metadata=NOT_IN_JSON)
    """Files of an earlier carry in the same folder."""

    @property
    def is_delivered(self) -> bool:
        """Whether the object arrived."""
        return self.outcome == "delivered"

    @classmethod
    def of(
        cls, carry: Carry, known: Sequence[str], *, is_printed: bool = True, **found: Any
    ) -> "Carried":
        """The carry with the warnings that were known before it, which may be printed already, in
        front of its own, and with what was `found` besides."""
        values = {one.name: getattr(carry, one.name) for one in fields(carry)}
        late = (text for text in carry.warnings if text not in known)
        values["warnings"] = (*known, *late)
        return cls(**values, **found, printed=len(known) if is_printed else 0)

    def lines(self) -> Iterator[Item]:
        """The carry, without the warnings that are printed already, the scene's statistics, and the
        files."""
        yield from carry_lines(self, self.warnings[self.printed :], self.hint)
        if self.scene_statistics is not None:
            yield from self.scene_statistics.lines()
        elif self.to_measure[0]:
            command, time = self.to_measure
            yield quiet(
                f"one carry does not show how often this scene fails; counting takes {time}:"
            )
            yield Line(f"run: {command}", indent=2, is_whole=True)
        for path in self.removed:
            yield Line(f"removed {path} of an earlier carry", is_whole=True)
        yield from map(written_file, self.written)
