# SPDX-License-Identifier: Apache-2.0
"""`palmbots.carry_and_report`: what the command `palmbots carry` does, called from Python."""

from pathlib import Path

import palmbots as pb
from palmbots.assessment.carried import Carried

OVERRUN = {
    "tactile.zero_half_width_m": 0.0001, "robot.noise_m_s": 0, "robot.acceleration_m_s2": 20,
    "start.right_m": 0.02, "task.distance_m": 0.1,
}  # fmt: skip


def test_early_warnings_are_reported_or_else_listed() -> None:
    reported: list[str] = []
    found = pb.carry_and_report(overrides=OVERRUN, seeds=1, on_warning=reported.append)
    assert isinstance(found, Carried)
    assert reported and found.warnings[: len(reported)] == tuple(reported)
    listed = pb.carry_and_report(overrides=OVERRUN, seeds=1)
    assert listed == found
    for text in reported:
        assert text not in repr(found) and text in repr(listed)


def test_files_stand_in_the_report(tmp_path: Path) -> None:
    short = {"task.distance_m": 0.02}
    path = tmp_path / "carry.svg"
    assert f"wrote {path}" in repr(pb.carry_and_report(overrides=short, seeds=1, out=path))
    assert [file.name for file in tmp_path.iterdir()] == ["carry.svg"]


def test_counting_is_offered_where_it_takes_long() -> None:
    """A reference is never counted without being asked; the command names scene and controller."""
    found = pb.carry_and_report("paper", "exact-p", overrides={"task.distance_m": 0.02})
    assert isinstance(found, Carried)
    assert found.scene_statistics is None
    assert "-c exact-p --world quasistatic --seeds 100" in repr(found)
    single = pb.carry_and_report(
        "paper", "exact-p", precision="float", overrides={"task.distance_m": 0.02}
    )
    assert "--world quasistatic --precision float --seeds 100" in repr(single)
