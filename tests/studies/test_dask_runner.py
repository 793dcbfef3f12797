# SPDX-License-Identifier: Apache-2.0
"""The same study on a real Dask scheduler with real worker processes, one of them killed."""

import contextlib
import importlib
import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import at_call
from palmbots.errors import PalmbotsError
from palmbots.studies import dask_runner
from palmbots.studies.store import Store
from sampled import in_soak, sampled
from study_fixtures import CHUNK, marks, refused, said_here, study, study_here
from waiting import wait_until

pytestmark = pytest.mark.slow

TIMEOUT_S = 60


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

            def answer() -> re.Match[str] | None:
                text = Path(log.name).read_text()
                assert process.poll() is None, text
                return re.search(ready, text)

            wait_until(answer)
            found = answer()
            assert found is not None
            yield process, found[0]
        finally:
            process.kill()


@contextlib.contextmanager
def scheduler() -> Iterator[str]:
    words = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    with started(["distributed.cli.dask_scheduler", *words], r"tcp://127\.0\.0\.1:\d+") as up:
        yield up[1]


address_of: dict[int, str] = {}
"""Addresses of the workers, as their own logs state them."""


@contextlib.contextmanager
def worker(address: str, env: dict[str, str] | None = None) -> Iterator[subprocess.Popen[bytes]]:
    words = ["distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny"]
    ready = r"Start worker at: +(tcp://\S+)[\s\S]*Registered to"
    with started([*words, "--no-dashboard"], ready, env) as up:
        address_of[up[0].pid] = up[1].split()[3]
        yield up[0]


@pytest.fixture(scope="module")
def running() -> Iterator[contextlib.ExitStack]:
    """What ends the scheduler and the worker that the tests share."""
    importlib.import_module("distributed")  # its log goes to the stderr of this moment
    with contextlib.ExitStack() as stack:
        yield stack


@pytest.fixture(scope="module")
def shared(running: contextlib.ExitStack) -> str:
    """The address of a scheduler with a worker."""
    address = running.enter_context(scheduler())
    running.enter_context(worker(address))
    return address


