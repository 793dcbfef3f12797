# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots derive`."""

from typing import Annotated

import typer

from palmbots._types import BySide
from palmbots._util.command import command
from palmbots.cli._progress import progress
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, FAILED, JsonOption
from palmbots.errors import PalmbotsError


@command(
    order=140,
    example="palmbots derive --policy examples/policies/both-drive.toml",
    results=(
        "palmbots.derivation.derived_rules:DerivedRules",
        "palmbots.derivation.derived_policy:DerivedPolicy",
    ),
)
def derive(
    policy: Annotated[
        str,
        typer.Option(
            "--policy",
            metavar="NAME",
            help="table-1 (as implemented), as-printed (with the misprint in case 7) or FILE.toml.",
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

    Also check which controllers refine the policy. From a policy file, derive a distributed
    algorithm and check it in every run; palmbots carry --controller FILE.toml runs it.

    Exit status 1: the rules differ from Table 2, or the policy is faulty. For a file: no algorithm
    follows, or its check fails.
    """
    if policy.endswith(".toml"):
        return _derive_file(policy, controllers, as_json)
    from palmbots._util.arguments import one_of
    from palmbots.derivation.abstract_world import CONTROLLERS, system_of
    from palmbots.derivation.derived_rules import DerivedRules
    from palmbots.derivation.global_policy import as_printed, table_1
    from palmbots.derivation.local_rules import derive as run_derivation
    from palmbots.derivation.refinement import check_refinement

    one_of("--policy", policy, ("table-1", "as-printed", "FILE.toml"))
    if controllers is None:
        names = list(CONTROLLERS)
    else:
        names = [] if controllers == "none" else [name.strip() for name in controllers.split(",")]
    for name in names:
        one_of("--controllers", name, CONTROLLERS)
    result = run_derivation(table_1() if policy == "table-1" else as_printed())
    refinements = {name: check_refinement(system_of(name), result) for name in names}
    shown = DerivedRules(policy, result, refinements, counterexamples)
    print_result(shown, as_json=as_json)
    return DONE if shown.holds else FAILED


def _derive_file(policy: str, controllers: str | None, as_json: bool) -> int:
    from palmbots.derivation.derived_policy import DerivedPolicy
    from palmbots.derivation.distributed_algorithm import machines_of, refusals
    from palmbots.derivation.local_rules import derive as run_derivation
    from palmbots.derivation.policy_file import read_policy
    from palmbots.derivation.verification import verify

    if controllers is not None:
        raise PalmbotsError("--controllers needs table-1 or as-printed as --policy")
    table = read_policy(policy)
    rules = run_derivation(table.cases, rest=table.rest)
    reasons = refusals(table, rules)
    machines = None if reasons else machines_of(table)
    found = None
    if machines is not None:
        with progress("checking every run", as_json) as report:
            found = verify(machines, table.rest, on_progress=report)
    sides = None if machines is None else BySide.of(machines)
    shown = DerivedPolicy(policy, table, rules, tuple(reasons), sides, found)
    print_result(shown, as_json=as_json)
    return DONE if found is not None and found.holds else FAILED
