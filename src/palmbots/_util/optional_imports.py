# SPDX-License-Identifier: Apache-2.0
"""Optional packages: imported where they are used; a missing one is reported in one line.

The message names the packages of the extra themselves. Unlike ``palmbots[EXTRA]``, which needs an
index that has palmbots, these install in a clone and beside an installed palmbots alike.
"""

import importlib
import re
import shlex
import sys
from typing import Any

from palmbots.errors import MissingExtra

_REQUIREMENT = re.compile(r"""(?P<package>[^;]+?)\s*;\s*extra\s*==\s*['"](?P<extra>[\w-]+)['"]""")


def require(module: str, extra: str) -> Any:
    """The module of that name, which comes with an extra.

    Raises:
        MissingExtra: its package is not installed.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise missing_extra(error.name or module, extra) from None
    except ImportError as error:
        raise MissingExtra(f"{extra}: {module} cannot be imported: {error}", extra) from None


def missing_extra(module: str, extra: str) -> MissingExtra:
    """The error that reports a missing module, with the command that installs its extra."""
    package = module.partition(".")[0]
    return MissingExtra(
        f"{extra}: the package {package} is missing; run: {install_command(extra, package)}", extra
    )


def install_command(extra: str, package: str = "") -> str:
    """The command that installs the packages of an extra; one package where they are unknown."""
    command = [sys.executable or "python", "-m", "pip", "install"]
    return shlex.join([*command, *(_packages(extra) or [package or extra])])


def _packages(extra: str) -> list[str]:
    """What an extra installs, from the metadata of palmbots; empty where there is none."""
    import importlib.metadata  # here, because every program of a robot imports this module

    try:
        lines = importlib.metadata.requires("palmbots") or []
    except importlib.metadata.PackageNotFoundError:
        return []
    packages: list[str] = []
    for match in filter(None, map(_REQUIREMENT.fullmatch, lines)):
        if match["extra"] != extra:
            continue
        inner = re.fullmatch(r"palmbots\[([\w-]+)\]", match["package"])  # an extra within an extra
        packages += _packages(inner[1]) if inner else [match["package"]]
    return packages
