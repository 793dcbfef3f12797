# SPDX-License-Identifier: Apache-2.0
"""Folders that are installed distributions with entry points, for processes of the tests."""

import os
import subprocess
import sys
from pathlib import Path

from cxx import ROOT


def installed(folder: Path, group: str, **classes: str) -> dict[str, str]:
    """Make the folder one that provides these classes, ``module:class``, by name.

    Returns the environment for a process that is to find it. The modules are those of
    tests/support.
    """
    metadata = folder / "somebody-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: somebody\nVersion: 1.0\n")
    lines = [f"{name} = {place}" for name, place in classes.items()]
    (metadata / "entry_points.txt").write_text("\n".join([f"[{group}]", *lines]) + "\n")
    return path_to(folder, Path(__file__).parent)


def path_to(*folders: Path) -> dict[str, str]:
    """The environment for a process that imports from these folders, too."""
    paths = [*map(str, folders), os.environ.get("PYTHONPATH", "")]
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}


def installed_example(name: str, folder: Path) -> dict[str, str]:
    """An environment in which this example is installed, by pip."""
    source = ROOT / "examples" / name
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    options = ["--no-deps", "--no-build-isolation", "--target", str(folder), str(source)]
    done = subprocess.run([*pip, *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return path_to(folder)
