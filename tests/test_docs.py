"""The docs are true: links lead somewhere, tables match the code, commands and examples run."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from palmbots import cli

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
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


@pytest.mark.parametrize("name", ["docs_derivation", "docs_keys", "docs_tables", "docs_wire"])
def test_what_is_drawn_from_the_code_is_up_to_date(name: str) -> None:
    script = ROOT / "scripts" / name
    assert subprocess.run([sys.executable, script, "--check"], check=False).returncode == 0


# What would take long is done with less.
FEW = {
    "carry --out": ["--set", "task.distance_m=0.3"],
    "compare": ["--carries", "2"],
    "study": ["--carries", "2"],
    "speed": ["--seeds", "1", "--set", "task.distance_m=0.2"],
    "validate": ["--states", "3", "--seeds", "1", "--set", "task.distance_m=0.2"],
}
NAMES = "carry|modes|analyze|certify|check|derive|design|compare|replay|study"


def commands() -> list[str]:
    found = []
    for page in PAGES:
        found += re.findall(rf"`(palmbots (?:{NAMES})[^`\[]*)`", page.read_text())
        found += re.findall(r"^    \$ (palmbots .*)$", page.read_text(), re.MULTILINE)
    return sorted(set(found))


@pytest.mark.parametrize("command", commands())
def test_commands_run(
    command: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    words = command.split()[1:]
    if words in (["replay"], ["check"], ["study"]) or words[-1].endswith(
        ".toml"
    ):  # named, not shown
        return
    films = words[0] == "carry" and "--out" in words
    less = FEW["carry --out" if films else words[0]] if films or words[0] in FEW else []
    assert cli.run([*words, *less]) in (cli.DONE, cli.FAILED)
    assert capsys.readouterr().out


def test_the_summary_in_the_readme_is_what_the_command_prints(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    shown = (ROOT / "README.md").read_text().split("$ palmbots carry --seed 0\n")[1]
    shown = shown.split("\n\n")[0]
    cli.run(["carry", "--seed", "0"])
    told = capsys.readouterr().out
    assert [line.split() for line in told.splitlines()] == [
        line.split() for line in shown.splitlines() if line.strip()
    ]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_python_in_the_docs_runs(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL):
        exec(compile(block, page.name, "exec"), {"__name__": "__main__"})
