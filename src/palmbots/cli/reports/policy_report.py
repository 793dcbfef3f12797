# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots derive --policy FILE.toml`, and the same as one JSON object."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from palmbots._types import SIDES
from palmbots.cli.console import BAD, GOOD, QUIET, report_console
from palmbots.cli.reports.derivation_report import report_table, rules_summary, rules_table
from palmbots.derivation.global_policy import signs_text
from palmbots.derivation.run_chart import chart
from palmbots.derivation.verification import MEANINGS

if TYPE_CHECKING:
    from palmbots.derivation.distributed_algorithm import Machine
    from palmbots.derivation.local_rules import Conflict, Derivation
    from palmbots.derivation.policy_file import PolicyTable
    from palmbots.derivation.verification import Verification


def policy_report(
    policy: str,
    table: "PolicyTable",
    derivation: "Derivation",
    reasons: list[str],
    found: "Verification | None",
    console: Console | None = None,
) -> None:
    """Print the rules that follow from a policy file, and what the check of their algorithm found.

    Args:
        policy: the name of the file.
        table: its rows.
        derivation: the rules.
        reasons: why no algorithm follows from them; empty: one does.
        found: the check; None: there is no algorithm, or it was not checked.
        console: where to print.
    """
    console = console or report_console()
    head = Text("REFUSED" if reasons else "DERIVED", style=BAD if reasons else GOOD)
    what = "no distributed algorithm follows" if reasons else "a distributed algorithm"
    head.append(f"  {what}", "bold").append(f"   policy {policy}", QUIET)
    console.print(head)
    if table.description:
        console.print(Text(table.description, QUIET))
    for reason in reasons:
        console.print(Text("reason: ", style="bold yellow").append(reason, style="default"))
    _rows(console, derivation)
    rules_table(console, derivation)
    if reasons:
        return
    if derivation.conflicts:
        _conflicts(console, table, derivation)
    if found is not None:
        _check(console, found)


def _rows(console: Console, derivation: "Derivation") -> None:
    """Print what each row gives."""
    table = report_table("\nRows, and the robot that can follow each one", "row", "move", "palms",
                         "robot", "because")  # fmt: skip
    for step in derivation.steps:
        case = derivation.policy[step.case - 1]
        guards = [g for g in derivation.guards if (g.case, g.step) == (step.case, step.number)]
        alone = len(step.owners) == 1 and all(g.dropped for g in guards)
        table.add_row(
            signs_text(case.signs),
            f"{step.move.direction} until {step.move.end}",
            ", ".join(step.palms),
            Text(SIDES[step.owners[0]], "green") if alone else Text("none", "yellow"),
            guards[0].reason if guards else "",
        )
    console.print(table)


def _conflicts(console: Console, table: "PolicyTable", derivation: "Derivation") -> None:
    shown = report_table("\nSigns at which both robots have a rule", "signs", "rules", "order")
    for conflict in derivation.conflicts:
        for signs in conflict.signs:
            rules = "∥".join(f"({name})" for name in conflict.rules)
            shown.add_row(signs_text(signs), rules, _order(table, conflict, signs))
    console.print(shown)


def _order(table: "PolicyTable", conflict: "Conflict", signs: tuple[int, int]) -> str:
    if conflict.asking == 0:
        return "nothing orders them: neither robot asks"
    first = table.first(signs)
    who = SIDES[first if first is not None else 0]
    reason = "by its row" if first is not None else "by convention: the row moves either contact"
    return f"{who} first, {reason}"


def _check(console: Console, found: "Verification") -> None:
    verdict = Text(
        "\nPROVED" if found.holds else "\nNOT PROVED", style=GOOD if found.holds else BAD
    )
    verdict.append(f"  every run of the abstract world, {found.states:,} states", "bold")
    if found.holds:
        verdict.append(f"; the goal is reached within {found.worst_turns} turns", "bold")
    console.print(verdict)
    for name, meaning in MEANINGS.items():
        fails = name in found.counterexamples
        verdict = "fails" if fails else "holds" if found.checks(name) else "not checked"
        style = {"fails": BAD, "holds": "green"}.get(verdict, "yellow")
        line = Text(f"{name:9}", "bold").append(verdict, style)
        console.print(line.append(f"  {'' if fails else 'never: '}{meaning}", QUIET))
    for line in failure_lines(found, found.fails):
        console.print(line, style="default", soft_wrap=True, highlight=False)


def failure_lines(found: "Verification", names: Sequence[str]) -> list[str]:
    """The shortest run against each of these properties, as sequence charts."""
    lines: list[str] = []
    for name in names:
        loop = found.loop if name == "progress" else 0
        lines += ["", f"The shortest run against {name}: {MEANINGS[name]}."]
        lines += chart(found.starts[name], found.counterexamples[name], loop)
    return lines


def policy_summary(
    policy: str,
    table: "PolicyTable",
    derivation: "Derivation",
    reasons: list[str],
    machines: "tuple[Machine, Machine] | None",
    found: "Verification | None",
) -> dict[str, Any]:
    """Everything as plain data, for JSON."""
    marks = {1: "+", 0: "0", -1: "-"}
    return {
        "policy": policy,
        "description": table.description,
        "rows": {
            marks[left] + marks[right]: {"palms": list(row.palms), "drives": list(row.drives)}
            for (left, right), row in table.rows.items()
        },
        "rules": rules_summary(derivation),
        "is_table_2": derivation.is_table_2,
        "reasons": reasons,
        "machines": None
        if machines is None
        else {
            side: {
                "states": [state._asdict() for state in machine.states],
                "rows": [row._asdict() for row in machine.rows],
            }
            for side, machine in zip(SIDES, machines, strict=True)
        },
        "verification": None
        if found is None
        else {
            "proved": found.holds,
            "states": found.states,
            "worst_turns": found.worst_turns,
            "counterexamples": {
                name: chart(found.starts[name], run, found.loop if name == "progress" else 0)
                for name, run in found.counterexamples.items()
            },
        },
    }
