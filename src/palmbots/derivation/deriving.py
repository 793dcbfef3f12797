# SPDX-License-Identifier: Apache-2.0
"""Derives the rules of a policy: of the paper's, or of a file."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from palmbots._types import BySide
from palmbots._util.arguments import one_of
from palmbots._util.command import Option, command
from palmbots.derivation.abstract_world import CONTROLLERS, system_of
from palmbots.derivation.derived_policy import DerivedPolicy
from palmbots.derivation.derived_rules import DerivedRules
from palmbots.derivation.distributed_algorithm import machines_of, refusals
from palmbots.derivation.global_policy import as_printed, table_1
from palmbots.derivation.local_rules import derive
from palmbots.derivation.policy_file import read_policy
from palmbots.derivation.refinement import check_refinement
from palmbots.derivation.verification import verified
from palmbots.errors import PalmbotsError

_POLICIES = {"table-1": table_1, "as-printed": as_printed}


@command(
    "derive",
    order=140,
    example="palmbots derive --policy examples/policies/both-drive.toml",
    progress="checking every run",
    failure=(
        "holds",
        "the rules differ from Table 2, or the policy is faulty. For a file: no algorithm follows, "
        "or its check fails",
    ),
    policy=Option(metavar="NAME"),
    checked=Option("--controllers", metavar="A,B,…"),
    counterexamples=Option(),
)
def derive_policy(
    policy: str = "table-1",
    *,
    checked: Sequence[str] | None = None,
    counterexamples: bool = False,
    on_progress: Callable[[float], None] | None = None,
) -> DerivedRules | DerivedPolicy:
    """Derive the robots' rules from the global policy.

    Also check which controllers refine the policy. From a policy file, derive a distributed
    algorithm and check it in every run; palmbots carry --controller FILE.toml runs it.

    Args:
        policy: ``table-1`` (as implemented), ``as-printed`` (with the misprint in case 7) or
            FILE.toml.
        checked: controllers to check, or none; None: all.
        counterexamples: print the shortest run to each departure from the policy.
        on_progress: called with the completed fraction of the check of a file's algorithm.

    Raises:
        PalmbotsError: the policy or a controller is unknown, or the file cannot be read.
    """
    if policy.endswith(".toml"):
        if checked is not None:
            raise PalmbotsError("--controllers needs table-1 or as-printed as --policy")
        return _of_file(policy, on_progress or (lambda fraction: None))
    one_of("policy", policy, (*_POLICIES, "FILE.toml"))
    names = list(CONTROLLERS) if checked is None else [name for name in checked if name != "none"]
    for name in names:
        one_of("checked", name, CONTROLLERS)
    rules = derive(_POLICIES[policy]())
    refinements = {name: check_refinement(system_of(name), rules) for name in names}
    return DerivedRules(policy, rules, refinements, counterexamples)


def _of_file(policy: str, on_progress: Callable[[float], None]) -> DerivedPolicy:
    table = read_policy(policy)
    rules = derive(table.cases, rest=table.rest)
    reasons = tuple(refusals(table, rules))
    if reasons:
        return DerivedPolicy(policy, table, rules, reasons, None)
    machines = machines_of(table)
    found = verified(machines, table.rest, on_progress)
    return DerivedPolicy(policy, table, rules, (), BySide.of(machines), found)
