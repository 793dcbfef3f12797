# SPDX-License-Identifier: Apache-2.0
"""What `--json` prints of robots and of MuJoCo; `json_shapes` explains the notation."""

from typing import Any

from palmbots.cli.json_shapes import CARRY

_LIVE_CARRY = {
    "outcome": "text", "distance_m": "number", "time_s": "number", "overruns": "whole",
    "avoidable": "boolean?",
}  # fmt: skip
_END_COUNTS = {
    "sent": "whole", "received": "whole", "lost": "whole?", "copies": "whole", "overtaken": "whole",
    "round_trip_median_s": "number?", "round_trip_p99_s": "number?",
    "round_trip_longest_s": "number?",
}  # fmt: skip
_METER = {
    "left?": _END_COUNTS, "right?": _END_COUNTS, "station?": _END_COUNTS, "details?": {"*": "any"},
}  # fmt: skip
_CHECKS = [
    {"about": "text", "robot": "text", "is_well": "boolean", "text": "text", "remedy": "text"}
]
_TRIAL = {
    "engine": "text", "state": {"*": "any"}, "closing": "boolean", "expected": "text",
    "seen": "text", "decisive": "boolean", "slid_m": "pair", "cause": "text?",
}  # fmt: skip

ROBOT_SHAPES: dict[str, Any] = {
    "validate": {
        "holds": "boolean",
        "agreement": [
            {
                "engine": "text",
                "n": "whole",
                "rate": "number",
                "decisive_n": "whole",
                "decisive_rate": "number",
                "decisive_interval": "pair",
            }
        ],
        "differences": [_TRIAL],
        "switch_lines": [
            {"right_m": "number", "closing": "boolean", "known_m": "number?", "seen_m": "number?"}
        ],
        "tilts": [{"left_m": "number", "known_m": "pair", "seen_m": "pair"}],
        "carries": [
            {
                "seed": "whole",
                "outcome": ["text"],
                "rms_m": "pair",
                "peak_m": "pair",
                "corrections": "pair",
            }
        ],
        "delivery": {
            "n": "whole",
            "delivered": "whole",
            "interval": "pair",
            "known_n": "whole",
            "known": "number",
        },
        "creep_m": "pair",
        "controller": "text",
        "missing": ["text"],
        "scene": "scene",
    },
    "speed-limits": {
        "limits": [
            {
                "friction": "number",
                "closing": "boolean",
                "forward": "boolean",
                "slides": "text",
                "known": "number?",
                "seen": "number?",
            }
        ],
        "paces": [
            {
                "speed_m_s": "number",
                "n": "whole",
                "delivered": "pair",
                "rms_m": "pair",
                "peak_m": "pair",
            }
        ],
        "max_acceleration_m_s2": "number?",
        "scene": "scene",
    },
    "up": (CARRY, _LIVE_CARRY),
    "world": (CARRY, _LIVE_CARRY),
    "robot": {
        "side": "text",
        "boots": "whole",
        "mode": "text",
        "fault": "text",
        "ticks": "whole",
        "overruns": "whole",
        "jitter": {"*": "whole"},
        "link": _METER,
        "verdicts": {"*": "whole"},
    },
    "station": {
        "done": "boolean",
        "modes": {"*": "text"},
        "lines": ["text"],
        "links": {"*": "any"},
    },
    "doctor": (
        {
            "well": "boolean",
            "controller": "text",
            "links": {
                "*": {
                    "received": "whole",
                    "lost": "whole",
                    "mode": "text?",
                    "fault": "text?",
                    "loss": "number",
                    "round_trip_median_s": "number?",
                    "round_trip_p99_s": "number?",
                    "round_trip_longest_s": "number?",
                }
            },
            "needs": (
                {
                    "delay_s": "number",
                    "loss": "number",
                    "lease_s": "number",
                    "verdicts": {"*": "text"},
                },
                None,
            ),
            "checks": _CHECKS,
        },
        {"well": "boolean", "checks": _CHECKS},
    ),
    "calibrate": {
        "side": "text",
        "file": "text",
        "backup": "text",
        "hardware": {"*": "any"},
        "intervals": {"*": "pair"},
        "warnings": ["text"],
    },
    "ros2": {"side": "text", "published": {"*": "whole"}},
    "view": {"written": ["text"]},
    "firmware": {"files": ["text"]},
    "flash": {"file": "text"},
}
