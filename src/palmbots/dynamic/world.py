"""The dynamic world: MuJoCo moves it, this tells the motors what to do and sees what became of it.

Frame: that of `model`. All that is seen is of one instant, one integration step before the end of
the tick. A contact coordinate is where a vertex of the object is along its palm, from the foot of
the pivot, outward [m]. The tactile sensor feels where contact forces press (`switches`).
"""

import math
from typing import Any

import numpy as np

from palmbots import _core
from palmbots.dynamic.columns import Measured
from palmbots.dynamic.edges import STAYS, edges_of, fit_edges
from palmbots.dynamic.engine import mujoco
from palmbots.dynamic.model import layout, mjcf, steps_per_tick
from palmbots.dynamic.robot_model import axle_out, chassis
from palmbots.dynamic.settings import DEFAULT, Engine
from palmbots.dynamic.switches import Switches
from palmbots.dynamic.touches import Further, Kind, Rests, further_of
from palmbots.errors import PalmbotsError, SceneError
from palmbots.geometry import SIDES
from palmbots.scene import Scene

__all__ = ["SLACK", "MujocoWorld", "refuse_unknown"]

SLACK = math.radians(0.25)  # a wrist so near to its angle has turned; assumed
_SETTLE_S = 0.3  # before the carry, for weights to be taken up
_HEADING = 5.0  # 1/s, with which a robot steers back to its heading
_STICKS = 5e-4  # m/s; what moves less along its palm sticks
_LET_GO_S = 0.25  # an object that a palm has not borne for so long is not held any more
_TURNED = math.radians(60)  # an object turned further has tipped over
_OUT = (-1.0, 1.0)
Point = tuple[float, float, float]


def refuse_unknown(scene: Scene) -> None:
    """Raise `SceneError` for keys that this world cannot obey."""
    if scene.bumps.script or scene.bumps.rate_per_m > 0:
        raise SceneError(
            "bumps: shift contacts, which only the quasistatic world can do; allowed in mujoco: "
            "dynamic.ridges, bumps of the floor"
        )


