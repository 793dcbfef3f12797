# SPDX-License-Identifier: Apache-2.0
"""Writes the stubs of palmbots._core (CMakeLists.txt): write_stubs.py MODULE_FOLDER PACKAGE_FOLDER.

The package itself is not imported: in an environment that has an older build, it would load that.
"""

import sys
import types

from nanobind.stubgen import main

package = sys.modules["palmbots"] = types.ModuleType("palmbots")
package.__path__ = [sys.argv[1]]
main(["-q", "-r", "-m", "palmbots._core", "-O", sys.argv[2]])
