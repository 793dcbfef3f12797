# SPDX-License-Identifier: Apache-2.0
"""The table ``[board]`` of ``pair.toml``: robots whose program runs on a microcontroller board."""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots.scene.fields import Range, Switch, field_error, whole
from palmbots.scene.section import Section

Channel = Annotated[int, BeforeValidator(whole(0, 100))]
PULSES_S = (0.0005, 0.0025)
"""Shortest and longest pulse of a servo."""
PulseLength = Annotated[float, BeforeValidator(Range("s", least=PULSES_S[0], most=PULSES_S[1]))]
PulseChange = Annotated[float, BeforeValidator(Range("s", least=0.00001, most=0.001))]
Bounce = Annotated[float, BeforeValidator(Range("s", least=0, most=0.5))]
Timeout = Annotated[float, BeforeValidator(Range("s", least=0, most=10))]


class BoardTable(Section):
    """[board] Robots on microcontroller boards; `palmbots firmware` reads it."""

    name: Literal["microbit-v2"] = "microbit-v2"
    """microbit-v2: BBC micro:bit with an nRF52833."""
    wheels: Literal["servos", "motor-board"] = "servos"
    """servos: two servos that turn without end; motor-board: motors behind an I²C motor board."""
    channel: Channel = 60
    """Radio channel, in MHz above 2400 MHz."""
    power_dbm: Literal[-40, -20, -16, -12, -8, -4, 0, 2, 3, 4, 5, 6, 7, 8] = 4
    """Transmission power, in dBm."""
    wheel_rest_s: PulseLength = 0.0015
    """Length of the pulse at which a wheel servo rests."""
    wheel_full_s: PulseChange = 0.0005
    """By how much the pulse is longer at hardware.full_speed_m_s."""
    motor_timeout_s: Timeout = 0.0
    """Time after which the motor board stops the wheels by itself when it gets no command. 0: it
    keeps its last speed, and is refused."""
    bounce_s: Bounce = 0.005
    """Longest time for which a switch bounces; the default is assumed."""
    goal_switch: Switch = False
    """In a job on the floor, switch 6 closes where the object is to be put down. Without it a robot
    travels for the time that the distance takes at its speed."""
    stand_switch: Switch = False
    """In a job from a stand, a switch closes where the robot is below the object: switch 6, or 5
    with goal_switch. Such a job needs it."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        most = min(self.wheel_rest_s - PULSES_S[0], PULSES_S[1] - self.wheel_rest_s)
        if self.wheel_full_s > most + 1e-9:
            raise field_error(
                self.wheel_full_s,
                f"makes pulses shorter than {PULSES_S[0]:g} s or longer than {PULSES_S[1]:g} s",
                f"at most {most:g} s around wheel_rest_s, {self.wheel_rest_s:g} s",
                "wheel_full_s",
            )
        return self
