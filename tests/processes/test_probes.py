# SPDX-License-Identifier: Apache-2.0
"""A pair that probes as processes, in lockstep with a world and in real time."""

import contextlib
import json
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random
from threading import Event, Thread
from typing import Any

import pytest

import palmbots as pb
from commands import Run
from pair_programs import new_pair, running, started
from palmbots._types import SIDES
from palmbots.links.local_connection import listen
from palmbots.probing import probe as probe_command
from palmbots.probing.probe_run import ProbeRun
from palmbots.simulation import probe_stage
from palmbots.simulation.probe_stage import ProbeStage, run_probe_world
from sampled import sampled
from waiting import wait_until

SEED = 3
KEYS = {"palm.friction": 0.39, "control.period_s": 0.05}  # few ticks: processes wait for each other
OPTIONS = ["--friction", "0.3", "0.5", "--com-x-m", "0.115", "0.135"]


Started = tuple[Path, dict[str, "subprocess.Popen[str]"]]


LOCKSTEP = ["--lockstep"]
REAL_TIME: list[str] = []


@pytest.fixture
def pair(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Started]:
    """A pair file, and the processes of a world and both robots; the parameter: scene keys, and
    further options of the processes."""
    scene = tmp_path / "scene.toml"
    keys, options = request.param
    scene.write_text(pb.load_scene("paper", keys).to_toml())
    file = new_pair(tmp_path, scene="scene.toml")
    serve = f"unix:{tmp_path / 'world'}"
    commands = {
        "world": ["world", str(scene), "--serve", serve, "--seed", str(SEED)],
        "left": ["robot", str(file), "--side", "left"],
        "right": ["robot", str(file), "--side", "right"],
    }
    lines = ([*one, "--probe", *options] for one in commands.values())
    with running(*lines, folder=tmp_path) as processes:
        yield file, dict(zip(commands, processes, strict=True))


@pytest.mark.parametrize("pair", [(KEYS, LOCKSTEP)], indirect=True)
def test_processes_find_what_one_program_finds(here: Run, pair: Started) -> None:
    file, processes = pair
    probe = started(["probe", str(file), *OPTIONS, "--json"], file.parent)
    printed, errors = probe.communicate(timeout=180)
    assert probe.returncode == 0, errors
    found = json.loads(printed)
    keys = [word for key, value in KEYS.items() for word in ("--set", f"{key}={value}")]
    alone = json.loads(here("probe", *keys, "--seed", str(SEED), *OPTIONS, "--json").stdout)
    assert (found.pop("contains_truth"), found.pop("contact_m")) == (None, None)
    assert alone.pop("contains_truth")
    farthest_mm = 1000 * alone.pop("contact_m")
    assert found["strokes"] == alone["strokes"]
    assert {key: found[key] for key in found if key != "scene"} == {
        key: alone[key] for key in alone if key != "scene"
    }
    world, _ = processes["world"].communicate(timeout=30)
    assert f"within ±{farthest_mm:.1f} mm" in world
    assert "the object is held" in world
    assert [processes[side].wait(30) for side in ("left", "right")] == [0, 0]


@pytest.mark.parametrize("pair", [({"palm.friction": 0.39}, REAL_TIME)], indirect=True)
def test_probes_in_real_time(pair: Started) -> None:
    """The wheels stand while the next probe is computed, so contacts stay on the permitted part of
    the palms. The object is in the set."""
    file, processes = pair
    probe = started(["probe", str(file), *OPTIONS, "--json"], file.parent)
    printed, errors = probe.communicate(timeout=180)
    assert probe.returncode == 0, errors
    found = json.loads(printed)
    low, high = found["com_x_m"]
    assert low <= 0.125 <= high
    assert high - low < 0.5 * (0.135 - 0.115)
    assert all(low <= 0.39 <= high for low, high in found["friction"].values())
    world, _ = processes["world"].communicate(timeout=30)
    assert "the object is held" in world
    assert float(world.rpartition("±")[2].split()[0]) <= 10.0
    assert [processes[side].wait(30) for side in ("left", "right")] == [0, 0]


Span = tuple[float, float]


