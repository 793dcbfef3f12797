# SPDX-License-Identifier: Apache-2.0
"""The last line of `palmbots carry`: a controller that tolerates more noise, where that helps."""

import json

import pytest

from commands import Run

QUIET = ("--set", "robot.noise_m_s=0", "--set", "task.distance_m=0.3")


@pytest.mark.parametrize(
    ("arguments", "status", "peak_mm", "gain"),
    [
        (("--set", "robot.noise_m_s=0.03", "--seed", "3"), 1, None, "2.7 times"),  # dropped
        ((*QUIET, "--set", "start.left_m=0.0601"), 0, (60, 75), "2.7 times"),
        ((*QUIET, "--set", "start.left_m=-0.0601"), 0, (60, 75), "2.7 times"),
        ((*QUIET, "--set", "start.left_m=0.0599"), 0, (55, 60), None),
        (("--controller", "shared-sign", *QUIET, "--set", "start.left_m=0.07"), 0, (60, 75), None),
    ],
)
def test_recommends_where_the_object_was_or_nearly_was_dropped(
    here: Run,
    arguments: tuple[str, ...],
    status: int,
    peak_mm: tuple[int, int] | None,
    gain: str | None,
) -> None:
    carry = here("carry", *arguments)
    assert carry.returncode == status
    if peak_mm is not None:
        peaks = json.loads(here("carry", *arguments, "--json").stdout)["contact_peak_m"]
        assert peak_mm[0] <= 1e3 * max(peaks.values()) <= peak_mm[1]
    text = " ".join(carry.stdout.split())
    if gain is None:
        assert "recommended" not in text
    else:
        assert text.endswith(
            f"recommended: --controller shared-sign tolerates {gain} as much noise in the default "
            "scene"
        )
