# SPDX-License-Identifier: Apache-2.0
"""Every old name that the CHANGELOG lists is refused in one line that gives the new one.

`ROWS` has the rows of its table "Old and new names", each with programs that use the old names, and
the new name that the refusal must contain.
"""

import re
from pathlib import Path
from typing import Any

import pytest

import palmbots
from commands import runner
from cxx import ROOT
from palmbots import control, learn, logs, mujoco, simulation, stability, studies, viz, wire

ROWS: dict[str, dict[str, str]] = {
    "`palmbots rare`": {"cli('rare')": "drop-rate"},
    "`palmbots speed`": {"cli('speed')": "speed-limits"},
    "`--within-percent`": {"cli('drop-rate', '--within-percent', '9')": "--relative-error-percent"},
    "`--beyond-budget`": {"cli('carry', '--beyond-budget')": "--allow-drift-beyond-budget"},
    "`--common`, `--each`": {
        "cli('certify', '--common')": "--common-friction",
        "cli('design', '--each')": "--independent-friction",
    },
    "`--slope` (a tangent)": {
        "cli('certify', '--slope', '0', '0.1')": "--slope-deg",
        "cli('design', '--slope', '0', '0.1')": "--slope-deg",
    },
    "`--least-difference-deg`, `--least-clearance-deg`, `--angles-deg`": {
        "cli('design', '--least-difference-deg', '5')": "--min-angle-difference-deg",
        "cli('design', '--least-clearance-deg', '5')": "--min-clearance-deg",
        "cli('design', '--angles-deg', '0', '5')": "--angle-range-deg",
    },
    "`--runs`": {"cli('derive', '--runs')": "--counterexamples"},
    "`--explain`, `--chunk`": {
        "cli('study', 'x.toml', '--explain')": "--estimate-cost",
        "cli('study', 'x.toml', '--chunk', '5')": "--chunk-size",
    },
    "`--seeds`": {
        "cli('validate', '--seeds', '5')": "--carries",
        "cli('speed-limits', '--seeds', '5')": "--carries",
    },
    "`dynamic.*`": {"scene('dynamic.body_kg', 1)": "mujoco.body_kg"},
    "`dynamic.press_n`, `dynamic.debounce_s`, `dynamic.wheel_mismatch`": {
        "scene('dynamic.press_n', 1)": "mujoco.switch_force_n",
        "scene('dynamic.debounce_s', 1)": "mujoco.switch_debounce_s",
        "scene('dynamic.wheel_mismatch', 1)": "mujoco.wheel_radius_mismatch",
    },
    "`palm.slip_deg`": {"scene('palm.slip_deg', 9)": "palm.friction_angle_deg"},
    "`task.inertia_lag_s`": {"scene('task.inertia_lag_s', 1)": "task.inertia_tau_s"},
    "`task.path.ease_m`, `task.path.lead_m`": {
        "scene('task.path.ease_m', 1)": "task.path.transition_m",
        "scene('task.path.lead_m', 1)": "task.path.lead_in_m",
    },
    "`radio.burst_share`": {"scene('radio.burst_share', 1)": "radio.burst_fraction"},
    "`radio.script[].fate`, `late_s`": {
        "scene('radio.script', [dict(fate='lost')])": "radio.script[0].effect",
        "scene('radio.script', [dict(late_s=1)])": "radio.script[0].delay_s",
    },
    '`"late"`, `"copied"`': {
        "scene('radio.script', [dict(sender='left', message=1, effect='late')])": "delayed",
        "scene('radio.script', [dict(sender='left', message=1, effect='copied')])": "duplicated",
    },
    "`faults.script[].for_s`, `reads`, `rate`": {
        "scene('faults.script', [dict(for_s=1)])": "faults.script[0].duration_s",
        "scene('faults.script', [dict(reads=1)])": "faults.script[0].stuck_at",
        "scene('faults.script', [dict(rate=1)])": "faults.script[0].probability",
    },
    '`"flicker"`, `"station"`': {
        "scene('faults.script', [dict(kind='flicker', at_s=1)])": "intermittent",
        "scene('faults.script', [dict(kind='station', at_s=1)])": "station-down",
    },
    "`faults.reboots`": {"scene('faults.reboots', 1)": "faults.random_reboots"},
    "`palmbots.rare(within=)`": {
        "palmbots.rare(within=0.1)": "palmbots.estimate_drop_rate",
        "palmbots.estimate_drop_rate(within=0.1)": "relative_half_width",
    },
    "`palmbots.states`, `States`": {
        "from palmbots import states": "palmbots.modes_batch",
        "from palmbots import States": "palmbots.mechanics.ContactModesBatch",
    },
    "`palmbots.objects`": {"palmbots.objects()": "palmbots.object_names"},
    "`palmbots.MODES`": {"palmbots.MODES": "palmbots.mechanics.CONTACT_MODES"},
    "`Checked`, `Replay`, `Touch`, `Letter`": {
        "from palmbots import Checked": "palmbots.stability.CheckResult",
        "from palmbots import Replay": "palmbots.logs.ReplayResult",
        "from palmbots import Touch": "palmbots.simulation.ContactEvent",
        "from palmbots import Letter": "palmbots.simulation.Message",
    },
    "`Controller`, `StepInput`, `StepOutput`, `Distributed`": {
        "from palmbots import Controller": "palmbots.control.Controller",
        "from palmbots import StepInput": "palmbots.control.StepInput",
        "from palmbots import StepOutput": "palmbots.control.StepOutput",
        "from palmbots import Distributed": "palmbots.control.DistributedController",
    },
    "`palmbots.learn.LETTERS`, `RewardWeights.letter`": {
        "learn.LETTERS": "palmbots.learn.MESSAGES",
        "from palmbots.learn import LETTERS": "palmbots.learn.MESSAGES",
        "learn.RewardWeights().letter": "message",
        "learn.RewardWeights(letter=0.1)": "message",
    },
    "`StepInput.letter`, `.turned`; `StepOutput.read`, `.waits`": {
        "control.StepInput(0, None, True).letter": "message",
        "control.StepInput(0, None, True).turned": "palm_at_target",
        "control.StepInput(0, letter=None, palm_at_target=True)": "message",
        "control.StepInput(0, message=None, turned=True)": "palm_at_target",
        "control.StepOutput().read": "consume",
        "control.StepOutput().waits": "waiting",
        "control.StepOutput(read=True)": "consume",
        "control.StepOutput(waits=True)": "waiting",
    },
    "`Carry.touches`, `.letters`, `.physics`, `.bumps`, `.across_peak_m`": {
        "carry().touches": "contact_events",
        "blank(logs.Log).touches": "contact_events",
        "carry().letters": "message_log",
        "carry().physics": "mujoco_record",
        "carry().bumps": "bump_count",
        "carry().across_peak_m": "lateral_peak_m",
    },
    "`Carry.links[].late`": {"carry().links['left_to_right'].late": "expired"},
    "`Message.letter`": {"blank(simulation.Message).letter": "kind"},
    "`lift`, `across`, `slip`, `drag`": {},  # the variables of an xarray dataset
    "`carry(watch=)`; `progress=` everywhere": {
        "palmbots.carry(watch=print)": "on_tick",
        "palmbots.carry(progress=print)": "on_progress",
        "palmbots.compare(progress=print)": "on_progress",
        "palmbots.estimate_drop_rate(progress=print)": "on_progress",
        "palmbots.study('what-matters', progress=print)": "on_progress",
        "palmbots.validate(progress=print)": "on_progress",
        "mujoco.find_speed_limits(progress=print)": "on_progress",
        "mujoco.forecast_drift('paper', progress=print)": "on_progress",
        "mujoco.save_video(carry(), 'x.gif', progress=print)": "on_progress",
        "studies.design_points(progress=print)": "on_progress",
        "viz.save_animation(carry(), 'x.gif', progress=print)": "on_progress",
    },
    "`DropRate.planning`, `.reached`, `.carries`": {
        "blank(simulation.DropRate).planning": "pilot_replicates",
        "blank(simulation.DropRate).reached": "conditional_probabilities",
        "blank(simulation.DropRate).carries": "equivalent_carries",
    },
    "`Analysis.situation`, `Clearance.turn`, `.longer`, `Bands.lower_by`, `.upper_by`": {
        "blank(stability.Analysis).situation": "problem",
        "blank(stability.Clearance).turn": "rotation_margin",
        "blank(stability.Clearance).longer": "length_margin",
        "blank(stability.Bands).lower_by": "lower_binding",
        "blank(stability.Bands).upper_by": "upper_binding",
    },
    "`CheckResult.why`": {"blank(stability.CheckResult).why": "reason"},
    "`check(path=)`": {"palmbots.check(path='x.json')": "certificate"},
    "`certify(most_parts=)`": {"palmbots.certify(most_parts=9)": "max_boxes"},
    "`common=`, `slope=` of `certify` and `design`": {
        "palmbots.certify(common=True)": "common_friction",
        "palmbots.certify(slope=(0, 0.1))": "slope_deg",
        "palmbots.design(common=True)": "common_friction",
        "palmbots.design(slope=(0, 0.1))": "slope_deg",
    },
    "`design(least_difference_deg=, least_clearance_deg=, angles_deg=)`": {
        "palmbots.design(least_difference_deg=5)": "min_angle_difference_deg",
        "palmbots.design(least_clearance_deg=5)": "min_clearance_deg",
        "palmbots.design(angles_deg=(0, 5))": "angle_range_deg",
    },
    "`validate(seeds=)`, `find_speed_limits(seeds=)`, `study(chunk=)`": {
        "palmbots.validate(seeds=2)": "carries",
        "mujoco.find_speed_limits(seeds=2)": "carries",
        "palmbots.study('what-matters', chunk=9)": "chunk_size",
    },
    "`palmbots.animation`, `figure8`; `batch`, `result`; `controllers`; `dynamic`": {
        "import palmbots.animation": "palmbots.viz",
        "import palmbots.figure8": "palmbots.viz",
        "from palmbots import batch": "palmbots.simulation",
        "import palmbots.result": "palmbots.simulation",
        "from palmbots.controllers import StepInput": "palmbots.control",
        "from palmbots.dynamic.world import MujocoWorld": "palmbots.mujoco",
    },
    "`palmbots.drops.is_forced`": {
        "palmbots.drops.is_forced(carry())": "palmbots.simulation.is_unavoidable",
        "from palmbots.drops import is_forced": "palmbots.simulation.is_unavoidable",
    },
    "`learn.meaning.Do`, `Seen`; `learn.episodes.Now`": {
        "from palmbots.learn.meaning import Do": "RobotAction",
        "learn.meaning.Seen": "RobotObservation",
        "from palmbots.learn.episodes import Now": "StepResult",
    },
    "`learn.baseline.Played`, `play`; `learn.reward.Scale`, `Rewards`": {
        "learn.baseline.Played": "EpisodeResult",
        "from palmbots.learn.baseline import play": "run_episode",
        "learn.reward.Scale": "RewardTerms",
        "from palmbots.learn.reward import Rewards": "RewardWeights",
    },
    "verdicts `stranger`, `misdirected`, `forged`, `unanswered`, `other_version`": {
        "endpoint().counts['stranger']": "wrong_pair",
        "endpoint().counts['misdirected']": "wrong_receiver",
        "endpoint().counts['forged']": "bad_tag",
        "endpoint().counts['unanswered']": "no_session",
        "endpoint().counts['other_version']": "wrong_version",
    },
    "`Packet.heard`, `Report.turned`": {
        "packet().heard": "acknowledged",
        "wire.Packet('left', 'right', 1, 1, 1, heard=(1, 1))": "acknowledged",
        "wire.Report(0, 'steep', True).turned": "palm_at_target",
        "wire.Report(0, 'steep', turned=True)": "palm_at_target",
    },
}
CASES = [(program, new) for cases in ROWS.values() for program, new in cases.items()]
NOT_REFUSED = "trace (not refused)"


