# SPDX-License-Identifier: Apache-2.0
"""Starting a world and two robots as processes of one machine, and restarting what reboots."""

import contextlib
import os
import secrets
import socket
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Self

from palmbots._types import SIDES
from palmbots._util.atomic_files import write_whole
from palmbots._util.exit_status import BAD_INPUT
from palmbots.errors import PalmbotsError
from palmbots.links.impairment import Impairment, Proxy, RecordedFates
from palmbots.links.lockstep_line import REBOOTED
from palmbots.pair.pair_file import ENDS, init_pair, load_pair, station_address
from palmbots.pair.processes import Processes
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.scene.scene import Scene
from palmbots.wire import KEY_SIZE, Role

UP: dict[str, object] = {"limits.after_reboot": "rejoin", "limits.partner_lost": "controller"}
"""What ``palmbots up`` sets in a pair file: the controllers, not the robots, answer losses."""
_POLL_S = 0.02
_END_WITHIN_S = 5.0


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
        PalmbotsError: a process cannot be started, a robot's program fails, or the world was
            killed.
    """
    with (
        _pair(scene, controller, _limits(scene)) as (file, address, key),
        Processes(descriptors=[key]) as running,
    ):
        world = ["world", str(file.with_name("scene.toml")), "--serve", address, "--lockstep"]
        running.start("world", [*world, "--controller", controller, *world_options])
        for side in scene.working_sides:
            running.start(side, ["robot", str(file), "--side", side, "--lockstep"])
        if has_station:
            running.start("station", ["station", str(file), "--lockstep"])
        while (status := running.status("world")) is None:
            for side in scene.working_sides:
                ended = running.status(side)
                if ended == REBOOTED:
                    running.restart(side)
                elif ended not in (None, 0) and not running.ends_within("world", 1.0):
                    raise PalmbotsError(f"{side} robot: its program ended with status {ended}")
            time.sleep(_POLL_S)
        _check_world(status)
        running.end(*scene.working_sides, within_s=_END_WITHIN_S, ask=False)
        return status


def _check_world(status: int) -> None:
    """Raise `PalmbotsError` for a world that was killed."""
    if status < 0:
        raise PalmbotsError("world: was killed; the carry is void")


class LiveCarryProcesses:
    """A world, two robots and a station as processes in real time; a context manager.

    Args:
        scene: the scene.
        controller: the controller of both robots.
        world_options: further options of ``palmbots world``.
        rate: multiple of real time.
        impairment: what happens to the packets, in the time of the robots.
        screen: options of ``palmbots station`` for a screen of the station; None: no screen.
        output: file for what the world prints; None: it prints on stdout.
        station_output: file for what the station says; None: only screens show it.
        log_folder: where robots and station log; empty: nowhere.
        live: where a live view for Foxglove is served; None: nowhere.
        auto: the station arms and starts the robots; otherwise an operator does so on a screen.
        on_line: called with a line about each program that was killed and starts again.
        seed: of the packets' fates.
        fates: of recorded packets, in place of losses and recorded delays.
    """

    def __init__(
        self,
        scene: Scene,
        controller: str,
        world_options: Sequence[str],
        *,
        rate: float,
        impairment: Impairment,
        screen: Sequence[str] | None = None,
        output: Path | None = None,
        station_output: Path | None = None,
        log_folder: str = "",
        live: str | None = None,
        auto: bool = True,
        on_line: Callable[[str], None],
        seed: int = 0,
        fates: RecordedFates | None = None,
    ) -> None:
        self._scene, self._controller, self._options = scene, controller, world_options
        self._rate, self._screen, self._on_line = rate, screen, on_line
        self._output, self._station_output, self._auto = output, station_output, auto
        self._log_folder, self._live = log_folder, live
        with free_addresses(len(ENDS)) as ports:  # the proxy gets others
            self._own: dict[Role, str] = dict(zip(ENDS, ports, strict=True))
            self.proxy = Proxy(self._own, impairment, seed, rate, fates)
        self.processes = Processes()
        """The processes, by the names ``world``, ``left``, ``right`` and ``station``."""
        self.station_address = ""
        """Where the station listens for screens."""

    def __enter__(self) -> Self:
        with contextlib.ExitStack() as stack:
            stack.enter_context(self.proxy)
            file, address, key = stack.enter_context(
                _pair(self._scene, self._controller, self._values())
            )
            self.processes.descriptors = [key]
            running = stack.enter_context(self.processes)
            self._start(file, address, running)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def _values(self) -> dict[str, object]:
        return {
            **{f"link.{end}": address for end, address in self.proxy.addresses.items()},
            "pair.log_folder": self._log_folder,
            **_limits(self._scene),
            "limits.time_limit_s": self._scene.timeout_s,
            "hardware.stopping_s": stopping_limit_s(self._scene),
        }

    def _start(self, file: Path, address: str, running: Processes) -> None:
        files = {end: own_file(file, end, address) for end, address in self._own.items()}
        speed = ["--rate", str(self._rate)]
        world = ["world", str(file.with_name("scene.toml")), "--serve", address, *speed]
        self.station_address = station_address(load_pair(files["station"]))
        running.start("world", [*world, *self._options], output=self._output)
        for side in self._scene.working_sides:
            running.start(side, ["robot", str(files[side]), "--side", side, *speed])
        station = ["station", str(files["station"])]
        running.start(
            "station",
            [*station, *(["--auto"] if self._auto else []), "--no-screen"],
            output=self._station_output or Path(os.devnull),
        )
        if self._screen is not None:
            running.start("screen", [*station, *self._screen])
        if self._live is not None:
            view = ["view", str(files["station"]), "--serve", self._live, "--wait-s", "60"]
            running.start("view", [*view, "--json"])

    def poll(self) -> bool:
        """Start again what was killed; returns whether the carry goes on.

        Raises:
            PalmbotsError: a program ended with a fault, or the world was killed.
        """
        running = self.processes
        world = running.status("world")
        if world is not None:
            _check_world(world)
            return False
        for name in (*self._scene.working_sides, "station"):
            ended = running.status(name)
            if ended is not None and ended < 0:
                self._on_line(f"{name}: was killed (signal {-ended}), and starts again")
                running.restart(name)
            elif name == "station" and ended is not None:
                if ended == BAD_INPUT:
                    raise PalmbotsError("station: its program ended with a fault")
                return False
            elif ended not in (None, 0) and not running.ends_within("world", 1.0):
                raise PalmbotsError(f"{name} robot: its program ended with status {ended}")
        return True

    def finish(self) -> int:
        """End the robots, and return the exit status of the world, which then ends.

        Raises:
            PalmbotsError: the world does not end.
        """
        if self._screen is not None:  # it shows the end
            self.processes.ends_within("screen", _END_WITHIN_S)
        self.processes.end(*self._scene.working_sides, within_s=_END_WITHIN_S)
        # The world waits for robots for three seconds of its own time.
        return self.processes.wait("world", _END_WITHIN_S + 5.0 / min(1.0, self._rate))


def run_live(
    scene: Scene,
    controller: str,
    world_options: Sequence[str],
    *,
    rate: float,
    impairment: Impairment,
    screen: Sequence[str] | None,
    output: Path | None,
    log_folder: str,
    live: str | None,
    on_line: Callable[[str], None],
    seed: int = 0,
    fates: RecordedFates | None = None,
) -> int:
    """Run a world, two robots and a station in real time; the station arms and starts the robots.

    The arguments are those of `LiveCarryProcesses`.

    Returns:
        The exit status of the world: 0 if the object was delivered.

    Raises:
        PalmbotsError: a process cannot be started, a program fails, or the world was killed.
    """
    with LiveCarryProcesses(
        scene,
        controller,
        world_options,
        rate=rate,
        impairment=impairment,
        screen=screen,
        output=output,
        log_folder=log_folder,
        live=live,
        on_line=on_line,
        seed=seed,
        fates=fates,
    ) as carry:
        while carry.poll():
            time.sleep(_POLL_S)
        return carry.finish()


def _limits(scene: Scene) -> dict[str, object]:
    """Limits of a pair with which robots do what the scene says."""
    return {**UP, "limits.max_speed_m_s": max(scene.robot_of(s).max_speed_m_s for s in SIDES)}


@contextlib.contextmanager
def _pair(
    scene: Scene, controller: str, values: Mapping[str, object] | None = None
) -> Iterator[tuple[Path, str, int]]:
    """A ``pair.toml`` beside ``scene.toml`` in a temporary folder, the address of a world, and the
    open file with the key, which the programs have to inherit."""
    with (
        tempfile.TemporaryDirectory(prefix="palmbots-") as name,
        tempfile.TemporaryFile(prefix="palmbots-") as key,
    ):
        # The key has no name in the file system, so that a SIGKILL leaves none behind.
        key.write(secrets.token_hex(KEY_SIZE).encode())
        key.flush()
        folder = Path(name)
        write_whole(folder / "scene.toml", scene.to_toml())
        address = f"unix:{folder / 'world.socket'}"
        file = folder / "pair.toml"
        init_pair(
            file,
            scene="scene.toml",
            controller=_absolute(controller),
            address=address,
            values={**(values or {}), "pair.key_file": f"/dev/fd/{key.fileno()}"},
        )
        file.with_suffix(".key").unlink()  # another key, which nobody uses
        yield file, address, key.fileno()


def own_file(file: Path, end: Role, address: str) -> Path:
    """The pair file for one end: it receives at its own address, and sends through the proxy."""
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    own = [f'{end} = "{address}"\n' if line.startswith(f"{end} = ") else line for line in lines]
    copy = file.with_name(f"{file.stem}-{end}.toml")
    write_whole(copy, "".join(own))
    return copy


@contextlib.contextmanager
def free_addresses(count: int) -> Iterator[list[str]]:
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
