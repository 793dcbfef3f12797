# SPDX-License-Identifier: Apache-2.0
"""Policy files: Table 1 as a file, and what a message says about each fault."""

import re
from collections.abc import Callable
from itertools import product
from pathlib import Path

import pytest

from abstract_world import sign
from palmbots.cli import main as cli
from palmbots.derivation.distributed_algorithm import machines_of, refusals
from palmbots.derivation.global_policy import table_1
from palmbots.derivation.local_rules import derive
from palmbots.derivation.policy_file import read_policy
from palmbots.errors import PalmbotsError

POLICIES = Path(__file__).parents[2] / "examples" / "policies"
TABLE_1 = (POLICIES / "table-1.toml").read_text("utf-8")


@pytest.fixture
def file(tmp_path: Path) -> Callable[[str], Path]:
    def write(text: str) -> Path:
        path = tmp_path / "policy.toml"
        path.write_text(text, "utf-8")
        return path

    return write


def with_row(key: str, palms: str, drives: str, text: str = TABLE_1) -> str:
    """Table 1 with another row; palms and drives as words, left and right."""
    left, right = ([f'"{word}"' for word in words.split()] for words in (palms, drives))
    row = f'"{key}" = {{ palms = [{", ".join(left)}], drives = [{", ".join(right)}] }}'
    return re.sub(rf'^"{re.escape(key)}" =.*$', row, text, flags=re.MULTILINE)


def test_table_1_as_a_file_gives_the_rules_of_the_built_in_table() -> None:
    table = read_policy(POLICIES / "table-1.toml")
    done, built_in = derive(table.cases, rest=table.rest), derive(table_1())
    assert done.is_table_2
    assert done.findings == []
    assert done.rules == built_in.rules
    assert done.programs == built_in.programs
    assert done.robots == built_in.robots
    assert [(c.rules, c.signs) for c in done.conflicts] == [
        (c.rules, c.signs) for c in built_in.conflicts
    ]


def test_table_1_as_a_file_moves_as_the_built_in_table_does() -> None:
    """Move by move: the same signs, palms and direction, except that a second move is a row."""
    table = read_policy(POLICIES / "table-1.toml")
    rows = {
        (signs, row.palms, row.direction) for signs, row in table.rows.items() if signs != (0, 0)
    }
    moves = {
        (signs, step.palms, step.move.direction)
        for step in derive(table_1()).steps
        for signs in step.during
    }
    # A second move of cases 7 and 8 begins at the signs of cases 1 and 2, with their palms.
    assert rows == moves


def test_as_a_station_would_follow_it_every_start_reaches_the_goal() -> None:
    """The examples as global policies, on a grid: the contact that may slide slides by a unit."""
    for path in sorted(POLICIES.glob("*.toml")):
        table = read_policy(path)
        places = set(product(range(-3, 4), repeat=2))
        done = {(0, 0)}
        for _ in range(40):
            for p in places - done:
                row = table.rows[sign(p[0]), sign(p[1])]
                change = {"closer": 1, "away": -1}[row.direction or ""]
                if set(row.palms) == {"steep", "shallow"}:
                    able = [row.palms.index("shallow" if change > 0 else "steep")]
                else:
                    able = [0, 1]
                after = {(p[0] + change * (k == 0), p[1] + change * (k == 1)) for k in able}
                if after <= done:
                    done = done | {p}
        assert done == places, path


# Policies from which no algorithm follows: the row that a message names, and the reason.
REFUSED = [
    ("+0", "steep steep", "away hold", "row (+, 0)", "away from 0"),
    ("+0", "steep shallow", "hold hold", "row (+, 0)", "never moves anything"),
    ("+0", "steep shallow", "closer hold", "row (+, 0)", "away from 0"),
    ("+0", "shallow steep", "away hold", "row (+, 0)", "away from 0"),
    ("0-", "shallow steep", "closer hold", "row (0, −)", "away from 0"),
    ("00", "steep steep", "away hold", "row (0, 0)", "the corrections never end"),
    ("+-", "steep shallow", "away hold", "row (+, −)", None),
    ("+-", "shallow shallow", "closer closer", "row (+, −)", "away from 0"),
]


@pytest.mark.parametrize(("key", "palms", "drives", "row", "reason"), REFUSED)
def test_policy_without_algorithm_is_refused_with_its_row(
    key: str,
    palms: str,
    drives: str,
    row: str,
    reason: str | None,
    file: Callable[[str], Path],
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = file(with_row(key, palms, drives))
    table = read_policy(path)
    reasons = refusals(table, derive(table.cases, rest=table.rest))
    if reason is None:  # it only changes the order
        assert reasons == []
        return
    assert any(row in text and reason in text for text in reasons), reasons
    with pytest.raises(PalmbotsError, match="no distributed algorithm follows"):
        machines_of(table)
    assert cli.run(["carry", "--controller", str(path)]) == cli.BAD_INPUT
    assert row in capsys.readouterr().err
    assert cli.run(["derive", "--policy", str(path)]) == cli.FAILED
    assert capsys.readouterr().out.startswith("REFUSED")


def test_signs_that_only_a_joint_row_corrects_are_refused(file: Callable[[str], Path]) -> None:
    """With palms alike in every row of an outward left contact, no robot can follow any of them."""
    text = with_row("+-", "steep steep", "away away")
    text = with_row("+0", "steep steep", "away away", text)
    table = read_policy(file(text))
    reasons = refusals(table, derive(table.cases, rest=table.rest))
    assert "(+, 0) is corrected by no rule: either contact may slide, and no robot senses both" in (
        reasons
    )


def test_drives_that_the_robot_cannot_decide_are_refused(file: Callable[[str], Path]) -> None:
    """Whether the left robot drives depends on the right contact, which it does not sense."""
    table = read_policy(file(with_row("+-", "steep shallow", "hold away")))
    reasons = refusals(table, derive(table.cases, rest=table.rest))
    assert any("row (+, 0) and row (+, −) differ in whether the left robot drives" in reason
               for reason in reasons)  # fmt: skip
