# SPDX-License-Identifier: Apache-2.0
"""The file ``pair.toml``: which two robots belong together, and how each reaches its hardware.

Both robots and the station read the same file. Paths in it are relative to its folder.
"""

import contextlib
import json
import os
import secrets
import shlex
import stat
import tomllib
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from palmbots._types import SIDES, Side
from palmbots._util.arguments import one_of, show
from palmbots._util.atomic_files import check_file, folder, open_regular, write_whole
from palmbots._util.command import Option, command
from palmbots._util.user_paths import user_path
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.errors import PalmbotsError, SceneError
from palmbots.mechanics.load_limits import check_load
from palmbots.pair.pair_keys import LinkTable, PairFile, pair_keys
from palmbots.pair.stored_state import StateFile, StoredState, write_state
from palmbots.scene.error_messages import validation_message
from palmbots.scene.file_kinds import KEY, FileKind, refuse_other_kind
from palmbots.scene.files import read_table
from palmbots.scene.key_reference import commented_toml
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import refuse_curved, to_spec
from palmbots.wire import KEY_SIZE, Role

_LONGEST = 1_000_000  # bytes
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
            SceneError: it cannot be read, its object is too heavy or cannot be lifted, or it needs
                turns.
        """
        scene = load_scene(self.scene())
        scene.spell(shlex.quote(self.scene()))
        try:
            check_on_robots(scene)
        except SceneError as error:
            raise SceneError(f"{self.scene()}: {error}") from None
        return scene


def check_on_robots(scene: Scene) -> None:
    """Check a scene against what robots as processes can carry.

    Raises:
        SceneError: its object is too heavy or cannot be lifted, or it needs turns.
    """
    refuse_curved(scene)
    check_load(scene)
    if to_spec(scene).uses_floor:
        from palmbots.mechanics.lifting import check_lift  # loads numpy

        check_lift(scene)


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


def probe_address(pair: Pair, side: Side) -> str:
    """Where the program of a robot listens for `palmbots probe`."""
    return f"unix:{pair.state_file(side).path.with_suffix('.probe')}"


def is_pair_file(name: object) -> bool:
    """Whether this names a ``pair.toml``. A file that cannot be read is left to its reader."""
    if not isinstance(name, str | os.PathLike):
        return False
    try:
        with open_regular(user_path(name)) as stream:
            return "pair" in tomllib.loads(stream.read(_LONGEST).decode())
    except (OSError, ValueError, RecursionError, PalmbotsError):
        return False
