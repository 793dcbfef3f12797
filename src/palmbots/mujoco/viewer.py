# SPDX-License-Identifier: Apache-2.0
"""Shows a running carry in MuJoCo's viewer, in real time if the machine is fast enough."""

import importlib
import os
import sys
import threading
import time
import warnings
from types import TracebackType
from typing import Any

import numpy as np

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.mujoco.curved_world import CurvedWorld
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.mjcf import camera_height
from palmbots.mujoco.overlay import Overlay
from palmbots.mujoco.world import MujocoWorld

_PATIENCE_S = 10.0  # how long to wait until the window closes


class Viewer:
    """A window; pass `show` as `on_tick` to `palmbots.carry`. Use it as a context manager.

    Closing the window ends nothing: the carry goes on unseen. Tab and shift-Tab show its panels.
    """

    def __init__(self) -> None:
        mujoco()
        screens = ("DISPLAY", "WAYLAND_DISPLAY")
        if sys.platform.startswith("linux") and not any(os.environ.get(s) for s in screens):
            raise PalmbotsError(
                "--view: there is no screen (DISPLAY is not set); allowed: --video, a film instead"
            )
        if not _answers():
            raise PalmbotsError(
                f"--view: the screen {os.environ.get('DISPLAY') or 'of this machine'} does not "
                "answer; allowed: one that does, or --video, a film instead"
            )
        self._viewer: Any = importlib.import_module("mujoco.viewer")
        self._window: Any = None
        self._overlay: Overlay | None = None
        self._threads: list[threading.Thread] = []
        self._began = 0.0

    def __enter__(self) -> "Viewer":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._window is not None:
            self._window.close()
        for thread in self._threads:  # ending the process while one of them draws causes an X error
            thread.join(_PATIENCE_S)

    def show(self, world: MujocoWorld) -> None:
        """Update the window at the time that belongs to the tick."""
        if self._window is None:
            others = set(threading.enumerate())
            self._window = self._viewer.launch_passive(
                world.model, world.data, show_left_ui=False, show_right_ui=False
            )
            self._threads = [t for t in threading.enumerate() if t not in others]
            self._window.cam.azimuth, self._window.cam.elevation = 96.0, -10.0
            self._window.cam.distance = 1.0
            self._began = time.perf_counter() - world.time_s
        if self._window.is_running():
            early = world.time_s - (time.perf_counter() - self._began)
            if early > 0:
                time.sleep(early)
            with self._window.lock():
                self._draw(world)
            self._window.sync()

    def _draw(self, world: MujocoWorld) -> None:
        """Draw the pair with friction cones, forces and its path."""
        if self._overlay is None:
            self._overlay = Overlay(world.model, world.data, world.scene)
        one, two = (world.data.body(f"{side}_palm").xpos for side in SIDES)
        middle = 0.5 * (one + two)
        middle[2] = camera_height(world.scene)
        self._window.cam.lookat[:] = middle
        ahead = (two - one) * np.array([1.0, 1.0, 0.0])
        into = self._window.user_scn
        into.ngeom = 0
        self._overlay.contacts(into, world.motion, middle, ahead / np.linalg.norm(ahead))
        if isinstance(world, CurvedWorld):
            self._overlay.path(into, world.line, world.way)


def _answers() -> bool:
    """Whether a window can be opened; if not, MuJoCo's viewer would end the process."""
    glfw: Any = importlib.import_module("glfw")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        there = bool(glfw.init())
        if there:
            glfw.terminate()
    return there
