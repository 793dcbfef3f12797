# SPDX-License-Identifier: Apache-2.0
"""Starting a world and two robots as processes of one machine, and restarting what reboots."""

import contextlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

from palmbots._types import SIDES
from palmbots._util.arguments import show
from palmbots._util.atomic_files import write_whole
from palmbots.errors import PalmbotsError
from palmbots.runtime.impairment import Impairment, Proxy
from palmbots.runtime.lockstep_robot import REBOOTED
from palmbots.runtime.pair_file import ENDS, init_pair
from palmbots.scene.scene import Scene
from palmbots.wire import Role

_Running: TypeAlias = dict[str, "subprocess.Popen[bytes]"]
_Commands: TypeAlias = Mapping[str, Sequence[str]]
_BAD_INPUT = 2
_POLL_S = 0.02
_END_WITHIN_S = 5.0
_WORLD_ENDS_WITHIN_S = 600.0  # at a low rate it waits for long


def check_rate(rate: float) -> float:
    """The rate, if it is one.

    Raises:
        PalmbotsError: it is too small or too large.
    """
    if not 0.01 <= rate <= 100:
        raise PalmbotsError(f"rate: value is {show(rate)}; allowed: a number from 0.01 to 100")
    return rate


def run_lockstep(
    scene: Scene, controller: str, world_options: Sequence[str], *, has_station: bool
) -> int:
    """Run a carry as a world and two robots, each in a process of its own, in lockstep.

    Args:
        scene: the scene.
        controller: the controller of both robots, as ``palmbots carry --controller`` takes it.
        world_options: further options of ``palmbots world``.
        has_station: whether a station decides for the robots; it is a process, too.

    Returns:
        The exit status of the world: 0 if the object was delivered.

    Raises:
        PalmbotsError: a process cannot be started, or a robot's program fails.
    """
    with _pair(scene, controller) as (file, address), _processes() as running:
        world = ["world", str(file.with_name("scene.toml")), "--serve", address, "--lockstep"]
        running["world"] = _started([*world, "--controller", controller, *world_options])
        robots = {side: ["robot", str(file), "--side", side, "--lockstep"] for side in SIDES}
        for side, command in robots.items():
            running[side] = _started(command)
        if has_station:
            running["station"] = _started(["station", str(file), "--lockstep"])
        _wait_for("world", running, robots)
        for side in SIDES:
            with contextlib.suppress(subprocess.TimeoutExpired):
                running[side].wait(_END_WITHIN_S)
        return running["world"].wait()


def run_live(
    scene: Scene,
    controller: str,
    world_options: Sequence[str],
    *,
    rate: float,
    impairment: Impairment,
    quiet: bool,
    on_line: Callable[[str], None],
) -> int:
    """Run a world, two robots and a station in real time; the station arms and starts the robots.

    Args:
        scene: the scene.
        controller: the controller of both robots.
        world_options: further options of ``palmbots world``.
        rate: multiple of real time.
        impairment: what happens to the packets.
        quiet: only the world prints its result.
        on_line: called with a line about each program that was killed and starts again.

    Returns:
        The exit status of the world: 0 if the object was delivered.

    Raises:
        PalmbotsError: a process cannot be started, or a program fails.
    """
    with _free_ports(len(ENDS)) as ports:  # the proxy gets others
        own: dict[Role, str] = dict(zip(ENDS, ports, strict=True))
        proxy = Proxy(own, impairment)
    values = {
        **{f"link.{end}": address for end, address in proxy.addresses.items()},
        "limits.after_reboot": "rejoin",
        "limits.partner_lost": "controller",
        "limits.time_limit_s": scene.timeout_s,
        "limits.max_speed_m_s": max(scene.robot_of(side).max_speed_m_s for side in SIDES),
    }
    speed = ["--rate", str(rate)]
    with proxy, _pair(scene, controller, values) as (file, address), _processes() as running:
        files = {end: _own_file(file, end, address) for end, address in own.items()}
        world = ["world", str(file.with_name("scene.toml")), "--serve", address, *speed]
        running["world"] = _started([*world, *world_options])
        robots = {side: ["robot", str(files[side]), "--side", side, *speed] for side in SIDES}
        for side, command in robots.items():
            running[side] = _started(command)
        commands = robots | {"station": ["station", str(files["station"]), "--auto"]}
        running["station"] = _started(commands["station"], quiet=quiet)
        _supervise(running, commands, on_line)
        for side in SIDES:
            running[side].send_signal(signal.SIGTERM)
        return _status_of(running["world"])


