# SPDX-License-Identifier: Apache-2.0
"""Starting a world and two robots as processes of one machine, and restarting what reboots."""

import contextlib
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from palmbots._types import SIDES
from palmbots._util.atomic_files import write_whole
from palmbots.errors import PalmbotsError
from palmbots.node.lockstep_robot import REBOOTED
from palmbots.node.pair_file import init_pair
from palmbots.scene.scene import Scene

_POLL_S = 0.02
_END_WITHIN_S = 5.0


def run_processes(scene: Scene, controller: str, world_options: Sequence[str]) -> int:
    """Run a carry as a world and two robots, each in a process of its own, in lockstep.

    Args:
        scene: the scene.
        controller: the controller of both robots, as ``palmbots carry --controller`` takes it.
        world_options: further options of ``palmbots world``.

    Returns:
        The exit status of the world: 0 if the object was delivered.

    Raises:
        PalmbotsError: a process cannot be started, or a robot's program fails.
    """
    with tempfile.TemporaryDirectory(prefix="palmbots-") as name:
        folder = Path(name)
        write_whole(folder / "scene.toml", scene.to_toml())
        address = f"unix:{folder / 'world.socket'}"
        file = folder / "pair.toml"
        init_pair(file, scene="scene.toml", controller=_absolute(controller), address=address)
        lockstep = ["--serve", address, "--lockstep", "--controller", controller, *world_options]
        with _processes() as processes:
            processes["world"] = _started(["world", str(folder / "scene.toml"), *lockstep])
            robots = {side: ["robot", str(file), "--side", side] for side in SIDES}
            for side, command in robots.items():
                processes[side] = _started(command)
            while (status := processes["world"].poll()) is None:
                for side, command in robots.items():
                    ended = processes[side].poll()
                    if ended == REBOOTED:
                        processes[side] = _started(command)
                    elif ended not in (None, 0):
                        raise PalmbotsError(f"{side} robot: its program ended with status {ended}")
                time.sleep(_POLL_S)
            for side in SIDES:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    processes[side].wait(_END_WITHIN_S)
            return status


def _absolute(controller: str) -> str:
    """The controller, also if it is a file, for programs that start in another folder."""
    file, colon, name = controller.partition(":")
    if not file.endswith((".py", ".toml")):
        return controller
    return f"{Path(file).absolute()}{colon}{name}"


def _started(arguments: Sequence[str]) -> "subprocess.Popen[bytes]":
    try:
        return subprocess.Popen([sys.executable, "-m", "palmbots", *arguments])
    except OSError as error:
        raise PalmbotsError(f"{sys.executable}: {error.strerror or error}") from None


@contextlib.contextmanager
def _processes() -> Iterator[dict[str, "subprocess.Popen[bytes]"]]:
    """Processes by name; all that still run at the end are ended."""
    running: dict[str, subprocess.Popen[bytes]] = {}
    try:
        yield running
    finally:
        for process in running.values():
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for process in running.values():
            try:
                process.wait(_END_WITHIN_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
