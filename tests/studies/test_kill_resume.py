# SPDX-License-Identifier: Apache-2.0
"""Faults: a study is killed at any moment, the disk is full, the folder belongs to another study.

Every fault is the real thing: real processes, killed by SIGKILL; a real limit of the file size and
a real full file system.
"""

import contextlib
import fcntl
import json
import os
import resource
import shutil
import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pytest

import at_call
from palmbots.cli import main as cli
from palmbots.studies.store import Store
from study_fixtures import CHUNK, LONG, marks, refused, said_here, study_here


def killed(when: str, function: Callable[..., Any] | str, count: int, *arguments: object) -> None:
    """Run a study that is killed at a call of a function."""
    status = at_call.fork("SIGKILL", when, function, count, lambda: study_here(*arguments))
    assert status == -signal.SIGKILL


WRITE_WHOLE = "palmbots.studies.store:write_whole"
MAKE_ARRAYS = "palmbots.studies.store:make_arrays"
# The last thing that a run does.
IN_MID_RUN = {
    "it has one chunk and the results of another are ready": ("before", Store.write, 2),
    "results of a chunk are written, their mark is not": ("before", WRITE_WHOLE, 2),
    "two chunks are written": ("after", Store.write, 2),
}
AT_THE_BEGINNING = {
    "the folder is made": ("after", "palmbots.studies.store:folder", 1),
    "the lock is held": ("before", WRITE_WHOLE, 1),
    "the record is written": ("after", WRITE_WHOLE, 1),
    "the arrays are to be made": ("before", MAKE_ARRAYS, 1),
    "the arrays are made and not in their place": ("after", MAKE_ARRAYS, 1),
}


def test_repeatedly_killed_study_has_the_same_result(
    long: Path, whole: str, tmp_path: Path
) -> None:
    root = tmp_path / "study"
    arguments = (long, "--out", root, "--chunk-size", CHUNK)
    kept: set[str] = set()
    for when, function, count in IN_MID_RUN.values():
        killed(when, function, count, *arguments)
        now = marks(root)
        assert now > kept, "a run that is killed gets somewhere, and nothing is lost"
        kept = now
    assert len(kept) < 12, "it was not killed but had ended"
    summary = said_here(*arguments)
    assert summary["hash"] == whole
    assert summary["carries"] == 960
    assert summary["resumed"] == CHUNK * len(kept)
    assert not [path for path in root.rglob("*") if path.suffix in (".part", ".partial")]


def test_study_killed_while_it_begins_continues(long: Path, whole: str, tmp_path: Path) -> None:
    """At each step in which the folder is made, one after the other in the same folder."""
    root = tmp_path / "study"
    for when, function, count in AT_THE_BEGINNING.values():
        killed(when, function, count, long, "--out", root)
    summary = said_here(long, "--out", root)
    assert summary["hash"] == whole


@pytest.mark.slow
def test_ctrl_c_keeps_completed_chunks(long: Path, whole: str, tmp_path: Path) -> None:
    root = tmp_path / "study"
    words = ("study", long, "--out", root, "--chunk-size", CHUNK)
    done = subprocess.run(
        at_call.command("SIGINT", "after", Store.write, 3, *words),
        stderr=subprocess.PIPE, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 130
    assert done.stderr.count("\n") == 1
    assert f"kept in {root}" in done.stderr
    assert 3 <= len(marks(root)) < 12
    assert said_here(long, "--out", root)["hash"] == whole


@pytest.mark.slow
def test_second_process_is_refused(long: Path, whole: str, tmp_path: Path) -> None:
    root = tmp_path / "study"
    words = ("study", long, "--out", root, "--chunk-size", CHUNK)
    stopped = at_call.command("SIGSTOP", "after", Store.write, 1, *words)
    with subprocess.Popen(stopped) as process:
        try:
            at_call.wait_until_stopped(process)
            second = study_here(long, "--out", root)
        finally:
            process.kill()
    refused(second, root, "another palmbots study is using this folder")
    assert said_here(long, "--out", root)["hash"] == whole


def test_lock_of_a_dead_process_is_ignored(long: Path, tmp_path: Path) -> None:
    root = tmp_path / "study"
    said_here(long, "-n", 2, "--out", root)
    with open(root / "lock", "ab") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        refused(study_here(long, "-n", 2, "--out", root), "another palmbots study is using")
    assert said_here(long, "-n", 2, "--out", root)["resumed"] == 48


@pytest.mark.parametrize(("function", "count"), [("make_arrays", 1), ("Store.write", 3)])
def test_file_size_limit_ends_the_study_and_keeps_its_chunks(
    long: Path, whole: str, tmp_path: Path, function: str, count: int
) -> None:
    """A limit of the file size, below what the arrays or one chunk of results need."""
    root = tmp_path / "study"
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    name = f"palmbots.studies.store.{function}"
    limit = at_call.wrapped(
        lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, usual[1])),
        "before", resolve_name(name), count,
    )  # fmt: skip
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(name, limit)
        try:
            done = study_here(long, "--out", root, "--chunk-size", CHUNK)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    refused(done, root, "cannot be written: File too large", "kept: make room")
    kept = marks(root)
    assert len(kept) == count - 1
    summary = said_here(long, "--out", root)
    assert (summary["hash"], summary["resumed"]) == (whole, CHUNK * len(kept))