class MujocoWorld:
    """A scene in MuJoCo, at rest at its start. `model` and `data` are MuJoCo's own."""

    def __init__(self, scene: Scene, engine: Engine = DEFAULT, measures: bool = True) -> None:
        """`measures`: keep `measured` up to date, which takes time."""
        refuse_unknown(scene)
        self._measures = measures
        self._mj = mujoco()
        self.scene = scene
        self.layout = layout(scene)
        self.model: Any = self._mj.MjModel.from_xml_string(mjcf(scene, engine))
        self.data: Any = self._mj.MjData(self.model)
        self.steps = steps_per_tick(scene)
        self._ticks, self.time_s = 0, 0.0
        self._period = scene.control.period_s
        self._track = chassis(self.layout.height, axle_out(scene)).track
        self._radius = scene.dynamic.wheel_radius_m
        left, right = self.layout.spec.palms
        self._steep = (left.steep, right.steep)
        self._set = list(self._steep)  # what the wrists' motors have been told so far [rad]
        self._find()
        self._unborne = [0.0, 0.0]
        self.motion = (0, 0)  # contacts over the last tick: slide inward −1, stick 0, outward 1
        self._rests = Rests()
        self._switches = [Switches(scene.dynamic) for _ in SIDES]
        self._loads = (0.0, 0.0)
        self.measured = Measured(*(11 * [(0.0, 0.0)]))
        self._settle()
        self._origin = self._midpoint()
        self._p = self._contacts()
        self._x = self._ways()
        self.across_peak = self.across

    # --- moving ---------------------------------------------------------------------------------

    def move(self, speeds: tuple[float, float], angles: tuple[float, float]) -> None:
        """One control period with wheels at `speeds` [m/s, towards +x] and wrists turning evenly to
        `angles` [rad]."""
        self._fit()
        ctrl = self.data.ctrl
        for k in (0, 1):
            steer = -0.5 * self._track * self._turning(k, speeds[k])
            port, starboard = self._wheels[k]
            ctrl[port] = (speeds[k] + steer) / self._radius
            ctrl[starboard] = (speeds[k] - steer) / self._radius
            ctrl[self._wrists[k]] = (angles[k] - self._set[k]) / self._period
            self._set[k] = angles[k]
        before = self.data.time
        self._mj.mj_step(self.model, self.data, nstep=self.steps)
        self._ticks += 1
        self.time_s = self._ticks * self._period
        if self.data.time < before:  # MuJoCo begins anew where numbers get out of hand
            raise PalmbotsError(
                f"mujoco: the simulation became unstable at {self.time_s:.2f} s; allowed: a "
                f"smaller dynamic.step_s than {self.scene.dynamic.step_s:g}, or masses of robots "
                "and object that differ less"
            )

    # --- seeing ---------------------------------------------------------------------------------

    def sight(self, first: bool = False) -> _core.Sight:
        """What is seen now, since the last time."""
        p, before = self._contacts(), self._p
        touched, pressed, force, drag = self._feel(p)
        x, last = self._ways(), self._x
        self._p, self._x = p, x
        if first:
            self._loads = force
        end = "" if first else self._end(p, (force[0] > 0, force[1] > 0))
        least = _STICKS * self._period
        left, right = (
            0 if abs(now - then) < least else (1 if now > then else -1)
            for now, then in zip(p, before, strict=True)
        )
        if self._measures:
            speed = ((x[0] - last[0]) / self._period, (x[1] - last[1]) / self._period)
            yaw = (self._yaw(0), self._yaw(1))
            self.measured = Measured(
                force, drag, speed, self._slips(speed), self._pitches(), yaw, self.across,
                *self._places(),
            )  # fmt: skip
        self.motion = (left, right)
        across, peak = self.across, self.across_peak
        self.across_peak = (max(peak[0], across[0], key=abs), max(peak[1], across[1], key=abs))
        vertices = self._vertices()
        return _core.Sight(
            contacts=p,
            lift=self._lifts(),
            touched=touched,
            pressed=pressed,
            palms=self._palms(),
            wrists=self.wrists(),
            separation=self._separation(x),
            midpoint=0.5 * (x[0] + x[1]) - self._origin,
            rise=vertices[1][2] - vertices[0][2],
            motion=self.motion,
            end=end,
        )

    def state(self) -> np.ndarray:
        """MuJoCo's state, to be looked at again later."""
        kind = int(self._mj.mjtState.mjSTATE_INTEGRATION)
        state = np.empty(self._mj.mj_stateSize(self.model, kind))
        self._mj.mj_getState(self.model, self.data, state, kind)
        return state

    def restore(self, state: np.ndarray) -> None:
        """Go back to a state of a moment when the motors held the palms steep."""
        kind = int(self._mj.mjtState.mjSTATE_INTEGRATION)
        self._mj.mj_setState(self.model, self.data, state, kind)
        self._mj.mj_forward(self.model, self.data)
        self._set = list(self._steep)

    @property
    def wrists_set(self) -> tuple[float, float]:
        """The palm angles that the wrists' motors have been told [rad]."""
        return self._set[0], self._set[1]

    @property
    def contacts(self) -> tuple[float, float]:
        """The contact coordinates p [m]."""
        return self._contacts()

    @property
    def lifts(self) -> tuple[float, float]:
        """Heights of the contact edges' middles above their palms [m]; < 0: palms give way."""
        return self._lifts()

    def touches(self, until_s: float) -> list[tuple[int, Kind, float, float]]:
        """When, until then, the object rested on more than its two contact vertices: on which
        palm, what began it (``flush``, ``tip``), from when to when [s]."""
        return self._rests.rows(until_s)

    @property
    def warnings(self) -> list[str]:
        """What the start gives rise to."""
        least = self.scene.dynamic.press_n
        return [
            f"the {side} palm bears {load:.2g} N at the start and dynamic.press_n is {least:g}: "
            "its switches stay open, which reads as 0"
            for side, load in zip(SIDES, self._loads, strict=True)
            if load < least
        ]

    @property
    def advance(self) -> float:
        """Of the midpoint of the pivots since the start, towards +x [m]."""
        return self._midpoint() - self._origin

    def wrists(self) -> tuple[float, float]:
        """The palm angles as the wrists measure them [rad]."""
        q = self.data.qpos
        return (
            float(q[self._wrist_at[0]]) + self._steep[0],
            float(q[self._wrist_at[1]]) + self._steep[1],
        )

    # --- inside ---------------------------------------------------------------------------------

    def _find(self) -> None:
        """Where in MuJoCo's arrays things are."""
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
        self._wrist_at = [int(m.joint(f"{side}_wrist").qposadr[0]) for side in SIDES]
        self._wheel_at = [
            [int(m.joint(f"{side}_{wheel}").dofadr[0]) for wheel in ("port", "starboard")]
            for side in SIDES
        ]
        self._shoulder_at = [int(m.joint(f"{side}_shoulder").qposadr[0]) for side in SIDES]
        self._shoulders = [m.actuator(f"{side}_shoulder").id for side in SIDES]
        bodies = {name: m.body(name).id for s in SIDES for name in (f"{s}_palm", f"{s}_body")}
        thing = m.body("object").id
        d = self.data
        # Views into MuJoCo's arrays: they follow it.
        self._palm_pos = [d.xpos[bodies[f"{s}_palm"]] for s in SIDES]
        self._palm_mat = [d.xmat[bodies[f"{s}_palm"]] for s in SIDES]
        self._body_mat = [d.xmat[bodies[f"{s}_body"]] for s in SIDES]
        self._thing_pos, self._thing_mat = d.xpos[thing], d.xmat[thing]
        spec = self.layout.spec
        self._offset = [palm.offset for palm in spec.palms]
        self._half = [palm.length / 2 for palm in spec.palms]
        self._aside = [self.scene.palm_of(side).width_m / 2 for side in SIDES]
        self._edges = edges_of(m, self.scene)
        self._width = spec.width
        self._is_palm = [str(m.geom(k).name).startswith(SIDES) for k in range(m.ngeom)]
        # The pairs of palm and object: of which palm, and what it is if not the contact vertex.
        self._touching: dict[tuple[int, int], tuple[int, Further | None]] = {}
        for pair in zip(m.pair_geom1.tolist(), m.pair_geom2.tolist(), strict=True):
            of_object = [k for k in pair if m.geom_bodyid[k] == thing]
            of_palm = [k for k in pair if self._is_palm[k]]
            if not of_object or any("_lip_" in m.geom(k).name for k in pair):
                continue  # lips hold sideways; no switch feels them
            side = SIDES.index(m.geom(of_palm[0]).name.split("_")[0])
            name = m.geom(of_object[0]).name
            own = name.startswith(f"vertex_{(0, spec.contact_right)[side]}_")
            what = None if own else further_of(side, name, self.layout)
            self._touching[pair] = self._touching[pair[::-1]] = (side, what)

    def _fit(self) -> None:
        """Contacts where edges and palms overlap, if they have moved."""
        if any(abs(y) > 2 * STAYS * half for y, half in zip(self.across, self._aside, strict=True)):
            fit_edges(self.model, self.data, self._edges)

    def _settle(self) -> None:
        """Weights are taken up, and shoulders told to hold against them."""
        ticks = max(1, round(_SETTLE_S / self._period))
        for tick in range(ticks):
            self.move((0.0, 0.0), self._steep)
            if 3 * tick < 2 * ticks:
                for at, shoulder in zip(self._shoulder_at, self._shoulders, strict=True):
                    self.data.ctrl[shoulder] -= 0.3 * float(self.data.qpos[at])
        self._ticks, self.time_s = (
            0,
            0.0,
        )  # MuJoCo's own clock goes on: that it falls back tells of a fault

    def _turning(self, k: int, speed: float) -> float:
        """How fast a robot is to turn, anticlockwise seen from above [rad/s]: to its heading."""
        return -_HEADING * self._yaw(k)

    def _ways(self) -> tuple[float, float]:
        """How far along the path the pivots are, towards +x at the start [m]: their x."""
        return float(self._palm_pos[0][0]), float(self._palm_pos[1][0])

    def _separation(self, ways: tuple[float, float]) -> float:
        return ways[1] - ways[0]

    def _midpoint(self) -> float:
        return 0.5 * sum(self._ways())

    def _vertices(self) -> tuple[Point, Point]:
        """The middles of the two contact edges (x, y, z)."""
        x, y, z = self._thing_pos.tolist()
        ax, _, _, ay, _, _, az, _, _ = self._thing_mat.tolist()
        w = self._width
        return (x, y, z), (x + w * ax, y + w * ay, z + w * az)

    def _seen(self, k: int, point: Point) -> Point:
        """A point as a palm sees it: outward along it, across to its left, above its surface."""
        pos, mat = self._palm_pos[k].tolist(), self._palm_mat[k].tolist()
        dx, dz = point[0] - pos[0], point[2] - pos[2]
        along = dx * mat[0] + dz * mat[6]
        above = dx * mat[2] + dz * mat[8] - self._offset[k]
        return _OUT[k] * along, point[1] - pos[1], above

    def _contacts(self) -> tuple[float, float]:
        left, right = self._vertices()
        return self._seen(0, left)[0], self._seen(1, right)[0]

    def _lifts(self) -> tuple[float, float]:
        left, right = self._vertices()
        return self._seen(0, left)[2], self._seen(1, right)[2]

    @property
    def across(self) -> tuple[float, float]:
        """Where the middle of each contact edge is across its palm, to the left seen towards +x
        [m]: no sensor feels it."""
        left, right = self._vertices()
        return self._seen(0, left)[1], self._seen(1, right)[1]

    def _palms(self) -> tuple[float, float]:
        left, right = self._palm_mat
        return (
            -math.atan2(float(left[6]), float(left[0])),
            math.atan2(float(right[6]), float(right[0])),
        )

    def _pitches(self) -> tuple[float, float]:
        left, right = self._body_mat
        return -math.asin(float(left[6])), math.asin(float(right[6]))

    def _yaw(self, k: int) -> float:
        mat = self._body_mat[k]
        return math.atan2(float(mat[3]), float(mat[0]))

    def _places(self) -> list[tuple[float, float]]:
        """Pivots and contact edges as seen from above: x, y, x, y."""
        one, two = (pos.tolist() for pos in self._palm_pos)
        left, right = self._vertices()
        return [(a[i], b[i]) for a, b in ((one, two), (left, right)) for i in (0, 1)]

    def _slips(self, speed: tuple[float, float]) -> tuple[float, float]:
        v = self.data.qvel
        left, right = (
            self._radius * 0.5 * (float(v[at[0]]) + float(v[at[1]])) - speed[k]
            for k, at in enumerate(self._wheel_at)
        )
        return left, right

    def _feel(
        self, p: tuple[float, float]
    ) -> tuple[tuple[float, float], tuple[bool, bool], tuple[float, float], tuple[float, float]]:
        """Where each palm is pressed, whether a switch is closed, and the forces on it."""
        # Of all else and of the contact vertex: force, force times place.
        sums = [[[0.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 0.0]]]
        drag = [0.0, 0.0]
        further: list[Further] = []
        contact, forces = self.data.contact, self.data.efc_force
        places, frames = contact.pos, contact.frame
        for i, (pair, address) in enumerate(
            zip(contact.geom.tolist(), contact.efc_address.tolist(), strict=True)
        ):
            touching = self._touching.get((pair[0], pair[1]))
            if touching is None or address < 0:
                continue
            k, what = touching
            push, one, other = forces[address : address + 3].tolist()
            sums[k][what is None][0] += push
            sums[k][what is None][1] += push * self._seen(k, places[i].tolist())[0]
            if what is not None and push > 0:
                further.append(what)
            if not self._measures:
                continue
            frame, mat = frames[i], self._palm_mat[k]
            # MuJoCo's force acts on the second geom; the palm takes it or gives it.
            sign = 1.0 if self._is_palm[pair[1]] else -1.0
            fx, fy, fz = (one * float(frame[3 + i]) + other * float(frame[6 + i]) for i in range(3))
            along = fx * float(mat[0]) + fy * float(mat[3]) + fz * float(mat[6])
            drag[k] += sign * _OUT[k] * along
        self._rests.see(
            self.time_s,
            [(w.side, w.kind(self._palm_mat[w.side], self._thing_mat)) for w in further],
        )
        for switches, loads in zip(self._switches, sums, strict=True):
            switches.feel(self.time_s, loads)
        one, other = self._switches
        return (
            (one.place if one.closed else p[0], other.place if other.closed else p[1]),
            (one.closed, other.closed),
            (sums[0][0][0] + sums[0][1][0], sums[1][0][0] + sums[1][1][0]),
            (drag[0], drag[1]),
        )

    def _end(self, p: tuple[float, float], borne: tuple[bool, bool]) -> str:
        """Why the object is not held any more; empty if it is. `borne`: each palm bears some of
        it."""
        if any(abs(at) > half for at, half in zip(p, self._half, strict=True)):
            return "off-palm"
        if any(abs(y) > half for y, half in zip(self.across, self._aside, strict=True)):
            return "off-palm"
        if float(self._thing_mat[8]) < math.cos(_TURNED):
            return "tipping"
        for k in (0, 1):
            self._unborne[k] = 0.0 if borne[k] else self._unborne[k] + self._period
        return "lifting" if max(self._unborne) > _LET_GO_S else ""
