# SPDX-License-Identifier: Apache-2.0
"""Conversion of a scene to the `Spec` that the core runs.

A `Spec` has SI units and radians, the object in its own frame, left and right resolved, and times
in control periods. All its numbers affect the trace. They are therefore computed with + − × ÷ √ and
the core's own tangent only, and the spec of a mirrored scene is the mirror image of the scene's
spec to the last bit.
"""

import math

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.arguments import show
from palmbots.errors import SceneError
from palmbots.scene.faults_section import Fault
from palmbots.scene.object_frame import object_frame
from palmbots.scene.palm_section import PalmParameters
from palmbots.scene.radio_section import MessageFault
from palmbots.scene.robot_section import RobotParameters, Tactile
from palmbots.scene.scene import Scene

_RADIANS_PER_DEGREE = math.pi / 180
_EFFECTS = ("lost", "delayed", "duplicated")
_SIGNS = {"-": -1, "0": 0, "+": 1}
_SENDERS = (*SIDES, "station")
_FAULTS = (  # in the core's order
    "reboot", "freeze", "stuck", "intermittent", "station-down", "clock-rate", "clock-jump",
)  # fmt: skip
_LOSES_BOOT_COUNTER, _PALM_GOES_LIMP = 1, 2
_PER_MILLION = 1e-6


def refuse_curved(scene: Scene) -> None:
    """Raise `SceneError` for a curved path, which planar mechanics does not cover."""
    if scene.task.path.is_curved:
        raise SceneError(
            f"task.path.kind: {show(scene.task.path.kind)} is a curved path, but the quasistatic "
            "world and its mechanics are planar; allowed: straight, or carry --world mujoco"
        )


def _or_that_of_all(value: float | None) -> float:
    """A value of one direction; negative: the one of all links counts."""
    return -1.0 if value is None else value


def to_spec(scene: Scene, *, unrolled: bool = False) -> _core.Spec:
    """The core's description of a scene; left is index 0, right index 1.

    The core is planar. With `unrolled` a curved path is replaced by a straight one of its length;
    without it, a curved path raises `SceneError`.
    """
    if not unrolled:
        refuse_curved(scene)
    spec = _core.Spec()
    frame = object_frame(scene.object.vertices_m, scene.object.contacts, scene.object.com_m)
    spec.width = frame.width
    spec.com_left = frame.com.from_left
    spec.com_right = frame.com.from_right
    spec.com_height = frame.com.height
    spec.outline = [(c.from_left, c.from_right, c.height) for c in frame.outline]
    spec.contact_right = frame.contact_right

    left, right = (_palm(scene.palm_of(side)) for side in SIDES)
    spec.palms = (left, right)
    left, right = (_robot(scene.robot_of(side)) for side in SIDES)
    left.stride, right.stride = (scene.stride_of(side) for side in SIDES)
    spec.robots = (left, right)
    spec.zones = _zones(scene.tactile)
    spec.false_rate = scene.tactile.false_rate
    spec.period = scene.control.period_s
    spec.latency = scene.radio.latency_s
    spec.jitter = scene.radio.jitter_s
    spec.loss = scene.radio.loss
    spec.duplicate = scene.radio.duplicate
    spec.corruption = scene.radio.corruption
    spec.reorders = scene.radio.reorder
    spec.sessions = scene.radio.sessions
    spec.burst_share = scene.radio.burst_fraction
    spec.burst_mean = scene.radio.burst_s
    spec.airtime = scene.radio.airtime_s
    spec.directions = [
        (_or_that_of_all(d.latency_s), _or_that_of_all(d.jitter_s), _or_that_of_all(d.loss))
        for d in (scene.radio.left, scene.radio.right, scene.radio.station)
    ]
    spec.replay = scene.radio.replay
    spec.replay_delay = scene.radio.replay_within_s
    spec.beacon = scene.radio.beacon_s
    spec.lease = scene.radio.lease_s or 0.0
    spec.outages = [(_SENDERS.index(o.sender), o.start_s, o.end_s) for o in scene.radio.outages]
    spec.message_faults = [
        (_link(m), m.message, _EFFECTS.index(m.effect), m.delay_s or 0.0)
        for m in scene.radio.script
    ]
    spec.brake = scene.control.brake
    spec.start_by_touch = scene.control.start == "touch"
    spec.watchdog = scene.control.watchdog_s
    spec.faults = [_fault(fault) for fault in scene.faults.script]
    spec.random_reboots = scene.faults.random_reboots
    spec.reboot = scene.faults.reboot_s
    spec.bumps = [
        (
            SIDES.index(bump.robot),
            bump.at_s is not None,
            bump.at_s if bump.at_s is not None else bump.at_m or 0.0,
            bump.shift_m,
        )
        for bump in scene.bumps.script
    ]
    spec.pushes = [
        (SIDES.index(push.robot), push.at_s, push.duration_s, push.speed_m_s)
        for push in scene.bumps.pushes
    ]
    spec.bump_rate = scene.bumps.rate_per_m
    spec.bump_max = scene.bumps.max_shift_m
    spec.start = (scene.start.left_m, scene.start.right_m)

    task = scene.task
    spec.distance = task.distance_m
    spec.direction = 1 if task.direction == "forward" else -1
    # Uphill in the direction of travel pulls the object back: towards −x when travelling forward.
    spec.slope = spec.direction * _core.tangent(_radians(task.slope_deg)) + 0.0
    spec.inertia = 1.0 if task.inertia else 0.0
    spec.inertia_lag = task.inertia_tau_s
    spec.timeout_ticks = scene.timeout_ticks
    # A limp palm may turn to any angle.
    spec.safe_reach = -1.0 if spec.may_go_limp else _core.safe_reach(spec)
    return spec


