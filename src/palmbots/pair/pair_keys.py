# SPDX-License-Identifier: Apache-2.0
"""The keys of ``pair.toml``, with their defaults and meanings."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from palmbots._types import Side
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.drivers.hardware import Hardware
from palmbots.pair.board_keys import BoardTable
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.scene.fields import Range, whole
from palmbots.scene.key_reference import SceneKey, section_keys
from palmbots.scene.section import Section
from palmbots.wire import Role

PairNumber = Annotated[int, BeforeValidator(whole(0, 0xFFFF))]
Baud = Annotated[int, BeforeValidator(whole(300, 10_000_000))]


class PairTable(Section):
    """[pair] Who belongs together, and what they do."""

    number: PairNumber = 0
    """Number of the pair on the air, 0 to 65535. Pairs within radio range of each other need
    different ones."""
    key_file: str = "pair.key"
    """File with the key, 32 hexadecimal digits. Copy it to both robots and the station, and to no
    other computer."""
    state_folder: str = "pair-state"
    """Folder in which each robot stores what it must remember over a reboot. Copy it to both robots
    once, while it is new, and never copy or restore it after a robot has run: its boot counter
    protects against replayed packets."""
    log_folder: str = "pair-logs"
    """Folder in which each program logs its readings, packets and decisions; empty: no logs."""
    scene: str = "paper"
    """Name of a built-in scene, or a TOML file."""
    controller: str = RECOMMENDED
    """Name of a controller, module:Class, FILE.py:Class, or a policy FILE.toml."""


class DriverTable(Section):
    """[driver] How a robot reaches its hardware."""

    kind: str = "simulated"
    """simulated: a world in another process (palmbots world). serial: a motor board on a serial
    line. dry-run: no hardware; it states what the robot would do. ros2: a base and a palm that are
    nodes of ROS 2, as [ros2] describes them. Or the name of an installed driver."""
    address: str = "127.0.0.1:7400"
    """simulated: where the world listens, HOST:PORT or unix:PATH. serial: the device, such as
    /dev/ttyACM0."""
    left_address: str | None = None
    """The address for the left robot, if it differs."""
    right_address: str | None = None
    """The address for the right robot, if it differs."""
    baud: Baud = 115_200
    """serial: bits per second."""
    options: dict[str, Any] | None = None
    """Keys of the driver's own: a table, which may also be written as [driver.options]."""

    def address_of(self, side: Side) -> str:
        """The address for one robot."""
        own = self.left_address if side == "left" else self.right_address
        return self.address if own is None else own


class LinkTable(Section):
    """[link] How packets travel between the robots and the station."""

    kind: str = "udp"
    """udp: a network. serial: a radio bridge or modem on a serial line of each robot and of the
    station. Or the name of an installed link."""
    left: str = "127.0.0.1:7411"
    """Address of the left robot. udp: HOST:PORT. serial: the device on that robot's own computer,
    such as /dev/ttyACM0."""
    right: str = "127.0.0.1:7412"
    """Address of the right robot."""
    station: str = "127.0.0.1:7413"
    """Address of the operator's station."""
    baud: Baud = 1_000_000
    """serial: bits per second."""

    def addresses(self) -> dict[Role, str]:
        """The address of each end."""
        return {"left": self.left, "right": self.right, "station": self.station}


Limit = Annotated[float, BeforeValidator(Range("s", least=0.01, most=100_000))]
OrderAge = Annotated[float, BeforeValidator(Range("s", least=0.2, most=4.0))]
TopSpeed = Annotated[float, BeforeValidator(Range("m/s", least=0.001, most=10))]


class LimitsTable(Section):
    """[limits] What ends a carry, in real time."""

    after_reboot: Literal["disarm", "rejoin"] = "disarm"
    """After a reboot in a carry: disarm, or rejoin by the controller's own rules."""
    station_lost: Literal["stop", "carry-on"] = "stop"
    """What happens if the station falls silent: stop, or carry-on."""
    partner_lost: Literal["stop", "controller"] = "stop"
    """What happens if the partner falls silent: stop, or what the controller does then. With stop,
    robots repeat their messages all the time, also those of shared-sign."""
    station_limit_s: Limit = 1.0
    """Silence of the station after which it counts as lost. A packet that arrives late is as
    old as the robot's own packet that it acknowledges."""
    order_age_s: OrderAge = 1.0
    """Greatest age at which a robot obeys an order to arm, start or release. It must exceed twice
    the time of a packet and its answer. Stops act at any age."""
    time_limit_s: Limit = 600.0
    """Longest duration of a carry."""
    max_speed_m_s: TopSpeed = 0.2
    """Largest speed of a command to a driver. A scene that needs a larger one is refused."""


class PairFile(Section):
    """The whole file."""

    pair: PairTable = PairTable()
    link: LinkTable = LinkTable()
    driver: DriverTable = DriverTable()
    ros2: Ros2Table = Ros2Table()
    limits: LimitsTable = LimitsTable()
    hardware: Hardware = Hardware()
    board: BoardTable = BoardTable()


def pair_keys() -> tuple[SceneKey, ...]:
    """All keys of the file, in order."""
    file = PairFile()
    tables = ((name, type(getattr(file, name))) for name in PairFile.model_fields)
    return tuple(key for name, model in tables for key in section_keys(model, name))
