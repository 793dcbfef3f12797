# SPDX-License-Identifier: Apache-2.0
"""The last page of an image: what distinguishes one board from another.

The firmware reads the same bytes as a struct (``firmware/app/settings.hpp``). Times are control
ticks unless a name says otherwise.
"""

import struct
import zlib
from dataclasses import MISSING, dataclass, field, fields
from itertools import islice
from typing import Any

from palmbots.pair.board_keys import PULSES_S
from palmbots.wire import MAX_EPOCH

PERIODS_S = (0.005, 0.05)
"""Shortest and longest control period of a board."""
WATCHDOGS_S = (0.1, 10.0)
"""Shortest and longest time after which a processor that has halted is reset. An erase of a page of
flash memory halts it for 88 ms; the wheels keep turning until the reset."""
MOST_POWER = 255
"""The speed that a motor board takes as full power; a number without a unit."""
PAGE_ADDRESS = 0xF000
PAGE_SIZE = 0x1000
TABLE_SIZE = 3265
"""Bytes of the table of a policy."""
SWITCHES = ("unused", "minus", "zero", "plus", "steep-end", "shallow-end", "goal", "beneath")
"""What a closed switch of the palm means, in the order of the numbers."""
_MAGIC = 0x42504D42
_FORMAT = 3

Limits = tuple[int, int]
"""The least and the most."""


def _us(limits_s: tuple[float, float]) -> Limits:
    return round(1e6 * limits_s[0]), round(1e6 * limits_s[1])


_WHEELS = (_us(PULSES_S), (-MOST_POWER, MOST_POWER))
"""Limits of the pulses [us] or of the speeds of the wheels, by the kind of the wheels."""


def _at(
    code: str, every: Limits | None = None, *, robot: Limits | None = None, default: Any = MISSING
) -> Any:
    """A field of the page.

    Args:
        code: as in `struct`.
        every: limits that a board cannot check itself.
        robot: the same for a robot's page: the station's radio has neither wheels nor a palm.
        default: where settings do not state the field.
    """
    return field(default=default, metadata={"code": code, "every": every, "robot": robot})


@dataclass(frozen=True, kw_only=True)
class BoardSettings:
    """What is written into the page, in its order."""

    pair: int = _at("H")
    key: bytes = _at("16s")
    first_epoch: int = _at("I")
    """Epoch of the first boot with the image."""
    last_epoch: int = _at("I", (0, MAX_EPOCH))
    """The last that the image may use."""
    number: int = _at("I")
    """Equal for both boards if their settings are."""
    period_us: int = _at("I", _us(PERIODS_S))
    watchdog_us: int = _at("I", _us(WATCHDOGS_S))
    lease: int = _at("I")
    station_limit: int = _at("I")
    time_limit: int = _at("I")
    travel: int = _at("I")
    """Time in mode carrying that covers the distance."""
    stopping_limit: int = _at("I")
    stopping: int = _at("I")
    turn_limit: int = _at("I")
    """Longest time in which a palm turns."""
    most_overruns: int = _at("H")
    state_period: int = _at("H")
    status_period: int = _at("H")
    least_battery_mv: int = _at("H")
    role: int = _at("B", (0, 2))
    """0: the left robot, 1: the right one, 2: the radio of the station."""
    controller: int = _at("B")
    """The number of its program (`ControllerEntry.board_number`)."""
    channel: int = _at("B", (0, 100))
    power_dbm: int = _at("b", (-40, 8))
    rejoins: bool = _at("B", (0, 1))
    stops_without_station: bool = _at("B", (0, 1))
    stops_without_partner: bool = _at("B", (0, 1))
    has_radio: bool = _at("B", (0, 1))
    leads: bool = _at("B", (0, 1))
    may_stop: bool = _at("B", (0, 1))
    by_touch: bool = _at("B", (0, 1))
    is_under_way: bool = _at("B", (0, 1), default=False)
    """The carry begins at the boot, as in the simulator."""
    wheel_kind: int = _at("B", (0, 1))
    """0: servos, 1: a motor board."""
    debounce: int = _at("B", (1, 0xFF))
    """Equal readings in a row that a switch needs."""
    palm_slew_us: int = _at("H", robot=(1, 0xFFFF))
    """Largest change of the palm's pulse in a tick; with 0 a palm never turns."""
    wheel_slew: int = _at("H", robot=(1, 0xFFFF))
    """Largest change of a wheel's pulse or speed in a tick."""
    switches: tuple[int, ...] = _at("9B", (0, len(SWITCHES) - 1))
    order_age: int = _at("B", default=0)
    """Greatest age of an order, in periods of the status; 0: the usual one of the firmware."""
    palm_us: tuple[int, int] = _at("2H", robot=_us(PULSES_S))
    """Pulses of the steep and of the shallow angle."""
    wheels: tuple[int, ...] = _at("12h")
    """Pulses [us] or speeds of the left and the right wheel, by stop and move: 2 x 2 x 3."""
    times: tuple[int, ...] = _at("16H")
    """Of the controller."""
    phase_times: tuple[int, ...] = _at("7H", default=())
    """Of the table of a job on the floor."""
    arm_floor_us: tuple[int, int] = _at("2H", default=(0, 0))
    """Pulses of the arm at which the nose of a steep and of a shallow palm is on the floor."""
    arm_low_us: tuple[int, int] = _at("2H", default=(0, 0))
    """The same at which it is at its lowest at the beginning and at the end of the job."""
    arm_clear_us: int = _at("H", default=0)
    """The same at which the palm touches an object on its stand at the latest."""
    arm_top_us: int = _at("H", default=0)
    """The same while the pair carries."""
    arm_slew: int = _at("H", default=0)
    """Change of the arm's pulse in a tick [1/256 us]."""
    job: int = _at("B", (0, 63), default=0)
    """Bits of a job on the floor or at a stand: there is one, it begins low, it ends low, this
    robot docks after its partner, it begins on a stand, it ends on one."""
    table: int = _at("B", default=0)
    """Number of the table of the job."""
    unused: tuple[int, int] = _at("2B", default=(0, 0))
    arm_step: int = _at("I", default=0)
    """A step of this table [1/256 us]."""

    def packed(self) -> bytes:
        """The bytes, with their check."""
        values: list[Any] = []
        for one in fields(self):
            value = getattr(self, one.name)
            given = value if isinstance(value, tuple) else (value,)
            values += [*given, *[0] * (_count(one.metadata["code"]) - len(given))]
        body = _STRUCT.pack(_MAGIC, _FORMAT, *values)
        return body + zlib.crc32(body).to_bytes(4, "little")


