# SPDX-License-Identifier: Apache-2.0
"""What `--json` prints, command by command; `json_schemas` turns this into JSON Schemas.

A table lists its keys. All are there, except those that end in ``?``; there are no others, unless
the key ``*`` says what any further key holds. A list has the shape of its items, a tuple lists
alternatives. Words are ``text``, ``number``, ``whole``, ``boolean``, ``pair`` (two numbers),
``scene`` and ``any``; with ``?`` the value may be null.
"""

from typing import Any

__all__ = ["JSON_SHAPES"]

_SIDE = ["left", "right"]


def _sides(shape: Any) -> dict[str, Any]:
    return dict.fromkeys(_SIDE, shape)


_CLAIMED_SIDES = _sides(["text"])
_BOX = {
    "com_m": [["text"]],
    "width_m": ["text"],
    "friction": {"left": ["text"], "right": ["text"], "common": "boolean"},
    "shallow_deg": _CLAIMED_SIDES,
    "steep_deg": _CLAIMED_SIDES,
    "contacts_m": _CLAIMED_SIDES,
    "beyond_m": "text",
    "half_length_m": _CLAIMED_SIDES,
    "offset_m": _CLAIMED_SIDES,
    "slope": ["text"],
    "outline_m": [["text"]],
    "right_contact": "whole",
}
_CERTIFICATE = {
    "format": "text",
    "claims": ["text"],
    "scene": "scene",
    "box": _BOX,
    "verdict": "text",
    "proof?": {"*": "any"},
    "witness?": {"*": "any"},
}
_LINK = dict.fromkeys(("sent", "delivered", "lost", "duplicated", "expired", "rejected"), "whole")
_CONTACT = {"side": "text", "kind": "text", "place_m": "number", "point_m": "pair"}
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
_CARRY = {
    "outcome": "text",
    "reason": "text?",
    "rest_angle_deg": "number",
    "time_s": "number",
    "distance_m": "number",
    "contact_rms_m": _sides("number"),
    "contact_peak_m": _sides("number"),
    "corrections": [_CORRECTION],
    "correction_count": "whole",
    "contact_events": [{"robot": "text", "kind": "text", "start_s": "number", "end_s": "number"}],
    "messages": "whole",
    "messages_lost": "whole",
    "links": {"*": _LINK},
    "bounds": (_BOUNDS, None),
    "waiting_s": _sides("number"),
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
_LIVE_CARRY = {
    "outcome": "text", "distance_m": "number", "time_s": "number", "overruns": "whole",
    "avoidable": "boolean?",
}  # fmt: skip
_END_COUNTS = {
    "sent": "whole", "received": "whole", "lost": "whole", "copies": "whole", "overtaken": "whole",
    "round_trip_median_s": "number?", "round_trip_p99_s": "number?",
    "round_trip_longest_s": "number?",
}  # fmt: skip
_METER = {
    "left?": _END_COUNTS, "right?": _END_COUNTS, "station?": _END_COUNTS, "details?": {"*": "any"},
}  # fmt: skip
_CHECKS = [
    {"about": "text", "robot": "text", "is_well": "boolean", "text": "text", "remedy": "text"}
]
_PROPERTY = _sides(
    {
        "holds": "boolean",
        "margins": {
            "travel_m": "number?", "angle_rad": "number?", "friction": "number?",
            "com_m": "number?",
        },
        "binding": "text",
        "binding_p_m": "pair",
        "com_x_m": "pair?",
    }
)  # fmt: skip
_BAND = _sides(
    {
        "k_lower": "number?", "k_upper": "number?", "lower_binding": "text",
        "upper_binding": "text",
    }
)  # fmt: skip
_CLOSEST = {
    "margin": "number", "side": "text", "kind": "text", "angles_rad": "pair", "contacts_m": "pair",
}  # fmt: skip
_ANGLES = {
    "shallow_deg": "number?", "steep_deg": "number?", "sigma_star_m_s": "number?",
    "interval": "pair?", "tolerance": "number?",
}  # fmt: skip
_STATISTICS = (
    "drop_rate", "stall_rate", "drop_rate_difference", "mean_time_s", "rms_m", "square_difference",
    "mean_peak_m", "mean_waiting_s", "mean_corrections", "mean_messages",
)  # fmt: skip
_CELL = {"at": {"*": "any"}, "controller": "text", "carries": "whole"} | {
    f"{name}{end}?": shape
    for name in _STATISTICS
    for end, shape in (("", "number?"), ("_interval", ["number?"]))
}
_RULES = {"*": {"when": "text", "lines": ["text"], "robots": ["text"], "from": [["whole"]]}}
_DEPARTURE = {
    "differs": "text", "case": "any", "permitted_by": "text?", "strays": "any", "motions": "whole",
    "start": ["any"], "explanation": "text", "run": "any",
}  # fmt: skip
_REFINED = {
    "states": "whole", "motions": {"*": "whole"}, "weakest_permission": "text?", "stuck": "any",
    "falls": "any", "departures": [_DEPARTURE],
}  # fmt: skip
_DERIVATION = {
    "policy": [
        {
            "case": "whole",
            "signs": ["whole"],
            "tilt": "text?",
            "moves": [{"direction": "text", "until": ["text"]}],
        }
    ],
    "guards": [
        {
            "case": "whole", "move": "whole", "owner": "text", "guard": "text",
            "dropped": "boolean", "reason": "text",
        }
    ],
    "rules": _RULES,
    "conflicts": [
        {
            "rules": ["text"], "signs": [["whole"]], "palms_clash": "boolean",
            "moves_clash": "boolean", "cases": ["whole"], "order": "text",
        }
    ],
    "findings": ["text"],
    "is_table_2": "boolean",
    "refinement": {"*": _REFINED},
}  # fmt: skip
_MACHINE = {
    "states": [
        {"name": "text", "case": "text", "palm": "text", "move": "text", "awaits": "text"}
    ],
    "rows": [
        {
            "state": "text", "contact": "text", "got": "text", "tilt": "text", "next": "text",
            "send": "text",
        }
    ],
}  # fmt: skip
_POLICY = {
    "policy": "text",
    "description": "text",
    "rows": {"*": {"palms": ["text"], "drives": ["text"]}},
    "rules": _RULES,
    "is_table_2": "boolean",
    "reasons": ["text"],
    "machines": (_sides(_MACHINE), None),
    "verification": (
        {
            "proved": "boolean", "states": "whole", "worst_turns": "whole?",
            "counterexamples": {"*": "any"},
        },
        None,
    ),
}  # fmt: skip
_NAMES = [{"name": "text", "meaning": "text"}]
_TRIAL = {
    "engine": "text", "state": {"*": "any"}, "closing": "boolean", "expected": "text",
    "seen": "text", "decisive": "boolean", "slid_m": "pair", "cause": "text?",
}  # fmt: skip

JSON_SHAPES: dict[str, Any] = {
    "carry": _CARRY,
    "modes": {
        "feasible": [["text"]],
        "consistent_closing": [["text"]],
        "consistent_opening": [["text"]],
        "closing": (["text"], None),
        "opening": (["text"], None),
        "wedged": _sides("boolean"),
        "squeeze": _sides(["number?"]),
        "margin_rad": "number",
        "object_deg": "number",
        "p_left_m": "number",
        "p_right_m": "number",
        "theta_left_deg": "number",
        "theta_right_deg": "number",
        "contacts": [_CONTACT],
        "held?": "boolean?",
        "motions_closing?": [["text"]],
        "motions_opening?": [["text"]],
        "scene": "scene",
    },
    "analyze": {
        "holds": "boolean",
        "properties": {"1": _PROPERTY, "2": _PROPERTY, "0": _PROPERTY},
        "bands": {"1": _BAND, "2": _BAND},
        "com_x_m": "pair?",
        "com_y_m": ["pair"],
        "friction": ["pair"],
        "half_length_m": "any",
        "max_slope_deg": "number?",
        "max_acceleration_m_s2": "number?",
        "slope_deg": "pair?",
        "angle_error_deg": "number?",
        "clearance_deg": "number",
        "clearance": {
            "rotation_margin": _CLOSEST,
            "length_margin": (_CLOSEST, None),
            "touches": "boolean",
        },
        "touch": (
            {
                "angles_rad": "pair",
                "contacts_m": "pair",
                "contacts": [_CONTACT],
                "held": "boolean",
                "closing": [["text"]],
                "opening": [["text"]],
                "motion_names": {"*": "text"},
            },
            None,
        ),
        "wedging": {"friction": "number?", "side": "text", "palm": "text", "happens": "boolean"},
        "sideways": {
            "support_m": ["pair"],
            "margin_m": "number",
            "tilt_rad": "number",
            "acceleration_g": "number",
        },
        "warnings": ["text"],
        "region_m": _sides("pair"),
        "scene": "scene",
    },
    "design": {
        "shallow_deg": "number",
        "steep_deg": "number",
        "maximize": "text",
        "sigma_star_m_s": "number?",
        "interval": "pair?",
        "controller": "text?",
        "tolerance": "number",
        "tolerance_of": "text",
        "unit": "text",
        "own": _ANGLES,
        "paper_tolerance": "number?",
        "clearance_deg": "number",
        "friction": "pair?",
        "friction_floor": "number?",
        "reaction_s": {"own": "number", "asked": "number"},
        "reach_m": "number",
        "region_m": "pair",
        "warnings": ["text"],
        "certificate": _CERTIFICATE,
        "designed_scene": "scene",
        "scene": "scene",
    },
    "certify": _CERTIFICATE | {"parts": "whole"},
    "check": {
        "valid": "boolean",
        "claim": "text",
        "reason": "text",
        "box": (_BOX, None),
        "outside": ["text"],
        "scene": ("scene", None),
    },
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
    "derive": (_DERIVATION, _POLICY),
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
    "up": (_CARRY, _LIVE_CARRY),
    "world": (_CARRY, _LIVE_CARRY),
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
