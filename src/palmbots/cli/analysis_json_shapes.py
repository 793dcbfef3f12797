# SPDX-License-Identifier: Apache-2.0
"""What `--json` prints of analyses and proofs; `json_shapes` explains the notation."""

from typing import Any

from palmbots.cli.json_shapes import sides

_CLAIMED_SIDES = sides(["text"])
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
_ANGLES = {
    "shallow_deg": "number?", "steep_deg": "number?", "sigma_star_m_s": "number?",
    "interval": "pair?", "tolerance": "number?",
}  # fmt: skip
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
    "machines": (sides(_MACHINE), None),
    "verification": (
        {
            "proved": "boolean", "states": "whole", "worst_turns": "whole?",
            "counterexamples": {"*": "any"},
        },
        None,
    ),
}  # fmt: skip

ANALYSIS_SHAPES: dict[str, Any] = {
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
    "derive": (_DERIVATION, _POLICY),
}
