# SPDX-License-Identifier: Apache-2.0
"""What `--json` prints of robots and of MuJoCo; `json_shapes` explains the notation."""

from typing import Any

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

ROBOT_SHAPES: dict[str, Any] = {
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
