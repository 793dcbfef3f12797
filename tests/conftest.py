"""What every test may rely on, and which files begin first."""

import os
import signal
import sys

import pytest
from hypothesis import settings

# A shell that runs the tests in the background lets them, and what they start, ignore Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# How long an example takes tells how busy the machine is, and nothing of what is tested.
settings.register_profile("unhurried", settings(deadline=None))
settings.load_profile("unhurried")

# Some 150 Python processes are started: not each of them shall compile every module again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# One worker runs all of a file. Those that take longest come first, or one worker would be at
# the last of them when the others are done; the second one waits for processes much of its time.
LONGEST = (
    "test_core.py",
    "test_study_cluster.py",
    "test_batch.py",
    "test_study_kill.py",
    "test_cli.py",
    "test_docs.py",
    "test_validation.py",
    "test_rare.py",
    "test_determinism.py",
    "test_verify.py",
    "test_study_run.py",
    "test_design.py",
    "test_film.py",
    "test_stability_figures.py",
    "test_fuzz.py",
    "test_stability_files.py",
)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    rank = {name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: rank.get(item.path.name, len(rank)))
