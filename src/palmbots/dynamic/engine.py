"""MuJoCo itself, which is an extra: what is asked for without it is refused in one line."""

import importlib
from typing import Any

from palmbots.errors import PalmbotsError

__all__ = ["mujoco"]


def mujoco() -> Any:
    """The module `mujoco`. Raises `PalmbotsError` where it is not installed."""
    try:
        return importlib.import_module("mujoco")
    except ImportError:
        raise PalmbotsError(
            "world: mujoco needs the package mujoco; install it: pip install 'palmbots[mujoco]'"
        ) from None
