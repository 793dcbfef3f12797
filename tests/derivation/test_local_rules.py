# SPDX-License-Identifier: Apache-2.0
"""From the policy to the rules: against Table 2 as transcribed from the paper, against brute force
in the abstract world of grid.py, and on policies that are not the paper's."""

import json
from dataclasses import replace
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from abstract_world import SHALLOW, STEEP, moved, sign
from palmbots.cli import main as cli
from palmbots.derivation.global_policy import (
    Case,
    Move,
    Policy,
    Until,
    Wiring,
    as_printed,
    mirrored,
    table_1,
)
from palmbots.derivation.local_rules import Derivation, derive
from palmbots.derivation.table2_programs import table_2
from table2_transcript import COLUMNS

GRID = list(product(range(-3, 4), range(-3, 4)))
ANGLE = {"steep": STEEP, "shallow": SHALLOW}
# What is printed above the columns.
WHEN = {"a": "p > 0", "b": "p > 0", "c": "p ≤ 0, got TiltUp", "d": "p < 0"}


def without(*numbers: int) -> Policy:
    return tuple(case for n, case in enumerate(table_1(), 1) if n not in numbers)


def changed(number: int, **changes: object) -> Policy:
    cases = list(table_1())
    cases[number - 1] = replace(cases[number - 1], **changes)
    return tuple(cases)


def printed(column: str) -> tuple[str, ...]:
    """A column of the paper's Table 2 with what stands above it."""
    above = [*COLUMNS["request"][:1], f"Wait for {'Ack' if column == 'a' else 'TiltUp'}"]
    lines = COLUMNS[column] if column in "cd" else above + COLUMNS[column]
    return tuple(line.replace("<=", "≤").replace(">=", "≥") for line in lines)


def test_rules_are_the_printed_table_2() -> None:
    done = derive(table_1())
    assert {name: p.lines for name, p in done.programs.items()} == {c: printed(c) for c in "acd"}
    assert {name: p.when for name, p in done.programs.items()} == {c: WHEN[c] for c in "acd"}
    assert done.is_table_2
    assert done.findings == []
    assert done.robots == {"a": (0, 1), "d": (0, 1)}


def test_compiled_table_2_reads_as_the_paper_prints_it() -> None:
    assert {name: (p.when, p.lines) for name, p in table_2().items()} == {
        column: (WHEN[column], printed(column)) for column in "abcd"
    }


def test_which_guards_go() -> None:
    done = derive(table_1())
    fate = {(g.case, g.step, g.owner): g.dropped for g in done.guards}
    assert {case for (case, _, _), dropped in fate.items() if not dropped} == {5, 6}
    assert sorted(key for key, dropped in fate.items() if dropped) == [
        (1, 1, 0), (2, 1, 1), (3, 1, 0), (4, 1, 1), (7, 1, 1), (7, 2, 0), (8, 1, 0), (8, 2, 1),
    ]  # fmt: skip
    assert [(step.case, step.number) for step in done.joint] == [(5, 1), (6, 1)]


def assert_guards_are_true(done: Derivation) -> None:
    """A guard is dropped if and only if no tick, from anywhere, whatever slides between palms
    alike, moves the contact that it is about; and one robot alone senses the condition."""
    for guard in done.guards:
        (step,) = [s for s in done.steps if (s.case, s.number) == (guard.case, guard.step)]
        palms = ANGLE[step.palms[0]], ANGLE[step.palms[1]]
        stays = all(
            q[guard.contact] == p[guard.contact]
            for p in GRID
            for q in moved(p, palms, step.move.direction == "closer")
        )
        assert guard.dropped == (stays and len(step.owners) == 1), guard


def test_guard_is_dropped_if_and_only_if_its_contact_cannot_move() -> None:
    assert_guards_are_true(derive(table_1()))


untils = st.builds(Until, st.integers(0, 1), st.sampled_from(["≤", "≥"]))
moves = st.builds(
    Move,
    st.sampled_from(["away", "closer"]),
    st.lists(untils, min_size=1, max_size=2, unique=True).map(tuple),
)
signs = st.tuples(st.integers(-1, 1), st.integers(-1, 1))
cases = st.builds(
    Case,
    signs,
    st.sampled_from([None, 0, 1]),
    st.lists(moves, min_size=1, max_size=3).map(tuple),
)
policies = st.lists(cases, min_size=1, max_size=8, unique_by=lambda case: case.signs).map(tuple)


@given(policies)
def test_guards_of_any_policy(policy: Policy) -> None:
    assert_guards_are_true(derive(policy))


