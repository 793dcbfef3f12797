# SPDX-License-Identifier: Apache-2.0
"""Imports MuJoCo, which is an optional package.

Rendering off-screen needs EGL or OSMesa. The environment variable ``MUJOCO_GL`` selects one of
them; if it is not set, the first that is installed is used.
"""

import ctypes.util
import importlib.util
import os
import warnings
from typing import Any

from palmbots._util.optional_imports import install_command, require
from palmbots.errors import PalmbotsError


def mujoco() -> Any:
    """The module `mujoco`.

    Raises:
        PalmbotsError: it is not installed, or ``MUJOCO_GL`` is not valid.
    """
    if "MUJOCO_GL" not in os.environ:  # the module reads it once, on import
        installed = [name for name in ("EGL", "OSMesa") if ctypes.util.find_library(name)]
        if installed:
            os.environ["MUJOCO_GL"] = installed[0].lower()
    try:
        module = require("mujoco", "mujoco")
    except RuntimeError as error:  # so it says that MUJOCO_GL is none of those it knows
        raise PalmbotsError(f"world: mujoco: {error}; allowed: egl, osmesa or unset") from None
    if module.get_mju_user_warning() is None:
        # MuJoCo would write its warnings to MUJOCO_LOG.TXT in the working directory. The faults
        # that they report are detected by `MujocoWorld.move`.
        module.set_mju_user_warning(_silent)
    return module


def without_mujoco() -> str:
    """That MuJoCo is not installed, and the command that installs it; empty: it is."""
    if importlib.util.find_spec("mujoco") is not None:
        return ""
    return f"MuJoCo, which is not installed; run: {install_command('mujoco')}"


def check_offscreen() -> None:
    """Raise `PalmbotsError` if `offscreen` cannot render here."""
    offscreen(mujoco().MjModel.from_xml_string("<mujoco/>"), (32, 32)).close()


def _silent(_: str) -> None:
    pass


def offscreen(model: Any, size: tuple[int, int]) -> Any:
    """MuJoCo's renderer for images of `size` (width, height).

    Raises:
        PalmbotsError: no graphics library is installed.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the error contains the same information
            # The buffer is as large as the image: a larger one takes longer to make.
            model.vis.global_.offwidth, model.vis.global_.offheight = size
            return mujoco().Renderer(model, height=size[1], width=size[0])
    except Exception as error:  # graphics libraries raise errors of many types
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise PalmbotsError(
            f"video: cannot render: {reason}; install libegl1 and libgl1-mesa-dri, or "
            "libosmesa6 and set MUJOCO_GL=osmesa"
        ) from None
