"""Carry logs: one MCAP file with everything that was seen of a carry, and proof that it replays.

Channels: `/left` and `/right` (robot states) and `/pair` at every tick, `/messages` and
`/corrections` as events, all with types of their own (`log_schema`); `/tf`, `/solids` and
`/contacts` for three-dimensional viewers, and `/robot_description` for those that want URDF
(`log_scene`). The metadata record `palmbots` holds scene, controller, seed, precision, version,
outcome and trace hash. Log time is simulated time.

Checksums cover every byte of the file, and reading checks them first: a log that was cut short or
changed is refused, by one line.
"""

import io
import json
import math
import os
import struct
import zlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from mcap.records import Channel, Message, Metadata
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer
from mcap_protobuf.schema import register_schema

from palmbots import log_scene
from palmbots.bounds import Bounds
from palmbots.dynamic.columns import COLUMNS, LOGGED
from palmbots.errors import PalmbotsError
from palmbots.files import whole_file
from palmbots.geometry import SIDES, place_rows
from palmbots.log_schema import CorrectionEvent, LetterEvent, PairState, RobotDynamics, RobotState
from palmbots.lowering import lower
from palmbots.result import Carry, Correction, Letter, LinkCounts, Touch
from palmbots.result import trace_dataset as trace_dataset
from palmbots.solids import contact_balls, solids, urdf

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Log", "read_log", "write_log"]

_RECORD = "palmbots"  # the name of the metadata record
_FORMAT = "2"
_SCENE_INTERVAL_S = 0.04  # between two pictures of the three-dimensional scene

# Facts of a carry that are no time series: as they are, and as JSON (which keeps every bit too).
_TEXTS = ("controller", "world", "precision", "version", "outcome", "trace_hash")
_VALUES = (
    "seed", "reason", "time_s", "distance_m", "contact_rms_m", "contact_peak_m", "messages",
    "messages_lost", "waiting_s", "bumps", "warnings", "links", "bounds", "across_peak_m",
    "correction_count",
)  # fmt: skip

# Variable of the trace, field of the message.
_ROBOT_FIELDS = (
    ("contact", "contact_m"),
    ("lift", "lift_m"),
    ("palm", "palm_rad"),
    ("speed", "speed_m_s"),
    ("commanded", "commanded_m_s"),
    ("sign", "sign"),
    ("motion", "motion"),
    ("case", "case"),
)
_PAIR_FIELDS = (
    ("time", "time_s"),
    ("separation", "separation_m"),
    ("midpoint", "midpoint_m"),
    ("object", "object_rad"),
)


@dataclass(frozen=True)
class Log:
    """What a log tells of a carry; the same names, types and units as in `palmbots.result.Carry`,
    but `scene` is a table (which `load_scene` takes)."""

    scene: dict[str, Any]
    controller: str
    world: str
    precision: str
    seed: int
    version: str
    outcome: str
    reason: str | None
    time_s: float
    distance_m: float
    contact_rms_m: dict[str, float]
    contact_peak_m: dict[str, float]
    corrections: tuple[Correction, ...]
    correction_count: int
    touches: tuple[Touch, ...]
    messages: int
    messages_lost: int
    links: dict[str, LinkCounts]
    bounds: Bounds | None
    waiting_s: dict[str, float]
    bumps: int
    warnings: tuple[str, ...]
    trace_hash: str
    trace: "xr.Dataset"
    letters: tuple[Letter, ...]
    across_peak_m: dict[str, float] | None


# --- writing ----------------------------------------------------------------------------------


def write_log(carry: Carry, path: str | os.PathLike[str]) -> None:
    """Write a carry to `path` as MCAP; the file appears whole or not at all.

    Raises `PalmbotsError` for a carry without trace or an unwritable path.
    """
    if carry.trace is None:
        raise PalmbotsError("log: this carry has no trace; run it with record=True")
    with whole_file(path) as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD, enable_data_crcs=True)
        writer.start(profile="", library=f"palmbots {carry.version}")
        writer.add_metadata(_RECORD, _facts(carry, carry.trace.sizes["time"]))
        _Channels(writer).write(carry, carry.trace)
        writer.finish()


def _facts(carry: Carry, samples: int) -> dict[str, str]:
    """All that is no time series, as text."""
    values = {"scene": carry.scene.model_dump(mode="json"), "samples": samples}
    values |= {name: carry.summary()[name] for name in _VALUES}
    values["touches"] = [asdict(touch) for touch in carry.touches]
    return (
        {"format": _FORMAT}
        | {name: getattr(carry, name) for name in _TEXTS}
        | {name: json.dumps(value) for name, value in values.items()}
    )


