# SPDX-License-Identifier: Apache-2.0
"""The link and the driver of one end of a pair, as its ``pair.toml`` describes them."""

import contextlib
from collections.abc import Callable, Iterator

from palmbots._types import Side
from palmbots._util.arguments import show
from palmbots.drivers.arm import NEW_ARM, StoredArm, arm_shape
from palmbots.drivers.driver import Driver, DriverFailed, DriverSettings, NoAnswer
from palmbots.drivers.driver_registry import check_arm, open_driver
from palmbots.errors import PalmbotsError
from palmbots.links.greeting import scene_number
from palmbots.links.link import Link, LinkSettings, to_stderr
from palmbots.links.link_registry import open_link
from palmbots.pair.drive_table import drive_table
from palmbots.pair.pair_file import Pair
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.wire import Role

_ROUNDING = 1e-9
_TABLES = ("link.", "driver.", "hardware.", "ros2.")


@contextlib.contextmanager
def _named(pair: Pair) -> Iterator[None]:
    """Name the file in refusals of its keys."""
    try:
        yield
    except PalmbotsError as error:
        if isinstance(error, DriverFailed) or not str(error).startswith(_TABLES):
            raise
        kind = NoAnswer if isinstance(error, NoAnswer) else PalmbotsError
        raise kind(f"{pair.file}: {error}") from None


def open_pair_link(pair: Pair, role: Role, on_line: Callable[[str], None] = to_stderr) -> Link:
    """Open the link of a robot or the station.

    Raises:
        PalmbotsError: there is no such kind, or its address is wrong or cannot be used.
    """
    table = pair.settings.link
    number = pair.settings.pair.number
    settings = LinkSettings(role, table.addresses(), number, table.baud, on_line)
    with _named(pair):
        return open_link(table.kind, settings)


def check_speed(pair: Pair, side: Side, scene: Scene) -> None:
    """Check that a robot never needs a higher speed than the limit of the pair.

    Raises:
        PalmbotsError: it does.
    """
    limit_m_s = pair.settings.limits.max_speed_m_s
    fastest_m_s = max(abs(drive.speed_m_s) for drive in drive_table(scene, side).values())
    if fastest_m_s > limit_m_s + _ROUNDING:
        raise PalmbotsError(
            f"{pair.file}: limits.max_speed_m_s: value is {show(limit_m_s)}; allowed: at least "
            f"{fastest_m_s:g} m/s, which the {side} robot needs for the scene {pair.scene()}; "
            "raise it, or lower robot.speed_m_s and robot.correction_m_s of the scene"
        )


def check_pair_arms(pair: Pair, scene: Scene) -> None:
    """Refuse a job on the floor whose robots have no arms.

    Raises:
        PalmbotsError: drivers of the pair's kind move no arm.
    """
    if to_spec(scene).uses_floor:
        with _named(pair):
            check_arm(pair.settings.driver.kind)


def open_pair_driver(
    pair: Pair,
    side: Side,
    scene: Scene,
    *,
    epoch: int,
    rate: float = 1.0,
    within_s: float = 20.0,
    on_line: Callable[[str], None] = to_stderr,
    stored_arm: StoredArm | None = None,
) -> Driver:
    """Open the driver of a robot, with the speed limit of the pair.

    Args:
        pair: the pair.
        side: of the robot.
        scene: of the pair.
        epoch: number of the robot's boots.
        rate: multiple of real time at which a simulated robot runs.
        within_s: time within which the world of a simulated robot has to answer.
        on_line: called with a line for the operator.
        stored_arm: before the boot; None: the robot does not do its job.

    Raises:
        PalmbotsError: the scene needs a higher speed than the limit, there is no such kind of
            driver, or its hardware cannot be used.
    """
    check_speed(pair, side, scene)
    table, limit_m_s = pair.settings.driver, pair.settings.limits.max_speed_m_s
    does_job = to_spec(scene).uses_floor and stored_arm is not None
    settings = DriverSettings(
        side=side,
        leads=(side == "right") == (scene.task.direction == "forward"),
        address=table.address_of(side),
        period_s=scene.control.period_s / rate,
        watchdog_s=scene.control.watchdog_s / rate,
        hardware=pair.settings.hardware.of(side),
        baud=table.baud,
        options=table.options or {},
        max_speed_m_s=limit_m_s,
        epoch=epoch,
        within_s=within_s,
        scene=scene_number(scene),
        arm=arm_shape(scene, side) if does_job else None,
        stored_arm=stored_arm or NEW_ARM,
        table=getattr(pair.settings, table.kind, None),
        on_line=on_line,
    )
    with _named(pair):
        return open_driver(table.kind, settings)