def test_killed_worker_is_named_and_another_one_takes_over(
    shared: str, long: Path, whole: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with worker(shared) as first:

        def kill() -> None:
            first.kill()
            first.wait()

        monkeypatch.setattr(Store, "write", at_call.wrapped(kill, "after", Store.write, 4))
        words = ("--out", tmp_path / "study", "--chunk-size", CHUNK, "--scheduler", shared)
        done = study_here(long, *words, "--json")
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["hash"] == whole
    assert result["lost_workers"] == [address_of[first.pid]]
    warnings = done.stderr.split("palmbots:")[1:]  # each is wrapped
    assert all(address_of[first.pid] in line for line in warnings), done.stderr


def test_client_that_cannot_be_closed_hides_no_message(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in distributed, where closing meets a connection that is running out of time."""

    class LostClient:
        def __init__(self, *_: object, **__: object) -> None:
            pass

        def close(self) -> None:
            raise RuntimeError("Cannot change state of expiring Timeout")

    fake = SimpleNamespace(Client=LostClient)
    monkeypatch.setattr(dask_runner, "require", lambda *_: fake)
    with pytest.raises(PalmbotsError, match="was lost"), dask_runner._client("tcp://x", None):
        raise PalmbotsError("the connection was lost")


def test_local_cluster_has_the_same_results(long: Path, whole: str, tmp_path: Path) -> None:
    """And nothing but the result is printed while another cluster holds the usual port."""
    with socket.socket() as other:
        with contextlib.suppress(OSError):  # held already
            other.bind(("", 8787))
            other.listen()
        process = study(long, "--out", tmp_path / "study", "--local-cluster", 1, "--json")
    assert (process.returncode, process.stderr) == (0, "")
    result = json.loads(process.stdout)
    assert result["hash"] == whole
    assert result["lost_workers"] == []


@pytest.mark.parametrize(
    ("workers", "when", "function", "count"),
    [
        (2, "after", "palmbots.studies.store:Store.write", 3),
        in_soak(2, "before", "distributed.nanny:Nanny.instantiate", 2),
        in_soak(1, "before", "palmbots.studies.dask_runner:_check_workers", 1),
    ],
    ids=["in mid-run", "while a worker starts", "when all are there"],
)
def test_ctrl_c_ends_the_workers_and_prints_one_line(
    long: Path, whole: str, tmp_path: Path, workers: int, when: str, function: str, count: int
) -> None:
    """No process is left, and completed chunks are kept."""
    root = tmp_path / "study"
    words = ("study", long, "--out", root, "--chunk-size", CHUNK, "--local-cluster", workers)
    process = subprocess.Popen(
        at_call.command("SIGSTOP", when, function, count, *words),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    at_call.wait_until_stopped(process)
    os.killpg(process.pid, signal.SIGINT)
    process.send_signal(signal.SIGCONT)
    out, error = process.communicate(timeout=TIMEOUT_S)  # ends when all of them have ended
    assert (process.returncode, out) == (130, ""), error
    assert error.count("\n") == 1, error
    assert f"kept in {root}" in error
    if when == "after":
        assert said_here(long, "--out", root)["hash"] == whole


OTHER = """
import palmbots.studies.chunk_task
palmbots.studies.chunk_task.__version__ = "0.0.9"
"""


def test_worker_with_another_version_is_refused(
    shared: str, long: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that comes when the study has begun, and one that is there."""
    (tmp_path / "sitecustomize.py").write_text(OTHER)
    before = os.environ.get("PYTHONPATH")
    path = {"PYTHONPATH": os.pathsep.join([str(tmp_path), *([before] if before else [])])}
    arguments = (long, "--out", tmp_path / "study", "--chunk-size", CHUNK, "--scheduler", shared)
    with contextlib.ExitStack() as late:
        come = at_call.wrapped(
            lambda: late.enter_context(worker(shared, path)), "after", Store.write, 2
        )
        monkeypatch.setattr(Store, "write", come)
        refused(study_here(*arguments), "has palmbots 0.0.9", "same version")
        assert 2 <= len(marks(tmp_path / "study")) < 12
        refused(study_here(*arguments), "the worker tcp://", "has palmbots 0.0.9", "same version")


def test_two_chunk_sizes_on_one_scheduler_do_not_mix(
    shared: str, long: Path, whole: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Side by side on one scheduler: equal chunk numbers, unlike chunks."""

    def said(chunk: int) -> dict[str, Any]:
        words = ("--out", tmp_path / str(chunk), "--chunk-size", chunk, "--scheduler", shared)
        return said_here(long, *words)

    inner: list[dict[str, Any]] = []
    begin = at_call.wrapped(lambda: inner.append(said(2 * CHUNK)), "after", Store.write, 2)
    monkeypatch.setattr(Store, "write", begin)
    outer = said(CHUNK)
    assert [outer["hash"], *(one["hash"] for one in inner)] == [whole, whole]
    assert len(marks(tmp_path / str(CHUNK))) == 2 * len(marks(tmp_path / str(2 * CHUNK))) == 12


def test_scheduler_without_workers_or_address_is_refused(long: Path, tmp_path: Path) -> None:
    done = study_here(long, "--out", tmp_path / "a", "--scheduler", "tcp://127.0.0.1:9")
    refused(done, "scheduler tcp://127.0.0.1:9: cannot be reached", "dask scheduler")
    refused(study_here(long, "--out", tmp_path / "b", "--scheduler", "nonsense://x"), "nonsense")
    refused(
        study_here(long, "--out", tmp_path / "c", "--local-cluster", 0),
        "--local-cluster: value is 0; allowed: 1 to 1024",
    )
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]  # nothing has begun
    both = ("--local-cluster", 1, "--scheduler", "tcp://127.0.0.1:9")
    refused(study_here(long, "--out", tmp_path / "d", *both), "one of them")


@pytest.mark.parametrize(
    "before", sampled(["if __name__ == '__main__':\n    log = 1\n", "log = __name__\n", ""], 3)
)
def test_a_script_without_a_guard_is_refused_before_processes_import_it(
    before: str, tmp_path: Path
) -> None:
    """Also one that has a guard, or the name, elsewhere."""
    script = tmp_path / "mine.py"
    script.write_text(
        f"import palmbots as pb\n{before}pb.study('silent-map', 'out', local_cluster=1)\n"
    )
    run = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 1
    assert run.stderr.count("Traceback") == 1
    assert run.stderr.splitlines()[-1].endswith(
        "local_cluster: its processes import mine.py again; in that script, call the study below "
        'the line: if __name__ == "__main__":'
    )
    assert not (tmp_path / "out").exists()


def test_a_script_from_stdin_is_refused(tmp_path: Path) -> None:
    """No process could import it again, and each would print a traceback of its own."""
    script = "import palmbots as pb\npb.study('silent-map', 'out', local_cluster=1)\n"
    run = subprocess.run(
        [sys.executable, "-"], input=script, cwd=tmp_path, capture_output=True, text=True
    )
    assert run.returncode == 1 and run.stderr.count("Traceback") == 1
    assert run.stderr.splitlines()[-1].endswith("stdin; allowed: a script in a file")
    assert not (tmp_path / "out").exists()


def test_study_continues_without_a_lost_scheduler(
    running: contextlib.ExitStack, shared: str, long: Path, whole: str, tmp_path: Path
) -> None:
    """The last test here, because it ends the scheduler that the others share."""
    root = tmp_path / "study"
    words = ("study", long, "--out", root, "--chunk-size", CHUNK, "--scheduler", shared)
    process = subprocess.Popen(
        at_call.command("SIGSTOP", "after", Store.write, 4, *words),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    at_call.wait_until_stopped(process)
    running.close()
    process.send_signal(signal.SIGCONT)
    out, error = process.communicate(timeout=TIMEOUT_S)
    refused(
        subprocess.CompletedProcess([], process.returncode, out, error),
        shared, "the connection was lost", "completed chunks are kept",
    )  # fmt: skip
    kept = marks(root)
    assert kept
    summary = said_here(long, "--out", root)
    assert summary["hash"] == whole
    assert summary["resumed"] == CHUNK * len(kept)