@contextlib.contextmanager
def small_disk(place: Path, kib: int) -> Iterator[Path]:
    place.mkdir()
    mounted = ["mount", "-t", "tmpfs", "-o", f"size={kib}k", "tmpfs", str(place)]
    subprocess.run(mounted, check=True)
    try:
        yield place
    finally:
        subprocess.run(["umount", str(place)], check=True)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may mount a small disk")
def test_full_disk_ends_the_study_and_keeps_its_chunks(
    long: Path, whole: str, tmp_path: Path
) -> None:
    """What was finished is kept; with more room it goes on."""
    with small_disk(tmp_path / "disk", 600) as disk:
        root = disk / "study"
        refused(
            study_here(long, "--out", root, "--chunk-size", CHUNK),
            root, "No space left", "make room",
        )  # fmt: skip
        kept = marks(root)
        assert kept
        room = tmp_path / "room"
        shutil.copytree(root, room)
    summary = said_here(long, "--out", room)
    assert summary["hash"] == whole
    assert summary["resumed"] == CHUNK * len(kept)


Here = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def here(capsys: pytest.CaptureFixture[str]) -> Here:
    """The command in this process: as good as a real one where it only refuses."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        status = cli.run(["study", *map(str, arguments)])
        summary = capsys.readouterr()
        return subprocess.CompletedProcess([], status, summary.out, summary.err)

    return run


def test_folder_of_something_else_is_refused_and_unchanged(
    here: Here, long: Path, tmp_path: Path
) -> None:
    (tmp_path / "letters.txt").write_text("mine")
    refused(
        here(long, "--out", tmp_path), tmp_path, "this is not the folder of a study", "letters.txt"
    )
    assert [p.name for p in tmp_path.iterdir()] == ["letters.txt"]
    (tmp_path / "study.json").write_text('{"a": 1}')
    refused(here(long, "--out", tmp_path), tmp_path, "study.json")
    file = tmp_path / "letters.txt"
    refused(here(long, "--out", file), file, "a file has this name")
    assert file.read_text() == "mine"


def test_changed_study_is_refused(here: Here, long: Path, tmp_path: Path) -> None:
    root, file = tmp_path / "study", tmp_path / "few.toml"
    few = LONG.replace("count = 40", "count = 3")
    file.write_text(few)
    summary = json.loads(here(file, "--out", root, "--json").stdout)
    for old, new, words in (
        ("count = 3", "count = 4", ["seeds.count is 3 there and 4 here"]),
        ("0.2]", "0.3]", ["vary.radio.latency_s"]),
        ('"distributed"', '"none"', ["controllers", "distributed", "none"]),
        ("[vary]", "palm.friction = 0.4\n[vary]", ["scene.palm.friction is 0.3 there"]),
    ):
        file.write_text(few.replace(old, new))
        refused(here(file, "--out", root), root, "this folder holds another study", *words)
    file.write_text("# a remark\n" + few)
    again = json.loads(here(file, "--out", root, "--json").stdout)
    assert again["hash"] == summary["hash"]
    assert again["resumed"] == 72


def test_study_of_another_version_is_refused(here: Here, long: Path, tmp_path: Path) -> None:
    root = tmp_path / "study"
    here(long, "-n", 2, "--out", root)
    record = json.loads((root / "study.json").read_text())
    record["content"]["version"], record["identity"] = "0.0.9", "0"
    (root / "study.json").write_text(json.dumps(record))
    refused(
        here(long, "-n", 2, "--out", root), "begun with palmbots 0.0.9, and this is palmbots 0.1.0"
    )


def test_other_chunk_size_is_refused(here: Here, long: Path, tmp_path: Path) -> None:
    root = tmp_path / "study"
    here(long, "-n", 8, "--out", root, "--chunk-size", 16)
    refused(
        here(long, "-n", 8, "--out", root, "--chunk-size", 32),
        "begun with chunks of 16 carries",
        "the same chunk size or none",
    )
    assert "192 carries from earlier runs" in here(long, "-n", 8, "--out", root).stdout
