# SPDX-License-Identifier: Apache-2.0
"""What a pair file asks of links and drivers, and cannot have: one line each."""

from pathlib import Path

import palmbots as pb
from pair_programs import new_pair
from palmbots.drivers.driver_registry import DRIVERS
from palmbots.pair.live_ends import open_pair_driver
from palmbots.pair.pair_file import load_pair


def test_a_limit_of_just_the_fastest_speed_suffices(tmp_path: Path) -> None:
    pair = load_pair(new_pair(tmp_path, driver__kind="dry-run", limits__max_speed_m_s=0.09))
    open_pair_driver(pair, "left", pb.load_scene("paper"), epoch=1).close()


def test_kinds_of_the_package_can_be_imported() -> None:
    assert set(DRIVERS.names()) == {"simulated", "serial", "dry-run", "ros2"}
    assert all(callable(DRIVERS.get(name)) for name in DRIVERS.names())
