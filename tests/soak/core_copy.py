# SPDX-License-Identifier: Apache-2.0
"""A second build of the core from other headers or with other flags, and a Python that uses it."""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
TOOLS = Path(sys.executable).parent
LINKED = ("CMakeLists.txt", "src", "docs")


def programs(work: Path, include: Path, sources: Sequence[Path], flags: str) -> str | None:
    """Compile C++ test programs into `work`/programs.

    Returns:
        What the compiler says if one does not compile; None: all are there.
    """
    rules = [
        "rule cxx",
        f"  command = g++ -std=c++20 {flags} -w -ffp-contract=off -fno-math-errno -I {include} "
        f"-I {ROOT}/tests/cpp -MD -MF $out.d -o $out $in",
        "  depfile = $out.d",
        "  deps = gcc",
        *(f"build programs/{source.stem}: cxx {source}" for source in sources),
    ]
    (work / "build.ninja").write_text("\n".join(rules) + "\n")
    return _ninja(work)


def build(work: Path, include: Path, flags: str, *, is_quick: bool) -> str | None:
    """Compile the extension, and put it with the Python sources into `work`/package.

    Returns:
        What the compiler says if it does not compile; None: it is there.
    """
    source, made = work / "source", work / "extension"
    source.mkdir(parents=True, exist_ok=True)
    links = {name: ROOT / name for name in LINKED} | {"include": include}
    for name, target in links.items():
        if not (source / name).is_symlink():
            (source / name).symlink_to(target)
    if not (made / "build.ninja").exists():
        code = "import nanobind; print(nanobind.cmake_dir())"
        folder = subprocess.check_output([sys.executable, "-c", code], text=True).strip()
        options = {
            "CMAKE_MAKE_PROGRAM": TOOLS / "ninja",
            "nanobind_ROOT": folder,
            "Python_EXECUTABLE": sys.executable,
            "PALMBOTS_QUICK": "ON" if is_quick else "OFF",
            "CMAKE_BUILD_TYPE": "Release",
            "CMAKE_CXX_FLAGS": flags,
        }
        configure = [TOOLS / "cmake", "-S", source, "-B", made, "-G", "Ninja"]
        configure += [f"-D{name}={value}" for name, value in options.items()]
        subprocess.run(configure, check=True, capture_output=True)
    messages = _ninja(made)
    if messages is None:
        package = work / "package" / "palmbots"
        shutil.copytree(ROOT / "src" / "palmbots", package, dirs_exist_ok=True)
        for module in made.glob("_*.so"):
            shutil.copy2(module, package)
    return messages


def environment(work: Path) -> Path:
    """A Python that takes the package of `build`, and all other packages from this environment."""
    folder = work / "environment"
    python = folder / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
        (site,) = folder.glob("lib/python3*/site-packages")
        (own,) = Path(sys.prefix).glob("lib/python3*/site-packages")
        # Files .pth in the second folder are not read: they name the sources of this tree.
        (site / "second_build.pth").write_text(f"{work / 'package'}\n{own}\n")
    return python


def _ninja(folder: Path) -> str | None:
    jobs = str(len(os.sched_getaffinity(0)))
    command = [TOOLS / "ninja", "-C", folder, "-k", "0", "-j", jobs]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout if done.returncode != 0 else None
