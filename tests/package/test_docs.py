# SPDX-License-Identifier: Apache-2.0
"""The docs are true: links have targets, tables match the code, commands and examples run."""

import importlib
import itertools
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

import palmbots as pb
from coarse_pictures import COARSE
from palmbots.cli import main as cli
from palmbots.cli.main import build_app
from palmbots.optimum.opening import Grid
from palmbots.optimum.optimal_controllers import _policy
from sampled import in_soak
from short_route import TYPED
from short_validation import FEW_LINES

ROOT = Path(__file__).parent.parent.parent
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_have_targets(page: Path) -> None:
    for target in re.findall(r"\]\(([^)]+)\)", page.read_text()):
        if target.startswith("http"):
            continue
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.exists(), f"{page.name}: {target}"
        if anchor:
            heads = re.findall(r"^#+ (.+)$", file.read_text(), re.MULTILINE)
            slugs = [re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads]
            assert anchor in slugs, f"{page.name}: {target}"


def test_every_page_stands_in_the_contents() -> None:
    docs = ROOT / "docs"
    contents = set(re.findall(r"\]\(([\w/-]+\.md)\)", (docs / "README.md").read_text()))
    pages = {path.relative_to(docs).as_posix() for path in docs.rglob("*.md")}
    assert contents == pages - {"README.md"}


@pytest.mark.slow
def test_generated_parts_are_up_to_date() -> None:
    """When this fails: `make docs`."""
    script = ROOT / "scripts" / "generate_docs.py"
    checked = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout


NEAR = ["--set", "task.distance_m=0.3"]
# What would take long is done with less: by the command, or its first three words.
FEW = {
    "assess": ["--turn-radius-m", "0", "--set", "task.distance_m=0.1"],
    "carry --out": ["--set", "task.distance_m=0.1"],
    "carry -c optimal": ["--set", "task.distance_m=0.1"],
    "carry -c optimal-stopping": ["--set", "task.distance_m=0.1"],
    "carry --set radio.loss=1": ["--seeds", "1"],
    "carry lift": ["--seeds", "1"],
    "route": ["--routes", "1", *TYPED],
    "carry lone": ["--seeds", "1"],
    "carry handover": ["--seeds", "1"],
    "compare": ["--carries", "2"],
    "curve": ["--carries", "1", "--turn-angle-deg", "7", "--set", "robot.speed_m_s=0.18"],
    "design": ["--resolution-deg", "3", "--set", "task.distance_m=0.1"],
    "final-place": ["--jobs", "100"],
    "up": ["--rate", "3"],
    "drop-rate": ["--effort", "20", "--relative-error-percent", "100", *NEAR],
    "bound": ["--set", "task.distance_m=0.05"],
    "noise-limit": ["--relative-error-percent", "10", "--set", "task.distance_m=0.2"],
    "study": ["--carries", "2"],
    "speed-limits": ["--carries", "1", "--set", "task.distance_m=0.05"],
    "validate": ["--states", "3", "--carries", "1", "--set", "task.distance_m=0.1"],
}
# What is done with less where no option says so: nobody looks at these numbers.
GRID = Grid(32, 16, 1.0)
OPTIMUM, LIMITS = "palmbots.optimum", "palmbots.mujoco.validation.speed_limits"
OPTIMAL = {
    f"{OPTIMUM}.optimal_controllers.FINE": GRID,
    f"{OPTIMUM}.optimal_controllers.COARSE": GRID,
    f"{OPTIMUM}.optimal_controllers._policy": _policy.__wrapped__,  # keeps nothing
}
SMALLER: dict[str, dict[str, Any]] = {
    "bound": {f"{OPTIMUM}.drop_bound.FINE": GRID, f"{OPTIMUM}.drop_bound.COARSE": GRID},
    "carry -c optimal": OPTIMAL,
    "carry -c optimal-stopping": OPTIMAL,
    "curve": {"palmbots.mujoco.curve_trial.FORECASTS": 1},
    "validate": FEW_LINES,
    "speed-limits": {f"{LIMITS}.FRICTIONS": (0.3,), f"{LIMITS}.FACTORS": (1.0,)},
}
# Of these, `make test` runs each.
ALL = (None, "compare", "study", "noise-limit", "carry --out")
DATA = ROOT / "src" / "palmbots" / "studies" / "data"
# Named in the text without their arguments.
NAMED = (["replay"], ["check"], ["study"], ["export"], ["init"], ["up"], ["world"], ["robot"],
         ["robot", "--json"], ["station"], ["ros2"], ["calibrate"], ["firmware"],
         ["flash"], ["schema"], ["doctor"], ["import"], ["fit"])  # fmt: skip


def commands() -> list[str]:
    group: Any = get_command(build_app())
    names = "|".join(name for name in group.commands if name != "drop-rate")  # takes minutes
    found = []
    for page in PAGES:
        found += re.findall(rf"`(palmbots (?:{names})\b[^`\[]*)`", page.read_text())
        found += re.findall(r"^    \$ (palmbots .*)$", page.read_text(), re.MULTILINE)
    # With --out a long command prints the same, and writes files, too.
    shorter = {c for c in found if fewer(c) and f"{c} --out out" in found}
    return sorted(set(found) - shorter)