def _link(fault: MessageFault) -> int:
    """The link of a message, as the core numbers them."""
    if fault.sender == "station":
        return 2 + SIDES.index(fault.receiver or "left")
    return SIDES.index(fault.sender)


def _radians(degrees: float) -> float:
    return degrees * _RADIANS_PER_DEGREE


def _palm(palm: PalmParameters) -> _core.PalmSpec:
    spec = _core.PalmSpec()
    spec.length = palm.length_m
    spec.offset = palm.pivot_offset_m
    spec.friction = palm.friction
    spec.shallow = _radians(palm.shallow_deg)
    spec.steep = _radians(palm.steep_deg)
    spec.rate = _radians(palm.rate_deg_s)
    return spec


def _robot(robot: RobotParameters) -> _core.RobotSpec:
    spec = _core.RobotSpec()
    spec.speed = robot.speed_m_s
    spec.correction = robot.correction_m_s
    spec.acceleration = robot.acceleration_m_s2
    spec.max_speed = robot.max_speed_m_s
    spec.noise = robot.noise_m_s
    spec.noise_tau = robot.noise_tau_s
    spec.bias = robot.bias_m_s
    spec.clock_drift = robot.clock_ppm * _PER_MILLION
    return spec


def _fault(fault: Fault) -> tuple[int, int, float, float, int, float, int]:
    value = fault.probability or 0.0
    marks = _LOSES_BOOT_COUNTER if fault.loses_boot_counter else 0
    if fault.ppm is not None:
        value = fault.ppm * _PER_MILLION
    elif fault.kind == "clock-jump":
        value = fault.duration_s
    elif fault.limp_deg is not None:
        value = _radians(fault.limp_deg)
        marks |= _PALM_GOES_LIMP
    return (
        _FAULTS.index(fault.kind),
        SIDES.index(fault.robot or "left"),
        fault.at_s,
        fault.duration_s,
        _SIGNS[fault.stuck_at or "0"],
        value,
        marks,
    )


def _zones(tactile: Tactile) -> list[tuple[int, float, float]]:
    """The switches (sign, from, to), ends included; a zone of sign 0 overrides the others."""
    if tactile.zones is not None:
        return [(_SIGNS[zone.sign], zone.from_m, zone.to_m) for zone in tactile.zones]
    half = tactile.zero_half_width_m
    return [(-1, -math.inf, -half), (0, -half, half), (1, half, math.inf)]
