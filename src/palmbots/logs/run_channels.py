# SPDX-License-Identifier: Apache-2.0
"""The channels of the logs of real runs: what one program of a pair saw, said and decided.

A robot logs every tick on ``/left/ticks`` or ``/right/ticks``. The station logs the packets that it
sent and received, and the lines that it showed. Times of a log are those of the program's own
monotonic clock, from its start.
"""

from typing import Any

from palmbots.logs.message_types import FIELD, message_type

RUN_RECORD = "palmbots-run"
"""Name of the metadata record."""
RUN_FORMAT = "1"
"""Version of the format of these logs."""

_BOOL, _BYTES, _STRING = FIELD.TYPE_BOOL, FIELD.TYPE_BYTES, FIELD.TYPE_STRING
_INT, _COUNT = FIELD.TYPE_SINT64, FIELD.TYPE_UINT64

RobotTick: Any = message_type(
    "RobotTick",
    {
        "number": _COUNT,
        "elapsed": _COUNT,
        # What the robot read: the arguments of the core's Reading.
        "sign": _INT,
        "palm_at_target": _BOOL,
        "contact": _BOOL,
        "battery_ok": _BOOL,
        "driver_ok": _BOOL,
        "storage_ok": _BOOL,
        "covered": _BOOL,
        "stop": _BOOL,
        "overruns": _COUNT,
        "battery_mv": _COUNT,
        "progress": _COUNT,
        "stopping": _COUNT,
        "arm_there": _BOOL,
        "arm_steps": _COUNT,
        "beneath": _BOOL,
        "received": _BYTES,
        # What it decided.
        "palm": _COUNT,
        "move": _COUNT,
        "rests": _BOOL,
        "wheels": _BOOL,
        "case": _STRING,
        "assists": _BOOL,
        "phase": _STRING,
        "mode": _STRING,
        "fault": _STRING,
        "sent": _BYTES,
        "receivers": _COUNT,
        "words": _COUNT,
        # Who did not get its packet: what it promises was not stored yet.
        "withheld": _COUNT,
    },
    repeated=("received", "sent", "receivers", "words", "withheld"),
)
"""One tick of a robot. Packets have the tag of the log's own key, not that of the pair's."""

PacketEvent: Any = message_type(
    "PacketEvent",
    {"receiver": _STRING, "epoch": _COUNT, "sequence": _COUNT, "content": _STRING},
)
"""A packet that the station sent."""

StatusEvent: Any = message_type(
    "StatusEvent",
    {
        "sender": _STRING,
        "epoch": _COUNT,
        "sequence": _COUNT,
        "acknowledged_epoch": _COUNT,
        "acknowledged_sequence": _COUNT,
        "mode": _STRING,
        "fault": _STRING,
        "sign": _INT,
        "palm": _STRING,
        "palm_at_target": _BOOL,
        "case": _STRING,
        "item": _STRING,
        "value": _COUNT,
        "at_rest": _BOOL,
        "stop": _BOOL,
    },
)
"""A status of a robot that the station received."""

LineEvent: Any = message_type("LineEvent", {"text": _STRING})
"""A line that the station showed."""