@pytest.mark.parametrize(
    ("offset_m", "pause_s", "gap_s"),
    sampled([(0.02, (0.005, 0.1), (0.05, 0.3)), (0.0, (0.005, 0.03), (0.003, 0.05))], 2),
)
def test_late_programs_contradict_nothing(
    offset_m: float, pause_s: Span, gap_s: Span, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The programs of both robots are suspended at random. The world runs in this process, so the
    test compares it with what `probe` reads while both robots stand, and with where `probe` takes
    the contacts to be."""
    scene = tmp_path / "scene.toml"
    keys = {"palm.friction": 0.39, "palm.pivot_offset_m": offset_m}
    scene.write_text(pb.load_scene("paper", keys).to_toml())
    file = new_pair(tmp_path, scene="scene.toml")
    stages: list[ProbeStage] = []
    off_m: list[float] = []

    class Seen(ProbeStage):
        def __init__(self, *given: Any) -> None:
            super().__init__(*given)
            stages.append(self)

    class Watched(ProbeRun):
        def _rest(self, way: int, free: tuple[bool, bool] = (True, True)) -> list[int]:
            changed = super()._rest(way, free)
            hands: Any = self.hands
            assert self.is_possible
            assert stages[0].readings() == hands._seen
            for p, (low, high) in zip(stages[0].contacts, self.bounds.contacts, strict=True):
                off_m.append(max(low - p, p - high))
            return changed

    monkeypatch.setattr(probe_stage, "ProbeStage", Seen)
    monkeypatch.setattr(probe_command, "ProbeRun", Watched)
    monkeypatch.setattr(probe_command, "_MOST_S", 20.0)
    door = listen(f"unix:{tmp_path / 'world'}")
    world = Thread(target=run_probe_world, args=(pb.load_scene(scene), door), kwargs={"seed": SEED})
    world.start()
    lines = (["robot", str(file), "--side", side, "--probe"] for side in SIDES)
    with contextlib.closing(door), running(*lines, folder=tmp_path) as robots:
        with suspended_at_random([one.pid for one in robots], pause_s, gap_s) as pauses:
            found = pb.probe(file, friction=(0.3, 0.5), com_x_m=(0.115, 0.135))
        world.join(30)
    assert found.is_consistent
    assert found.com_x_m[0] <= 0.125 <= found.com_x_m[1]
    assert found.found.contains(0.125, (0.39, 0.39))
    assert stages[0].outcome == "running"
    assert len(pauses) > 20
    com = [round(1000 * end, 1) for end in found.com_x_m]
    print(f"{len(pauses)} pauses, {len(found.strokes)} strokes, COM {com} mm")
    assert len(off_m) > 10
    assert max(off_m) <= 1e-8


@contextlib.contextmanager
def suspended_at_random(numbers: list[int], pause_s: Span, gap_s: Span) -> Iterator[list[float]]:
    """Suspend these processes one at a time; gives how long each pause was meant to last [s]."""
    random, pauses, ends = Random(SEED), list[float](), Event()

    def work() -> None:
        while not ends.wait(random.uniform(*gap_s)):
            number = random.choice(numbers)
            pauses.append(random.uniform(*pause_s))
            os.kill(number, signal.SIGSTOP)
            time.sleep(pauses[-1])
            os.kill(number, signal.SIGCONT)

    thread = Thread(target=work)
    thread.start()
    try:
        yield pauses
    finally:
        ends.set()
        thread.join()


@pytest.mark.parametrize(
    "pair", [({"palm.friction": 0.39}, options) for options in (LOCKSTEP, REAL_TIME)], indirect=True
)
@pytest.mark.parametrize("lost", ["right", "probe"])
def test_a_killed_program_stops_both_robots(lost: str, pair: Started) -> None:
    """The object stays on the palms, and a line states what was lost."""
    file, processes = pair
    probe = started(["probe", str(file), *OPTIONS], file.parent)
    processes["probe"] = probe
    with probe:
        wait_until(lambda: _cpu_s(probe.pid) > _STARTED_S or probe.poll() is not None)
        assert probe.poll() is None, probe.communicate()
        os.kill(processes[lost].pid, signal.SIGKILL)
        world, _ = processes["world"].communicate(timeout=60)
        assert "the object is held" in world
        if lost == "probe":
            for side in ("left", "right"):
                _, said = processes[side].communicate(timeout=30)
                assert f"{side}: palmbots probe is gone; the wheels stop" in said
            return
        _, errors = probe.communicate(timeout=30)
        assert probe.returncode == 2
        assert errors.splitlines()[-1].startswith("palmbots: probe: the right robot is lost (")
        assert errors.endswith("the wheels of the other one stop, and its palm keeps its angle\n")


_STARTED_S = 2.0
"""Processor time of `palmbots probe` in the middle of its work: it starts in about 1 s."""


def _cpu_s(number: int) -> float:
    """Processor time of a process so far."""
    try:
        fields = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--seed", "2"], "is a pair file, with which --set and --seed have no effect; allowed: "),
        (["--set", "palm.friction=0.4"], "is a pair file, with which --set and --seed have no"),
    ],
)
def test_options_of_a_simulation_are_refused(
    here: Run, tmp_path: Path, options: list[str], line: str
) -> None:
    file = new_pair(tmp_path)
    result = here("probe", str(file), *options)
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert line in result.stderr


def test_robot_and_world_both_run_in_lockstep(tmp_path: Path) -> None:
    file = new_pair(tmp_path)
    world = ["world", "--serve", f"unix:{tmp_path / 'world'}", "--probe"]
    left, right = (["robot", str(file), "--side", side, "--probe"] for side in SIDES)
    with (
        running(world, [*left, *LOCKSTEP], right, folder=tmp_path) as (_, robot, _),
        started(["probe", str(file)], tmp_path) as probe,
    ):
        _, errors = robot.communicate(timeout=60)
        assert robot.returncode == 2
        assert errors.endswith(
            "left robot: its world runs in real time; allowed: without --lockstep\n"
        )
        assert probe.wait(60) == 2


def test_robots_that_do_not_run_are_named(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("palmbots.probing.robot_hands._STARTS_WITHIN_S", 0.1)
    file = new_pair(tmp_path)
    result = here("probe", str(file))
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert f"palmbots robot {file} --side left --probe" in result.stderr
