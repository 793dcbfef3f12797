# SPDX-License-Identifier: Apache-2.0
"""The outputs of `palmbots derive`."""

import io
from pathlib import Path

from rich.console import Console

from palmbots._types import BySide
from palmbots._util.results import Result
from palmbots.cli.console import print_report
from palmbots.derivation.abstract_world import CONTROLLERS, system_of
from palmbots.derivation.derived_policy import DerivedPolicy
from palmbots.derivation.derived_rules import DerivedRules
from palmbots.derivation.distributed_algorithm import machines_of
from palmbots.derivation.global_policy import as_printed, table_1
from palmbots.derivation.local_rules import derive
from palmbots.derivation.policy_file import read_policy
from palmbots.derivation.refinement import check_refinement
from palmbots.derivation.verification import verify

ROOT = Path(__file__).parents[2]


def text_of(result: Result) -> str:
    """What a command prints of a result, 100 columns wide."""
    out = io.StringIO()
    print_report(result.lines(), console=Console(file=out, width=100, highlight=False))
    return "\n".join(line.rstrip() for line in out.getvalue().splitlines())


def printed(policy: str, controllers: tuple[str, ...], runs: bool) -> str:
    """The output of `palmbots derive`."""
    rules = derive(table_1() if policy == "table-1" else as_printed())
    checked = {name: check_refinement(system_of(name), rules) for name in controllers}
    return text_of(DerivedRules(policy, rules, checked, runs))


def policy_printed(name: str) -> str:
    """The output of `palmbots derive --policy` for an example."""
    file = f"examples/policies/{name}.toml"
    table = read_policy(ROOT / file)
    machines = machines_of(table)
    rules, found = derive(table.cases, rest=table.rest), verify(machines, table.rest)
    return text_of(DerivedPolicy(file, table, rules, (), BySide.of(machines), found))


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    everything = printed("table-1", CONTROLLERS, True)
    marks = [everything.index(f"\n\nWhere {name} ") for name in CONTROLLERS[1:]]
    middle = everything.index("\n\nMotions in every run")
    mixed = policy_printed("rest-mixed")
    verdict, end = mixed.index("\nNOT PROVED"), mixed.index("\n\nThe shortest run against S2")
    outputs = {
        "both drive": policy_printed("both-drive"),
        "rest mixed": mixed[verdict + 1 : end],
        "derivation": everything[:middle],
        "refinement": everything[middle + 2 : marks[0]],
        "distributed": everything[marks[0] + 2 : marks[1]],
        "resilient": everything[marks[1] + 2 :],
        "as printed": "\n".join(printed("as-printed", (), False).splitlines()[:4]),
    }
    return {name: f"```\n{text}\n```" for name, text in outputs.items()}