class CommandRefused(Exception):
    """A command ended with this line on stderr."""


def table() -> list[list[str]]:
    """The cells of the rows of the CHANGELOG's table."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    section = text.split("#### Old and new names\n")[1].split("\n#")[0]
    rows = [line.strip("|").split("|") for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in rows[2:]]


def names(cell: str) -> list[str]:
    """The names in a cell, without what stands before their last dot."""
    found = []
    for text in re.findall(r"`([^`]+)`", cell):
        found += re.findall(r"(\w+)=", text) or re.findall(r"[\w-]+", text)[-1:]
    return found


def run(program: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Run a program, in which the helpers below are known."""

    def cli(*arguments: str) -> None:
        raise CommandRefused(runner(capsys)(*arguments).stderr.strip())

    space: dict[str, Any] = {
        "palmbots": palmbots, "control": control, "learn": learn, "logs": logs, "mujoco": mujoco,
        "simulation": simulation, "stability": stability, "studies": studies, "viz": viz,
        "wire": wire, "cli": cli,
        "scene": lambda key, value: palmbots.load_scene("paper", {key: value}),
        "carry": lambda: palmbots.carry(overrides={"task.distance_m": 0.3}, record=False),
        "blank": lambda result: object.__new__(result),
        "endpoint": lambda: wire.Endpoint(bytes(16), 1, "left", 1),
        "packet": lambda: wire.Packet("left", "right", 1, 1, 1),
    }  # fmt: skip
    exec(program, space)


