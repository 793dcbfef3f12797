# SPDX-License-Identifier: Apache-2.0
"""The station as a process: no screen holds it up, and without an operator the robots stop."""

import contextlib
import json
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from pair_programs import new_pair, running, started
from palmbots.pair.pair_file import load_pair, station_address
from palmbots.station.station_client import ScreenRole, StationClient
from waiting import wait_until

CARRYING = {"carrying", "holding"}


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A world and two robots that carry for as long as the tests last; the folder of the pair."""
    folder = tmp_path_factory.mktemp("pair")
    # A busy machine may hold up a robot for a while.
    overrides = {"task.distance_m": 50.0, "robot.noise_m_s": 0.0, "control.watchdog_s": 0.6}
    scene = pb.load_scene("paper", overrides)
    (folder / "scene.toml").write_text(scene.to_toml())
    new_pair(folder, {"limits.partner_lost": "controller"}, "scene.toml")
    slow = ["--rate", "0.2"]  # a busy machine must not make a robot miss its ticks
    world = ["world", "scene.toml", "--serve", f"unix:{folder / 'world'}", *slow]
    sides = [["robot", "pair.toml", "--side", side, *slow] for side in ("left", "right")]
    with running(world, *sides, folder=folder):
        yield folder


@contextlib.contextmanager
def station(folder: Path, *options: str) -> Iterator["subprocess.Popen[str]"]:
    process = started(["station", "pair.toml", "--no-screen", *options], folder)
    try:
        yield process
    finally:
        process.terminate()
        process.communicate(timeout=60)


Screen = Callable[..., StationClient]


@pytest.fixture
def screen(robots: Path) -> Iterator[Screen]:
    """Opens screens of the station."""
    with contextlib.ExitStack() as opened:

        def opens(role: ScreenRole = "operator") -> StationClient:
            address = station_address(load_pair(robots / "pair.toml"))
            return opened.enter_context(StationClient(address, role, within_s=60))

        yield opens


def seen(client: StationClient, is_so: Callable[[dict[str, Any]], object], within_s: float = 60):
    """Wait until the state of the station is so; the screen stays alive meanwhile."""

    def found() -> object:
        client.wait(0.05)
        client.poll()
        return client.state is not None and is_so(client.state)

    wait_until(found, within_s)


def modes(state: dict[str, Any]) -> set[str]:
    return {"" if robot is None else robot["mode"] for robot in state["robots"].values()}


def carrying(client: StationClient) -> None:
    """Bring both robots to a carry, whatever their modes were."""
    seen(client, lambda state: "" not in modes(state))
    for wish, wanted in (("release", None), ("disarm", {"disarmed"}), ("arm", {"armed"}),
                         ("start", CARRYING)):  # fmt: skip
        client.wish(wish)
        if wanted is None:
            seen(client, lambda state: "stopped" not in modes(state))
        else:
            seen(client, lambda state, wanted=wanted: modes(state) <= wanted)


def stopped_after_s(client: StationClient) -> float:
    start_s = time.monotonic()
    seen(client, lambda state: modes(state) == {"stopped"})
    return time.monotonic() - start_s


def test_a_stopped_screen_delays_no_stop(robots: Path, screen: Screen) -> None:
    """Two operators look at the station. The screen of one stands still and reads nothing, until
    the socket to it is full; the e-stop of the other comes through."""
    with station(robots), running(
        ["station", "pair.toml", "--attach", "--json", "--wait-s", "60"], folder=robots
    ) as screens:  # fmt: skip
        client = screen()
        carrying(client)
        os.kill(screens[0].pid, signal.SIGSTOP)
        try:
            begin_s = time.monotonic()
            seen(client, lambda _: time.monotonic() - begin_s > 3.2)  # it counts as gone by now
            assert client.state is not None
            assert modes(client.state) <= CARRYING  # another operator is there
            client.wish("e_stop")
            assert stopped_after_s(client) < 2
        finally:
            os.kill(screens[0].pid, signal.SIGCONT)
        client.wish("quit")


@pytest.mark.parametrize("how", [signal.SIGSTOP, signal.SIGKILL])
def test_without_an_operator_the_robots_stop(
    robots: Path, screen: Screen, how: signal.Signals
) -> None:
    with station(robots):
        operator = subprocess.Popen(
            [*_python(), "-m", "palmbots", "station", "pair.toml", "--attach", "--plain",
             "--wait-s", "60"], cwd=robots, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip
        try:
            assert operator.stdout is not None
            operator.stdout.readline()  # it is attached
            first = screen()
            carrying(first)
            viewer = screen("viewer")
            first.close()
            seen(viewer, lambda state: modes(state) <= CARRYING)
            operator.send_signal(how)
            seen(viewer, lambda state: modes(state) == {"stopped"})
            assert any("no operator's screen is left" in line for line in viewer.lines)
        finally:
            operator.kill()
            operator.communicate()


def _python() -> list[str]:
    import sys

    return [sys.executable]


def test_a_viewer_gives_no_orders(robots: Path, screen: Screen) -> None:
    with station(robots):
        viewer = screen("viewer")
        seen(viewer, lambda state: "" not in modes(state))
        before = modes(viewer.state or {})
        viewer.wish("arm")
        wait_until(lambda: (viewer.poll(), not viewer.is_connected)[1])
        other = screen("viewer")
        seen(other, lambda state: state["time_s"] > 0)
        assert (other.state or {})["wish"] is None
        assert modes(other.state or {}) == before
        assert not any("arm" in line.split("s  ")[-1].split() for line in other.lines)


def test_a_second_station_on_this_machine_is_refused_by_name(robots: Path, screen: Screen) -> None:
    with station(robots) as first:
        watching = screen("viewer")
        for options in (["--plain"], ["--no-screen"]):
            second = started(["station", "pair.toml", *options], robots)
            printed, errors = second.communicate(timeout=60)
            assert second.returncode == 2
            assert errors == (
                f"palmbots: station: process {first.pid} on this machine is the station of this "
                "pair; allowed: one at a time; palmbots station PAIR --attach opens a screen for "
                "it\n"
            )
            assert printed == ""
        watching.poll()
        assert watching.is_connected
        assert not any("operator" in line for line in watching.lines)  # nobody was here


def test_typed_orders_and_json(robots: Path) -> None:
    """A station with its loop: what is typed happens, and the last line is the result."""
    process = started(["station", "pair.toml", "--json"], robots)
    assert process.stdin is not None
    stdout = process.stdout
    assert stdout is not None
    lines: list[Any] = []

    def read_until(is_so: Callable[[Any], object]) -> None:
        give_up = time.monotonic() + 60
        while time.monotonic() < give_up:
            lines.append(json.loads(stdout.readline()))
            if is_so(lines[-1]):
                return
        raise AssertionError(lines)

    def says(text: str) -> Callable[[Any], bool]:
        return lambda row: text in row.get("line", "")

    read_until(says("left:"))
    process.stdin.write("e-stop\nnonsense\n")
    process.stdin.flush()
    read_until(says("stopped"))
    read_until(lambda row: "state" in row and modes(row["state"]) == {"stopped"})
    process.stdin.write("release\n")
    process.stdin.flush()
    read_until(says("disarmed"))
    printed, errors = process.communicate("quit\n", timeout=60)
    last = json.loads(printed.splitlines()[-1])
    assert set(last) == {"done", "modes", "lines", "links"}
    assert last["done"] is True
    assert any("operator: e-stop" in line for line in last["lines"])
    assert errors == (
        'palmbots: order: value is "nonsense"; allowed: arm, disarm, start, stop, e-stop, '
        "release, quit\n"
    )
    assert process.returncode == 0


def test_ctrl_c_stops_the_robots(robots: Path, screen: Screen) -> None:
    process = started(["station", "pair.toml", "--plain"], robots)
    client = screen()
    carrying(client)
    watching = screen("viewer")
    client.close()
    process.send_signal(signal.SIGINT)
    wait_until(lambda: (watching.wait(0.05), watching.poll(), watching.end is not None)[2])
    assert set((watching.end or {})["modes"].values()) == {"stopped"}
    process.communicate(timeout=60)
    assert process.returncode == 130
