# SPDX-License-Identifier: Apache-2.0
"""The package as it is installed: versions agree, the wheel is complete."""

import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

import palmbots
from cxx import ROOT
from waiting import locked

pytestmark = pytest.mark.slow

REFERENCE = "palmbots/scene/data/scene-keys.md"
# In a text for users: an installation from an index, which does not have the package.
FROM_INDEX = re.compile(r"""pip3? install [^\n`]*(?<![\w./-])palmbots(?![\w/-]|\S*\.whl)""")


def stated_version(file: str, pattern: str) -> str:
    result = re.search(pattern, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    assert result, f"{file} states no version"
    return result[1]


def test_every_file_states_the_same_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["version"] == palmbots.__version__
    assert project["version"] == stated_version("CITATION.cff", r"^version: (\S+)$")
    # The first heading: the changelog's newest version, released or not yet.
    assert project["version"] == stated_version("CHANGELOG.md", r"\A(?:(?!## ).*\n)*## \[(.+?)\]")


def test_no_instruction_names_an_index_without_the_package() -> None:
    assert FROM_INDEX.search("pip install 'palmbots[mujoco]'")
    assert FROM_INDEX.search("python -m pip install --user palmbots")
    assert not FROM_INDEX.search("pip install dist/palmbots-0.1.0-cp311-cp311-linux_x86_64.whl")
    assert not FROM_INDEX.search("pip install ./examples/zenoh_link")
    texts = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "src").rglob("*.py")]
    texts += [*(ROOT / "examples").rglob("*.py"), *(ROOT / "docs").rglob("*.ipynb")]
    assert len(texts) > 100
    named = [
        f"{path}: {found[0]}"
        for path in texts
        if (found := FROM_INDEX.search(path.read_text(encoding="utf-8")))
    ]
    assert named == []


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built with the tools of this environment from the objects of `make test`."""
    out = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(out)]
    settings = ["build-dir=build/extension", "cmake.define.PALMBOTS_WERROR=ON"]
    command = [*build, *(f"--config-setting={setting}" for setting in settings), str(ROOT)]
    with locked(ROOT / "build" / "extension.lock"):  # another worker may need one too
        run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    (made,) = out.glob("*.whl")
    return made


def test_wheel_holds_every_source_scene_and_type(wheel: Path) -> None:
    held = {name for name in zipfile.ZipFile(wheel).namelist() if name.startswith("palmbots/")}
    sources = ROOT / "src"
    table = {
        path.relative_to(sources).as_posix()
        for path in (sources / "palmbots").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert {
        "palmbots/py.typed",
        "palmbots/scene/data/scenes/paper.toml",
        "palmbots/_core/__init__.pyi",
    } <= table
    assert {f"palmbots/scene/data/objects/{name}.toml" for name in palmbots.object_names()} <= table
    assert {f"palmbots/boards/data/{name}.hex" for name in ("robot", "dongle")} <= table
    extensions = {Path(n).name.split(".")[0] for n in held - table if n.endswith(".so")}
    assert {"_core", "_batch"} <= extensions <= {"_core", "_batch", "_batch_v3", "_batch_v4"}
    assert held - table - {name for name in held if name.endswith(".so")} == {REFERENCE}
    assert table <= held
    reference = (ROOT / "docs" / "reference" / "scene-keys.md").read_bytes()
    assert zipfile.ZipFile(wheel).read(REFERENCE) == reference


def test_unpacked_wheel_runs_a_carry(wheel: Path, tmp_path: Path) -> None:
    """The unpacked wheel carries the paper's box without this tree on the path."""
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
    run = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert run.stdout == "delivered\n", run.stderr
