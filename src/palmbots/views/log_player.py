# SPDX-License-Identifier: Apache-2.0
"""Plays a log to viewers: the messages of an MCAP file, in the time in which they were logged."""

import dataclasses
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

from palmbots.errors import PalmbotsError
from palmbots.logs.mcap_writer import write_log
from palmbots.logs.run_log_reader import log_of_carry
from palmbots.scene.file_kinds import LOG, refuse_other_kind
from palmbots.views.estimated_carry import drawn_contact
from palmbots.views.foxglove_server import FoxgloveServer
from palmbots.views.run_figures import carry_of
from palmbots.views.run_replay import read_run, replay_run

_LATCHED = ("/solids", "/robot_description")
_AGAIN_S = 2.0
_STEP_S = 0.02
_MOST_WAIT_S = 0.1


def viewable(paths: Sequence[Path], folder: Path) -> Path:
    """A carry log that shows these logs: the log itself, or, for logs of robots, a new one.

    Args:
        paths: one carry log, or the logs of a run (folders stand for all logs in them).
        folder: where the new log goes.

    Raises:
        PalmbotsError: a log cannot be read, or the logs show no carry.
    """
    if len(paths) == 1 and (file := log_of_carry(paths[0])) is not None:
        return file
    logs = read_run(list(paths))
    carry = carry_of(logs, replay_run(logs).clocks)
    assert carry.trace is not None
    trace = carry.trace.copy()
    contact = drawn_contact(trace["sign"].to_numpy())
    trace["contact"] = (trace["sign"].dims, contact, trace["contact"].attrs)
    apart = trace["separation"].to_numpy()  # in a gap of a log the newest known one is drawn
    newest = np.maximum.accumulate(np.where(np.isnan(apart), 0, np.arange(len(apart))))
    trace["separation"] = (trace["separation"].dims, apart[newest], trace["separation"].attrs)
    file = folder / "run.mcap"
    write_log(dataclasses.replace(carry, trace=trace), file)
    return file


@dataclasses.dataclass(frozen=True)
class Playable:
    """What is to be played."""

    channels: list[tuple[str, str, tuple[str, str, bytes]]]
    """Topic, encoding of the messages, and schema (name, encoding, text) of each channel."""
    messages: list[tuple[int, str, bytes]]
    """Time [ns], topic and bytes of each message, in the order of time."""


def announce(log: Playable, server: FoxgloveServer) -> None:
    """Announce the channels of a log, before viewers connect."""
    for channel in log.channels:
        server.add(*channel)


def play(
    log: Playable,
    server: FoxgloveServer,
    *,
    rate: float,
    loops: bool,
    is_ended: Callable[[], bool] = lambda: False,
) -> int:
    """Send all messages of a log, as they were logged; returns how many were sent.

    Args:
        log: what `read_playable` has read.
        server: where viewers connect; the channels have been announced.
        rate: multiple of real time.
        loops: begin again at the end.
        is_ended: whether to end.
    """
    count = 0
    first_ns = log.messages[0][0]
    while True:
        start_s = time.monotonic()
        again_s = start_s + _AGAIN_S
        latched: dict[str, bytes] = {}
        for instant, topic, data in log.messages:
            due_s = start_s + (instant - first_ns) / 1e9 / rate
            while (left_s := due_s - time.monotonic()) > 0:
                if is_ended():
                    return count
                if time.monotonic() >= again_s:  # for viewers that come later
                    again_s += _AGAIN_S
                    for name, shape in latched.items():
                        server.send(name, shape, instant)
                time.sleep(min(left_s, _MOST_WAIT_S))
            if topic in _LATCHED:
                latched[topic] = data
            server.send(topic, data, instant)
            count += 1
        if not loops:
            return count


def read_playable(log: Path) -> Playable:
    """Read an MCAP file.

    Raises:
        PalmbotsError: the file cannot be read, is no MCAP log, or has no messages.
    """
    refuse_other_kind(log, LOG)
    schemas: dict[int, tuple[str, str, bytes]] = {}
    topics: dict[int, str] = {}
    found = Playable([], [])
    try:
        with log.open("rb") as stream:
            for record in StreamReader(stream).records:
                if isinstance(record, Schema):
                    schemas[record.id] = (record.name, record.encoding, record.data)
                elif isinstance(record, Channel) and record.id not in topics:
                    topics[record.id] = record.topic
                    schema = schemas[record.schema_id]
                    found.channels.append((record.topic, record.message_encoding, schema))
                elif isinstance(record, Message):
                    topic = topics[record.channel_id]
                    found.messages.append((record.log_time, topic, record.data))
    except OSError as error:
        raise PalmbotsError(f"{log}: cannot be read: {error.strerror or error}") from None
    except Exception:  # what a foreign or damaged file holds may raise anything
        raise PalmbotsError(f"{log}: is no MCAP log, or is damaged") from None
    if not found.messages:
        raise PalmbotsError(f"{log}: has no messages")
    found.messages.sort(key=lambda message: message[0])
    return found
