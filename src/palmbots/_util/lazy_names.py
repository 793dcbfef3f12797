# SPDX-License-Identifier: Apache-2.0
"""Public names of a package, each listed once: as an import in its `__init__.py`."""

import importlib
import sys
from collections.abc import Callable
from typing import Any


def lazy_names(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """The functions `__getattr__` and `__dir__` of a package; also sets its `__all__`.

    Public are the names that its source imports as themselves, ``from module import other as name``
    in one line: type checkers and editors take just these as exported. They stand under ``if
    TYPE_CHECKING:``, so that each is imported on first use: `palmbots --help`, Ctrl-C and the
    programs of robots must not wait for modules that they do not need.
    """
    module = sys.modules[package]
    places: dict[str, tuple[str, str]] = {}
    with open(str(module.__file__), encoding="utf-8") as source:
        for line in source:
            match line.split():
                case ["from", place, "import", attribute, "as", name]:
                    places[name] = place, attribute
    module.__dict__["__all__"] = sorted(places)

    def __getattr__(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        place, attribute = places[name]
        if place == package:
            value: Any = importlib.import_module(f"{package}.{attribute}")
        else:
            value = getattr(importlib.import_module(place), attribute)
        setattr(module, name, value)
        return value

    def __dir__() -> list[str]:
        return sorted(places)

    return __getattr__, __dir__
