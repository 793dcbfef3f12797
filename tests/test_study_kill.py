"""What may befall a study: killed at any moment, no room, folders that are not its own.

Every fault is the real thing: real processes, killed by SIGKILL; a real limit of the file size and
a real full file system.
"""

import contextlib
import fcntl
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from palmbots import cli
from studies import LONG, command, marks, refused, said_here, study, study_here


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("long") / "long.toml"
    file.write_text(LONG)
    return file


@pytest.fixture(scope="module")
def whole(long: Path) -> str:
    """The hash of a run that nothing befell, on one thread in another cut."""
    return said_here(long, "--out", long.parent / "whole", "--chunk", 1500, "--threads", 1)["hash"]


def killed_after(root: Path, chunks: int, delay_s: float, *arguments: object) -> set[str]:
    """Start a study, kill it when so many chunks are kept and a moment has passed."""
    process = subprocess.Popen(
        command(*arguments), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    deadline = time.monotonic() + 60
    while len(marks(root)) < chunks and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.005)
    time.sleep(delay_s)
    process.kill()
    process.wait(timeout=60)
    return marks(root)


def test_killed_again_and_again_the_result_is_the_same(
    long: Path, whole: str, tmp_path: Path
) -> None:
    rng = random.Random(2)
    root = tmp_path / "study"
    arguments = (long, "--out", root, "--chunk", 200)
    kept: set[str] = set()
    for _ in range(6):
        now = killed_after(root, len(kept) + 1, rng.uniform(0, 0.15), *arguments)
        assert now > kept, "a run that is killed gets somewhere, and nothing is lost"
        kept = now
    assert len(kept) < 48, "it was not killed but had ended"
    told = said_here(*arguments)
    assert told["hash"] == whole
    assert told["carries"] == 9600
    assert told["resumed"] == 200 * len(kept)
    assert not [path for path in root.rglob("*") if path.suffix in (".part", ".partial")]


def test_killed_while_it_begins(long: Path, whole: str, tmp_path: Path) -> None:
    """At any instant of its first second, in which the folder is made."""
    rng = random.Random(5)
    root = tmp_path / "study"
    for _ in range(4):
        process = subprocess.Popen(command(long, "--out", root), stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while not (root / "lock").exists() and time.monotonic() < deadline:
            time.sleep(0.001)
        time.sleep(rng.uniform(0, 0.15))
        process.kill()
        process.wait(timeout=60)
        if marks(root) or rng.random() < 0.5:
            shutil.rmtree(root)
    told = said_here(long, "--out", root)
    assert told["hash"] == whole


def test_ctrl_c_keeps_what_is_finished(long: Path, whole: str, tmp_path: Path) -> None:
    root = tmp_path / "study"
    process = subprocess.Popen(
        command(long, "--out", root, "--chunk", 200), stderr=subprocess.PIPE, text=True
    )
    while len(marks(root)) < 3:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=60)
    assert process.returncode == 130
    assert error.count("\n") == 1
    assert f"kept in {root}" in error
    assert said_here(long, "--out", root)["hash"] == whole


def test_a_second_process_is_refused(long: Path, whole: str, tmp_path: Path) -> None:
    root = tmp_path / "study"
    with subprocess.Popen(command(long, "--out", root, "--chunk", 200)) as process:
        while len(marks(root)) < 1:
            time.sleep(0.01)
        refused(study_here(long, "--out", root), root, "in use by another")
        process.kill()
    assert said_here(long, "--out", root)["hash"] == whole


def test_a_lock_outlives_nobody(long: Path, tmp_path: Path) -> None:
    root = tmp_path / "study"
    said_here(long, "-n", 2, "--out", root)
    with open(root / "lock", "ab") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        refused(study_here(long, "-n", 2, "--out", root), "in use by another")
    assert said_here(long, "-n", 2, "--out", root)["resumed"] == 48


def test_no_room_in_a_file(long: Path, whole: str, tmp_path: Path) -> None:
    """A limit of the file size, below what one chunk of results needs."""
    root = tmp_path / "study"
    said_so = study(
        long, "--out", root, "--chunk", 1500, "--threads", 2,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000)),
    )  # fmt: skip
    refused(said_so, root, "cannot be written: File too large", "kept: make room")
    assert said_here(long, "--out", root)["hash"] == whole


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
def test_a_full_disk(long: Path, whole: str, tmp_path: Path) -> None:
    """What was finished is kept; with more room it goes on."""
    with small_disk(tmp_path / "disk", 600) as disk:
        root = disk / "study"
        refused(study_here(long, "--out", root, "--chunk", 200), root, "No space left", "make room")
        kept = marks(root)
        assert kept
        room = tmp_path / "room"
        shutil.copytree(root, room)
    told = said_here(long, "--out", room)
    assert told["hash"] == whole
    assert told["resumed"] == 200 * len(kept)


Here = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def here(capsys: pytest.CaptureFixture[str]) -> Here:
    """The command in this process: as good as a real one where it only refuses."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        status = cli.run(["study", *map(str, arguments)])
        told = capsys.readouterr()
        return subprocess.CompletedProcess([], status, told.out, told.err)

    return run


def test_a_foreign_folder_is_left_alone(here: Here, long: Path, tmp_path: Path) -> None:
    (tmp_path / "letters.txt").write_text("mine")
    refused(here(long, "--out", tmp_path), tmp_path, "no study's folder", "letters.txt")
    assert [p.name for p in tmp_path.iterdir()] == ["letters.txt"]
    (tmp_path / "study.json").write_text('{"a": 1}')
    refused(here(long, "--out", tmp_path), tmp_path, "study.json")
    file = tmp_path / "letters.txt"
    refused(here(long, "--out", file), file, "a file has this name")
    assert file.read_text() == "mine"


def test_a_changed_study_is_refused(here: Here, long: Path, tmp_path: Path) -> None:
    root, file = tmp_path / "study", tmp_path / "few.toml"
    few = LONG.replace("count = 400", "count = 3")
    file.write_text(few)
    told = json.loads(here(file, "--out", root, "--json").stdout)
    for old, new, words in (
        ("count = 3", "count = 4", ["seeds.count is 3 there, 4 here"]),
        ("0.2]", "0.3]", ["vary.radio.latency_s"]),
        ('"distributed"', '"none"', ["controllers", "distributed", "none"]),
        ("[vary]", "[set]\npalm.friction = 0.4\n[vary]", ["scene.palm.friction is 0.3 there"]),
    ):
        file.write_text(few.replace(old, new))
        refused(here(file, "--out", root), root, "holds another study", *words)
    file.write_text("# a remark\n" + few)
    again = json.loads(here(file, "--out", root, "--json").stdout)
    assert again["hash"] == told["hash"]
    assert again["resumed"] == 72


def test_another_version_is_refused(here: Here, long: Path, tmp_path: Path) -> None:
    root = tmp_path / "study"
    here(long, "-n", 2, "--out", root)
    record = json.loads((root / "study.json").read_text())
    record["content"]["version"], record["identity"] = "0.0.9", "0"
    (root / "study.json").write_text(json.dumps(record))
    refused(here(long, "-n", 2, "--out", root), "begun with palmbots 0.0.9, this is 0.1.0")


def test_another_cut_is_refused(here: Here, long: Path, tmp_path: Path) -> None:
    root = tmp_path / "study"
    here(long, "-n", 8, "--out", root, "--chunk", 16)
    refused(here(long, "-n", 8, "--out", root, "--chunk", 32), "chunks of 16 carries", "--chunk")
    assert "192 carries had been kept" in here(long, "-n", 8, "--out", root).stdout
