# SPDX-License-Identifier: Apache-2.0
"""Classes that other installed distributions provide, under a group of entry points.

A distribution names them in its ``pyproject.toml``::

    [project.entry-points."palmbots.drivers"]
    mine = "my_package:MyDriver"
"""

from collections.abc import Mapping
from typing import Any

from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError


def built_in_or_installed(key: str, name: str, built_in: Mapping[str, Any], group: str) -> Any:
    """The entry of this name: a built-in one, or else an installed one, which is imported.

    Args:
        key: what messages call the name, such as ``driver.kind``.
        name: of the entry.
        built_in: the entries of this package; they come first.
        group: of the entry points.

    Raises:
        PalmbotsError: there is none, or it cannot be imported.
    """
    if name in built_in:
        return built_in[name]
    import importlib.metadata  # here, because every program of a robot imports this module

    installed = importlib.metadata.entry_points(group=group)
    if name not in installed.names:
        allowed = ", ".join([*built_in, *sorted(installed.names - built_in.keys())])
        raise PalmbotsError(
            f"{key}: value is {show(name)}; allowed: {allowed}, or an installed entry point of "
            f"{group}"
        )
    try:
        return installed[name].load()
    except Exception as error:  # whatever a module of somebody else does
        why = f"{type(error).__name__}: {error}"
        value = installed[name].value
        raise PalmbotsError(f"{key}: {name} ({value}) cannot be imported: {why}") from None
