# SPDX-License-Identifier: Apache-2.0
"""World, robots and station as real processes over real sockets, whose time a test grants.

The programs are those that `palmbots up` starts. Each waits for its next tick on a socket of this
module (`palmbots.clocks.stepped_clock`), and all packets pass through a bad radio that runs on the
same time. A fault therefore comes at the same instant in every run, and `trace` is the same.
"""

import contextlib
import hashlib
import os
import re
import signal
import socket
import subprocess
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import palmbots as pb
from json_output import read_json
from pair_programs import new_pair, started
from palmbots._types import Side
from palmbots.links.impairment import ImpairedPackets, Impairment
from palmbots.links.local_connection import Connection, ConnectionLost, listen
from palmbots.pair.launcher import UP, free_addresses, own_file
from palmbots.pair.pair_file import ENDS, load_pair
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.station.robot_view import phase_name
from palmbots.wire import Status, decode

ORDER = ("world", *ENDS)
KEY = "0f1e2d3c4b5a69788796a5b4c3d2e1f0"
MS = 1_000_000  # ns
WITHIN_S = 60.0
UNDER_WAY = ("ready", "carrying", "holding")


@dataclass
class Program:
    """One process."""

    name: str
    process: "subprocess.Popen[str]"
    output: Path
    errors: Path
    period_ns: int
    role: str
    """What it calls itself."""
    world: str
    """The process from which it gets its readings."""
    steps: Connection | None = None
    is_ready: bool = False
    is_stopped: bool = False
    next_ns: int = 0
    missed: int = 0
    sent: Counter[str] = field(default_factory=Counter)

    @property
    def is_over(self) -> bool:
        return self.steps is None and self.process.poll() is not None

    def printed(self) -> str:
        return self.output.read_text()

    def said(self) -> str:
        return self.errors.read_text()


