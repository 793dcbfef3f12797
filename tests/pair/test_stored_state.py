# SPDX-License-Identifier: Apache-2.0
"""The boot counter: never used twice, and refused where it is missing or damaged."""

from pathlib import Path

import pytest

import palmbots as pb
from palmbots.pair.stored_state import (
    StateFile,
    StoredState,
    booted,
    held,
    read_state,
    write_state,
)
from palmbots.wire import MAX_EPOCH


def left_in(folder: Path) -> StateFile:
    return StateFile(folder / "left.json", 7, "left")


def test_what_is_written_is_read(tmp_path: Path) -> None:
    file = left_in(tmp_path)
    for state in (StoredState(), StoredState(7, True, True, False, 0.42), StoredState(MAX_EPOCH)):
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
    with booted(file) as state:
        for use in (booted, held):
            with pytest.raises(pb.PalmbotsError, match=r"another program uses this boot counter; "):
                use(file).__enter__()
        assert read_state(file) == state == StoredState(1)
    with booted(file) as state:
        assert state == StoredState(2)
