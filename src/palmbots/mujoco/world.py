# SPDX-License-Identifier: Apache-2.0
"""The scene in MuJoCo: it commands the motors and observes contacts, palms and robots.

Frame: that of `mjcf`. An observation belongs to one instant, one integration step before the end of
the tick. A contact coordinate is the position of a vertex of the object along its palm, from the
foot of the pivot, outward [m]. The tactile sensor reports where contact forces act (`switches`).
"""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.mujoco.contact_events import ContactEventTracker, Kind
from palmbots.mujoco.contact_forces import PalmContacts, PalmLoads
from palmbots.mujoco.edge_contacts import STAYS, edges_of, fit_edges
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.engine_settings import DEFAULT, Engine
from palmbots.mujoco.mjcf import layout, mjcf, steps_per_tick
from palmbots.mujoco.pair_places import PairPlaces
from palmbots.mujoco.switches import Switches
from palmbots.mujoco.trace_columns import Measured
from palmbots.scene.chassis import axle_out, chassis
from palmbots.scene.scene import Scene
from palmbots.simulation.carry_ends import ends_in

SLACK = math.radians(0.25)  # a wrist this close to its target has reached it; assumed
_SETTLE_S = 0.3  # before the carry, until motors and contacts carry the weights
HEADING = 5.0  # 1/s, gain with which a robot steers back to its heading
_STICKS = 5e-4  # m/s; a contact that moves more slowly along its palm sticks
_LET_GO_S = 0.25  # without load on a palm for this long, the object is no longer held
_PITCHED = math.radians(10)  # a robot that pitches by more than the floor and this has tipped
TURNED = math.radians(60)  # an object turned further has tipped over
_ENDS = ends_in("carried")


