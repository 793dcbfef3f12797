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


_LINK = dict.fromkeys(("sent", "delivered", "lost", "duplicated", "expired", "rejected"), "whole")
_CORRECTION = {
    "label": "text", "robot": "text", "case": "text", "assistant": "text?", "start_s": "number",
    "end_s": "number",
}  # fmt: skip
_DRIFT = {
    "budget_m": "number", "mean_m": "number", "most_m": "number", "seeds": "whole",
    "askew_deg": "number", "lips": "boolean", "lip_room_m": "number?", "verdict": "text",
}  # fmt: skip
_BOUNDS = {
    "beacon_s": "number", "delay_s": "number", "shortest_lease_s": "number", "lease_s": "number",
    "longest_lease_s": "number", "losses": "whole", "hold_s": "number", "alone_s": "number",
    "skew_m": "number", "noise_m": "number", "room_m": "number", "is_noisy": "boolean",
}  # fmt: skip
CARRY = {
    "outcome": "text",
    "reason": "text?",
    "rest_angle_deg": "number",
    "time_s": "number",
    "distance_m": "number",
    "contact_rms_m": sides("number"),
    "contact_peak_m": sides("number"),
    "corrections": [_CORRECTION],
    "correction_count": "whole",
    "contact_events": [{"robot": "text", "kind": "text", "start_s": "number", "end_s": "number"}],
    "messages": "whole",
    "messages_lost": "whole",
    "links": {"*": _LINK},
    "bounds": (_BOUNDS, None),
    "waiting_s": sides("number"),
    "bump_count": "whole",
    "warnings": ["text"],
    "trace_hash": "text",
    "lateral_peak_m": "number?",
    "controller": "text",
    "controller_source": ({"reference": "text?", "sha256": "text?"}, None),
    "world": "text",
    "precision": "text",
    "seed": "whole",
    "forks": ["pair"],
    "version": "text",
    "scene": "scene",
    "drift_forecast": (_DRIFT, None),
}
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
    "carry": CARRY,
    "drop-rate": {
        "drop_rate": "number",
        "interval": "pair",
        "levels": ["number"],
        "conditional_probabilities": ["number"],
        "replicates": "whole",
        "pilot_replicates": "whole",
        "effort": "whole",
        "equivalent_carries": "number",
        "controller": "text",
        "seed": "whole",
        "scene": "scene",
    },
    "noise-limit": {
        "sigma_star_m_s": "number",
        "interval": "pair",
        "rate": "number",
        "slope": "number",
        "carries": "whole",
        "pilot_carries": "whole",
        "points": [
            {"noise_m_s": "number", "carries": "whole", "drops": "whole", "counts": "boolean"}
        ],
        "controller": "text",
        "seed": "whole",
        "scene": "scene",
    },
    "bound": {
        "sigma_star_m_s": "number",
        "grid_error": "number",
        "drop_rate": "number",
        "rate": "number",
        "speeds": "text",
        "time_s": "number",
        "law_m_s": "number",
        "opening_speed_m_s": "number",
        "usable_m": "number",
        "front": [{"*": "number"}],
        "noise_m_s": "number",
        "scene": "scene",
    },
    "compare": {
        "rows": [
            {
                "controller": "text",
                "key": "text",
                "value": "any",
                "n": "whole",
                "drop_rate": "number",
                "interval": "pair",
                "stall_rate": "number",
                "stall_interval": "pair",
                "rms_m": "number",
                "rms_interval_m": ["number?"],
                "messages_per_m": "number?",
                "messages_interval_per_m": ["number?"],
                "bytes_per_s": "number?",
                "corrections": "number",
            }
        ],
        "refused": ["text"],
        "key": "text",
        "seed": "whole",
        "scene": "scene",
    },
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
    "replay": (
        {
            "identical": "boolean",
            "samples": "whole",
            "difference": "text?",
            "trace_hash": "text",
            "logged_hash": "text",
            "controller": "text",
            "seed": "whole",
            "precision": "text",
            "version": "text",
            "scene": "scene",
        },
        {
            "identical": "boolean",
            "logs": [
                {
                    "file": "text",
                    "end": "text",
                    "boots": "whole",
                    "is_cut": "boolean",
                    "ticks": "whole",
                    "verified": "whole",
                    "difference": "text?",
                }
            ],
            "clocks": [
                {
                    "file": "text",
                    "offset_s": "number?",
                    "rate": "number",
                    "uncertainty_s": "number",
                    "packets": "whole",
                }
            ],
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
