"""Two jobs at once: results, errors, and children that are killed, with real processes."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from palmbots import side_by_side
from palmbots.errors import PalmbotsError
from palmbots.side_by_side import both, can_fork


@pytest.fixture(autouse=True)
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork on a machine with one core, too."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})


def refuse() -> int:
    """A job that cannot be done."""
    raise PalmbotsError(f"refused in {os.getpid()}")


@pytest.fixture
def forks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork whatever threads other tests have left in this process."""
    monkeypatch.setattr(side_by_side, "can_fork", lambda: True)


@pytest.mark.usefixtures("forks")
def test_each_job_has_its_process() -> None:
    first, second = both(os.getpid, os.getpid)
    assert first == os.getpid() != second


def test_a_process_with_one_thread_and_two_cores_forks() -> None:
    program = (
        "import os; os.sched_getaffinity = lambda _: {0, 1}\n"
        "from palmbots.side_by_side import can_fork; print(can_fork())"
    )
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert told.stdout.split() == ["True"], told.stderr


def test_other_threads_forbid_the_fork() -> None:
    done = threading.Event()
    thread = threading.Thread(target=done.wait)
    thread.start()
    try:
        assert not can_fork()
        assert both(os.getpid, os.getpid) == (os.getpid(), os.getpid())
    finally:
        done.set()
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
def test_after_an_error_nothing_goes_on(tmp_path: Path) -> None:
    """The child has ended when the error arrives: its file is there, and nobody is left."""
    path = tmp_path / "second"

    def second() -> None:
        while not (tmp_path / "go").exists():
            pass
        path.write_text("whole")

    def first() -> None:
        (tmp_path / "go").touch()
        raise PalmbotsError("no")

    with pytest.raises(PalmbotsError):
        both(first, second)
    assert path.read_text() == "whole"
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)


@pytest.mark.usefixtures("forks")
def test_a_killed_child_is_made_up_for(capfd: pytest.CaptureFixture[str]) -> None:
    parent = os.getpid()

    def second() -> int:
        if os.getpid() != parent:
            os.kill(os.getpid(), signal.SIGKILL)
        return os.getpid()

    assert both(lambda: "first", second) == ("first", parent)
    assert capfd.readouterr() == ("", "")
