# SPDX-License-Identifier: Apache-2.0
"""Writes carry logs: one MCAP file with everything that was recorded of a carry.

Channels: `channels` lists the states at every tick and the events. For three-dimensional viewers
there are ``/tf``, ``/solids`` and ``/contacts``, and ``/robot_description`` for those that read
URDF (`scene_updates`). The metadata record ``palmbots`` holds scene, controller, seed, precision,
version, outcome and trace hash. Log time is simulated time. Checksums cover every byte.
"""

import json
import math
import os
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from mcap.writer import CompressionType, Writer
from mcap_protobuf.schema import register_schema

from palmbots._util.atomic_files import whole_file
from palmbots.errors import PalmbotsError
from palmbots.logs import scene_updates
from palmbots.logs.channels import CorrectionEvent, MessageEvent, state_channels, variables_of
from palmbots.logs.robot_description import urdf
from palmbots.scene.placement import placements
from palmbots.scene.spec import to_spec
from palmbots.simulation.result import Carry
from palmbots.viz.solids import contact_balls, solids

if TYPE_CHECKING:
    import xarray as xr

RECORD = "palmbots"
"""Name of the metadata record."""
FORMAT = "4"
"""Version of the format of the log."""

# What JSON has of a carry, except its scene and what has a channel of its own: some as text, the
# others as JSON, which is exact too.
TEXT_FACTS = ("controller", "world", "precision", "version", "outcome", "trace_hash")
JSON_FACTS = tuple(
    one.name
    for one in fields(Carry)
    if one.metadata.get("json", True) and one.name not in (*TEXT_FACTS, "scene", "corrections")
)

_SCENE_INTERVAL_S = 0.04  # between two poses for the three-dimensional viewers


def write_log(carry: Carry, path: str | os.PathLike[str]) -> None:
    """Write a carry to `path` as MCAP. The file appears only when it is complete.

    Raises:
        PalmbotsError: the carry has no trace, or the path cannot be written.
    """
    if carry.trace is None:
        raise PalmbotsError("log: this carry has no trace; run it with record=True")
    with whole_file(path) as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD, enable_data_crcs=True)
        writer.start(profile="", library=f"palmbots {carry.version}")
        writer.add_metadata(RECORD, _facts(carry, carry.trace))
        _LogWriter(writer).write(carry, carry.trace)
        writer.finish()


def _facts(carry: Carry, trace: "xr.Dataset") -> dict[str, str]:
    """Everything that is no time series, as text."""
    summary = carry.summary()
    values: dict[str, Any] = {name: summary[name] for name in JSON_FACTS}
    values["scene"] = carry.scene.model_dump(mode="json")
    values["samples"] = trace.sizes["time"]
    values["variables"] = [asdict(variable) for variable in variables_of(trace)]
    return (
        {"format": FORMAT}
        | {name: getattr(carry, name) for name in TEXT_FACTS}
        | {name: json.dumps(value) for name, value in values.items()}
    )


class _LogWriter:
    """Writes the channels of one log."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}

    def write(self, carry: Carry, trace: "xr.Dataset") -> None:
        """Write all messages in the order of time."""
        spec = to_spec(carry.scene, unrolled=True)
        instants = [round(time * 1e9) for time in trace["time"].to_numpy().tolist()]

        parts = solids(carry.scene, spec)
        self._add_description(urdf([*parts, *contact_balls()]), instants[0])
        self._add("/solids", scene_updates.scene_update(parts), instants[0])

        states = {
            topic: messages
            for channel in state_channels(variables_of(trace))
            for topic, messages in zip(channel.topics, channel.messages(trace), strict=True)
        }
        motions = trace["motion"].transpose("time", "side").to_numpy().tolist()
        step = max(1, round(_SCENE_INTERVAL_S / spec.period))
        shown = sorted({*range(0, len(instants), step), len(instants) - 1})
        place = placements(spec, trace, np.array(shown))
        place_of = {row: k for k, row in enumerate(shown)}
        events = _events(carry)

        for row, instant in enumerate(instants):
            while events and events[-1][0] <= instant:
                self._add(*events.pop()[1:], instant)
            for topic, messages in states.items():
                self._add(topic, messages[row], instant)
            if row in place_of:
                transforms = scene_updates.transforms(place, place_of[row], instant)
                self._add("/tf", transforms, instant)
                update = scene_updates.contact_update(tuple(motions[row]), instant)
                self._add("/contacts", update, instant)
        for event in reversed(events):
            self._add(*event[1:], instants[-1])

    def _add(self, topic: str, message: Any, nanoseconds: int) -> None:
        channel = self._channels.get(topic)
        if channel is None:
            kind = type(message).DESCRIPTOR.full_name
            if kind not in self._schemas:
                self._schemas[kind] = register_schema(self._writer, type(message))
            channel = self._writer.register_channel(topic, "protobuf", self._schemas[kind])
            self._channels[topic] = channel
        data = message.SerializeToString()
        self._writer.add_message(channel, nanoseconds, data, nanoseconds)

    def _add_description(self, text: str, nanoseconds: int) -> None:
        """The robot description as a ROS 2 string, because Rerun reads it in no other encoding."""
        schema = self._writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        channel = self._writer.register_channel("/robot_description", "cdr", schema)
        self._writer.add_message(channel, nanoseconds, scene_updates.ros_string(text), nanoseconds)


def _events(carry: Carry) -> list[tuple[int, str, Any]]:
    """Messages and corrections: time in nanoseconds, topic, message; the latest first.

    Within a channel their order is kept.
    """
    events: list[tuple[int, str, Any]] = []
    for message in carry.message_log:
        event = MessageEvent(
            sent_s=message.sent_s,
            received_s=math.nan if message.received_s is None else message.received_s,
            sender=message.sender,
            receiver=message.receiver,
            kind=message.kind,
        )
        events.append((round(message.sent_s * 1e9), "/messages", event))
    for c in carry.corrections:
        event = CorrectionEvent(
            label=c.label,
            robot=c.robot,
            case=c.case,
            assistant=c.assistant or "",
            start_s=c.start_s,
            end_s=c.end_s,
        )
        events.append((round(c.start_s * 1e9), "/corrections", event))
    events.sort(key=lambda event: event[0])
    return events[::-1]
