# SPDX-License-Identifier: Apache-2.0
"""The file ``pair.toml``: which two robots belong together, and how each reaches its hardware.

Both robots and the station read the same file. Paths in it are relative to its folder.
"""

import contextlib
import json
import os
import secrets
import stat
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ValidationError

from palmbots._types import SIDES, Side
from palmbots._util.arguments import one_of, show
from palmbots._util.atomic_files import check_file, folder, open_regular, write_whole
from palmbots._util.command import Option, command
from palmbots._util.user_paths import user_path
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.drivers.hardware import Hardware
from palmbots.errors import PalmbotsError, SceneError
from palmbots.mechanics.load_limits import check_load
from palmbots.pair.board_keys import BoardTable
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.pair.stored_state import StateFile, StoredState, write_state
from palmbots.scene.error_messages import validation_message
from palmbots.scene.fields import Range, whole
from palmbots.scene.file_kinds import KEY, FileKind, refuse_other_kind
from palmbots.scene.files import read_table
from palmbots.scene.key_reference import SceneKey, commented_toml, section_keys
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.section import Section
from palmbots.scene.spec import refuse_curved, refuse_floor
from palmbots.wire import KEY_SIZE, Role

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


PAIR_FILE = FileKind(
    "a pair file",
    "palmbots robot, station and doctor",
    "palmbots init pair FILE writes one",
    keys=PairFile.model_fields,
)


@dataclass(frozen=True)
class Pair:
    """A pair of robots, as its file describes it."""

    file: Path
    settings: PairFile
    key: bytes

    def state_file(self, end: Role) -> StateFile:
        """The file in which a robot or the station stores what it must remember over a reboot."""
        table = self.settings.pair
        path = user_path(table.state_folder, self.file.parent) / f"{end}.json"
        return StateFile(path, table.number, end)

    def log_folder(self) -> Path | None:
        """Where the programs of this pair log; None: nowhere."""
        name = self.settings.pair.log_folder
        return user_path(name, self.file.parent) if name else None

    def with_logs(self, folder: Path | None, *, is_off: bool) -> "Pair":
        """The same pair with its logs in another folder, or without logs; None: as in the file."""
        if folder is None and not is_off:
            return self
        name = "" if is_off or folder is None else str(folder.absolute())
        table = self.settings.pair.model_copy(update={"log_folder": name})
        return replace(self, settings=self.settings.model_copy(update={"pair": table}))

    def fingerprint(self, scene: Scene) -> int:
        """A number that is equal for both robots if they have the same scene and settings."""
        # What may differ between the robots.
        own: dict[str, Any] = {
            "driver": True,
            "link": True,
            "hardware": True,
            "board": True,
            "ros2": True,
        }
        own |= {"pair": {"log_folder"}, "limits": {"order_age_s"}}
        table = self.settings.model_dump(exclude=own)
        text = json.dumps([scene.model_dump(), table], sort_keys=True, default=str)
        return max(1, zlib.crc32(text.encode()))

    def scene(self) -> str:
        """The scene, as `load_scene` takes it."""
        name = self.settings.pair.scene
        return str(user_path(name, self.file.parent)) if name.endswith(".toml") else name

    def checked_scene(self) -> Scene:
        """The scene, which the robots can carry.

        Raises:
            SceneError: it cannot be read, its object is too heavy, or it needs arms or turns.
        """
        scene = load_scene(self.scene())
        try:
            check_on_robots(scene)
        except SceneError as error:
            raise SceneError(f"{self.scene()}: {error}") from None
        return scene


def check_on_robots(scene: Scene) -> None:
    """Check a scene against what robots as processes can carry.

    Raises:
        SceneError: its object is too heavy, or it needs arms or turns.
    """
    refuse_floor(scene, "robots as processes do")
    refuse_curved(scene)
    check_load(scene)


def load_pair(file: str | os.PathLike[str], *, with_key: bool = True) -> Pair:
    """Read a ``pair.toml`` and the key that it names. A viewer needs no key.

    Raises:
        PalmbotsError: a file cannot be read, has a fault, or the key is not protected.
    """
    path = user_path(file)
    table = read_table(str(path), PAIR_FILE)
    try:
        settings = PairFile.model_validate(table)
    except ValidationError as error:
        raise PalmbotsError(f"{path}: {validation_message(error, PairFile)}") from None
    _check_addresses(path, settings.link)
    key = _key_of(path, settings.pair.key_file) if with_key else b""
    return Pair(path, settings, key)


def _check_addresses(path: Path, link: LinkTable) -> None:
    """Refuse UDP addresses that two ends share, and those of one computer beside those of a
    network. A serial device may have the same name on each computer.

    Raises:
        PalmbotsError: two ends have the same address, or one cannot be reached by the others.
    """
    if link.kind != "udp":
        return
    owners: dict[str, Role] = {}
    for end, address in link.addresses().items():
        owner = owners.setdefault(address, end)
        if owner != end:
            raise PalmbotsError(
                f"{path}: link.{end}: value is {show(address)}, which is also link.{owner}; "
                "allowed: an address of its own for each end"
            )
    local = {end for end, address in link.addresses().items() if _is_local(address)}
    if local and len(local) < len(owners):
        end = min(local)
        other = min(set(owners.values()) - local)
        raise PalmbotsError(
            f"{path}: link.{end}: value is {show(link.addresses()[end])}, which only this computer "
            f"reaches, but link.{other} is {show(link.addresses()[other])}; allowed: the address "
            "of that end in the network, such as 192.168.1.12:7411, or addresses of this computer "
            "for all three"
        )