class _Channels:
    """The channels of one log that is being written."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}

    def _put(self, topic: str, message: Any, nanoseconds: int) -> None:
        channel = self._channels.get(topic)
        if channel is None:
            kind = type(message).DESCRIPTOR.full_name
            if kind not in self._schemas:
                self._schemas[kind] = register_schema(self._writer, type(message))
            channel = self._writer.register_channel(topic, "protobuf", self._schemas[kind])
            self._channels[topic] = channel
        data = message.SerializeToString()
        self._writer.add_message(channel, nanoseconds, data, nanoseconds)

    def _put_description(self, text: str, nanoseconds: int) -> None:
        schema = self._writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        channel = self._writer.register_channel("/robot_description", "cdr", schema)
        self._writer.add_message(channel, nanoseconds, log_scene.ros_string(text), nanoseconds)

    def write(self, carry: Carry, trace: "xr.Dataset") -> None:
        """Everything in the order of time."""
        spec = lower(carry.scene, unrolled=True)
        instants = [round(time * 1e9) for time in trace["time"].to_numpy().tolist()]

        parts = solids(carry.scene, spec)
        self._put_description(urdf([*parts, *contact_balls()]), instants[0])
        self._put("/solids", log_scene.scene_update(parts), instants[0])

        ordered = trace.transpose("time", "side")
        robots = [ordered[name].to_numpy().tolist() for name, _ in _ROBOT_FIELDS]
        pair = [ordered[name].to_numpy().tolist() for name, _ in _PAIR_FIELDS]
        dynamics = [ordered[n].to_numpy().tolist() for n, _ in LOGGED if n in ordered]
        motions = ordered["motion"].to_numpy().tolist()
        step = max(1, round(_SCENE_INTERVAL_S / spec.period))
        shown = sorted({*range(0, len(instants), step), len(instants) - 1})
        place = place_rows(spec, trace, np.array(shown))
        picture = {row: k for k, row in enumerate(shown)}
        events = self._events(carry)

        for row, instant in enumerate(instants):
            while events and events[-1][0] <= instant:
                self._put(*events.pop()[1:], instant)
            for k, side in enumerate(SIDES):
                columns = zip(_ROBOT_FIELDS, robots, strict=True)
                state = RobotState(**{field: column[row][k] for (_, field), column in columns})
                self._put(f"/{side}", state, instant)
                if dynamics:
                    columns = zip(LOGGED, dynamics, strict=True)
                    state = RobotDynamics(
                        **{field: column[row][k] for (_, field), column in columns}
                    )
                    self._put(f"/{side}/dynamics", state, instant)
            columns = zip(_PAIR_FIELDS, pair, strict=True)
            state = PairState(**{field: column[row] for (_, field), column in columns})
            self._put("/pair", state, instant)
            if row in picture:
                self._put("/tf", log_scene.transforms(place, picture[row], instant), instant)
                update = log_scene.contact_update(tuple(motions[row]), instant)
                self._put("/contacts", update, instant)
        for event in reversed(events):
            self._put(*event[1:], instants[-1])

    def _events(self, carry: Carry) -> list[tuple[int, str, Any]]:
        """Messages and corrections, the latest first; within a channel their order is kept."""
        events: list[tuple[int, str, Any]] = []
        for letter in carry.letters:
            event = LetterEvent(
                sent_s=letter.sent_s,
                received_s=math.nan if letter.received_s is None else letter.received_s,
                sender=letter.sender,
                receiver=letter.receiver,
                letter=letter.letter,
            )
            events.append((round(letter.sent_s * 1e9), "/messages", event))
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


# --- reading ----------------------------------------------------------------------------------

_MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _DATA_END = struct.Struct("<BQQQI"), struct.Struct("<BQI")


def read_log(path: str | os.PathLike[str]) -> Log:
    """Read a carry log.

    Raises `PalmbotsError` with one line for a file that cannot be read, is no MCAP file, was cut
    short or changed, or is no carry log.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise PalmbotsError(f"{path}: cannot be read: {error.strerror or error}") from None
    problem = _damage(data)
    if problem is not None:
        raise PalmbotsError(f"{path}: {problem}")
    try:
        return _parse(data)
    except PalmbotsError as error:
        raise PalmbotsError(f"{path}: {error}") from None
    except Exception as error:
        # The bytes are what somebody wrote, but nothing says who: whatever a foreign file makes the
        # parsers raise, to the user it is one thing.
        raise PalmbotsError(f"{path}: not a carry log of palmbots: {_brief(error)}") from None


def _brief(error: Exception) -> str:
    text = str(error).strip()
    return text.splitlines()[0][:120] if text else type(error).__name__


