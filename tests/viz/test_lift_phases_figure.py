# SPDX-License-Identifier: Apache-2.0
"""The figure of the phases of a job on the floor: which moments it draws, with which contacts."""

import pytest

import palmbots as pb
from palmbots.simulation.floor_job import FloorJob, JobPhase
from palmbots.simulation.result import Carry
from palmbots.viz.lift_phases_figure import MOMENTS, draw_lift_phases, time_of

TITLES = ["approach", "dock", "under", "centre", "raise", "carry", "lower", "leave", "retreat"]


@pytest.fixture(scope="module")
def job() -> Carry:
    return pb.carry("lift", "shared-sign", seed=1)


def test_every_phase_has_a_panel_with_its_contacts(job: Carry) -> None:
    """In the air both contacts are on palms; at the end both corners stand on the floor. While the
    second nose gets under, and while the last palm slides out, its corner may touch either."""
    panels = [panel for panel in draw_lift_phases(job).axes if panel.get_title(loc="left")]
    assert [panel.get_title(loc="left").split()[1].strip(":,") for panel in panels] == TITLES
    marks = [[line.get_marker() for line in panel.lines] for panel in panels]
    counts = {
        title: (found.count("D"), found.count("s"))
        for title, found in zip(TITLES, marks, strict=True)
    }
    assert counts["approach"] == counts["retreat"] == (0, 2)
    assert counts["dock"][0] >= 1 and counts["leave"][0] == 1 <= counts["leave"][1]
    assert all(counts[name] == (2, 0) for name in ("under", "centre", "raise", "carry", "lower"))


def test_moments_are_within_their_phases(job: Carry) -> None:
    assert job.floor_job is not None
    times = [(wanted, time_of(job.floor_job, wanted)) for wanted in MOMENTS]
    drawn = [(wanted, time) for wanted, time in times if time is not None]
    assert [wanted.title.partition(":")[0] for wanted, _ in drawn] == TITLES
    for wanted, time in drawn:
        now = {
            one.robot: one.phase for one in job.floor_job.phases if one.start_s <= time < one.end_s
        }
        left, right = now["left"], now["right"]
        assert any(a in wanted.one and b in wanted.other for a, b in ((left, right), (right, left)))


def test_a_phase_in_which_the_robots_never_were_is_left_out() -> None:
    phases = (JobPhase("left", "dock", 0.0, 2.0, 0.0), JobPhase("right", "under", 3.0, 4.0, 0.0))
    assert time_of(FloorJob(phases, None, 0.0, 0.0), MOMENTS[1]) is None


def test_a_carry_on_the_palms_has_no_phases() -> None:
    with pytest.raises(pb.PalmbotsError, match="a job that begins or ends on the floor"):
        draw_lift_phases(pb.carry("paper", overrides={"task.distance_m": 0.1}))