def _is_local(address: str) -> bool:
    return address.startswith(("127.", "localhost:"))


def _key_of(pair: Path, name: str) -> bytes:
    """The key of a pair, in a file that only its owner can read."""
    path = user_path(name, pair.parent)
    try:
        with open_regular(path) as stream:
            mode = stat.S_IMODE(os.fstat(stream.fileno()).st_mode)
            text = stream.read(100)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        why = getattr(error, "strerror", None) or error
        lost = isinstance(error, FileNotFoundError)
        remedy = f"; copy it from where {pair.name} was made (mode 600)" if lost else ""
        raise PalmbotsError(f"{path}: cannot be read: {why}{remedy}") from None
    if mode & 0o077:
        raise PalmbotsError(
            f"{path}: others can read the key (mode {mode:o}); run: chmod 600 {path}"
        )
    try:
        key = bytes.fromhex(text.decode("ascii"))
    except ValueError:
        key = b""
    if len(key) != KEY_SIZE:
        refuse_other_kind(path, KEY)
        raise PalmbotsError(f"{path}: is no key; allowed: {2 * KEY_SIZE} hexadecimal digits")
    return key


ENDS: tuple[Role, ...] = (*SIDES, "station")
_HEAD = (
    "# A pair of robots for palmbots. Both robots and the station use this file and the",
    "# same key. Paths are relative to the folder of this file.",
)


def pair_keys() -> tuple[SceneKey, ...]:
    """All keys of the file, in order."""
    file = PairFile()
    tables = ((name, type(getattr(file, name))) for name in PairFile.model_fields)
    return tuple(key for name, model in tables for key in section_keys(model, name))


@command(
    "init pair",
    order=190,
    example="palmbots init pair pair.toml",
    then="palmbots world paper --serve 127.0.0.1:7400 if the robots are simulated, palmbots "
    "robot {file} --side left, --side right, and palmbots station {file}",
    file=Option(is_argument=True, metavar="FILE"),
)
def init_pair(
    file: str | os.PathLike[str],
    *,
    scene: str = "paper",
    controller: str = "",
    address: str = "127.0.0.1:7400",
    values: Mapping[str, object] | None = None,
) -> list[Path]:
    """Write the settings of a pair of robots, a random key and boot counters.

    Existing files are never overwritten.

    Args:
        file: new TOML file.
        scene: its key ``pair.scene``.
        controller: its key ``pair.controller``; empty: the recommended one.
        address: its key ``driver.address``.
        values: further keys, as in ``{"link.left": …}``.

    Returns:
        The files that were written.

    Raises:
        PalmbotsError: a file exists or cannot be written, there is no such folder or key.
    """
    known = pair_keys()
    for name in values or {}:
        one_of("values", name, tuple(key.name for key in known))
    path = user_path(file)
    if not path.name.endswith(".toml"):
        raise PalmbotsError(f"FILE: value is {show(str(path))}; allowed: a name that ends in .toml")
    check_file(path)
    names = {"key_file": f"{path.stem}.key", "state_folder": f"{path.stem}-state"}
    names |= {"log_folder": f"{path.stem}-logs"}
    number = secrets.randbelow(2**16)
    chosen: dict[str, object] = {
        "pair.number": number,
        "pair.scene": scene,
        "pair.controller": controller or RECOMMENDED,
        "driver.address": address,
    } | {f"pair.{name}": value for name, value in names.items()}
    chosen |= values or {}
    number = int(str(chosen["pair.number"]))
    keys = (replace(key, default=chosen.get(key.name, key.default)) for key in known)
    text = commented_toml(_HEAD, keys)
    key, state = path.parent / names["key_file"], path.parent / names["state_folder"]
    counters = [StateFile(state / f"{end}.json", number, end) for end in ENDS]
    for taken in (path, key, *(file.path for file in counters)):
        if os.path.lexists(taken):
            raise PalmbotsError(f"{taken}: exists already and is never overwritten")
    folders = [place for place in (state, *state.parents) if not os.path.lexists(place)]
    written: list[Path] = []
    try:
        folder(state)
        write_whole(path, text, new=True)
        written.append(path)
        previous = os.umask(0o077)
        try:
            write_whole(key, secrets.token_hex(KEY_SIZE) + "\n", new=True)
        finally:
            os.umask(previous)
        written.append(key)
        for counter in counters:
            write_state(counter, StoredState(), new=True)
            written.append(counter.path)
    except BaseException:  # half a pair would be in the way of the next attempt
        for one in written:
            one.unlink(missing_ok=True)
        for place in folders:
            with contextlib.suppress(OSError):
                place.rmdir()
        raise
    return written


def station_address(pair: Pair) -> str:
    """Where the station of a pair listens for screens."""
    return f"unix:{pair.state_file('station').path.with_suffix('.socket')}"
