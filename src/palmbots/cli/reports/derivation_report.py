# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots derive`, and the same as one JSON object."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from palmbots._types import SIDES
from palmbots._util.text import plural
from palmbots.cli.console import BAD, GOOD, QUIET, report_console
from palmbots.derivation.global_policy import signs_text
from palmbots.derivation.local_rules import Derivation
from palmbots.derivation.permissions import LEVELS

if TYPE_CHECKING:
    from palmbots.derivation.refinement import Departure, Refinement


def derivation_report(
    derivation: Derivation,
    refinements: Mapping[str, "Refinement"],
    policy: str,
    runs: bool,
    console: Console | None = None,
) -> None:
    """Print the rules with their sources, then each controller compared with the policy."""
    console = console or report_console()
    good = derivation.is_table_2 and not derivation.findings
    head = Text("DERIVED" if good else "FAULTY", style=GOOD if good else BAD)
    whether = "are" if derivation.is_table_2 else "are not"
    head.append(f"  the rules {whether} Table 2's (a), (c) and (d)", "bold")
    console.print(head.append(f"   policy {policy}", QUIET))
    for finding in derivation.findings:
        console.print(Text("finding: ", style="bold yellow").append(finding, style="default"))
    _moves(console, derivation)
    rules_table(console, derivation)
    _conflicts(console, derivation)
    if refinements:
        _refinement(console, refinements)
        for controller, found in refinements.items():
            _departures(console, controller, found, runs)


def report_table(title: str, *columns: str) -> Table:
    """A table of a report, with a title."""
    table = Table(
        title=title, title_justify="left", title_style="bold", box=None, pad_edge=False,
        padding=(0, 2, 0, 0), header_style=QUIET,
    )  # fmt: skip
    for column in columns:
        table.add_column(column, overflow="fold", no_wrap=column in ("controller", "owner"))
    return table


def _moves(console: Console, derivation: Derivation) -> None:
    """Print each move with its owner, and the guards that the owner does not sense."""
    table = report_table(
        "\nMoves, their owners, and guards that the owner does not sense",
        "case", "move", "up", "owner", "guard", "", "because",
    )  # fmt: skip
    for step in derivation.steps:
        raised = SIDES[step.palms.index("shallow")] if "shallow" in step.palms else ""
        owners = SIDES[step.owners[0]] if len(step.owners) == 1 else "both"
        guards = [g for g in derivation.guards if (g.case, g.step) == (step.case, step.number)]
        guard_text = ", ".join(map(str, guards))
        verdict, reason = Text(""), ""
        if guards:
            dropped = all(g.dropped for g in guards)
            verdict = Text("dropped", "green") if dropped else Text("kept", "yellow")
            reason = guards[0].reason
        move = f"{step.move.direction} until {step.move.end}"
        table.add_row(str(step.case), move, raised, owners, guard_text, verdict, reason)
    console.print(table)
    if derivation.joint:
        cases = " and ".join(str(case) for case in sorted({s.case for s in derivation.joint}))
        console.print(
            f"Cases {cases} need both sensors: they give no rule, only the conflicts below."
        )


def rules_table(console: Console, derivation: Derivation) -> None:
    """Print the programs side by side, as Table 2 does."""
    table = report_table("\nRules")
    columns = []
    for name, program in sorted(derivation.programs.items()):
        if name in derivation.rules:
            who = " and ".join(SIDES[robot] for robot in derivation.robots[name])
            of = f"{who}, {_sources(derivation, name)}"
        else:
            of = "the server"
        label = f"({name})" if name in derivation.table_2 else name
        table.add_column(label, overflow="fold", style="default", header_style="bold")
        columns.append([Text(of, style=QUIET), f"if {program.when}", *program.lines])
    for k in range(max(map(len, columns), default=0)):
        table.add_row(*(column[k] if k < len(column) else "" for column in columns))
    console.print(table)


def _sources(derivation: Derivation, name: str) -> str:
    """The cases from which a rule follows, or the rows of a policy file."""
    numbers = sorted({case for case, _ in derivation.sources[name]})
    cases = [derivation.policy[number - 1] for number in numbers]
    if all(case.angles is None for case in cases):
        return f"case {', '.join(map(str, numbers))}"
    return f"rows {' '.join(signs_text(case.signs) for case in cases)}"


def _conflicts(console: Console, derivation: Derivation) -> None:
    table = report_table(
        "\nConflicts: rules of both robots that hold at once",
        "rules", "signs", "palms", "motion", "policy", "what determines the order",
    )  # fmt: skip
    for conflict in derivation.conflicts:
        table.add_row(
            "∥".join(f"({name})" for name in conflict.rules),
            " ".join(map(signs_text, conflict.signs)),
            "clash" if conflict.palms_clash else "agree",
            "clash" if conflict.moves_clash else "agree",
            "case " + ", ".join(map(str, conflict.cases)) if conflict.cases else "",
            conflict.order + _kept_in_table_2(derivation, conflict.asking),
        )
    console.print(table)


