# SPDX-License-Identifier: Apache-2.0
"""Whole carries over a link that is not UDP: serial lines with bridges, and an installed link."""

import socket
from pathlib import Path
from typing import Any

import pytest

from distributions import installed_example
from json_output import read_json
from pair_programs import ENDS, ended, new_pair, running, started
from serial_lines import Bridges, lines

# A slow control loop, so that a busy machine seldom ends a carry by the fault `overrun`.
SCENE = "[task]\ndistance_m = 0.2\n[control]\nperiod_s = 0.04\nwatchdog_s = 0.4\n"
OTHER = {"left": "right", "right": "left"}


def carry(folder: Path, environment: dict[str, str] | None = None) -> tuple[Any, dict[str, Any]]:
    """What the station and both robots print after a carry."""
    world = ["world", "scene.toml", "--serve", f"unix:{folder / 'world'}"]
    robots = [["robot", "pair.toml", "--side", side, "--json"] for side in OTHER]
    with running(world, *robots, folder=folder, environment=environment) as (_, *both):
        station = started(["station", "pair.toml", "--auto", "--json"], folder, environment)
        printed, errors = station.communicate(timeout=100)
        assert (station.returncode, errors) == (0, ""), printed + errors
        found = {}
        for side, robot in zip(OTHER, both, strict=True):
            found[side], errors = ended(robot)
            assert errors == ""
    return read_json("station", printed.splitlines()[-1]), found


def check_counts(station: Any, robots: dict[str, Any]) -> None:
    """What one end has sent is what the other has received and lost."""
    assert station["done"] is True
    for side, other in OTHER.items():
        link = robots[side]["link"]
        assert link[other]["sent"] > 20
        assert link[other]["lost"] is None
        assert link["station"]["lost"] == 0
        assert robots[side]["verdicts"]["accepted"] > 40
        own = station["links"]["station"][side]
        assert own["received"] > 20 and own["lost"] == 0
        assert 0 < own["round_trip_median_s"] < 2
        # The last packets may be under way when a program ends.
        assert 0 <= link[other]["sent"] - robots[other]["link"][side]["received"] < 40
    reported = station["links"]["robots"]["left"]
    assert reported["sent"] > 20 and reported["accepted"] > 20


def test_serial_lines_and_bridges(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    devices = {f"link.{end}": str(tmp_path / end) for end in ENDS}
    new_pair(tmp_path, {**devices, "link.kind": "serial"}, "scene.toml")
    with lines(*(tmp_path / end for end in ENDS)) as made, Bridges(made):
        station, robots = carry(tmp_path)
    check_counts(station, robots)
    for side in OTHER:
        # The air is shared: what is for others arrives, too, and is refused.
        assert robots[side]["verdicts"]["wrong_receiver"] > 20
        assert robots[side]["link"]["details"]["damaged"] == 0
        assert robots[side]["link"]["details"]["dropped"] == 0


@pytest.fixture
def zenoh(tmp_path: Path) -> dict[str, str]:
    """An environment in which the example of a link is installed."""
    pytest.importorskip("zenoh")
    return installed_example("zenoh_link", tmp_path / "site")


@pytest.mark.soak
def test_the_example_over_zenoh(zenoh: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    ports = []
    for _ in ENDS:
        with socket.socket() as one:
            one.bind(("127.0.0.1", 0))
            ports.append(one.getsockname()[1])
    places = {f"link.{end}": f"tcp/127.0.0.1:{port}" for end, port in zip(ENDS, ports, strict=True)}
    new_pair(tmp_path, {**places, "link.kind": "zenoh"}, "scene.toml")
    check_counts(*carry(tmp_path, zenoh))
    # The address is in use: one line.
    with socket.create_server(("127.0.0.1", ports[0])):
        robot = started(["robot", "pair.toml", "--side", "left"], tmp_path, zenoh)
        printed, errors = robot.communicate(timeout=60)
    assert (robot.returncode, printed) == (2, "")
    assert "palmbots: link.left: cannot use tcp/127.0.0.1:" in errors
    assert "Traceback" not in errors