def transcript(command: str) -> list[str]:
    """The lines that the pages show as the output of a command."""
    block = rf"^    \$ {re.escape(command)}\n((?:    [^$\n].*\n)*)"
    shown = [re.findall(block, page.read_text(), re.MULTILINE) for page in PAGES]
    return [line[4:] for text in itertools.chain(*shown) for line in text.splitlines()]


def shortened(command: str) -> str | None:
    """The entry of `FEW` for a command that would take long; None: it does not."""
    words = shlex.split(command)[1:]
    if words[0] == "carry" and "--out" in words:
        return "carry --out"
    return next((key for key in (" ".join(words[:3]), words[0]) if key in FEW), None)


def fewer(command: str) -> list[str]:
    """Options that shorten a command that would take long; none: it does not."""
    key = shortened(command)
    return FEW[key] if key else []


def with_few_points(name: str, folder: Path) -> str:
    """A shipped study; one with thousands of points: a file of its name, with few of them."""
    file = DATA / f"{name}.toml"
    few, reduced = re.subn(r"^points = \d+$", "points = 4", file.read_text(), flags=re.MULTILINE)
    if not reduced:
        return name
    (folder / file.name).write_text(few)
    return file.name


def by_what_they_try() -> list[Any]:
    """Of the commands that are shortened in the same way, `make test` runs the one with most words,
    and `make soak` all of them."""
    most = {shortened(c): c for c in sorted(commands(), key=lambda c: len(shlex.split(c)))}
    return [c if shortened(c) in ALL or most[shortened(c)] == c else in_soak(c) for c in commands()]


@pytest.mark.parametrize("command", by_what_they_try())
def test_commands_run(
    command: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    words = shlex.split(command)[1:]
    is_pattern = "|" in words or re.search(r"\b[A-Z]{3,}\b", command) is not None
    if (
        words in NAMED
        or is_pattern
        or (words[-1].endswith((".toml", ".toml@station")) and words[0] != "init")
    ):
        return
    less = fewer(command)
    smaller = SMALLER.get(shortened(command) or "", {})
    if smaller:
        monkeypatch.setenv("PALMBOTS_CACHE", str(tmp_path / "cache"))  # not for other tests
    for name, value in (smaller | COARSE).items():
        monkeypatch.setattr(name, value)
    if words[0] == "study":
        words[1] = with_few_points(words[1], tmp_path)
    assert cli.run([*words, *less]) in (cli.DONE, cli.FAILED)
    printed = capsys.readouterr()
    assert printed.out
    if not less:
        assert set(transcript(command)) <= set((printed.out + printed.err).splitlines())


@pytest.mark.soak
@pytest.mark.parametrize("command", [c for c in commands() if fewer(c) and transcript(c)])
def test_transcripts_of_long_commands_are_their_output(
    command: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    assert cli.run(shlex.split(command)[1:]) == cli.DONE
    assert set(transcript(command)) <= set(capsys.readouterr().out.splitlines())


@pytest.mark.soak
@pytest.mark.parametrize("name", ["centralized-vs-distributed", "what-matters"])
def test_hash_of_the_study_is_on_its_page(name: str, tmp_path: Path) -> None:
    """The sections of the page begin with the command."""
    page = (ROOT / "docs" / "reference" / "study-results.md").read_text()
    section = page.split(f"palmbots study {name} --plot")[1]
    shown = re.findall(r"result hash `(\w+)`", section)
    assert shown[0] == pb.study(name, tmp_path).attrs["hash"]


def test_every_picture_has_its_command_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the same section of every page of the book that shows the picture."""
    monkeypatch.syspath_prepend(ROOT / "scripts")
    draw_images = importlib.import_module("draw_images")
    drawn = {*draw_images.FUNCTIONS, *itertools.chain(*draw_images.COMMANDS.values())}
    assert drawn == {path.name for path in (ROOT / "docs" / "images").iterdir()}
    commands = {name: f"scripts/draw_images.py {name}" for name in draw_images.FUNCTIONS}
    for command, written in draw_images.COMMANDS.items():
        commands |= dict.fromkeys(written, command)
    commands["carry-3d.png"] = "palmbots carry --world mujoco --video --out out"
    shown = set()
    for page in (ROOT / "docs").rglob("*.md"):
        for section in re.split(r"^#+ ", page.read_text(), flags=re.MULTILINE):
            for name in re.findall(r"!\[[^]]*\]\(\.\./images/([\w.-]+)\)", section):
                assert commands[name] in " ".join(section.split()), (page.name, name)
                shown.add(name)
    assert shown == drawn


def test_readme_summary_is_the_output_of_the_command(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    shown = (ROOT / "README.md").read_text().split("$ palmbots carry --seed 0\n")[1]
    shown = shown.split("\n\n")[0]
    cli.run(["carry", "--seed", "0"])
    result = capsys.readouterr().out
    assert [line.split() for line in result.splitlines()] == [
        line.split() for line in shown.splitlines() if line.strip()
    ]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_python_in_the_docs_runs(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "__main__"}  # the blocks of a page are one program
    for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL):
        exec(compile(block, page.name, "exec"), names)
