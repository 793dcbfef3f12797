# SPDX-License-Identifier: Apache-2.0
"""What a pair file asks of links and drivers, and cannot have: one line each."""

from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.drivers.driver_registry import DRIVERS
from palmbots.pair.live_ends import open_pair_driver
from palmbots.pair.pair_file import load_pair
from palmbots.robot.live_robot import run_live_robot
from robot_processes import new_pair


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"driver__kind": "nosuch"}, 'driver.kind: value is "nosuch"; allowed: simulated, serial'),
        ({"link__kind": "nosuch"}, 'link.kind: value is "nosuch"; allowed: udp, serial'),
        ({"driver__kind": "serial"}, "driver.address: value is "),
        ({"link__kind": "serial"}, "link.left: value is "),
        ({"limits__max_speed_m_s": 0.05}, "limits.max_speed_m_s: value is 0.05; allowed: at least "
         "0.09 m/s, which the left robot needs for the scene"),
        ({"driver__kind": "dry-run", "hardware__battery_low_v": 6.5},
         "hardware.battery_low_v: value is 6.5, but the driver does not measure the battery"),
        ({"driver__kind": "dry-run", "driver__options": {"sript": 1}}, "driver.options.sript: is "),
    ],
)  # fmt: skip
def test_what_cannot_be_had_is_refused(values: dict[str, Any], line: str, tmp_path: Path) -> None:
    pair = load_pair(new_pair(tmp_path, **values))
    with pytest.raises(pb.PalmbotsError) as refused:
        run_live_robot(pair, "left")
    assert str(refused.value).startswith(line)
    assert "\n" not in str(refused.value)


def test_a_limit_of_just_the_fastest_speed_suffices(tmp_path: Path) -> None:
    pair = load_pair(new_pair(tmp_path, driver__kind="dry-run", limits__max_speed_m_s=0.09))
    open_pair_driver(pair, "left", pb.load_scene("paper"), epoch=1).close()


def test_kinds_of_the_package_can_be_imported() -> None:
    assert set(DRIVERS.names()) == {"simulated", "serial", "dry-run", "ros2"}
    assert all(callable(DRIVERS.get(name)) for name in DRIVERS.names())
