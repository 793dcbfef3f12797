# SPDX-License-Identifier: Apache-2.0
"""What people read of derived rules."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from palmbots._types import SIDES
from palmbots._util.report import (
    Item,
    Line,
    Table,
    bad,
    bold,
    good,
    quiet,
    verdict,
    warn_word,
)
from palmbots._util.text import plural
from palmbots.derivation.derived_rules import counts_by_permission, sorted_departures
from palmbots.derivation.global_policy import signs_text
from palmbots.derivation.local_rules import Derivation
from palmbots.derivation.permissions import LEVELS

if TYPE_CHECKING:
    from palmbots.derivation.derived_rules import DerivedRules
    from palmbots.derivation.refinement import Refinement


def rule_lines(found: "DerivedRules") -> Iterator[Item]:
    """The rules with their sources, then each controller compared with the policy."""
    derivation = found.derivation
    whether = "are" if found.is_table_2 else "are not"
    yield Line(
        verdict(found.holds, "DERIVED", "FAULTY"),
        bold(f"  the rules {whether} Table 2's (a), (c) and (d)"),
        quiet(f"   policy {found.name}"),
    )
    for finding in found.findings:
        yield Line(warn_word("finding: "), finding)
    yield from _moves(derivation)
    yield from rules_table(derivation)
    yield from _conflicts(derivation)
    if found.refinements:
        yield from _refinement(found)
        for controller, refinement in found.refinements.items():
            yield from _departures(controller, refinement, found.shows_runs)


def titled(title: str, rows: Sequence[Sequence[str]], *heads: str) -> Iterator[Item]:
    """An empty line, and a table with a title."""
    yield ""
    yield Table(rows, heads, gap=2, title=title)


def _moves(derivation: Derivation) -> Iterator[Item]:
    """Each move with its owner, and the guards that the owner does not sense."""
    rows = []
    for step in derivation.steps:
        raised = SIDES[step.palms.index("shallow")] if "shallow" in step.palms else ""
        owners = SIDES[step.owners[0]] if len(step.owners) == 1 else "both"
        guards = [g for g in derivation.guards if (g.case, g.step) == (step.case, step.number)]
        word, reason = "", ""
        if guards:
            dropped = all(g.dropped for g in guards)
            word, reason = good("dropped") if dropped else warn_word("kept"), guards[0].reason
        move = f"{step.move.direction} until {step.move.end}"
        texts = ", ".join(map(str, guards))
        rows.append((str(step.case), move, raised, owners, texts, word, reason))
    yield from titled(
        "Moves, their owners, and guards that the owner does not sense",
        rows, "case", "move", "up", "owner", "guard", "", "because",
    )  # fmt: skip
    if derivation.joint:
        cases = " and ".join(str(case) for case in sorted({s.case for s in derivation.joint}))
        yield f"Cases {cases} need both sensors: they give no rule, only the conflicts below."


def rules_table(derivation: Derivation) -> Iterator[Item]:
    """The programs side by side, as in Table 2."""
    heads, columns = [], []
    for name, program in sorted(derivation.programs.items()):
        if name in derivation.rules:
            who = " and ".join(SIDES[robot] for robot in derivation.robots[name])
            of = f"{who}, {_sources(derivation, name)}"
        else:
            of = "the server"
        heads.append(f"({name})" if name in derivation.table_2 else name)
        columns.append([quiet(of), f"if {program.when}", *program.lines])
    longest = max(map(len, columns), default=0)
    rows = [tuple(c[k] if k < len(c) else "" for c in columns) for k in range(longest)]
    yield from titled("Rules", rows, *heads)


def _sources(derivation: Derivation, name: str) -> str:
    """The cases from which a rule follows, or the rows of a policy file."""
    numbers = sorted({case for case, _ in derivation.sources[name]})
    cases = [derivation.policy[number - 1] for number in numbers]
    if all(case.angles is None for case in cases):
        return f"case {', '.join(map(str, numbers))}"
    return f"rows {' '.join(signs_text(case.signs) for case in cases)}"


def _conflicts(derivation: Derivation) -> Iterator[Item]:
    rows = [
        (
            "∥".join(f"({name})" for name in conflict.rules),
            " ".join(map(signs_text, conflict.signs)),
            "clash" if conflict.palms_clash else "agree",
            "clash" if conflict.moves_clash else "agree",
            "case " + ", ".join(map(str, conflict.cases)) if conflict.cases else "",
            conflict.order + _kept_in_table_2(derivation, conflict.asking),
        )
        for conflict in derivation.conflicts
    ]
    yield from titled(
        "Conflicts: rules of both robots that hold at once",
        rows, "rules", "signs", "palms", "motion", "policy", "what determines the order",
    )  # fmt: skip


def _kept_in_table_2(derivation: Derivation, asking: int) -> str:
    """The lines of Table 2 about a conflict."""
    if asking == 2:
        lines = derivation.table_2["b"].lines
        return f". Table 2's (b): {', '.join(lines[2:])}"
    return "" if asking else ". Table 2 leaves this open"


def _refinement(found: "DerivedRules") -> Iterator[Item]:
    rows = []
    for controller, one in found.refinements.items():
        counts = map(str, counts_by_permission(one).values())
        reach = verdict(not (one.stuck or one.falls), "in reach", "lost")
        rows.append((controller, str(one.states), *counts, _verdict(one), reach))
    yield from titled(
        "Motions in every run, by what permits them",
        rows, "controller", "states", *LEVELS, "nothing", "verdict", "nominal",
    )  # fmt: skip
    yield quiet(
        "policy: the policy permits the motion. Weakenings, each in addition to those before: "
        "rules: without the dropped guards. at once: while the other robot runs a rule that is not "
        "ordered with this one. begun: until the first unit of a motion ends that began while its "
        "own guard held. nominal: p = 0, palms steep, no motion."
    )


def _verdict(found: "Refinement") -> str:
    if found.needs is None:
        return bad("departs")
    return good("refines" if found.needs == "policy" else "refines, weakened")


def _departures(controller: str, found: "Refinement", runs: bool) -> Iterator[Item]:
    if not found.departures:
        return
    yield ""
    yield bold(f"Where {controller} departs from the policy")
    for number, departure in enumerate(sorted_departures(found), 1):
        kind = departure.kind
        yield Line(
            bold(f"{number}. in ({kind.case}), {kind.differs}"),
            f"  permitted by: {kind.level}" if kind.level else bad("  permitted by nothing"),
            quiet(f", {plural(len(departure.motions), 'motion')}"),
        )
        yield Line(f"{departure.explanation}.", indent=3)
        if runs:
            for line in departure.transcript():
                yield Line(quiet(line), indent=6, is_whole=True)