def _count(code: str) -> int:
    """How many values a field has."""
    return 1 if code.endswith("s") else int(code[:-1] or 1)


_STRUCT = struct.Struct("<IH" + "".join(one.metadata["code"] for one in fields(BoardSettings)))


def radio_settings(channel: int, power_dbm: int) -> BoardSettings:
    """The settings of the station's radio, which has no key and belongs to no pair.

    Args:
        channel: frequency above 2400 MHz [MHz].
        power_dbm: of the radio [dBm].
    """
    return BoardSettings(
        role=2, key=bytes(16), pair=0, first_epoch=0, last_epoch=0, number=0,
        period_us=5000, watchdog_us=100000, lease=0, station_limit=0, time_limit=0,
        travel=0, stopping_limit=0, stopping=0, turn_limit=0, most_overruns=0,
        state_period=0, status_period=0, least_battery_mv=0, controller=0, channel=channel,
        power_dbm=power_dbm, rejoins=False, stops_without_station=False,
        stops_without_partner=False, has_radio=True, leads=False, may_stop=False, by_touch=False,
        wheel_kind=0, debounce=1, palm_slew_us=0, wheel_slew=0, switches=(), palm_us=(0, 0),
        wheels=(0,) * 12, times=(),
    )  # fmt: skip


def settings_page(settings: BoardSettings, table: bytes = b"") -> bytes:
    """The whole page.

    Args:
        settings: of the board.
        table: the table of a policy, as the core lays it out; empty: the controller is another one.
    """
    page = settings.packed()
    if table:
        assert len(table) == TABLE_SIZE
        page += table
        page += bytes(4 - len(page) % 4) + zlib.crc32(table).to_bytes(4, "little")
    return page.ljust(PAGE_SIZE, b"\xff")


def role_in(page: bytes) -> int | None:
    """The role in the last page of an image; None: it holds no settings that a board accepts."""
    body, check = page[: _STRUCT.size], page[_STRUCT.size : _STRUCT.size + 4]
    if len(body) < _STRUCT.size or check != zlib.crc32(body).to_bytes(4, "little"):
        return None
    magic, page_format, *values = _STRUCT.unpack(body)
    left = iter(values)
    found = {
        one.name: tuple(islice(left, _count(one.metadata["code"]))) for one in fields(BoardSettings)
    }
    if (magic, page_format) != (_MAGIC, _FORMAT) or not _are_within("every", found):
        return None
    role, first, last = (found[name][0] for name in ("role", "first_epoch", "last_epoch"))
    if role == 2:
        return role
    least, most = _WHEELS[found["wheel_kind"][0]]
    is_meant = _are_within("robot", found) and all(least <= one <= most for one in found["wheels"])
    return role if is_meant and 1 <= first <= last else None


def _are_within(whose: str, found: dict[str, tuple[int, ...]]) -> bool:
    limited = ((found[one.name], one.metadata[whose]) for one in fields(BoardSettings))
    return all(
        limits is None or limits[0] <= value <= limits[1]
        for values, limits in limited
        for value in values
    )
