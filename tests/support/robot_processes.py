# SPDX-License-Identifier: Apache-2.0
"""Programs of palmbots as processes, and pairs on free ports."""

import contextlib
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from palmbots.pair.pair_file import init_pair

ENDS = ("left", "right", "station")


def started(
    command: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None
) -> "subprocess.Popen[str]":
    """`palmbots COMMAND` in this folder."""
    return subprocess.Popen(
        [sys.executable, "-m", "palmbots", *command],
        cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, env=environment,
    )  # fmt: skip


@contextlib.contextmanager
def running(
    *commands: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None
) -> Iterator[list["subprocess.Popen[str]"]]:
    """The commands run as long as the block, also if it has suspended them."""
    processes = [started(command, folder, environment) for command in commands]
    try:
        yield processes
    finally:
        for process in processes:
            with contextlib.suppress(OSError):
                process.send_signal(signal.SIGCONT)
            process.terminate()
            process.communicate(timeout=60)


def new_pair(
    folder: Path,
    values: Mapping[str, object] | None = None,
    scene: str = "paper",
    **named: object,
) -> Path:
    """`pair.toml` in this folder, on ports that no program uses, with further values.

    They are a table (``{"link.kind": "serial"}``), or named (``link__kind="serial"``).
    """
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket(type=socket.SOCK_DGRAM)) for _ in ENDS]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        ports = [one.getsockname()[1] for one in sockets]
    chosen: dict[str, object] = {
        f"link.{end}": f"127.0.0.1:{port}" for end, port in zip(ENDS, ports, strict=True)
    }
    chosen |= {**(values or {}), **{name.replace("__", "."): v for name, v in named.items()}}
    address = f"unix:{folder / 'world'}"
    return init_pair(folder / "pair.toml", scene=scene, address=address, values=chosen)[0]
