"""Packages that only studies need: imported where they are used, and asked for in one line."""

import importlib
from typing import Any

from palmbots.errors import PalmbotsError

__all__ = ["needed"]


def needed(module: str, extra: str) -> Any:
    """The module of that name.

    Raises `PalmbotsError` with what to install where its package is missing.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        package = (error.name or module).partition(".")[0]
        raise PalmbotsError(
            f"study: the package {package} is missing; run: pip install 'palmbots[{extra}]'"
        ) from None
