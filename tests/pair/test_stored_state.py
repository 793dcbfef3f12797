# SPDX-License-Identifier: Apache-2.0
"""The boot counter: never used twice, and refused where it is missing or damaged."""

import json
import math
import os
import threading
import time
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.drivers.arm import StoredArm
from palmbots.pair import stored_state
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.pair.stored_state import (
    StateFile,
    StoredState,
    booted,
    held,
    read_state,
    write_state,
)
from palmbots.robot import storage_thread
from palmbots.wire import MAX_EPOCH

UP = StoredState(3, carries=True, holds=True, arm=StoredArm(0.15, 0.1), approached_m=0.12)


def left_in(folder: Path) -> StateFile:
    return StateFile(folder / "left.json", 7, "left")


def test_what_is_written_is_read(tmp_path: Path) -> None:
    file = left_in(tmp_path)
    carrying, most = StoredState(7, True, True, False, 0.42), StoredState(MAX_EPOCH)
    for state in (StoredState(), carrying, UP, most):
        write_state(file, state)
        assert read_state(file) == state


def test_a_boot_counts_one_further_and_keeps_the_rest() -> None:
    assert StoredState(7, True).booted() == StoredState(8, True)


def test_every_truncation_and_every_changed_byte_is_refused(tmp_path: Path) -> None:
    file = left_in(tmp_path)
    write_state(file, StoredState(123, True))
    whole = file.path.read_bytes()
    for size in range(len(whole) - 1):  # the last byte is the end of the line
        file.path.write_bytes(whole[:size])
        with pytest.raises(pb.PalmbotsError, match=r"the boot counter is damaged; "):
            read_state(file)
    for place in range(len(whole) - 1):
        for flip in (1, 2, 16):
            file.path.write_bytes(whole[:place] + bytes([whole[place] ^ flip]) + whole[place + 1 :])
            with pytest.raises(pb.PalmbotsError, match=r"the boot counter is damaged; "):
                read_state(file)


def test_a_second_program_of_the_same_end_is_refused_and_counts_no_boot(tmp_path: Path) -> None:
    """Otherwise the first one would set the counter back when it stores its own state."""
    file = left_in(tmp_path)
    write_state(file, StoredState())
    file.path.with_suffix(".lock").write_text("12345")  # of a program that has ended
    with booted(file) as state:
        for use in (booted, held):
            line = rf"process {os.getpid()} uses this boot counter; .*; end that one first$"
            with pytest.raises(pb.PalmbotsError, match=line):
                use(file).__enter__()
        assert read_state(file) == state == StoredState(1)
    with booted(file) as state:
        assert state == StoredState(2)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("covered_m", "x"), ("covered_m", math.nan), ("covered_m", True), ("stop", "no"),
        ("stop", 1), ("epoch", True), ("epoch", -5), ("epoch", 1.5), ("epoch", MAX_EPOCH + 1),
        ("pair", True), ("carries", None), ("approached_m", math.inf), ("arm", 0.0), ("arm", [0.1]),
        ("arm", [0.1, "x"]), ("arm", [0.1, math.nan]),
    ],
)  # fmt: skip
def test_values_of_other_types_are_refused(field: str, value: Any, tmp_path: Path) -> None:
    file = left_in(tmp_path)
    content = {"pair": 7, "end": "left"} | asdict(StoredState()) | {field: value}
    check = stored_state._check(content)
    file.path.write_text(json.dumps(content | {"check": check}))
    with pytest.raises(pb.PalmbotsError, match=r"the boot counter is damaged; "):
        read_state(file)


def test_a_pipe_is_refused_and_keeps_nobody_waiting(tmp_path: Path) -> None:
    file = left_in(tmp_path)
    os.mkfifo(file.path)
    with pytest.raises(pb.PalmbotsError, match="it is not a regular file"):
        read_state(file)
    toml = init_pair(tmp_path / "pair.toml")[0]
    key = tmp_path / "pair.key"
    key.unlink()
    os.mkfifo(key, 0o600)
    with pytest.raises(pb.PalmbotsError, match="it is not a regular file"):
        load_pair(toml)


def test_a_boot_forgets_what_could_not_be_stored_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = left_in(tmp_path)
    write_state(file, StoredState(1))
    monkeypatch.setattr(storage_thread, "_RETRY_S", 0.001)
    fails = threading.Event()
    tries = threading.Semaphore(0)

    def write(file: StateFile, state: StoredState) -> None:
        tries.release()
        if fails.is_set():
            raise pb.PalmbotsError("the disk is full")
        write_state(file, state)

    monkeypatch.setattr(storage_thread, "write_state", write)
    with storage_thread.StateWriter(file, StoredState(1)) as keeper:
        fails.set()
        keeper.keep(StoredState(1, carries=True))
        for _ in range(3):
            assert tries.acquire(timeout=60)
        with keeper._lock:  # between two attempts
            fails.clear()
            keeper._missing = StoredState(1, assists=True)
        assert keeper.boot().epoch == 2
    assert read_state(file).epoch == 2
    assert keeper._missing is None


def test_a_boot_is_written_after_what_a_slow_disk_still_had_to_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = left_in(tmp_path)
    write_state(file, StoredState(1))

    def slow(file: StateFile, state: StoredState) -> None:
        time.sleep(0.02)
        write_state(file, state)

    monkeypatch.setattr(storage_thread, "write_state", slow)
    with storage_thread.StateWriter(file, StoredState(1)) as keeper:
        for covered_m in (0.1, 0.2, 0.3):
            keeper.keep(StoredState(1, carries=True, covered_m=covered_m))
        booted = keeper.boot()
        keeper.settle()
        assert read_state(file) == booted == StoredState(2, carries=True, covered_m=0.3)


@pytest.mark.parametrize(
    ("change", "is_done"),
    [
        ({"assists": True}, False), ({"carries": False}, False), ({"stop": True}, False),
        ({"covered_m": 0.5}, True), ({"approached_m": 0.02}, True),
        ({"arm": StoredArm(0.1, 0.1)}, False),
    ],
)  # fmt: skip
def test_the_partner_waits_for_all_but_distances(
    tmp_path: Path, change: dict[str, Any], is_done: bool
) -> None:
    before = StoredState(1, carries=True)
    keeper = storage_thread.StateWriter(left_in(tmp_path), before)  # its thread does not run
    assert keeper.is_done
    keeper.keep(replace(before, **change))
    assert keeper.is_done is is_done
