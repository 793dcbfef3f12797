"""The command `palmbots derive`. Importing this module puts it into the command line."""

import json
from typing import Annotated

import typer

from palmbots.cli_options import DONE, FAILED, JsonOption, app

__all__ = ["derive"]


@app.command(epilog="Example: palmbots derive --policy as-printed --controllers none")
def derive(
    policy: Annotated[
        str,
        typer.Option(
            "--policy",
            help="table-1, as the controller runs it; as-printed, with the misprint in case 7.",
        ),
    ] = "table-1",
    controllers: Annotated[
        str,
        typer.Option("--controllers", help="To check against the policy, with commas; or none."),
    ] = "centralized,distributed,resilient",
    runs: Annotated[
        bool, typer.Option("--runs", help="Show the shortest run to each departure.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Derive each robot's rules from the global policy. Check controllers against it.

    Exit status 1: the policy does not give Table 2, or something is wrong with it.
    """
    from palmbots.derivation.pairs import CONTROLLERS, system_of
    from palmbots.derivation.policy import as_printed, table_1
    from palmbots.derivation.refinement import check_refinement
    from palmbots.derivation.report import derivation_report, summary
    from palmbots.derivation.rules import derive as run_derivation
    from palmbots.errors import one_of

    one_of("--policy", policy, ("table-1", "as-printed"))
    names = [] if controllers == "none" else [n.strip() for n in controllers.split(",")]
    for name in names:
        one_of("--controllers", name, CONTROLLERS)
    done = run_derivation(table_1() if policy == "table-1" else as_printed())
    checked = {name: check_refinement(system_of(name), done) for name in names}
    if as_json:
        print(json.dumps(summary(done, checked), allow_nan=False))
    else:
        derivation_report(done, checked, policy, runs)
    return DONE if done.is_table_2 and not done.findings else FAILED
