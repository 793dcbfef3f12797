# SPDX-License-Identifier: Apache-2.0
"""Writes the log of one program of a pair, off its control thread.

The control thread only puts messages into a queue. A disk that is full or too slow costs the rest
of the log and one warning, never a tick.
"""

import contextlib
import errno
import json
import os
import queue
import socket
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from palmbots.logs.run_channels import RUN_FORMAT, RUN_RECORD

_MOST_WAITING = 5000  # messages that the disk has not taken yet
_CHUNK_BYTES = 16_384  # what a program that is killed loses at most
_CLOSES_WITHIN_S = 5.0
_MOST_BYTES = 500_000_000
_FLUSHED_EVERY = 100  # messages
_LOOKS_EVERY_S = 0.1  # to wake for every message would take time from the control thread
Fill = Callable[[], Any]
_now_ns = time.monotonic_ns


class RunLogWriter:
    """One log file, ``END-BOOTS.mcap``.

    Args:
        folder: where the log goes; it is created.
        end: ``left``, ``right`` or ``station``.
        epoch: number of the program's boots.
        facts: what the log states about the program, for JSON.
        on_warning: called with one line, at most once.
    """

    def __init__(
        self,
        folder: Path,
        end: str,
        epoch: int,
        facts: Mapping[str, Any],
        on_warning: Callable[[str], None],
    ) -> None:
        self.path = folder / f"{end}-{epoch:06d}.mcap"
        self._start_ns = _now_ns()
        self._facts = dict(facts) | {
            "format": RUN_FORMAT,
            "end": end,
            "epoch": epoch,
            "host": socket.gethostname(),
            "started": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
            "monotonic_ns": self._start_ns,
        }
        self._warn: Callable[[str], None] | None = on_warning
        self._queue: queue.Queue[tuple[int, str, Fill] | None] = queue.Queue(_MOST_WAITING)
        self._closes = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def now_ns(self) -> int:
        """The time of the log."""
        return _now_ns() - self._start_ns

    def add(self, topic: str, fill: Fill, instant_ns: int | None = None) -> None:
        """Log what `fill` returns, a protobuf message. It is called later, on another thread;
        returns at once. If the disk is too slow, the message is lost.

        Args:
            topic: where the message belongs.
            fill: makes the message.
            instant_ns: when it happened, as `now_ns` gives it; None: now.
        """
        instant = self.now_ns() if instant_ns is None else instant_ns
        try:
            self._queue.put_nowait((instant, topic, fill))
        except queue.Full:
            self._say("the disk is too slow; parts of the log are missing")

    def close(self) -> None:
        """Write what is left, but do not wait long for it."""
        self._closes.set()
        with contextlib.suppress(queue.Full):
            self._queue.put(None, timeout=_CLOSES_WITHIN_S)
        self._thread.join(_CLOSES_WITHIN_S)

    def _say(self, why: str) -> None:
        warn, self._warn = self._warn, None
        if warn is not None:
            warn(f"log: {self.path}: {why}")

    def _run(self) -> None:
        try:
            self._write()
        except Exception as error:  # whatever it is: the robot goes on without a log
            why = (isinstance(error, OSError) and error.strerror) or error
            self._say(f"{why}; the rest of this run is not logged")
            while self._queue.get() is not None:  # so that nothing piles up
                pass

    def _write(self) -> None:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self._opened() as stream:
            channels = _Channels(stream)
            channels.start(self._facts)
            while (item := self._queue.get()) is not None:
                instant, topic, fill = item
                channels.write(topic, fill(), instant)
                if self._queue.empty():
                    self._closes.wait(_LOOKS_EVERY_S)
                if os.fstat(stream.fileno()).st_size > _MOST_BYTES:
                    self._say(f"has reached {_MOST_BYTES // 1_000_000} MB, and ends")
                    break
            channels.finish()
        if item is not None:
            while self._queue.get() is not None:
                pass

    def _opened(self) -> BinaryIO:
        """The new file; an older log of the same name is kept."""
        for number in range(1000):
            suffix = f"-{number}" if number else ""
            with contextlib.suppress(FileExistsError):
                path = self.path.with_name(f"{self.path.stem}{suffix}.mcap")
                stream = path.open("xb")
                self.path = path
                return stream
        raise FileExistsError(errno.EEXIST, "exists already")


class _Channels:
    """The channels of a log that is being written."""

    def __init__(self, stream: BinaryIO) -> None:
        from mcap.writer import CompressionType, Writer

        from palmbots._version import __version__

        self._stream = stream
        self._version = __version__
        self._writer = Writer(stream, chunk_size=_CHUNK_BYTES, compression=CompressionType.ZSTD)
        self._channels: dict[str, int] = {}
        self._counts: dict[str, int] = {}
        self._count = 0

    def start(self, facts: Mapping[str, Any]) -> None:
        self._writer.start(profile="", library=f"palmbots {self._version}")
        values = {name: json.dumps(value) for name, value in facts.items()}
        self._writer.add_metadata(RUN_RECORD, values | {"version": json.dumps(self._version)})
        self._stream.flush()

    def write(self, topic: str, message: Any, instant: int) -> None:
        from mcap_protobuf.schema import register_schema

        if topic not in self._channels:
            schema = register_schema(self._writer, type(message))
            self._channels[topic] = self._writer.register_channel(topic, "protobuf", schema)
            self._counts[topic] = 0
        self._counts[topic] += 1
        self._writer.add_message(
            self._channels[topic], instant, message.SerializeToString(), instant,
            self._counts[topic],
        )  # fmt: skip
        self._count += 1
        if self._count % _FLUSHED_EVERY == 0:
            self._stream.flush()

    def finish(self) -> None:
        self._writer.finish()
        self._stream.flush()