class SteppedProcesses:
    """The processes of one carry; a context manager."""

    def __init__(
        self, folder: Path, controller: str = "resilient", radio: Impairment | None = None,
        *, seed: int = 0, overrides: Mapping[str, Any] | None = None,
        environment: Mapping[str, str] | None = None,
        clock_rate: Mapping[Side, float] | None = None, scene: str = "paper",
    ) -> None:  # fmt: skip
        self.folder, self.now_ns = folder, 0
        self._environment = {"PALMBOTS_STEPS": f"unix:{folder / 'steps'}", **(environment or {})}
        self.scene = pb.load_scene(scene, {"task.distance_m": 0.4} | dict(overrides or {}))
        self.sides = self.scene.working_sides
        self.order = ("world", *self.sides, "station")
        (folder / "scene.toml").write_text(self.scene.to_toml())
        self._clock_rate: dict[str, float] = {**(clock_rate or {})}
        self._stack = contextlib.ExitStack()
        self.address = f"unix:{folder / 'world'}"
        with free_addresses(len(ENDS)) as addresses:
            self.own = dict(zip(ENDS, addresses, strict=True))
        targets = ((end, _place(address)) for end, address in self.own.items())
        self._targets: dict[str, tuple[str, int]] = dict(targets)
        self._sockets: dict[str, socket.socket] = {end: self._socket() for end in ENDS}
        given = {
            f"link.{end}": "{}:{}".format(*one.getsockname()) for end, one in self._sockets.items()
        }
        chosen: dict[str, object] = {
            **given, "pair.number": 4711, "pair.controller": controller,
            **UP,
            "limits.time_limit_s": 120.0, "hardware.stopping_s": stopping_limit_s(self.scene),
        }  # fmt: skip
        self.file = new_pair(folder, chosen, "scene.toml")
        (folder / "pair.key").write_text(KEY + "\n")
        self.pair = load_pair(self.file)
        self.files: dict[str, Path] = {end: own_file(self.file, end, self.own[end]) for end in ENDS}
        self.packets = ImpairedPackets(radio or Impairment(delay_ms=2.0), seed)
        self._door = self._stack.enter_context(listen(f"unix:{folder / 'steps'}"))
        self.programs: dict[str, Program] = {}
        self._arrived: Counter[str] = Counter()  # datagrams since its last tick
        self._senders = {place: end for end, place in self._targets.items()}
        self.status: dict[str, Status] = {}
        """The newest status of each robot."""
        self.phases: dict[str, str] = {}
        """The newest phase of each robot in a job."""
        self.trace = hashlib.sha256()
        """Of every packet: when, from whom, to whom, and its bytes."""

    def _socket(self) -> socket.socket:
        made = self._stack.enter_context(socket.socket(type=socket.SOCK_DGRAM))
        made.bind(("127.0.0.1", 0))
        made.settimeout(WITHIN_S)
        return made

    # Processes

    def command(self, name: str) -> list[str]:
        """What is started under this name."""
        if name == "world":
            scene = str(self.folder / "scene.toml")
            return ["world", scene, "--serve", self.address, "--json"]
        if name == "station":
            return ["station", str(self.files["station"]), "--auto", "--no-screen"]
        return ["robot", str(self.files[name]), "--side", name, "--json"]

    def spawn(
        self, name: str, command: list[str] | None = None, role: str = "", world: str = "world"
    ) -> Program:
        """Start a process; it does nothing before its first tick is granted."""
        files = [self.folder / f"{name}.{kind}" for kind in ("out", "err")]
        with files[0].open("a") as output, files[1].open("a") as errors:
            process = started(
                command or self.command(name), environment=self._environment,
                stdout=output, stderr=errors, stdin=subprocess.DEVNULL,
            )  # fmt: skip
        role = role or name
        period = 50 * MS if role == "station" else 10 * MS
        period = round(period / self._clock_rate.get(name, 1.0))
        made = Program(name, process, files[0], files[1], period, role, world)
        self.programs[name] = made
        return made

    def start(self) -> None:
        """Start all, and wait until the first tick can come."""
        for name in self.order:
            self.spawn(name)
        self.let_in(*self.order)

    def carry(self) -> None:
        """Start all, and let them carry for two seconds."""
        self.start()
        self.run_until(self.carries, 20)
        self.run(2.0)

    def let_in(self, *names: str) -> None:
        """Wait until these processes wait for their first tick, or have ended."""
        give_up = time.monotonic() + WITHIN_S
        missing = set(names)
        self._door.settimeout(0.05)
        while missing:
            assert time.monotonic() < give_up, (missing, [self.programs[n].said() for n in missing])
            missing -= {name for name in missing if self.programs[name].process.poll() is not None}
            with contextlib.suppress(TimeoutError):
                stream, _ = self._door.accept()
                steps = Connection(stream, "a program")
                role = steps.receive(WITHIN_S)
                name = next(n for n in missing if self.programs[n].role == role)
                program = self.programs[name]
                program.steps = steps
                program.next_ns = self.now_ns + program.period_ns
                self._arrived[program.name] = 0
                missing.discard(name)

    def restart(self, name: str) -> None:
        """Start a process again that has ended."""
        self.programs[name].process.wait(WITHIN_S)
        self.spawn(name)
        self.let_in(name)

    def cut(self, *links: tuple[str, str]) -> None:
        """From now on lose everything on these links, and on no other."""
        self.packets.cut(*links)

    def kill(self, name: str) -> None:
        """``kill -9``."""
        program = self.programs[name]
        program.process.kill()
        program.process.wait()
        self._over(program)

    def suspend(self, name: str) -> None:
        """``kill -STOP``."""
        program = self.programs[name]
        os.kill(program.process.pid, signal.SIGSTOP)
        program.is_stopped = True

    def resume(self, name: str) -> None:
        """``kill -CONT``."""
        program = self.programs[name]
        os.kill(program.process.pid, signal.SIGCONT)
        program.is_stopped = False
        self._arrived[program.name] = 0  # the system may have discarded some of them
        program.missed = -min(0, program.next_ns - self.now_ns) // program.period_ns
        program.next_ns += program.period_ns * program.missed

    def _over(self, program: Program) -> None:
        if program.steps is not None:
            program.steps.close()
        program.steps, program.is_ready = None, False

    # Time

    @property
    def now_s(self) -> float:
        return 1e-9 * self.now_ns

    def run(self, seconds: float) -> None:
        """Let this time pass."""
        until_ns = self.now_ns + round(1e9 * seconds)
        while (program := self._next()) is not None and program.next_ns <= until_ns:
            self._tick(program)
        self.now_ns = until_ns

    def run_until(self, holds: Callable[[], object], within_s: float) -> None:
        """Let time pass until something holds, looking every 10 ms; fails if it never does."""
        give_up = self.now_s + within_s
        while not holds():
            assert self.now_s < give_up, (self.modes(), self.report())
            self.run(0.01)

    def _next(self) -> Program | None:
        there = [p for p in self.programs.values() if p.steps is not None and not p.is_stopped]
        for program in there:  # a robot is ready when it has its first reading
            if not program.is_ready and program.role == "world":
                self._await(program)
        due = [p for p in there if p.is_ready or p.role in ("world", "station")]
        return min(due, key=lambda p: (p.next_ns, self._rank(p)), default=None)

    @staticmethod
    def _rank(program: Program) -> int:
        return ORDER.index(program.name) if program.name in ORDER else len(ORDER)

    def _tick(self, program: Program) -> None:
        if not program.is_ready:
            self._await(program)
        if program.steps is None:
            return
        self.now_ns = max(self.now_ns, program.next_ns)
        self._deliver()
        elapsed, program.missed = 1 + program.missed, 0
        program.next_ns += program.period_ns
        expected = self._arrived.pop(program.name, 0)
        program.is_ready = False
        with contextlib.suppress(ConnectionLost):
            program.steps.send([round(self.now_s, 9), elapsed, expected])
        self._await(program)
        if program.role == "world":
            for other in self.programs.values():
                gets_readings = other.world == program.name and not other.is_stopped
                if other.steps is not None and not other.is_ready and gets_readings:
                    self._await(other)

    def _await(self, program: Program) -> None:
        """Wait until the program waits for its next tick, or has ended; take what it has sent."""
        assert program.steps is not None
        try:
            sent = Counter(program.steps.receive(WITHIN_S))
        except ConnectionLost:
            program.process.wait(WITHIN_S)
            self._over(program)
            for receiver in ENDS:  # its last words
                self._sockets[receiver].settimeout(0)
                with contextlib.suppress(BlockingIOError):
                    while True:
                        self._note(program.name, receiver, self._sockets[receiver].recv(2048))
                self._sockets[receiver].settimeout(WITHIN_S)
            return
        for receiver in ENDS:
            for _ in range(sent[receiver] - program.sent[receiver]):
                data, place = self._sockets[receiver].recvfrom(2048)
                self._note(self._senders.get(place, program.name), receiver, data)
        program.sent, program.is_ready = sent, True

    def _note(self, sender: str, receiver: str, data: bytes) -> None:
        self.trace.update(f"{self.now_ns} {sender} {receiver} ".encode() + data)
        self.packets.send(self.now_s, sender, receiver, data)
        if receiver == "station" and sender in ENDS:
            number = self.pair.settings.pair.number
            packet = decode(data, self.pair.key, number, "station").packet
            if packet is not None and isinstance(packet.body, Status):
                self.status[sender] = packet.body
                if packet.body.item == "phase":
                    self.phases[sender] = phase_name(packet.body.value)

    def _deliver(self) -> None:
        for receiver, data in self.packets.due(self.now_s):
            program = self.programs.get(receiver)
            if program is not None and program.steps is not None:
                self._sockets[receiver].sendto(data, self._targets[receiver])
                self._arrived[receiver] += 0 if program.is_stopped else 1

    def has_ended(self, *names: str) -> bool:
        """These processes have ended."""
        return all(self.programs[name].process.poll() is not None for name in names)

    def finish(self, within_s: float = 100.0) -> dict[str, Any]:
        """Wait until the station ends, end the robots as `palmbots up` does, and return what the
        world prints."""
        self.run_until(lambda: self.has_ended("station") or self.has_ended("world"), within_s)
        for side in self.sides:
            if not self.has_ended(side):
                self.programs[side].process.terminate()
        self.run_until(lambda: self.has_ended(*self.order), 10.0)
        return read_json("world", self.programs["world"].printed())

    # What has happened

    def modes(self) -> dict[str, str]:
        """The modes that the robots have stated last."""
        return {side: status.mode for side, status in self.status.items()}

    def faults(self) -> dict[str, str]:
        return {side: status.fault for side, status in self.status.items()}

    def carries(self) -> bool:
        modes = self.modes().values()
        return len(modes) == len(self.sides) and all(m in UNDER_WAY[1:] for m in modes)

    def lines(self) -> str:
        """What the station has printed."""
        return self.programs["station"].printed()

    def says(self, pattern: str) -> bool:
        """The station has printed a line that begins so."""
        return re.search(rf"^ *[\d.]+ s  {pattern}", self.lines(), re.MULTILINE) is not None

    def report(self) -> str:
        return "\n".join(f"{p.name}:\n{p.printed()}{p.said()}" for p in self.programs.values())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for program in self.programs.values():
            if program.process.poll() is None:
                program.process.kill()
                program.process.wait()
            self._over(program)
        self._stack.close()


def _place(address: str) -> tuple[str, int]:
    host, _, port = address.rpartition(":")
    return host, int(port)
