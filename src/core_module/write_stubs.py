# SPDX-License-Identifier: Apache-2.0
"""Writes the stubs of palmbots._core (CMakeLists.txt): write_stubs.py MODULE_FOLDER PACKAGE_FOLDER.

The package itself is not imported: in an environment that has an older build, it would load that.
"""

import re
import sys
import types
from pathlib import Path

from nanobind.stubgen import main

package = sys.modules["palmbots"] = types.ModuleType("palmbots")
package.__path__ = [sys.argv[1]]


def quoted(found: re.Match[str]) -> str:
    """A type of names with its quotes, which the generator of stubs leaves out."""
    return f"Literal[{', '.join(map(repr, found[1].split(', ')))}]"


main(["-q", "-r", "-m", "palmbots._core", "-O", sys.argv[2]])
for stub in Path(sys.argv[2], "_core").glob("*.pyi"):
    stub.write_text(re.sub(r"Literal\[(.*)\]", quoted, stub.read_text("utf-8")), "utf-8")