def _damage(data: bytes) -> str | None:
    """What is wrong with the file as a file, or None: frame and checksums of all its bytes."""
    if data[: len(_MAGIC)] != _MAGIC:
        return "not an MCAP log, as palmbots carry --out writes it" if data else "the file is empty"
    end = len(data) - len(_MAGIC)
    footer_at = end - _FOOTER.size
    if data[end:] != _MAGIC or footer_at < len(_MAGIC) + _DATA_END.size:
        return "the log is cut short or damaged at its end"
    opcode, size, summary_at, _, summary_crc = _FOOTER.unpack_from(data, footer_at)
    data_end_at = summary_at - _DATA_END.size
    if (opcode, size) != (0x02, 20) or not len(_MAGIC) <= data_end_at < footer_at:
        return "the log is damaged at its end, or was not written by palmbots"
    if summary_crc == 0:  # by the format: left out
        return "the file was not written by palmbots: it has no checksums"
    if zlib.crc32(data[summary_at : end - 4]) != summary_crc:
        return "the log is damaged: the checksum of its summary is wrong"
    opcode, size, data_crc = _DATA_END.unpack_from(data, data_end_at)
    if (opcode, size) != (0x0F, 4) or zlib.crc32(data[:data_end_at]) != data_crc:
        return "the log is damaged: the checksum of its data is wrong"
    return None


def _parse(data: bytes) -> Log:
    facts: dict[str, str] | None = None
    topics: dict[int, str] = {}
    messages: dict[str, list[bytes]] = {}
    for record in StreamReader(io.BytesIO(data)).records:
        if isinstance(record, Message):
            messages.setdefault(topics[record.channel_id], []).append(record.data)
        elif isinstance(record, Channel):
            topics[record.id] = record.topic
        elif isinstance(record, Metadata) and record.name == _RECORD:
            facts = record.metadata
    if facts is None:
        raise PalmbotsError("not a carry log of palmbots: it has no metadata record of that name")
    if facts["format"] != _FORMAT:
        raise PalmbotsError(
            f"a carry log of format {facts['format']}; this version reads {_FORMAT}"
        )
    samples = json.loads(facts["samples"])
    counts = {topic: len(messages.get(topic, [])) for topic in ("/left", "/right", "/pair")}
    if set(counts.values()) != {samples}:
        raise PalmbotsError(f"the log lacks samples: it has {counts} of {samples}")
    return _assemble(facts, messages)


def _assemble(facts: dict[str, str], messages: dict[str, list[bytes]]) -> Log:
    robots = [[RobotState.FromString(m) for m in messages[f"/{side}"]] for side in SIDES]
    pair = [PairState.FromString(m) for m in messages["/pair"]]
    trace = {
        field: np.array([[getattr(state, field) for state in states] for states in robots]).T
        for _, field in _ROBOT_FIELDS
    }
    for name in ("sign", "motion"):
        trace[name] = trace[name].astype(np.int8)
    trace["case"] = np.ascontiguousarray(trace["case"].astype("S1")).view(np.uint8)
    for _, field in _PAIR_FIELDS:
        trace[field] = np.array([getattr(state, field) for state in pair])
    dynamics = [
        [RobotDynamics.FromString(m) for m in messages.get(f"/{side}/dynamics", [])]
        for side in SIDES
    ]
    if any(len(states) not in (0, len(pair)) for states in dynamics):
        raise PalmbotsError("the log lacks samples of the dynamic world")
    more = {
        name: (
            np.array([[getattr(s, field) for s in states] for states in dynamics]).T,
            *COLUMNS[name],
        )
        for name, field in LOGGED
        if all(dynamics)
    }
    letters = [LetterEvent.FromString(m) for m in messages.get("/messages", [])]
    corrections = [CorrectionEvent.FromString(m) for m in messages.get("/corrections", [])]
    told: dict[str, Any] = {name: facts[name] for name in _TEXTS}
    # Older logs say nothing of what is across, nor how many corrections they do not list.
    told |= {name: json.loads(facts.get(name, "null")) for name in ("scene", *_VALUES)}
    if told["correction_count"] is None:
        told["correction_count"] = len(corrections)
    told["touches"] = tuple(Touch(**touch) for touch in json.loads(facts["touches"]))
    told["warnings"] = tuple(told["warnings"])
    told["links"] = {name: LinkCounts(**counts) for name, counts in told["links"].items()}
    told["bounds"] = None if told["bounds"] is None else Bounds(**told["bounds"])
    return Log(
        **told,
        trace=trace_dataset(trace, more),
        corrections=tuple(
            Correction(c.label, c.robot, c.case, c.assistant or None, c.start_s, c.end_s)
            for c in corrections
        ),
        letters=tuple(
            Letter(
                m.sent_s,
                None if math.isnan(m.received_s) else m.received_s,
                m.sender,
                m.receiver,
                m.letter,
            )
            for m in letters
        ),
    )