@given(policies)
def test_mirrored_policy_gives_mirrored_rules(policy: Policy) -> None:
    done, image = derive(policy), derive(mirrored(policy))
    assert {
        (done.rules[n], tuple(sorted(1 - r for r in who))) for n, who in done.robots.items()
    } == {(image.rules[n], who) for n, who in image.robots.items()}
    assert len(image.conflicts) == len(done.conflicts)


@given(policies)
def test_findings_about_moves_are_true(policy: Policy) -> None:
    """By walking the grid: a move that is said never to move is over wherever it can begin, and one
    that is said never to end goes on for ever."""
    done = derive(policy)
    for number, case in enumerate(policy, 1):
        palms = [STEEP, STEEP]
        if case.tilt is not None:
            palms[case.tilt] = SHALLOW
        here = {p for p in GRID if (sign(p[0]), sign(p[1])) == case.signs}
        for k, move in enumerate(case.moves, 1):
            over = {p for p in here if move.over((sign(p[0]), sign(p[1])))}
            idle = f"case {number}, move {k} never moves"
            assert any(f.startswith(idle) for f in done.findings) == (over == here)
            seen, queue, ends = set(here), [p for p in here if p not in over], over
            while queue:
                for q in moved(queue.pop(), (palms[0], palms[1]), move.direction == "closer"):
                    if move.over((sign(q[0]), sign(q[1]))):
                        ends = ends | {q}
                    elif q not in seen and max(map(abs, q)) < 9:
                        seen.add(q)
                        queue.append(q)
            endless = f"case {number}, move {k} never ends"
            assert any(f.startswith(endless) for f in done.findings) == (not ends and bool(here))
            here = ends


def test_each_rule_corrects_its_own_contact_wherever_the_other_is() -> None:
    """Each rule, from any place of the other contact, corrects its own and leaves the other."""
    for rule in derive(table_1()).rules.values():
        palms = ANGLE[rule.palms[0]], ANGLE[rule.palms[1]]
        ((contact, relation),) = rule.until
        for start in GRID:
            if sign(start[0]) != rule.signs[0]:
                continue
            p = start
            while p[contact] > 0 if relation == "≤" else p[contact] < 0:
                (p,) = moved(p, palms, rule.direction == "closer")
            assert p == (0, start[1])


def test_conflicts() -> None:
    found = {c.rules: c for c in derive(table_1()).conflicts}
    assert sorted(found) == [("a", "a"), ("a", "d"), ("d", "d")]
    assert [found[pair].signs for pair in sorted(found)] == [
        ((1, 1),), ((-1, 1), (1, -1)), ((-1, -1),),
    ]  # fmt: skip
    assert [found[pair].cases for pair in sorted(found)] == [(5,), (7, 8), (6,)]
    assert [found[pair].asking for pair in sorted(found)] == [2, 1, 0]
    # (a) beside (d): both want the same palm up, and drive against each other.
    assert [found[pair].palms_clash for pair in sorted(found)] == [True, False, True]
    assert [found[pair].moves_clash for pair in sorted(found)] == [False, True, False]


def test_case_7_as_printed_never_moves() -> None:
    done = derive(as_printed())
    assert done.findings == [
        "case 7, move 1 never moves: p_R ≤ 0 holds when it begins",
        "case 7, move 2 never moves: p_L ≥ 0 holds when it begins",
        "case 7 never moves anything: (+, −) stays forever",
    ]
    assert done.sources == {
        "a": ((1, 1), (2, 1), (8, 2)), "d": ((3, 1), (4, 1), (8, 1)),
    }  # fmt: skip


def test_a_mirrored_policy_gives_the_same_rules() -> None:
    assert derive(mirrored(table_1())).programs == derive(table_1()).programs


def test_missing_case_is_reported_even_if_the_rules_correct_it() -> None:
    done = derive(without(7))
    assert done.is_table_2
    assert done.findings == ["(+, −) has no case in the policy; the rules correct it"]


def test_no_positive_contact_is_ever_corrected() -> None:
    done = derive(without(1, 2, 7, 8))
    assert list(done.programs) == ["d"]
    assert done.server is None
    assert "(+, 0) has no case in the policy; and no rule corrects it" in done.findings
    assert [c.rules for c in done.conflicts] == [("d", "d")]


def test_rule_of_one_robot_only_is_reported() -> None:
    """Without cases 2 and 8 the right robot does not correct a positive contact."""
    done = derive(without(2, 8))
    assert done.robots == {"a": (0,), "d": (0, 1)}
    assert not done.is_table_2
    assert any(f.startswith("rule (a) is the left robot's alone") for f in done.findings)


