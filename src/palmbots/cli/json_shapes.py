# SPDX-License-Identifier: Apache-2.0
"""What `--json` prints, command by command; `json_schemas` turns this into JSON Schemas.

A table lists its keys. All are there, except those that end in ``?``; there are no others, unless
the key ``*`` says what any further key holds. A list has the shape of its items, a tuple lists
alternatives. Words are ``text``, ``number``, ``whole``, ``boolean``, ``pair`` (two numbers),
``scene`` and ``any``; with ``?`` the value may be null.
"""

from typing import Any

_SIDE = ["left", "right"]


def sides(shape: Any) -> dict[str, Any]:
    """A table with the same shape for each robot."""
    return dict.fromkeys(_SIDE, shape)


_STATISTICS = (
    "drop_rate", "stall_rate", "drop_rate_difference", "mean_time_s", "rms_m", "square_difference",
    "mean_peak_m", "mean_waiting_s", "mean_corrections", "mean_messages",
)  # fmt: skip
_CELL = {"at": {"*": "any"}, "controller": "text", "carries": "whole"} | {
    f"{name}{end}?": shape
    for name in _STATISTICS
    for end, shape in (("", "number?"), ("_interval", ["number?"]))
}
_NAMES = [{"name": "text", "meaning": "text"}]

JSON_SHAPES: dict[str, Any] = {
    "study": (
        {
            "carries": "whole",
            "drop_rate": "number?",
            "interval": "pair?",
            "stall_rate": "number?",
            "output": "text",
            "hash": "text",
            "identity": "text",
            "resumed": "whole",
            "lost_workers": ["text"],
            "seconds": "number",
            "cells": [_CELL],
            "sensitivity": [
                {
                    "controller": "text",
                    "metric": "text",
                    "key": "text",
                    "first": "number?",
                    "first_half": "number?",
                    "total": "number?",
                    "total_half": "number?",
                }
            ],
            "refused": [{"at": {"*": "any"}, "controller": "text", "why": "text"}],
            "study": "text",
            "scene": "scene",
        },
        {
            "points": "whole",
            "cells": "whole",
            "carries": "whole",
            "chunks": "whole",
            "carries_a_chunk": "whole",
            "seconds": "number",
            "threads": "whole",
            "ms_a_carry": {"*": "number"},
            "disk_bytes": "whole",
            "memory_bytes": "whole",
            "study": "text",
            "scene": "scene",
        },
    ),
    "export": {"mjcf": "text?", "urdf": "text?", "scene": "scene"},
    "scenes": {"scenes": _NAMES},
    "objects": {"objects": _NAMES},
    "controllers": {
        "controllers": [
            {
                "name": "text",
                "meaning": "text",
                "messages": ["text"],
                "requirements": ["text"],
                "sigma_star_m_s": "number?",
                "sigma_star_interval": "pair?",
                "sigma_star_command": "text?",
            }
        ]
    },
    "keys": {"keys": [{"name": "text", "default": "any", "unit": "text", "meaning": "text"}]},
    "init": ({"file": "text", "scene": "scene"}, {"files": ["text"]}),
    "schema": {"$schema": "text", "*": "any"},
}
