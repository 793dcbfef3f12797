# SPDX-License-Identifier: Apache-2.0
"""A file appears whole or not at all, and every refusal is one clear line."""

import os
import stat
from pathlib import Path

import pytest

from palmbots._util.atomic_files import (
    check_file,
    check_folder,
    folder,
    set_aside,
    whole_file,
    write_whole,
)
from palmbots.errors import PalmbotsError


def only_line(error):
    text = str(error.value)
    assert "\n" not in text
    return text


def test_writes_bytes_and_text(tmp_path):
    write_whole(tmp_path / "a.txt", "θ = 5°\n")
    write_whole(tmp_path / "b.bin", b"\x00\xff")
    assert (tmp_path / "a.txt").read_text(encoding="utf-8") == "θ = 5°\n"
    assert (tmp_path / "b.bin").read_bytes() == b"\x00\xff"
    assert sorted(os.listdir(tmp_path)) == ["a.txt", "b.bin"]


def test_permissions_follow_the_umask(tmp_path):
    before = os.umask(0o027)
    try:
        write_whole(tmp_path / "a", "x")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


@pytest.mark.parametrize("interruption", [ValueError, KeyboardInterrupt])
def test_failure_leaves_the_old_file_and_nothing_else(tmp_path, interruption):
    path = tmp_path / "log"
    write_whole(path, "old")
    with pytest.raises(interruption), whole_file(path) as stream:
        stream.write(b"half of the ne")
        raise interruption
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["log"]


def test_nothing_is_visible_before_the_end(tmp_path):
    with whole_file(tmp_path / "log") as stream:
        stream.write(b"x")
        assert not (tmp_path / "log").exists()
    assert (tmp_path / "log").exists()


def test_full_disk_is_one_line(tmp_path):
    with pytest.raises(PalmbotsError) as error, whole_file(tmp_path / "log"):
        raise OSError(28, "No space left on device")
    assert only_line(error) == f"{tmp_path / 'log'}: cannot be written: No space left on device"
    assert os.listdir(tmp_path) == []


def test_new_file_never_replaces_one_that_appears_meanwhile(tmp_path):
    with (
        pytest.raises(PalmbotsError, match="exists already"),
        whole_file(tmp_path / "late", new=True) as stream,
    ):
        stream.write(b"new")
        write_whole(tmp_path / "late", "old")  # meanwhile
    assert (tmp_path / "late").read_text() == "old"
    assert os.listdir(tmp_path) == ["late"]


def test_link_is_followed(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "target")
    write_whole(tmp_path / "link", "x")
    assert (tmp_path / "target").read_text() == "x"
    assert (tmp_path / "link").is_symlink()


def test_name_of_255_bytes_is_written(tmp_path):
    write_whole(tmp_path / ("n" * 255), "x")


def test_folder(tmp_path):
    assert folder(tmp_path / "a" / "b").is_dir()
    assert folder(tmp_path / "a" / "b") == tmp_path / "a" / "b"


def test_folder_is_checked_without_being_created(tmp_path):
    check_folder(tmp_path)
    check_folder(tmp_path / "new" / "newer")
    assert os.listdir(tmp_path) == []


def test_folder_below_a_removed_working_directory_is_refused(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    for call in (check_folder, folder, check_file):
        with pytest.raises(PalmbotsError, match=r"^new: cannot be written: No such file"):
            call("new")


def test_set_aside_uses_the_first_free_name(tmp_path):
    for round_ in range(3):
        write_whole(tmp_path / "box.json", f"{round_}")
        set_aside(tmp_path / "box.json")
    texts = {name: (tmp_path / name).read_text() for name in os.listdir(tmp_path)}
    assert texts == {"box.json.old": "0", "box.json.old2": "1", "box.json.old3": "2"}


def test_folders_and_devices_are_not_set_aside(tmp_path):
    assert set_aside(tmp_path / "missing") is None
    assert set_aside(tmp_path) is None
    assert set_aside(Path(os.devnull)) is None
    assert os.listdir(tmp_path) == []


def test_link_is_set_aside_without_its_target(tmp_path):
    write_whole(tmp_path / "real", "x")
    (tmp_path / "link").symlink_to("real")
    assert set_aside(tmp_path / "link") == tmp_path / "link.old"
    assert sorted(os.listdir(tmp_path)) == ["link.old", "real"]
