"""MuJoCo itself, which is an extra: what is asked for without it is refused in one line.

Rendering off-screen takes EGL or, without it, OSMesa; the environment's ``MUJOCO_GL`` decides, and
where it is not set what is there.
"""

import ctypes.util
import importlib
import os
import warnings
from typing import Any

from palmbots.errors import PalmbotsError

__all__ = ["check_offscreen", "mujoco", "offscreen"]


def mujoco() -> Any:
    """The module `mujoco`. Raises `PalmbotsError` where it is not installed."""
    if "MUJOCO_GL" not in os.environ:  # it is read once, on import
        there = [name for name in ("EGL", "OSMesa") if ctypes.util.find_library(name)]
        if there:
            os.environ["MUJOCO_GL"] = there[0].lower()
    try:
        module = importlib.import_module("mujoco")
    except ImportError:
        raise PalmbotsError(
            "world: mujoco needs the package mujoco; install it: pip install 'palmbots[mujoco]'"
        ) from None
    except RuntimeError as error:  # so it says that MUJOCO_GL is none of those it knows
        raise PalmbotsError(f"world: mujoco: {error}; allowed: egl, osmesa or unset") from None
    if module.get_mju_user_warning() is None:
        # By itself MuJoCo would write MUJOCO_LOG.TXT into whatever folder this runs in. What its
        # warnings are about is found by `MujocoWorld.move`, and told.
        module.set_mju_user_warning(_silent)
    return module


def check_offscreen() -> None:
    """Raise `PalmbotsError` where `offscreen` could not draw."""
    offscreen(mujoco().MjModel.from_xml_string("<mujoco/>"), (32, 32)).close()


def _silent(_: str) -> None:
    pass


def offscreen(model: Any, size: tuple[int, int]) -> Any:
    """MuJoCo's renderer for pictures of `size` (width, height), or `PalmbotsError`."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what they say is in the error
            return mujoco().Renderer(model, height=size[1], width=size[0])
    except Exception as error:  # whatever graphics libraries raise, to the user it is one thing
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise PalmbotsError(
            f"film: nothing to render with: {reason}; install libegl1 and libgl1-mesa-dri, or "
            "libosmesa6 and set MUJOCO_GL=osmesa"
        ) from None
