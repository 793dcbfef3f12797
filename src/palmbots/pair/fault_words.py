# SPDX-License-Identifier: Apache-2.0
"""What a robot's fault code means, and what to do about it."""

from dataclasses import dataclass

from palmbots.wire import FaultCode


@dataclass(frozen=True)
class FaultWords:
    """The meaning of one fault code."""

    about: str
    """The part of a robot that it is about."""
    meaning: str
    """What is wrong."""
    remedy: str
    """What to do."""


FAULT_WORDS: dict[FaultCode, FaultWords] = {
    "driver": FaultWords(
        "driver", "its motor board does not answer", "check its power, cable and [driver]"
    ),
    "contact": FaultWords(
        "contact", "no contact is sensed", "put the object on the palm, or calibrate"
    ),
    "palm": FaultWords(
        "palm",
        "the palm is not at its angle",
        "wait while it turns; if it does not arrive, free the palm, or calibrate the servo",
    ),
    "battery": FaultWords("battery", "the battery is low", "charge it"),
    "partner_lost": FaultWords(
        "link",
        "it does not hear its partner",
        "check that the partner's program runs, and the radio (palmbots doctor), then arm again",
    ),
    "station_lost": FaultWords(
        "link", "it has lost the station", "check the radio (palmbots doctor), then arm again"
    ),
    "time_limit": FaultWords(
        "mode", "a carry took too long", "arm again, or raise limits.time_limit_s"
    ),
    "overrun": FaultWords(
        "clock",
        "its control loop is too slow, or its driver waits",
        "end other programs on its computer; palmbots doctor --side, on it, times the driver",
    ),
    "storage": FaultWords("storage", "it cannot store its state", "make room on its disk"),
    "settings": FaultWords(
        "settings", "its partner has other settings", "copy pair.toml and the scene"
    ),
    "stopping": FaultWords(
        "stopping",
        "hardware.stopping_s exceeds robot.speed_m_s / robot.acceleration_m_s2 of the scene",
        "lower the acceleration in the scene (a lower speed needs a lower one, too), or make the "
        "motors brake harder and calibrate again",
    ),
    "partner": FaultWords(
        "mode", "its partner has ended the carry", "see the partner, then arm again"
    ),
    "stop": FaultWords("mode", "a stop is in force at its partner", "release the stop"),
    "arm": FaultWords(
        "arm",
        "its arm is not where a job on the floor begins",
        "take the object off the palms of the disarmed robots: their arms then go down",
    ),
    "job": FaultWords(
        "mode",
        "it has tried its job on the floor as often as it may",
        "see palmbots analyze; put the object where the job begins, then arm again",
    ),
}
"""The words of every fault code but ``none``."""


def fault_line(fault: FaultCode) -> str:
    """The code with its meaning and remedy, in one line."""
    words = FAULT_WORDS.get(fault)
    return fault if words is None else f"{fault}: {words.meaning}; {words.remedy}"