def test_the_wrong_palm() -> None:
    """With the left palm up case 1 opens the right contact, and its own never comes to 0."""
    done = derive(changed(1, tilt=0))
    assert "case 1, move 1 never ends: it does not bring about p_L ≤ 0" in done.findings
    assert "case 1, move 1 can move a contact away from 0, at (+, −), (+, 0)" in done.findings
    guard = next(g for g in done.guards if g.case == 1)
    assert not guard.dropped
    assert (1, 1) not in done.sources["a"]


def test_move_that_never_ends_gives_no_rule() -> None:
    """Closing does not bring a positive contact to 0."""
    move = Move("closer", (Until(0, "≤"),))
    done = derive(changed(1, tilt=0, moves=(move,)))
    assert "case 1, move 1 never ends: it does not bring about p_L ≤ 0" in done.findings
    assert sorted(done.rules) == ["a", "d"]


def test_guard_is_kept_if_no_palm_is_up() -> None:
    done = derive(changed(3, tilt=None))
    guard = next(g for g in done.guards if g.case == 3)
    assert (guard.dropped, guard.reason) == (False, "either may slide")
    assert (3, 1) in [(step.case, step.number) for step in done.joint]


def test_other_guards_give_other_rules() -> None:
    """A policy that lets go of a positive contact only once it is negative."""
    late = replace(table_1()[0].moves[0], until=(Until(0, "≥"),))
    done = derive(changed(1, moves=(late,)))
    assert done.findings[0] == "case 1, move 1 never moves: p_L ≥ 0 holds when it begins"


def test_one_robot_that_senses_everything() -> None:
    """No guard has to go, no rule is shared: the left robot runs Table 1 and asks the right one."""
    done = derive(table_1(), Wiring(senses=(0, 0)))
    assert done.guards == []
    assert done.joint == []
    assert set(done.robots.values()) == {(0,)}
    assert len(done.rules) == 8
    asked = {name for name, rule in done.rules.items() if rule.asks}
    assert {done.sources[name][0][0] for name in asked} == {1, 4, 7}
    assert not done.is_table_2


def test_each_robot_turns_the_others_palm() -> None:
    """Then a positive contact is corrected alone, and a negative one needs the partner."""
    done = derive(table_1(), Wiring(turns=(1, 0)))
    asking = {rule.signs[0]: rule.asks for rule in done.rules.values()}
    assert asking == {1: False, -1: True}
    assert done.server is not None
    assert done.server.when == "p ≥ 0, got TiltUp"


@pytest.mark.parametrize("number", range(1, 9))
def test_duplicate_cases_are_reported(number: int) -> None:
    done = derive((*table_1(), table_1()[number - 1]))
    assert any("has several cases" in finding for finding in done.findings)


# The command.


def run_command(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    status = cli.run(["derive", *words])
    return status, capsys.readouterr().out


def test_command_prints_the_rules(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    status, out = run_command(capsys)
    assert status == cli.DONE
    assert out.startswith("DERIVED  the rules are Table 2's (a), (c) and (d)")
    for line in ("Move away until p ≤ 0", "(a)∥(a)  (+, +)", "Where distributed departs"):
        assert line in out
    assert "palms turning" not in out
    assert "palms turning" in run_command(capsys, "--counterexamples")[1]


def test_command_refuses_a_faulty_policy(capsys: pytest.CaptureFixture[str]) -> None:
    status, out = run_command(capsys, "--policy", "as-printed", "--controllers", "none")
    assert status == cli.FAILED
    assert "case 7 never moves anything: (+, −) stays forever" in out


def test_json_contains_the_derivation(capsys: pytest.CaptureFixture[str]) -> None:
    status, out = run_command(capsys, "--json", "--controllers", "distributed, resilient")
    done = json.loads(out)
    assert status == cli.DONE
    assert done["is_table_2"] is True
    assert done["rules"]["a"]["lines"] == list(printed("a"))
    assert done["rules"]["d"]["sources"] == [[3, 1], [4, 1], [7, 1], [8, 1]]
    assert done["policy"][0] == {
        "case": 1,
        "signs": [1, 0],
        "tilt": "right",
        "moves": [{"direction": "away", "until": ["p_L ≤ 0"]}],
    }
    table_2, resilient = (done["refinement"][name] for name in ("distributed", "resilient"))
    assert (table_2["weakest_permission"], resilient["weakest_permission"]) == (None, "begun")
    assert sum(d["motions"] for d in table_2["departures"] if d["permitted_by"] is None) == 8
    assert all(d["run"] for d in table_2["departures"])
