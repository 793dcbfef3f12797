# SPDX-License-Identifier: Apache-2.0
"""Old commands and options are refused in one line that gives the new name."""

from typing import Any

import pytest
from typer.main import get_command

from commands import Run, assert_refused
from palmbots.cli.main import build_app
from palmbots.cli.old_names import OLD_COMMANDS, OLD_OPTIONS

# As a user of the previous version typed them, and the present name.
EARLIER = [
    (["rare"], "drop-rate"),
    (["rare", "--within-percent", "20"], "drop-rate"),
    (["speed"], "speed-limits"),
    (["drop-rate", "--within-percent", "20"], "--relative-error-percent"),
    (["carry", "--beyond-budget"], "--allow-drift-beyond-budget"),
    (["design", "--each"], "--independent-friction"),
    (["certify", "--common"], "--common-friction"),
    (["certify", "--slope", "-0.1", "0.1"], "--slope-deg"),
    (["design", "--slope", "-0.1", "0.1"], "--slope-deg"),
    (["design", "--least-difference-deg", "5"], "--min-angle-difference-deg"),
    (["design", "--least-clearance-deg", "5"], "--min-clearance-deg"),
    (["design", "--angles-deg", "0", "5"], "--angle-range-deg"),
    (["derive", "--runs"], "--counterexamples"),
    (["study", "x.toml", "--explain"], "--estimate-cost"),
    (["study", "x.toml", "--chunk", "5"], "--chunk-size"),
    (["validate", "--seeds", "5"], "--carries"),
    (["speed-limits", "--seeds", "5"], "--carries"),
]


def commands() -> dict[str, Any]:
    group: Any = get_command(build_app())
    return group.commands


@pytest.mark.parametrize(("arguments", "new"), EARLIER, ids=lambda x: " ".join(x[:2]))
def test_old_name_is_refused_with_the_new_one(arguments: list[str], new: str, here: Run) -> None:
    assert_refused(here(*arguments), "is now called", new)


def test_every_row_of_the_tables_is_tried_here() -> None:
    tried = {(a[0], word) for a, _ in EARLIER for word in a[1:] if word.startswith("--")}
    assert set(OLD_OPTIONS) <= tried
    assert set(OLD_COMMANDS) <= {arguments[0] for arguments, _ in EARLIER}


def test_new_names_exist_and_old_ones_do_not() -> None:
    known = commands()
    for old, new in OLD_COMMANDS.items():
        assert new in known and old not in known
    for (command, old), new in OLD_OPTIONS.items():
        options = {o for p in known[command].params for o in (*p.opts, *p.secondary_opts)}
        assert new.split(",")[0] in options and old not in options
