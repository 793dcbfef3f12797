# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots derive`."""

from typing import Annotated

import typer

from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, FAILED, JsonOption

__all__ = ["COMMAND", "EXAMPLE", "ORDER"]

ORDER = 140
EXAMPLE = "palmbots derive --policy as-printed --controllers none"


def derive(
    policy: Annotated[
        str,
        typer.Option(
            "--policy",
            metavar="NAME",
            help="table-1 (as implemented) or as-printed (with the misprint in case 7).",
        ),
    ] = "table-1",
    controllers: Annotated[
        str | None,
        typer.Option(
            "--controllers", metavar="A,B,…", help="Controllers to check, or none [default: all]."
        ),
    ] = None,
    counterexamples: Annotated[
        bool,
        typer.Option(
            "--counterexamples", help="Print the shortest run to each departure from the policy."
        ),
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Derive the robots' rules from the global policy.

    Also check which controllers refine the policy.

    Exit status 1: the rules differ from Table 2, or the policy is faulty.
    """
    from palmbots._util.arguments import one_of
    from palmbots.cli.reports.derivation_report import derivation_report, summary
    from palmbots.derivation.abstract_world import CONTROLLERS, system_of
    from palmbots.derivation.global_policy import as_printed, table_1
    from palmbots.derivation.local_rules import derive as run_derivation
    from palmbots.derivation.refinement import check_refinement

    one_of("--policy", policy, ("table-1", "as-printed"))
    if controllers is None:
        names = list(CONTROLLERS)
    else:
        names = [] if controllers == "none" else [name.strip() for name in controllers.split(",")]
    for name in names:
        one_of("--controllers", name, CONTROLLERS)
    result = run_derivation(table_1() if policy == "table-1" else as_printed())
    refinements = {name: check_refinement(system_of(name), result) for name in names}
    if as_json:
        print_json(summary(result, refinements))
    else:
        derivation_report(result, refinements, policy, counterexamples)
    return DONE if result.is_table_2 and not result.findings else FAILED


COMMAND = derive
