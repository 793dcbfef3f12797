# SPDX-License-Identifier: Apache-2.0
"""The last page of an image: what distinguishes one board from another.

The firmware reads the same bytes as a struct (``firmware/app/settings.hpp``). Times are control
ticks unless a name says otherwise.
"""

import struct
import zlib
from dataclasses import dataclass

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
SWITCHES = ("unused", "minus", "zero", "plus", "steep-end", "shallow-end")
"""What a closed switch of the palm means, in the order of the numbers."""
_MAGIC = 0x42504D42
_FORMAT = 1
_MOST_TIMES = 16
_USUAL_ORDER_AGE = 20
_ROLE = 20
"""Place of the role among the fields."""
_STRUCT = struct.Struct("<IHH16s12I4H3Bb10B2H10B2H12h16H")


@dataclass(frozen=True, kw_only=True)
class BoardSettings:
    """What is written into the page."""

    role: int
    """0: the left robot, 1: the right one, 2: the radio of the station."""
    key: bytes
    pair: int
    first_epoch: int
    """Epoch of the first boot with the image."""
    last_epoch: int
    """The last that the image may use."""
    number: int
    """Equal for both boards if their settings are."""
    period_us: int
    watchdog_us: int
    lease: int
    station_limit: int
    time_limit: int
    travel: int
    """Time in mode carrying that covers the distance."""
    stopping_limit: int
    stopping: int
    turn_limit: int
    """Longest time in which a palm turns."""
    most_overruns: int
    state_period: int
    status_period: int
    least_battery_mv: int
    controller: int
    """The number of its program (`ControllerEntry.board_number`)."""
    channel: int
    power_dbm: int
    rejoins: bool
    stops_without_station: bool
    stops_without_partner: bool
    has_radio: bool
    leads: bool
    may_stop: bool
    by_touch: bool
    order_age: int = 0
    """Greatest age of an order, in periods of the status; 0: the usual one, 20."""
    is_under_way: bool = False
    """The carry begins at the boot, as in the simulator."""
    wheel_kind: int
    """0: servos, 1: a motor board."""
    debounce: int
    """Equal readings in a row that a switch needs."""
    palm_slew_us: int
    """Largest change of the palm's pulse in a tick."""
    wheel_slew: int
    """Largest change of a wheel's pulse or speed in a tick."""
    switches: tuple[int, ...]
    palm_us: tuple[int, int]
    """Pulses of the steep and of the shallow angle."""
    wheels: tuple[int, ...]
    """Pulses [us] or speeds of the left and the right wheel, by stop and move: 2 x 2 x 3."""
    times: tuple[int, ...]
    """Of the controller."""

    def packed(self) -> bytes:
        """The bytes, with their check."""
        times = (*self.times, *[0] * (_MOST_TIMES - len(self.times)))
        switches = (*self.switches, *[0] * (9 - len(self.switches)))
        order_age = 0 if self.order_age == _USUAL_ORDER_AGE else self.order_age
        body = _STRUCT.pack(
            _MAGIC, _FORMAT, self.pair, self.key, self.first_epoch, self.last_epoch, self.number,
            self.period_us, self.watchdog_us, self.lease, self.station_limit, self.time_limit,
            self.travel, self.stopping_limit, self.stopping, self.turn_limit, self.most_overruns,
            self.state_period, self.status_period, self.least_battery_mv, self.role,
            self.controller, self.channel, self.power_dbm, self.rejoins,
            self.stops_without_station, self.stops_without_partner,
            self.has_radio, self.leads, self.may_stop, self.by_touch, self.is_under_way,
            self.wheel_kind, self.debounce, self.palm_slew_us, self.wheel_slew, *switches,
            order_age, *self.palm_us, *self.wheels, *times,
        )  # fmt: skip
        return body + zlib.crc32(body).to_bytes(4, "little")


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


def _us(limits_s: tuple[float, float]) -> tuple[int, int]:
    return round(1e6 * limits_s[0]), round(1e6 * limits_s[1])


_LIMITS: dict[int, tuple[int, int]] = {
    5: (0, MAX_EPOCH),  # last_epoch
    7: _us(PERIODS_S),
    8: _us(WATCHDOGS_S),
    _ROLE: (0, 2),
    _ROLE + 2: (0, 100),  # channel
    _ROLE + 3: (-40, 8),  # power_dbm
    # From rejoins to wheel_kind.
    **{_ROLE + 4 + number: (0, 1) for number in range(9)},
    _ROLE + 13: (1, 0xFF),  # debounce
    **{_ROLE + 16 + number: (0, len(SWITCHES) - 1) for number in range(9)},
}
"""From the least to the most, for the places of the fields that a board cannot check itself."""
_WHEEL_KIND = _ROLE + 12
_WHEELS = (_us(PULSES_S), (-MOST_POWER, MOST_POWER))
"""Limits of the pulses [us] or of the speeds of the wheels, by the kind of the wheels."""


def _robot_limits(wheel_kind: int) -> dict[int, tuple[int, int]]:
    """Further limits of a robot's page: the station's radio has neither wheels nor a palm."""
    return {
        _ROLE + 14: (1, 0xFFFF),  # palm_slew_us; with 0 a palm never turns
        _ROLE + 15: (1, 0xFFFF),  # wheel_slew
        **{_ROLE + 26 + number: _us(PULSES_S) for number in range(2)},  # palm_us
        **{_ROLE + 28 + number: _WHEELS[wheel_kind] for number in range(12)},
    }


def role_in(page: bytes) -> int | None:
    """The role in the last page of an image; None: it holds no settings that a board accepts."""
    body, check = page[: _STRUCT.size], page[_STRUCT.size : _STRUCT.size + 4]
    if len(body) < _STRUCT.size or check != zlib.crc32(body).to_bytes(4, "little"):
        return None
    fields = _STRUCT.unpack(body)
    is_known = fields[:2] == (_MAGIC, _FORMAT)
    if not is_known or not _are_within(_LIMITS, fields):
        return None
    role, first, last = fields[_ROLE], fields[4], fields[5]
    if role == 2:
        return role
    is_meant = _are_within(_robot_limits(fields[_WHEEL_KIND]), fields)
    return role if is_meant and 1 <= first <= last else None


def _are_within(limits: dict[int, tuple[int, int]], fields: tuple[int, ...]) -> bool:
    return all(least <= fields[at] <= most for at, (least, most) in limits.items())