class MujocoWorld(PairPlaces):
    """A scene in MuJoCo, at rest at its start. `model` and `data` are MuJoCo's own."""

    def __init__(
        self,
        scene: Scene,
        engine: Engine = DEFAULT,
        measures: bool = True,
        pivot_heights_m: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """`measures`: keep `measured` up to date, which takes time. `pivot_heights_m`: of the
        pivots over where the scene has them."""
        self._measures = measures
        self._mj = mujoco()
        text = mjcf(scene, engine, pivot_heights_m)
        model = self._mj.MjModel.from_xml_string(text)
        super().__init__(scene, layout(scene, pivot_heights_m), model, self._mj.MjData(model))
        self.steps = steps_per_tick(scene)
        self._ticks, self.time_s = 0, 0.0
        self._period = scene.control.period_s
        self._track = chassis(self.layout.height, axle_out(scene)).track
        self._set = list(self._first)  # commanded wrist angles [rad]
        self._find()
        self._unloaded_s = [0.0, 0.0]
        self.motion = (0, 0)  # contacts in the last tick: −1 slides inward, 0 sticks, 1 outward
        self._events = ContactEventTracker()
        self._switches = [Switches(scene.mujoco) for _ in SIDES]
        self._loads = (0.0, 0.0)
        self.measured = Measured(*(11 * [(0.0, 0.0)]))
        self._settle()
        self._origin = self._midpoint()
        self._p = self.contacts
        self._x = self._distances()
        self.lateral_peak = self.lateral
        self.wheel_slip = (0.0, 0.0)  # m, path of the rims minus that of the robots

    # --- moving ---------------------------------------------------------------------------------

    def move(self, speeds: tuple[float, float], angles: tuple[float, float]) -> None:
        """Simulate one control period: robots that keep their heading at `speeds` [m/s, towards
        +x], wrists turning at a constant rate to `angles` [rad]."""
        steer = [-0.5 * self._track * self._turning(k, speeds[k]) for k in (0, 1)]
        left, right = ((speed + by, speed - by) for speed, by in zip(speeds, steer, strict=True))
        self.turn_wheels((left, right), angles)

    def turn_wheels(
        self,
        rims: tuple[tuple[float, float], tuple[float, float]],
        angles: tuple[float, float],
    ) -> None:
        """The same with the speeds of the rims of the port and the starboard wheel of each robot
        [m/s, towards +x]; nobody steers."""
        self._fit()
        ctrl = self.data.ctrl
        for k in (0, 1):
            for wheel, rim in zip(self._wheels[k], rims[k], strict=True):
                ctrl[wheel] = rim / self._radius
            ctrl[self._wrists[k]] = (angles[k] - self._set[k]) / self._period
            self._set[k] = angles[k]
        before = self.data.time
        self._mj.mj_step(self.model, self.data, nstep=self.steps)
        self._ticks += 1
        self.time_s = self._ticks * self._period
        if self.data.time < before:  # MuJoCo resets itself when the simulation diverges
            raise PalmbotsError(
                f"mujoco: the simulation became unstable at {self.time_s:.2f} s; allowed: a "
                f"smaller mujoco.step_s than {self.scene.mujoco.step_s:g}, or masses of robots "
                "and object that differ less"
            )

    def step(
        self,
        rims: tuple[tuple[float, float], tuple[float, float]],
        angles: tuple[float, float],
    ) -> None:
        """`turn_wheels` and `sight`: one control period of a world that is driven from outside."""
        self.turn_wheels(rims, angles)
        self.sight()

    # --- observing ------------------------------------------------------------------------------

    def sight(self, first: bool = False) -> _core.WorldObservation:
        """Observe the present instant; motions are those since the last call."""
        p, before = self.contacts, self._p
        touched, pressed, loads = self._feel(p)
        force = loads.force
        x, last = self._distances(), self._x
        self._p, self._x = p, x
        if first:
            self._loads = force
        self.touched, self.is_pressed = touched, pressed
        heel = loads.heel
        self.end = "" if first else self._end(p, (force[0] + heel[0] > 0, force[1] + heel[1] > 0))
        threshold = _STICKS * self._period
        left, right = (
            0 if abs(now - then) < threshold else (1 if now > then else -1)
            for now, then in zip(p, before, strict=True)
        )
        speed = ((x[0] - last[0]) / self._period, (x[1] - last[1]) / self._period)
        slips = self._wheel_slips(speed)
        if not first:
            step = self.layout.spec.direction * self._period
            (left_m, right_m), (left_v, right_v) = self.wheel_slip, slips
            self.wheel_slip = (left_m + step * left_v, right_m + step * right_v)
        if self._measures:
            yaw = (self._yaw(0), self._yaw(1))
            self.measured = Measured(
                force, loads.friction, speed, slips, self._pitches(), yaw,
                self.lateral, *self._places(),
            )  # fmt: skip
        self.motion = (left, right)
        lateral, peak = self.lateral, self.lateral_peak
        self.lateral_peak = (max(peak[0], lateral[0], key=abs), max(peak[1], lateral[1], key=abs))
        vertices = self._vertices()
        return _core.WorldObservation(
            contacts=p,
            lift=self.lifts,
            touched=touched,
            pressed=pressed,
            palms=self._palms(),
            wrists=self.wrists(),
            separation=self._separation(x),
            midpoint=0.5 * (x[0] + x[1]) - self._origin,
            rise=vertices[1][2] - vertices[0][2],
            motion=self.motion,
            reason=self.end,
            **self._floor_state(),
            turn=math.atan2(float(self._object_mat[6]), float(self._object_mat[0])),
        )

    def state(self) -> np.ndarray:
        """MuJoCo's complete state, for `restore` and for videos."""
        kind = int(self._mj.mjtState.mjSTATE_INTEGRATION)
        state = np.empty(self._mj.mj_stateSize(self.model, kind))
        self._mj.mj_getState(self.model, self.data, state, kind)
        return state

    def restore(self, state: np.ndarray) -> None:
        """Return to a state in which the motors held the palms at their first angles."""
        kind = int(self._mj.mjtState.mjSTATE_INTEGRATION)
        self._mj.mj_setState(self.model, self.data, state, kind)
        self._mj.mj_forward(self.model, self.data)
        self._set = list(self._first)

    @property
    def pressed(self) -> tuple[float | None, float | None]:
        """Contact coordinate [m] at which each palm is pressed; None: too lightly."""
        left, right = (
            at if is_closed else None
            for at, is_closed in zip(self.touched, self.is_pressed, strict=True)
        )
        return left, right

    @property
    def wrists_set(self) -> tuple[float, float]:
        """The commanded palm angles [rad]."""
        return self._set[0], self._set[1]

    def contact_events(self, until_s: float) -> list[tuple[int, Kind, float, float]]:
        """Further contacts until a time: palm, kind (``flush``, ``tip``), start and end [s]."""
        return self._events.rows(until_s)

    @property
    def warnings(self) -> list[str]:
        """Warnings about the start."""
        threshold = self.scene.mujoco.switch_force_n
        return [
            f"the {side} palm carries {load:.2g} N at the start, less than "
            f"mujoco.switch_force_n = {threshold:g}: its switches stay open and report 0"
            for side, load in zip(SIDES, self._loads, strict=True)
            if load < threshold
        ]

    @property
    def advance(self) -> float:
        """Advance of the midpoint of the pivots since the start, towards +x [m]."""
        return self._midpoint() - self._origin

    # --- inside ---------------------------------------------------------------------------------

    def _find(self) -> None:
        """Look up the motors, and what ends a carry."""
        m = self.model
        self._wheels = [
            tuple(
                [m.actuator(f"{side}_{wheel}_{part}").id for part in ("angle", "speed")]
                for wheel in ("port", "starboard")
            )
            for side in SIDES
        ]
        self._wrists = [
            [m.actuator(f"{side}_wrist_{part}").id for part in ("angle", "speed")] for side in SIDES
        ]
        highest = max((ridge.height_m for ridge in self.scene.mujoco.ridges), default=0.0)
        at = chassis(self.layout.height, axle_out(self.scene))
        self._tipped = _PITCHED + math.atan(highest / abs(at.axle - at.caster))
        # Inward and outward. Outward, only the heel ends a palm that has one.
        self._reach = [
            (palm.length / 2, palm.length) if palm.stops else (palm.usable / 2, palm.usable / 2)
            for palm in self.layout.spec.palms
        ]
        self._half_width = [self.scene.palm_of(side).width_m / 2 for side in SIDES]
        self._edges = edges_of(self.model, self.scene)
        self._palm_contacts = PalmContacts(self.model, self.layout)

    def _fit(self) -> None:
        """Move the contact edges to their overlap with the palms, if they have shifted."""
        if any(
            abs(y) > 2 * STAYS * half
            for y, half in zip(self.lateral, self._half_width, strict=True)
        ):
            fit_edges(self.model, self.data, self._edges)

    def _settle(self) -> None:
        """Let the motors take up the weights, and adjust the shoulders to hold them level."""
        ticks = max(1, round(_SETTLE_S / self._period))
        for tick in range(ticks):
            self.move((0.0, 0.0), self._first)
            if 3 * tick < 2 * ticks:
                self._adjust_arms()
        # MuJoCo's own clock runs on: `move` detects a divergence by a step back of that clock.
        self._ticks, self.time_s = 0, 0.0

    def _adjust_arms(self) -> None:
        for side in SIDES:
            at = int(self.model.joint(f"{side}_shoulder").qposadr[0])
            shoulder = self.model.actuator(f"{side}_shoulder").id
            self.data.ctrl[shoulder] -= 0.3 * float(self.data.qpos[at])

    def _floor_state(self) -> dict[str, Any]:
        """What is observed of a job on the floor only."""
        return {}

    def _turning(self, k: int, speed: float) -> float:
        """The turning rate with which a robot steers to its heading, anticlockwise seen from
        above [rad/s]."""
        return -HEADING * self._yaw(k)

    def _wheel_slips(self, speed: tuple[float, float]) -> tuple[float, float]:
        v = self.data.qvel
        left, right = (
            self._radius * 0.5 * (float(v[at[0]]) + float(v[at[1]])) - speed[k]
            for k, at in enumerate(self._wheel_at)
        )
        return left, right

    def _feel(
        self, p: tuple[float, float]
    ) -> tuple[tuple[float, float], tuple[bool, bool], PalmLoads]:
        """Where each palm is pressed, whether a switch is closed, and the loads."""
        loads = self._palm_contacts.loads(
            self.data, self._in_palm_frame, self._palm_mat, with_friction=self._measures
        )
        self._events.update(
            self.time_s,
            [(w.side, w.kind(self._palm_mat[w.side], self._object_mat)) for w in loads.further],
        )
        for switches, sums in zip(self._switches, self._pressing(p, loads), strict=True):
            switches.update(self.time_s, sums)
        one, other = self._switches
        pressed = one.place if one.closed else p[0], other.place if other.closed else p[1]
        return pressed, (one.closed, other.closed), loads

    def _pressing(self, p: tuple[float, float], loads: PalmLoads) -> list[list[list[float]]]:
        """What may close switches, by palm: forces [N] and their moments [N m]."""
        return loads.sums

    @property
    def _ends(self) -> dict[str, str]:
        """The reason for which each event ends the carry in this phase of the task."""
        return _ENDS

    def _end(self, p: tuple[float, float], loaded: tuple[bool, bool]) -> str:
        """Why the carry ends; empty if it goes on. `loaded`: each palm, or its heel, carries
        some of the weight of the object."""
        ends = self._ends
        for k in (0, 1):
            is_held = loaded[k] or "lifting" not in ends
            self._unloaded_s[k] = 0.0 if is_held else self._unloaded_s[k] + self._period
        return next((ends[event] for event in self._happens(p) if event in ends), "")

    def _happens(self, p: tuple[float, float]) -> Iterator[str]:
        if max(map(abs, self._pitches())) > self._tipped:
            yield "robot tipped"
        if any(not -low <= at <= high for at, (low, high) in zip(p, self._reach, strict=True)):
            yield "off-palm"
        if any(abs(y) > half for y, half in zip(self.lateral, self._half_width, strict=True)):
            yield "off-palm"
        if self._width > 0 and float(self._object_mat[8]) < math.cos(TURNED):
            yield "tipping"
        if max(self._unloaded_s) > _LET_GO_S:
            yield "lifting"