def _kept_in_table_2(derivation: Derivation, asking: int) -> str:
    """The lines of Table 2 about a conflict."""
    if asking == 2:
        lines = derivation.table_2["b"].lines
        return f". Table 2's (b): {', '.join(lines[2:])}"
    return "" if asking else ". Table 2 leaves this open"


def _refinement(console: Console, refinements: Mapping[str, "Refinement"]) -> None:
    table = report_table(
        "\nMotions in every run, by what permits them",
        "controller", "states", *LEVELS, "nothing", "verdict", "nominal",
    )  # fmt: skip
    for controller, found in refinements.items():
        counts = [len(found.permitted.get(level, ())) for level in (*LEVELS, None)]
        verdict = _verdict(found)
        stuck = Text("lost", BAD) if found.stuck or found.falls else Text("in reach", "green")
        table.add_row(controller, str(found.states), *map(str, counts), verdict, stuck)
    console.print(table)
    console.print(
        "policy: the policy permits the motion. Weakenings, each in addition to those before: "
        "rules: without the dropped guards. at once: while the other robot runs a rule that is not "
        "ordered with this one. begun: until the first cell of a motion ends that began while its "
        "own guard held. nominal: p = 0, palms steep, no motion.",
        style=QUIET,
    )


def _verdict(found: "Refinement") -> Text:
    if found.needs is None:
        return Text("departs", BAD)
    return Text("refines" if found.needs == "policy" else "refines, weakened", "green")


def _departures(console: Console, controller: str, found: "Refinement", runs: bool) -> None:
    if not found.departures:
        return
    console.print(Text(f"\nWhere {controller} departs from the policy", "bold"))
    for number, departure in enumerate(_sorted(found), 1):
        kind = departure.kind
        permitted = f"permitted by: {kind.level}" if kind.level else "permitted by nothing"
        head = Text(f"{number}. in ({kind.case}), {kind.differs}", "bold")
        head.append(f"  {permitted}", "not bold" if kind.level else BAD)
        console.print(head.append(f", {plural(len(departure.motions), 'motion')}", QUIET))
        console.print(Padding(f"{departure.explanation}.", (0, 0, 0, 3)))
        if runs:
            for line in departure.transcript():
                console.print(f"      {line}", style=QUIET, soft_wrap=True)


def _sorted(found: "Refinement") -> list["Departure"]:
    """Departures that the narrowest weakening permits first, those that nothing permits last."""
    order = (*LEVELS, None)
    return sorted(found.departures, key=lambda d: (order.index(d.kind.level), d.kind.case))


def summary(derivation: Derivation, refinements: Mapping[str, "Refinement"]) -> dict[str, Any]:
    """Everything as plain data, for JSON."""
    return {
        "policy": [
            {
                "case": number,
                "signs": list(case.signs),
                "tilt": None if case.tilt is None else SIDES[case.tilt],
                "moves": [
                    {"direction": m.direction, "until": [str(u) for u in m.until]}
                    for m in case.moves
                ],
            }
            for number, case in enumerate(derivation.policy, 1)
        ],
        "guards": [
            {
                "case": g.case,
                "move": g.step,
                "owner": SIDES[g.owner],
                "guard": str(g),
                "dropped": g.dropped,
                "reason": g.reason,
            }
            for g in derivation.guards
        ],
        "rules": rules_summary(derivation),
        "conflicts": [
            {
                "rules": list(c.rules),
                "signs": [list(s) for s in c.signs],
                "palms_clash": c.palms_clash,
                "moves_clash": c.moves_clash,
                "cases": list(c.cases),
                "order": c.order,
            }
            for c in derivation.conflicts
        ],
        "findings": derivation.findings,
        "is_table_2": derivation.is_table_2,
        "refinement": {name: _refined(found) for name, found in refinements.items()},
    }


def rules_summary(derivation: Derivation) -> dict[str, Any]:
    """The programs as plain data, with the robots that have them and where they come from."""
    return {
        name: {
            "when": program.when,
            "lines": list(program.lines),
            "robots": [SIDES[r] for r in derivation.robots.get(name, (0, 1))],
            "from": [list(source) for source in derivation.sources.get(name, ())],
        }
        for name, program in derivation.programs.items()
    }


def _refined(found: "Refinement") -> dict[str, Any]:
    return {
        "states": found.states,
        "motions": {
            level or "nothing": len(found.permitted.get(level, ())) for level in (*LEVELS, None)
        },
        "weakest_permission": found.needs,
        "stuck": found.stuck,
        "falls": found.falls,
        "departures": [
            {
                "differs": d.kind.differs,
                "case": d.kind.case,
                "permitted_by": d.kind.level,
                "strays": d.kind.strays,
                "motions": len(d.motions),
                "start": list(d.start),
                "explanation": d.explanation,
                "run": d.transcript(),
            }
            for d in _sorted(found)
        ],
    }
