# SPDX-License-Identifier: Apache-2.0
"""An answer in words, and what every answer about carries needs: rates of failure, and the best
controller."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from palmbots._util.confidence_intervals import rate_text
from palmbots._util.report import Item, Line, Marked, Table, bad, bold, good, quiet, warn_word
from palmbots._util.text import millimetres
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.scene.scene import Scene
from palmbots.scene.sides import on_every_side
from palmbots.simulation.outcome_counts import SMALL, OutcomeCounts

Verdict = Literal["yes", "likely", "partly", "no", "open"]
WORDS: dict[Verdict, Marked] = {
    "yes": good("YES"),
    "likely": good("LIKELY"),
    "partly": warn_word("PARTLY"),
    "no": bad("NO"),
    "open": quiet("NOT TRIED"),
}


@dataclass(frozen=True)
class Answer:
    """One question about the scene, and its answer in words."""

    question: str
    verdict: Verdict
    """``yes``: nothing to change. ``likely``: it never failed, in few trials. ``partly``: with
    conditions. ``open``: not tried."""
    text: str
    command: str
    """The command that answers the question in more detail."""

    @property
    def word(self) -> str:
        """The verdict as it is printed."""
        return WORDS[self.verdict]

    def lines(self, table: Table | None = None) -> Iterator[Item]:
        """The answer, and the numbers behind it."""
        yield Line(bold(f"{self.question}  "), WORDS[self.verdict], f"  {self.text}")
        if table is not None:
            yield table
        yield Line(quiet(f"more: {self.command}"), indent=2, is_whole=True)


def failures(one: OutcomeCounts) -> str:
    """The share of carries that do not deliver, in words."""
    return rate_text(one.dropped + one.stalled, one.carries)


def suffices(one: OutcomeCounts) -> bool:
    """Whether the whole interval of its failure rate is at most the rate that defines σ*."""
    return one.failure_interval[1] <= SMALL


def best_of(counts: Sequence[OutcomeCounts]) -> OutcomeCounts | None:
    """The recommended controller if it suffices or none fails less often, else the one that fails
    least often; None: no carry of any controller delivers."""
    usable = [one for one in counts if one.failure_rate < 1]
    named = [one for one in usable if one.controller == RECOMMENDED and suffices(one)]
    usable.sort(key=lambda one: (one.failure_rate, one.controller != RECOMMENDED))
    return (named or usable or [None])[0]


def swept(scene: Scene, key: str) -> str:
    """The key to sweep: that of the left side if both sides override the key."""
    return next(iter(on_every_side(scene, {key: None})))


def reached(counts: OutcomeCounts) -> str:
    """How far contacts got: what was seen in so many carries, and no bound."""
    assert counts.farthest_m is not None
    count = counts.carries - counts.dropped - counts.stalled
    carries = "1 carry" if count == 1 else f"{count:,} carries"
    return (
        f"in {carries} with {counts.controller} no contact got farther from its pivot than "
        f"{millimetres(counts.farthest_m)}"
    )


def arrived(counts: OutcomeCounts) -> str:
    """How many of how many carries deliver."""
    return f"{counts.carries - counts.dropped - counts.stalled} of {counts.carries}"
