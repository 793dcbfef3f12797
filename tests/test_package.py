"""The package as others get it: versions agree, stubs are true, the wheel is whole."""

import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

import palmbots
from cxx import ROOT


def stated_version(file: str, pattern: str) -> str:
    found = re.search(pattern, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    assert found, f"{file} states no version"
    return found[1]


def test_every_file_states_the_same_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["version"] == palmbots.__version__
    assert project["version"] == stated_version("CITATION.cff", r"^version: (\S+)$")
    # The first heading: the changelog's newest version, released or not yet.
    assert project["version"] == stated_version("CHANGELOG.md", r"\A(?:(?!## ).*\n)*## \[(.+?)\]")


def test_stubs_describe_the_built_module(tmp_path: Path) -> None:
    """When this fails: `make stubs`."""
    made = tmp_path / "_core.pyi"
    stubgen = [sys.executable, "-m", "nanobind.stubgen", "-q", "-m", "palmbots._core", "-o", made]
    subprocess.run(stubgen, check=True)
    kept = ROOT / "src" / "palmbots" / "_core.pyi"
    assert kept.read_text(encoding="utf-8") == made.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built with the tools of this environment from the objects of `make test`."""
    out = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(out)]
    settings = ["build-dir=build/extension", "cmake.define.PALMBOTS_WERROR=ON"]
    command = [*build, *(f"--config-setting={setting}" for setting in settings), str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (made,) = out.glob("*.whl")
    return made


def test_wheel_holds_every_source_scene_and_type(wheel: Path) -> None:
    held = {name for name in zipfile.ZipFile(wheel).namelist() if name.startswith("palmbots/")}
    sources = ROOT / "src"
    kept = {
        path.relative_to(sources).as_posix()
        for path in (sources / "palmbots").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert {"palmbots/py.typed", "palmbots/scenes/paper.toml", "palmbots/_core.pyi"} <= kept
    assert {f"palmbots/objects/{name}.toml" for name in palmbots.objects()} <= kept
    extensions = {Path(name).name.split(".")[0] for name in held - kept}
    assert {"_core", "_lanes"} <= extensions <= {"_core", "_lanes", "_lanes_v3", "_lanes_v4"}
    assert len(held - kept) == len(extensions)
    assert kept <= held


def test_wheel_carries(wheel: Path, tmp_path: Path) -> None:
    """The unpacked wheel carries the paper's box, with none of this tree on the path."""
    zipfile.ZipFile(wheel).extractall(tmp_path)
    packages = Path(pytest.__file__).parent.parent
    program = f"""
import sys
sys.path[:0] = [{str(tmp_path)!r}, {str(packages)!r}]
import palmbots
assert palmbots.__file__.startswith({str(tmp_path)!r}), palmbots.__file__
print(palmbots.carry("paper", seed=1).outcome)
"""
    # -S: without the hooks of site-packages, one of which is this tree's editable install.
    command = [sys.executable, "-S", "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.stdout == "delivered\n", done.stderr
