# SPDX-License-Identifier: Apache-2.0
"""What `palmbots derive --policy FILE.toml` finds: the algorithm of the file, and its check."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from palmbots._types import SIDES, BySide
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, bold, good, quiet, verdict, warn_word
from palmbots._util.results import Result
from palmbots.derivation.derived_rules import RuleRow, rule_rows
from palmbots.derivation.distributed_algorithm import Machine
from palmbots.derivation.global_policy import signs_text
from palmbots.derivation.local_rules import Conflict, Derivation
from palmbots.derivation.policy_file import PolicyTable, Row
from palmbots.derivation.rule_lines import rules_table, titled
from palmbots.derivation.run_chart import chart
from palmbots.derivation.verification import MEANINGS, Verification

_MARKS = {1: "+", 0: "0", -1: "-"}


@dataclass(frozen=True)
class VerificationRow:
    """The check of an algorithm in every run."""

    proved: bool
    states: int
    worst_turns: int
    """The longest run without disturbances to the goal."""
    counterexamples: dict[str, tuple[str, ...]]
    """By property that fails: the shortest run that shows it, as a sequence chart."""


@dataclass(frozen=True, repr=False)
class DerivedPolicy(Result):
    """The rules that follow from a policy file, and the check of their algorithm."""

    policy: str
    """The name of the file."""
    table: PolicyTable = field(metadata=NOT_IN_JSON)
    derivation: Derivation = field(metadata=NOT_IN_JSON)
    reasons: tuple[str, ...]
    """Why no algorithm follows; empty: one does."""
    machines: BySide[Machine] | None
    """The state machines of the robots; None: no algorithm follows."""
    found: Verification | None = field(default=None, metadata=NOT_IN_JSON)
    """The check; None: there is nothing to check."""

    @derived
    def description(self) -> str:
        """As in the file."""
        return self.table.description

    @derived
    def rows(self) -> dict[str, Row]:
        """The rows of the file, by the signs of both contacts, as in ``+0``."""
        return {_MARKS[a] + _MARKS[b]: row for (a, b), row in self.table.rows.items()}

    @derived
    def rules(self) -> dict[str, RuleRow]:
        """The programs by name."""
        return rule_rows(self.derivation)

    @derived
    def is_table_2(self) -> bool:
        """Whether the rules are (a), (c) and (d) of Table 2."""
        return self.derivation.is_table_2

    @derived
    def verification(self) -> VerificationRow | None:
        """What the check has found."""
        one = self.found
        if one is None:
            return None
        charts = {
            name: tuple(chart(one.starts[name], run, one.loop if name == "progress" else 0))
            for name, run in one.counterexamples.items()
        }
        return VerificationRow(one.holds, one.states, one.worst_turns, charts)

    @property
    def holds(self) -> bool:
        """Whether an algorithm follows and passes its check."""
        return self.found is not None and self.found.holds

    def lines(self) -> Iterator[Item]:
        """The rules, and what the check of their algorithm has found."""
        yield Line(
            verdict(not self.reasons, "DERIVED", "REFUSED"),
            bold(f"  {'no' if self.reasons else 'a'} distributed algorithm"),
            bold(" follows" if self.reasons else ""),
            quiet(f"   policy {self.policy}"),
        )
        if self.description:
            yield quiet(self.description)
        for reason in self.reasons:
            yield Line(warn_word("reason: "), reason)
        yield from self._row_lines()
        yield from rules_table(self.derivation)
        if self.reasons:
            return
        if self.derivation.conflicts:
            yield from self._conflicts()
        if self.found is not None:
            yield from _check(self.found)

    def _row_lines(self) -> Iterator[Item]:
        """What each row gives."""
        derivation, rows = self.derivation, []
        for step in derivation.steps:
            case = derivation.policy[step.case - 1]
            guards = [g for g in derivation.guards if (g.case, g.step) == (step.case, step.number)]
            alone = len(step.owners) == 1 and all(g.dropped for g in guards)
            rows.append((
                signs_text(case.signs),
                f"{step.move.direction} until {step.move.end}",
                ", ".join(step.palms),
                good(SIDES[step.owners[0]]) if alone else warn_word("none"),
                guards[0].reason if guards else "",
            ))  # fmt: skip
        title = "Rows, and the robot that can follow each one"
        yield from titled(title, rows, "row", "move", "palms", "robot", "because")

    def _conflicts(self) -> Iterator[Item]:
        rows = [
            (
                signs_text(signs),
                "∥".join(f"({name})" for name in conflict.rules),
                _order(self.table, conflict, signs),
            )
            for conflict in self.derivation.conflicts
            for signs in conflict.signs
        ]
        yield from titled("Signs at which both robots have a rule", rows, "signs", "rules", "order")


def _order(table: PolicyTable, conflict: Conflict, signs: tuple[int, int]) -> str:
    if conflict.asking == 0:
        return "nothing orders them: neither robot asks"
    first = table.first(signs)
    who = SIDES[first if first is not None else 0]
    reason = "by its row" if first is not None else "by convention: the row moves either contact"
    return f"{who} first, {reason}"


def _check(found: Verification) -> Iterator[Item]:
    turns = f"; the goal is reached within {found.worst_turns} turns" if found.holds else ""
    yield ""
    yield Line(
        verdict(found.holds, "PROVED", "NOT PROVED"),
        bold(f"  every run of the abstract world, {found.states:,} states{turns}"),
    )
    for name, meaning in MEANINGS.items():
        fails = name in found.counterexamples
        word = warn_word("not checked")
        if fails or found.checks(name):
            word = verdict(not fails, "holds", "fails")
        yield Line(bold(f"{name:9}"), word, quiet(f"  {'' if fails else 'never: '}{meaning}"))
    for line in failure_lines(found, found.fails):
        yield Line(line, is_whole=True)


def failure_lines(found: Verification, names: Sequence[str]) -> list[str]:
    """The shortest run against each of these properties, as sequence charts."""
    lines: list[str] = []
    for name in names:
        loop = found.loop if name == "progress" else 0
        lines += ["", f"The shortest run against {name}: {MEANINGS[name]}."]
        lines += chart(found.starts[name], found.counterexamples[name], loop)
    return lines
