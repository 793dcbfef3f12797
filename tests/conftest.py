# SPDX-License-Identifier: Apache-2.0
"""Settings of all tests: Hypothesis profiles, and reports of slow tests and of failures."""

import atexit
import gc
import os
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.database import DirectoryBasedExampleDatabase
from hypothesis.internal.conjecture import providers

ROOT = Path(__file__).resolve().parent.parent

# A shell that runs the tests in the background makes them, and what they start, ignore Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Some 150 Python processes are started: they share the compiled bytecode of the modules.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# No test multiplies large matrices, and each of these processes would start threads for them.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# With Python's thresholds a tenth of the time of the tests goes into collecting garbage.
gc.set_threshold(20_000, 20, 20)

# A checker of addresses, which comes with the tools of the docs: jsonschema would import it, which
# takes seconds, and no schema here has addresses.
modules: dict[str, Any] = sys.modules
modules["rfc3987_syntax"] = None

# The processes of a run have one new cache: what one has solved, the others read, and no result of
# earlier code.
if "PYTEST_XDIST_WORKER" not in os.environ:
    os.environ["PALMBOTS_CACHE"] = tempfile.mkdtemp(prefix="palmbots-cache-")
    atexit.register(shutil.rmtree, os.environ["PALMBOTS_CACHE"], ignore_errors=True)
    # What a user's programs remember stands there, too.
    os.environ["XDG_STATE_HOME"] = os.environ["PALMBOTS_CACHE"]

# `make test` uses `ci`: the same examples on every run, and no limit on the time of an example.
# `make soak` uses `soak`: random examples, and many more of them.
settings.register_profile(
    "ci",
    max_examples=50,
    derandomize=True,
    database=None,
    deadline=None,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.register_profile(
    "soak",
    derandomize=False,
    database=DirectoryBasedExampleDatabase(ROOT / "build" / "hypothesis"),
    deadline=None,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow],
)
SOAK_FACTOR = 20  # times as many examples
SLOW_S = 10.0  # the summary lists the tests that take longer

settings.load_profile("ci")  # unless --hypothesis-profile says otherwise


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("palmbots")
    group.addoption("--failures-to", metavar="FILE", help="append the report of each failure")
    group.addoption("--until", metavar="TIME", type=float, help="start no test after this time")
    group.addoption("--rewrite", action="store_true", help="write tests/transcripts anew")
    group.addoption("--soak-seed", type=int, default=0, help="seed of the tests in tests/soak")


def is_soak() -> bool:
    return settings.get_current_profile_name() == "soak"


def pytest_sessionstart() -> None:
    # Hypothesis also draws constants from the modules of the project that are imported already.
    # Which ones are depends on the tests that this worker has run, so `ci` draws none of them.
    if not is_soak():
        assert hasattr(providers, "_get_local_constants")
        drawn: Any = providers
        drawn._get_local_constants = lambda: providers._local_constants


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if not is_soak():
        long = [item for item in items if item.get_closest_marker("soak")]
        items[:] = [item for item in items if not item.get_closest_marker("soak")]
        config.hook.pytest_deselected(items=long)
        return
    for test in {item.obj for item in items if isinstance(item, pytest.Function)}:
        if getattr(test, "is_hypothesis_test", False):
            usual = test._hypothesis_internal_use_settings
            more = settings(usual, max_examples=SOAK_FACTOR * usual.max_examples)
            test._hypothesis_internal_use_settings = more


def pytest_collection_finish() -> None:
    gc.freeze()  # modules and tests stay: no collection of garbage need visit them


def pytest_runtest_teardown(item: pytest.Item) -> None:
    until = item.config.getoption("--until")
    if until is not None and time.time() > until:
        item.session.shouldstop = "the time is over"


class Reports:
    """Lists the slow tests and keeps the failures, in the process that prints the results."""

    def __init__(self, config: pytest.Config) -> None:
        self.failures_to: str | None = config.getoption("--failures-to")
        self.soak_seed = int(config.getoption("--soak-seed") or 0)
        self.slow: list[tuple[float, str]] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.duration > SLOW_S:
            self.slow.append((report.duration, f"{report.nodeid} ({report.when})"))
        if report.failed and self.failures_to:
            with Path(self.failures_to).open("a", encoding="utf-8") as stream:
                print(f"== {report.nodeid} ({report.when}), seed {self.soak_seed}", file=stream)
                print(report.longreprtext, file=stream)
                for title, text in report.sections:
                    print(f"-- {title}\n{text}", file=stream)

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if self.slow and not is_soak():
            terminalreporter.section(f"longer than {SLOW_S:g} s: shorten, or move to tests/soak")
            for duration_s, name in sorted(self.slow, reverse=True):
                terminalreporter.line(f"{duration_s:6.1f} s  {name}")


def pytest_configure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Reports(config), "palmbots-reports")


@pytest.fixture(scope="session")
def soak_seed(pytestconfig: pytest.Config) -> int:
    """The seed of the tests in tests/soak: another one in each round of `make soak`."""
    return int(pytestconfig.getoption("--soak-seed") or 0)


@pytest.fixture
def here(capsys: pytest.CaptureFixture[str]) -> Any:
    """`palmbots`, run in this process: a `commands.Run`."""
    from commands import runner  # here, because few tests need all commands

    return runner(capsys)