def test_rows_are_those_of_the_changelog() -> None:
    assert [old for _, old, _ in table()] == list(ROWS)


def test_every_name_in_a_row_is_tried() -> None:
    for where, old, new in table():
        if where != NOT_REFUSED:
            tried, expected = " ".join(ROWS[old]), " ".join(ROWS[old].values())
            assert [name for name in names(old) if name not in tried] == []
            assert [name for name in names(new) if name not in expected] == []


@pytest.mark.parametrize(("program", "new"), CASES, ids=[program for program, _ in CASES])
def test_old_name_is_refused_with_the_new_one(
    program: str,
    new: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)  # if it is accepted, it may write a file
    with pytest.raises(Exception, match=r"renamed to|now called") as error:
        run(program, capsys)
    (line,) = str(error.value).splitlines()
    assert re.search(rf"{re.escape(new)}(\W|$)", line), line


@pytest.mark.parametrize("name", sorted(palmbots._RENAMED))
def test_old_public_name_is_refused_by_attribute_and_import(name: str) -> None:
    expected = f"^palmbots.{name} is renamed to {re.escape(palmbots._RENAMED[name])}$"
    with pytest.raises(AttributeError, match=expected):
        getattr(palmbots, name)
    with pytest.raises(ImportError, match=expected):
        exec(f"from palmbots import {name}")
    with pytest.raises(ModuleNotFoundError, match=expected):
        exec(f"import palmbots.{name}")
