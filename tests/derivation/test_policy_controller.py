# SPDX-License-Identifier: Apache-2.0
"""Policy files as controllers: the machines step by step, carries in both worlds, logs, batches."""

import pickle
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from machine_search import row_of
from palmbots.control.registry import ControllerEntry, resolve
from palmbots.control.table_timing import transition_table
from palmbots.derivation.distributed_algorithm import machines_of
from palmbots.derivation.policy_file import read_policy
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import OUTCOMES, run_seeds

POLICIES = Path(__file__).parents[2] / "examples" / "policies"
EXAMPLES = sorted(POLICIES.glob("*.toml"))
BOTH_DRIVE = str(POLICIES / "both-drive.toml")
MIXED = str(POLICIES / "rest-mixed.toml")
NOISY = {"robot.noise_m_s": 0.02, "task.distance_m": 0.6}


def table_2_as_machines() -> ControllerEntry:
    """The paper's algorithm, whose compiled table is fixed, as a table that is data."""
    compiled = transition_table(resolve("distributed"), Scene())
    assert compiled is not None
    number = {state["name"]: k for k, state in enumerate(compiled["states"])}
    awaited = {"a_or_b_request": "Ack", "b_wait_ack": "Ack", "b_wait_down": "TiltDown",
               "c_wait_down": "TiltDown"}  # fmt: skip
    states = tuple((state["case"], state["palm"], state["move"], state["waits"],
                    awaited.get(state["name"], "")) for state in compiled["states"])  # fmt: skip
    rows = []
    for row in compiled["rows"]:
        (start,) = row["states"]
        # One row for each message; the one without a message comes last, because it looks at none.
        for heard in sorted(row["heard"] or [""], reverse=True):
            rows.append((number[start], row["contact"], heard, row["when"] == ["turned"],
                         number[row["next"]], row["send"]))  # fmt: skip
    table = (states, tuple(rows))
    return ControllerEntry("table-2-as-data", "", machines=(table, table))


@pytest.mark.parametrize("precision", ["double", "float"])
def test_table_2_as_data_carries_bit_for_bit_as_compiled(precision: str) -> None:
    data = table_2_as_machines()
    for seed in range(8):
        one = pb.carry("paper", data, seed=seed, precision=precision, overrides=NOISY)
        two = pb.carry("paper", "distributed", seed=seed, precision=precision, overrides=NOISY)
        assert one.trace_hash == two.trace_hash
        assert one.messages == two.messages
        assert one.waiting_s == two.waiting_s


def test_table_2_as_data_carries_in_mujoco_as_compiled() -> None:
    pytest.importorskip("mujoco")
    short = {"task.distance_m": 0.1}
    one, two = (pb.carry("paper", controller, world="mujoco", seed=2, overrides=short)
                for controller in (table_2_as_machines(), "distributed"))  # fmt: skip
    assert one.trace_hash == two.trace_hash


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_compiled_machine_steps_as_its_rows_say(path: Path) -> None:
    """Every state and input of both robots."""
    machines = machines_of(read_policy(path))
    core = _core.Machines(*(machine.for_core() for machine in machines))
    heard = ("", "TiltUp", "TiltDown", "Ack")
    for side, machine in enumerate(machines):
        names = [state.name for state in machine.states]
        reached, queue = {}, [_core.MachineRobot(core, side)]
        while queue:
            robot = queue.pop()
            state = robot.memory[0]
            if state in reached:
                continue
            reached[state] = robot
            for sign, message, settled in product((-1, 0, 1), range(4), (False, True)):
                after = robot.__copy__()
                palm, move, sent, read = after.step(sign, message, settled)
                row = row_of(machine, names[state], sign, heard[message], settled)
                assert names[after.memory[0]] == (names[state] if row is None else row.next)
                output = machine.states[after.memory[0]]
                assert (palm, move) == (
                    ("steep", "shallow").index(output.palm),
                    ("hold", "away", "closer").index(output.move),
                )
                assert heard[sent] == ("" if row is None else row.send)
                assert read == (row is not None and row.heard != "")
                queue.append(after)
        assert len(reached) == len(names)  # no state is useless


def test_entry_can_be_sent_to_another_process() -> None:
    entry = resolve(BOTH_DRIVE)
    assert pickle.loads(pickle.dumps(entry)) == entry


@pytest.mark.parametrize("name", ["table-1", "both-drive", "rest-shallow"])
def test_example_delivers(name: str) -> None:
    done = pb.carry("paper", str(POLICIES / f"{name}.toml"), seed=1)
    assert done.outcome == "delivered"
    assert done.controller == f"{name}.toml"
    assert done.corrections


def test_rest_shallow_asks_for_negative_contacts_only() -> None:
    """And Table 1 for positive ones only: a request is a TiltDown here and a TiltUp there."""
    for name, request, case in (("rest-shallow", "TiltDown", "d"), ("table-1", "TiltUp", "a")):
        done = pb.carry("paper", str(POLICIES / f"{name}.toml"), seed=1)
        asked = [row.sent_s for row in done.message_log if row.kind == request]
        began = [c.start_s for c in done.corrections if c.case == case]
        assert len(asked) > 3
        assert np.allclose(asked, began)


def test_assistant_drives_only_in_the_policy_that_says_so() -> None:
    for name, drives in (("table-1", False), ("both-drive", True)):
        trace = pb.carry("paper", str(POLICIES / f"{name}.toml"), seed=1).trace
        assert trace is not None
        serves = trace["case"].to_numpy() == "c"
        nominal = load_scene("paper").robot_of("left").speed_m_s
        moved = np.abs(trace["commanded"].to_numpy()[serves] - nominal) > 1e-9
        assert moved.any() == drives


def test_batch_stops_at_once_and_keeps_what_is_done() -> None:
    def watch(finished: int) -> None:
        if finished > 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        run_seeds(to_spec(load_scene("paper")), BOTH_DRIVE, 0, 200_000, watch=watch)
    (columns,) = stopped.value.args
    assert 0 < columns["finished"].sum() < 200_000


def test_drop_rate_agrees_with_plain_carries() -> None:
    noisy = {"robot.noise_m_s": 0.03, "task.distance_m": 0.6}
    estimate = pb.estimate_drop_rate("paper", BOTH_DRIVE, relative_half_width=0.5, effort=100,
                                     overrides=noisy)  # fmt: skip
    n = 2000
    dropped = run_seeds(to_spec(load_scene("paper", noisy)), BOTH_DRIVE, 1000, n)["outcome"]
    rate = float((dropped == OUTCOMES.index("dropped")).mean())
    low, high = estimate.interval
    margin = 4 * (rate * (1 - rate) / n) ** 0.5  # four standard errors
    assert low - margin < rate < high + margin


def test_a_policy_that_fails_runs_only_unproved() -> None:
    with pytest.raises(PalmbotsError, match="fails S1"):
        pb.carry("paper", MIXED)
    entry = resolve(MIXED, unproved=True)
    assert pb.carry("paper", entry).outcome == "delivered"
    assert entry.spelled == f"{MIXED} --unproved"
