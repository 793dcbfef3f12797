# SPDX-License-Identifier: Apache-2.0
"""Names of a package whose modules are imported when a name is first used."""

import importlib
import sys
from collections.abc import Callable, Mapping
from typing import Any


def lazy_names(
    package: str, places: Mapping[str, str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """The functions `__getattr__` and `__dir__` of a package.

    Args:
        package: its name.
        places: by name, the module that defines it, from the package on, as ``.room.module``. If
            it has another name there, that follows: ``.room.module:other``. A name whose place is
            ``.name`` is that module.
    """

    def __getattr__(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        place, _, attribute = places[name].partition(":")
        module = importlib.import_module(place, package)
        value = module if place == f".{name}" else getattr(module, attribute or name)
        setattr(sys.modules[package], name, value)
        return value

    def __dir__() -> list[str]:
        return sorted(sys.modules[package].__all__)

    return __getattr__, __dir__
