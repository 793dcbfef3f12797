# SPDX-License-Identifier: Apache-2.0
"""Motors and sensors of one simulated robot with imperfections (`ImperfectRobot`).

A motor turns at the commanded rate less the dead zone, and starts only against stiction. The gain,
the noise and the bias of the scene's robots are errors of the motors, with the random numbers of a
carry with the same seed: encoders count them.
"""

import math

from palmbots._core import WheelErrors
from palmbots._types import SIDES, Side
from palmbots.drivers.arm import arm_shape
from palmbots.drivers.driver import RawCommand, RawReading
from palmbots.scene.robot_section import Zone
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.imperfections import ImperfectionParameters

REST = RawCommand((0.0, 0.0))


def zones_of(scene: Scene, side: Side) -> tuple[Zone, ...]:
    """The zones of the scene's tactile sensor, as switches of one palm."""
    if scene.tactile.zones is not None:
        return scene.tactile.zones
    middle, half = scene.tactile.zero_half_width_m, scene.palm_of(side).length_m / 2
    return (
        Zone(sign="-", from_m=-half, to_m=-middle),
        Zone(sign="0", from_m=-middle, to_m=middle),
        Zone(sign="+", from_m=middle, to_m=half),
    )


class ImperfectRobot:
    """One robot, tick by tick.

    Args:
        params: what it really is.
        scene: speeds, noise and palm of the robot.
        side: which robot of the pair.
        seed: of the noise.
    """

    def __init__(self, params: ImperfectionParameters, scene: Scene, side: Side, seed: int) -> None:
        self._params = params
        palm = scene.palm_of(side)
        self._errors = WheelErrors(to_spec(scene, unrolled=True), SIDES.index(side), seed)
        self._period_s = scene.control.period_s
        leads = (side == "right") == (scene.task.direction == "forward")
        self._sense = -1 if leads else 1  # of its forward direction, along the direction of travel
        self._palm_rate = math.radians(palm.rate_deg_s)
        self._zones = zones_of(scene, side) if params.switches is None else params.switches
        self._rates = [0.0, 0.0]  # of the wheels [rad/s]
        self._turning_s = 0.0
        self._is_turning = False
        half = 0.5 * params.trim
        self.rims = (
            params.wheel_radius_m * params.wheel_scale * (1 + half),
            params.wheel_radius_m * params.wheel_scale * (1 - half),
        )
        """What one radian of each wheel really covers [m]."""
        self.palm_rad = math.radians(palm.steep_deg)
        """Where the servo turns the palm [rad]."""
        self._arm = arm_shape(scene, side)
        self.pivot_m = self._arm.floors_m[0]
        """Height of the pivot over the floor."""

    @property
    def battery_v(self) -> float:
        """The voltage of the battery."""
        params = self._params
        sag = params.battery_sag_v if self._is_turning else 0.0
        drained = params.battery_drain_v_per_min * self._turning_s / 60
        return max(0.0, params.battery_v - sag - drained)

    def move(self, command: RawCommand) -> tuple[float, float]:
        """Run the motors for one tick; returns the speeds of the rims of the wheels [m/s]."""
        params = self._params
        strength = 1.0
        if params.battery_slows and params.battery_v > 0:
            strength = self.battery_v / params.battery_v
        most = params.motor_acceleration_m_s2 * self._period_s / params.wheel_radius_m
        for wheel, wanted in enumerate(command.wheels_rad_s):
            rate = self._rates[wheel]
            size = abs(wanted) * params.wheel_radius_m
            least = params.dead_zone_m_s if rate else params.stiction_m_s
            is_on = wanted != 0 and size >= least
            over = (size - params.dead_zone_m_s) * strength if is_on else 0.0
            target = math.copysign(max(0.0, over), wanted) / params.wheel_radius_m
            self._rates[wheel] = max(rate - most, min(rate + most, target))
        self._is_turning = any(self._rates)
        self._turning_s += self._period_s * self._is_turning
        error = self._sense * self._errors.step() / params.wheel_radius_m
        creep = self._sense * self._errors.held / params.wheel_radius_m
        gain = self._errors.gain
        left, right = (
            rim * (gain * rate + error if rate else creep)  # brakes hold a wheel that rests
            for rim, rate in zip(self.rims, self._rates, strict=True)
        )
        self._turn(command.servo_rad)
        self._raise(command.arm_rad)
        return left, right

    def _raise(self, arm_rad: float | None) -> None:
        if arm_rad is None:
            return
        params, arm = self._params, self._arm
        way = params.arm_top_deg - params.arm_floor_deg
        share = (math.degrees(arm_rad) - params.arm_floor_deg) / way
        target = arm.floors_m[0] + share * (arm.top_m - arm.floors_m[0])
        most = arm.rate_m_s * self._period_s
        moved = max(self.pivot_m - most, min(self.pivot_m + most, target))
        self.pivot_m = max(moved, arm.floors_m[0])

    def _turn(self, servo_rad: float | None) -> None:
        if servo_rad is None:
            return
        params = self._params
        target = (servo_rad - math.radians(params.servo_zero_deg)) / params.servo_scale
        most = self._palm_rate * self._period_s
        self.palm_rad = max(self.palm_rad - most, min(self.palm_rad + most, target))

    def reading(
        self, rolled_m: tuple[float, float], pressed_m: float | None, palm_rad: float
    ) -> RawReading:
        """What the sensors read.

        Args:
            rolled_m: what the rims of the wheels have rolled forward.
            pressed_m: contact coordinate at which the palm is pressed; None: nowhere.
            palm_rad: angle of the palm.
        """
        params = self._params
        counts = None
        if params.encoder_ticks_per_turn > 0:
            left, right = (
                float(math.floor(rolled / rim / (2 * math.pi) * params.encoder_ticks_per_turn))
                for rolled, rim in zip(rolled_m, self.rims, strict=True)
            )
            counts = (left, right)
        servo = None
        if params.servo_reports:
            servo = math.radians(params.servo_zero_deg) + params.servo_scale * palm_rad
        closed = tuple(
            pressed_m is not None and zone.from_m <= pressed_m <= zone.to_m for zone in self._zones
        )
        return RawReading(counts, closed, servo, round(self.battery_v, 3))
