# SPDX-License-Identifier: Apache-2.0
"""Two jobs at once: results, errors, and children that are killed, with real processes."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from palmbots._util import fork_join as side_by_side
from palmbots._util.fork_join import both, can_fork
from palmbots.errors import PalmbotsError


@pytest.fixture(autouse=True)
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork on a machine with one core, too."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})


def refuse() -> int:
    """A job that fails."""
    raise PalmbotsError(f"refused in {os.getpid()}")


@pytest.fixture
def forks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork whatever threads other tests have left in this process."""
    monkeypatch.setattr(side_by_side, "can_fork", lambda: True)


@pytest.mark.usefixtures("forks")
def test_each_job_has_its_process() -> None:
    first, second = both(os.getpid, os.getpid)
    assert first == os.getpid() != second


def test_single_threaded_process_with_two_cores_can_fork() -> None:
    program = (
        "import os; os.sched_getaffinity = lambda _: {0, 1}\n"
        "from palmbots._util.fork_join import can_fork; print(can_fork())"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.stdout.split() == ["True"], run.stderr


def test_other_threads_forbid_the_fork() -> None:
    release = threading.Event()
    thread = threading.Thread(target=release.wait)
    thread.start()
    try:
        assert not can_fork()
        assert both(os.getpid, os.getpid) == (os.getpid(), os.getpid())
    finally:
        release.set()
        thread.join()


def test_one_core_forbids_the_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {3})
    assert not can_fork()


@pytest.mark.parametrize("forks", [True, False])
def test_errors_of_either_job_arrive(monkeypatch: pytest.MonkeyPatch, forks: bool) -> None:
    monkeypatch.setattr(side_by_side, "can_fork", lambda: forks)
    with pytest.raises(PalmbotsError, match=f"^refused in {os.getpid()}$"):
        both(refuse, lambda: 1)
    with pytest.raises(PalmbotsError, match=r"^refused in \d+$") as error:
        both(lambda: 1, refuse)
    assert str(error.value).endswith(f" {os.getpid()}") != forks


@pytest.mark.usefixtures("forks")
def test_child_has_ended_when_the_error_is_raised(tmp_path: Path) -> None:
    """The child has ended when the error arrives: its file is there, and it was waited for."""
    path, child = tmp_path / "second", tmp_path / "child"

    def second() -> None:
        child.write_text(str(os.getpid()))
        while not (tmp_path / "go").exists():
            pass
        path.write_text("whole")

    def first() -> None:
        (tmp_path / "go").touch()
        raise PalmbotsError("no")

    with pytest.raises(PalmbotsError):
        both(first, second)
    assert path.read_text() == "whole"
    # Only this child is asked for: a test worker may have others, such as a resource tracker.
    with pytest.raises(ChildProcessError):
        os.waitpid(int(child.read_text()), os.WNOHANG)


@pytest.mark.usefixtures("forks")
def test_job_of_a_killed_child_runs_in_the_parent(capfd: pytest.CaptureFixture[str]) -> None:
    parent = os.getpid()

    def second() -> int:
        if os.getpid() != parent:
            os.kill(os.getpid(), signal.SIGKILL)
        return os.getpid()

    assert both(lambda: "first", second) == ("first", parent)
    assert capfd.readouterr() == ("", "")
