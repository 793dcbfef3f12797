"""The same study on a real Dask scheduler with real worker processes, one of them killed."""

import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from studies import LONG, command, marks, refused, said, said_here, study, study_here

TIMEOUT_S = 60


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("long") / "long.toml"
    file.write_text(LONG)
    return file


@pytest.fixture(scope="module")
def whole(long: Path) -> str:
    """The hash of the study carried here, without a cluster."""
    return said_here(long, "--out", long.parent / "whole")["hash"]


@contextlib.contextmanager
def started(
    words: list[str], ready: str, env: dict[str, str] | None = None
) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """A process that has said it is ready, and how it said so; killed in the end."""
    with (
        tempfile.NamedTemporaryFile() as log,
        subprocess.Popen(
            [sys.executable, "-m", *words], stderr=log, env=os.environ | (env or {})
        ) as process,
    ):
        try:
            deadline = time.monotonic() + TIMEOUT_S
            while not (found := re.search(ready, Path(log.name).read_text())):
                assert process.poll() is None, Path(log.name).read_text()
                assert time.monotonic() < deadline
                time.sleep(0.02)
            yield process, found[0]
        finally:
            process.kill()


@contextlib.contextmanager
def scheduler() -> Iterator[str]:
    words = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    with started(["distributed.cli.dask_scheduler", *words], r"tcp://127\.0\.0\.1:\d+") as up:
        yield up[1]


@contextlib.contextmanager
def worker(address: str, env: dict[str, str] | None = None) -> Iterator[subprocess.Popen[bytes]]:
    words = ["distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny"]
    with started([*words, "--no-dashboard"], "Registered to", env) as up:
        yield up[0]


def test_a_worker_is_killed_in_mid_run_and_another_one_comes(
    long: Path, whole: str, tmp_path: Path
) -> None:
    root = tmp_path / "study"
    with scheduler() as address, worker(address) as first, worker(address):
        process = subprocess.Popen(
            command(long, "--out", root, "--chunk", 200, "--scheduler", address, "--json"),
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        with process:
            while len(marks(root)) < 4 and process.poll() is None:
                time.sleep(0.01)
            first.kill()
            with worker(address):
                out, error = process.communicate(timeout=TIMEOUT_S)
    assert process.returncode == 0, error
    assert error == ""
    assert f'"hash": "{whole}"' in out


def test_the_scheduler_is_lost_and_the_study_goes_on_without_it(
    long: Path, whole: str, tmp_path: Path
) -> None:
    root = tmp_path / "study"
    with contextlib.ExitStack() as stack:
        address = stack.enter_context(scheduler())
        stack.enter_context(worker(address))
        process = subprocess.Popen(
            command(long, "--out", root, "--chunk", 200, "--scheduler", address),
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        while len(marks(root)) < 4 and process.poll() is None:
            time.sleep(0.01)
    out, error = process.communicate(timeout=TIMEOUT_S)
    refused(
        subprocess.CompletedProcess([], process.returncode, out, error),
        address, "was lost", "what was finished is kept",
    )  # fmt: skip
    kept = marks(root)
    assert kept
    told = said_here(long, "--out", root)
    assert told["hash"] == whole
    assert told["resumed"] == 200 * len(kept)


def test_a_local_cluster(long: Path, whole: str, tmp_path: Path) -> None:
    told = said(long, "--out", tmp_path / "study", "--local-cluster", 2)
    assert told["hash"] == whole


@pytest.mark.parametrize("chunks", [0, 3], ids=["while it begins", "in mid-run"])
def test_ctrl_c_in_a_terminal_reaches_workers_too(
    long: Path, whole: str, tmp_path: Path, chunks: int
) -> None:
    """One line, nobody left behind, and what was finished is kept."""
    root = tmp_path / "study"
    process = subprocess.Popen(
        command(long, "--out", root, "--chunk", 200, "--local-cluster", 2),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while not children.read_text() or len(marks(root)) < chunks:
        assert process.poll() is None
        time.sleep(0.01)
    time.sleep(0.8)  # while it begins: workers are just starting
    os.killpg(process.pid, signal.SIGINT)
    out, error = process.communicate(timeout=TIMEOUT_S)  # ends when all of them have ended
    assert (process.returncode, out) == (130, ""), error
    assert error.count("\n") == 1, error
    assert f"kept in {root}" in error
    if chunks:
        assert said_here(long, "--out", root)["hash"] == whole


OTHER = """
import palmbots.studies.work
palmbots.studies.work.__version__ = "0.0.9"
"""


def test_a_worker_with_another_version_is_refused(long: Path, tmp_path: Path) -> None:
    """One that is there, and one that comes when the study has begun."""
    (tmp_path / "sitecustomize.py").write_text(OTHER)
    path = {"PYTHONPATH": str(tmp_path)}
    with scheduler() as address:
        arguments = (long, "--out", tmp_path / "study", "--chunk", 200, "--scheduler", address)
        with worker(address, path):
            refused(study(*arguments), "the worker tcp://", "has palmbots 0.0.9", "same version")
        with worker(address):
            process = subprocess.Popen(
                command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
            )
            while len(marks(tmp_path / "study")) < 2 and process.poll() is None:
                time.sleep(0.01)
            with worker(address, path):
                out, error = process.communicate(timeout=TIMEOUT_S)
        done = subprocess.CompletedProcess([], process.returncode, out, error)
        refused(done, "has palmbots 0.0.9", "same version")
    assert marks(tmp_path / "study")


def test_two_cuts_of_one_study_do_not_meet(long: Path, whole: str, tmp_path: Path) -> None:
    """Side by side on one scheduler: equal chunk numbers, unlike chunks."""
    with scheduler() as address, worker(address):
        running = [
            subprocess.Popen(
                command(
                    long, "--out", tmp_path / n, "--chunk", n, "--scheduler", address, "--json"
                ),
                stdout=subprocess.PIPE, text=True,
            )
            for n in ("500", "700")
        ]  # fmt: skip
        for process in running:
            out, _ = process.communicate(timeout=2 * TIMEOUT_S)
            assert f'"hash": "{whole}"' in out


def test_nobody_there(long: Path, tmp_path: Path) -> None:
    done = study(long, "--out", tmp_path / "a", "--scheduler", "tcp://127.0.0.1:9")
    refused(done, "--scheduler tcp://127.0.0.1:9: cannot be reached", "dask scheduler")
    refused(study_here(long, "--out", tmp_path / "b", "--scheduler", "nonsense://x"), "nonsense")
    refused(study_here(long, "--out", tmp_path / "c", "--local-cluster", 0), "--local-cluster: 0")
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]  # nothing has begun
    both = ("--local-cluster", 1, "--scheduler", "tcp://127.0.0.1:9")
    refused(study_here(long, "--out", tmp_path / "d", *both), "one of them")
