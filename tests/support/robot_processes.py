# SPDX-License-Identifier: Apache-2.0
"""Programs of palmbots as processes, and pairs on free ports."""

import contextlib
import socket
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from palmbots.runtime.pair_file import init_pair


def started(command: Sequence[str], folder: Path) -> "subprocess.Popen[str]":
    """`palmbots COMMAND` in this folder."""
    return subprocess.Popen(
        [sys.executable, "-m", "palmbots", *command],
        cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip


@contextlib.contextmanager
def running(*commands: Sequence[str], folder: Path) -> Iterator[list["subprocess.Popen[str]"]]:
    """The commands run as long as the block."""
    processes = [started(command, folder) for command in commands]
    try:
        yield processes
    finally:
        for process in processes:
            process.terminate()
            process.communicate(timeout=60)


def new_pair(
    folder: Path, values: Mapping[str, object] | None = None, scene: str = "paper"
) -> None:
    """`pair.toml` in this folder, on ports that no program uses."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket(type=socket.SOCK_DGRAM)) for _ in range(3)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        ports = [one.getsockname()[1] for one in sockets]
    ends = zip(("left", "right", "station"), ports, strict=True)
    links: dict[str, object] = {f"link.{end}": f"127.0.0.1:{port}" for end, port in ends}
    init_pair(
        folder / "pair.toml", scene=scene, address=f"unix:{folder / 'world'}",
        values=links | dict(values or {}),
    )  # fmt: skip
