# SPDX-License-Identifier: Apache-2.0
"""A folder that is an installed distribution with entry points, for processes of the tests."""

import os
from pathlib import Path


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
    paths = [str(folder), str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]
    return os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, paths))}
