# SPDX-License-Identifier: Apache-2.0
"""The steps of a calibration that turn the wheels: dead zone, wheels and trim, stopping time."""

import math

from palmbots.errors import PalmbotsError
from palmbots.pair.calibration_bench import Finding, Machine, Person, Task, finding
from palmbots.pair.estimates import Drive, Estimate, wheel_estimates

_RAMP_M_S = 0.001  # step of the commanded speed in the search for the dead zone
_HOLD_S = (0.3, 3.0)  # shortest and longest time for which a command is held
_STAYS_M_S = 0.006  # the command goes on by this much after the wheels have stopped
_SETTLE_S = 0.1  # at the start of a hold, until the wheels follow
_FASTEST_M_S = 0.2
_DRIVE_M_S = 0.08
_STOPS = 5
_MOST_STOPS = 10
_STILL_S = 0.5


def dead_zone(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """The commands at which the wheels begin to turn and stop turning, from the encoders."""
    person.ready(
        "Put the robot on the floor with half a metre of free floor before it. It moves slowly."
    )
    radius = machine.hardware.wheel_radius_m
    count_m = machine.count_rad * radius
    hold_s = min(max(count_m / _RAMP_M_S, _HOLD_S[0]), _HOLD_S[1])

    def held(speed_m_s: float) -> tuple[bool, bool]:
        """Whether each wheel turns while a command is held."""
        before = None
        counted = [False, False]
        for tick in range(math.ceil(hold_s / machine.period_s)):
            counts = machine.counts(machine.step(speed_m_s / radius, speed_m_s / radius))
            if before is not None and tick * machine.period_s > _SETTLE_S:
                for wheel in (0, 1):
                    counted[wheel] = counted[wheel] or counts[wheel] != before[wheel]
            before = counts
        return counted[0], counted[1]

    # A wheel that has begun to turn is faster by one step of the command in each hold. It counts at
    # the latest when it has turned by one count.
    late = 0
    while _RAMP_M_S * hold_s * late * (late + 1) / 2 < count_m:
        late += 1
    starts: dict[int, float] = {}
    command = 0.0
    while len(starts) < 2:
        command += _RAMP_M_S
        if command > _FASTEST_M_S:
            machine.stop()
            raise PalmbotsError(
                f"wheels: they do not turn up to a command of {_FASTEST_M_S:g} m/s; allowed: a "
                "motor board that has power"
            )
        for wheel, turns in enumerate(held(command)):
            if turns:
                starts.setdefault(wheel, command)
    stiction = Estimate(
        max(starts.values()),
        max(0.0, min(starts.values()) - (late + 1) * _RAMP_M_S),
        max(starts.values()),
    )
    command += 10 * _RAMP_M_S
    held(command)
    # The first command after the last one at which each wheel has counted. A wheel whose speed
    # happens to be 0 for a moment counts again; one that has stopped does not.
    stops = {0: command, 1: command}
    while command > 0 and min(stops.values()) - command < _STAYS_M_S:
        command = max(0.0, command - _RAMP_M_S)
        for wheel, turns in enumerate(held(command)):
            if turns:
                stops[wheel] = max(0.0, command - _RAMP_M_S)
    machine.rest(_STILL_S)
    unseen_m_s = count_m / (hold_s - _SETTLE_S)
    low = max(0.0, min(stops.values()) - unseen_m_s)
    high = max(stops.values()) + _RAMP_M_S
    dead = Estimate((low + high) / 2, low, high)
    value = 0.0 if low == 0 and high <= 2 * _RAMP_M_S else dead.value
    # A wheel has to start for certain, so the end of the interval is written.
    start = max(stiction.high, value) if stiction.high > 2 * _RAMP_M_S else value
    return [finding("dead_zone_m_s", dead, value), finding("stiction_m_s", stiction, start)]


def wheels(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """`wheel_scale` and `trim`, from a drive along a tape."""
    length = task.length_m
    machine.counts(machine.read())
    person.ready(
        f"Lay out a tape of at least {length + 0.3:g} m. Put the robot at its start: the mark "
        "halfway between the two wheels at 0 mm, on the edge of the tape, and the robot looking "
        "along it."
    )
    turn = length / 2 / machine.hardware.wheel_radius_m
    one = machine.drive(_DRIVE_M_S, turn)
    limit_mm = 500.0 * length
    half = person.number(
        "The robot is halfway. How far is its mark to the left of the edge? (right: negative)",
        "mm", -limit_mm, limit_mm,
    )  # fmt: skip
    two = machine.drive(_DRIVE_M_S, turn)
    along = person.number("How far has it come along the tape?", "mm", 500 * length, 2000 * length)
    offset = person.number(
        "How far is its mark to the left of the edge? (right: negative)", "mm", -limit_mm, limit_mm
    )
    rad = machine.count_rad
    measured = Drive(
        half / 1000, along / 1000, offset / 1000,
        (one[0] * rad, one[1] * rad),
        ((one[0] + two[0]) * rad, (one[1] + two[1]) * rad), rad,
    )  # fmt: skip
    hardware = machine.hardware
    scale, trim = wheel_estimates(measured, hardware.wheel_radius_m, hardware.wheel_separation_m)
    return [finding("wheel_scale", scale), finding("trim", trim)]


def stopping(machine: Machine, person: Person, task: Task) -> list[Finding]:
    """The time in which the wheels come to rest, from the encoders."""
    speed = task.speed_m_s
    machine.counts(machine.read())
    person.ready(
        f"Put the robot where it has {2 * _MOST_STOPS * speed:.1f} m of free floor before it. It "
        f"stops {_STOPS} times, or up to {_MOST_STOPS} times on a busy computer."
    )
    times: list[Estimate] = []
    for tries in range(_MOST_STOPS):
        missed = machine.missed
        one = _one_stop(machine, speed)
        # A late tick of this program makes a stop look longer. Such stops only fill up the number.
        if machine.missed == missed or _MOST_STOPS - tries <= _STOPS - len(times):
            times.append(one)
        if len(times) == _STOPS:
            break
    low, high = min(one.low for one in times), max(one.high for one in times)
    middle = sum(one.value for one in times) / len(times)
    # A longer time is the safe one: the end of the interval is written.
    return [finding("stopping_s", Estimate(middle, low, high), max(0.01, high))]


def _one_stop(machine: Machine, speed_m_s: float) -> Estimate:
    hardware, period_s = machine.hardware, machine.period_s
    dead, start = hardware.dead_zone_m_s, hardware.stiction_m_s
    counts = machine.counts(machine.read())
    for tick in range(math.ceil(1.0 / period_s)):
        command = speed_m_s + dead if tick * period_s > _STILL_S else max(speed_m_s + dead, start)
        rate = command / hardware.wheel_radius_m
        counts = machine.counts(machine.step(rate, rate))
    last = ticks = 0
    while (ticks - last) * period_s < _STILL_S:
        ticks += 1
        now = machine.counts(machine.step(0.0, 0.0))
        if now != counts:
            last, counts = ticks, now
    counted_s = last * period_s
    # After the last count a wheel moves by less than one further count, while it brakes evenly: for
    # the whole time T, T − counted ≤ √(2 count T / speed).
    share = math.sqrt(2 * machine.count_rad * hardware.wheel_radius_m / speed_m_s)
    longest_s = ((share + math.sqrt(share**2 + 4 * counted_s)) / 2) ** 2
    low, high = max(0.0, counted_s - 2 * period_s), longest_s + period_s
    return Estimate((low + high) / 2, low, high)