def _status_of(world: "subprocess.Popen[bytes]") -> int:
    """The exit status of the world, which ends soon after the robots."""
    try:
        return world.wait(_WORLD_ENDS_WITHIN_S)
    except subprocess.TimeoutExpired:
        raise PalmbotsError("world: does not end, although the robots have been ended") from None


def _wait_for(name: str, running: _Running, robots: _Commands) -> None:
    """Wait until the process of this name, or the world, ends; start rebooted robots again.

    Raises:
        PalmbotsError: a robot's program ended on its own.
    """
    while running[name].poll() is None and running["world"].poll() is None:
        for side, command in robots.items():
            ended = running[side].poll()
            if ended == REBOOTED:
                running[side] = _started(command)
            elif ended not in (None, 0):
                raise PalmbotsError(f"{side} robot: its program ended with status {ended}")
        time.sleep(_POLL_S)


def _supervise(running: _Running, commands: _Commands, on_line: Callable[[str], None]) -> None:
    """Wait until the station, or the world, ends; start again what was killed.

    Raises:
        PalmbotsError: a program ended with a fault, or the world was killed.
    """
    while running["world"].poll() is None:
        for name, command in commands.items():
            ended = running[name].poll()
            if ended is not None and ended < 0:
                on_line(f"{name}: was killed (signal {-ended}), and starts again")
                running[name] = _started(command)
            elif name == "station" and ended is not None:
                if ended == _BAD_INPUT:
                    raise PalmbotsError("station: its program ended with a fault")
                return
            elif ended not in (None, 0):
                raise PalmbotsError(f"{name} robot: its program ended with status {ended}")
        time.sleep(_POLL_S)
    if running["world"].returncode < 0:
        raise PalmbotsError("world: was killed; the carry is void")


@contextlib.contextmanager
def _pair(
    scene: Scene, controller: str, values: Mapping[str, object] | None = None
) -> Iterator[tuple[Path, str]]:
    """A ``pair.toml`` beside ``scene.toml`` in a temporary folder, and the address of a world."""
    with tempfile.TemporaryDirectory(prefix="palmbots-") as name:
        folder = Path(name)
        write_whole(folder / "scene.toml", scene.to_toml())
        address = f"unix:{folder / 'world.socket'}"
        file = folder / "pair.toml"
        init_pair(
            file,
            scene="scene.toml",
            controller=_absolute(controller),
            address=address,
            values=values,
        )
        yield file, address


def _own_file(file: Path, end: Role, address: str) -> Path:
    """The pair file for one end: it receives at its own address, and sends through the proxy."""
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    own = [f'{end} = "{address}"\n' if line.startswith(f"{end} = ") else line for line in lines]
    copy = file.with_name(f"{file.stem}-{end}.toml")
    write_whole(copy, "".join(own))
    return copy


@contextlib.contextmanager
def _free_ports(count: int) -> Iterator[list[str]]:
    """Addresses of this machine that no program uses."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket(type=socket.SOCK_DGRAM)) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        yield ["{}:{}".format(*one.getsockname()) for one in sockets]


def _absolute(controller: str) -> str:
    """The controller, also if it is a file, for programs that start in another folder."""
    file, colon, name = controller.partition(":")
    if not file.endswith((".py", ".toml")):
        return controller
    return f"{Path(file).absolute()}{colon}{name}"


def _started(arguments: Sequence[str], *, quiet: bool = False) -> "subprocess.Popen[bytes]":
    output = subprocess.DEVNULL if quiet else None
    try:
        return subprocess.Popen([sys.executable, "-m", "palmbots", *arguments], stdout=output)
    except OSError as error:
        raise PalmbotsError(f"{sys.executable}: {error.strerror or error}") from None


@contextlib.contextmanager
def _processes() -> Iterator[dict[str, "subprocess.Popen[bytes]"]]:
    """Processes by name; all that still run at the end are ended."""
    running: dict[str, subprocess.Popen[bytes]] = {}
    in_main = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGTERM, _end) if in_main else None
    try:
        yield running
    finally:
        if in_main:
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
        for process in running.values():
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for process in running.values():
            try:
                process.wait(_END_WITHIN_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if in_main:
            signal.signal(signal.SIGTERM, before)


def _end(number: int, _: object) -> None:
    """Leave on a signal that would otherwise leave the processes behind."""
    raise SystemExit(128 + number)
