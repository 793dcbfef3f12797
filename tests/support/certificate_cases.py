# SPDX-License-Identifier: Apache-2.0
"""What tests of certificates have in common."""

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import palmbots as pb

# Angles that differ by 21.4°: held while one palm turns, but not with both palms at any angle and
# the contacts off in opposite directions, the outward one on the shallow palm.
WIDE_APART: dict[str, Any] = {
    "object": {"com_m": [0.1089, 0.0765]},
    "palm": {"shallow_deg": 8.567, "steep_deg": 29.984, "pivot_offset_m": 0.01, "friction": 0.287},
}


def checked(data: dict[str, Any], folder: Path) -> pb.stability.CheckResult:
    target = folder / "certificate.json"
    target.write_text(json.dumps(data))
    return pb.check(target)


def numbers(pair: Any) -> list[float]:
    return [float(Fraction(value)) for value in pair]
