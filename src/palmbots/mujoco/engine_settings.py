# SPDX-License-Identifier: Apache-2.0
"""Settings of MuJoCo that are no scene keys: contacts, solver, servos.

The contact settings were chosen by measurement (docs/reference/mujoco-agreement.md, `palmbots
validate`, tests/mujoco): MuJoCo's default contacts creep, and with them the wrong contact slides.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Contact:
    """Compliance of a contact: MuJoCo's solref (time constant [s], damping ratio) and solimp."""

    solref: tuple[float, float]
    solimp: tuple[float, float, float]


PALM = Contact((0.02, 1.0), (0.8, 0.8, 0.001))
FLOOR = Contact((0.02, 1.0), (0.95, 0.95, 0.001))
LIFTING = Contact((0.01, 1.0), (0.9, 0.9, 0.001))


@dataclass(frozen=True)
class Engine:
    """MuJoCo's solver options, and the contacts between palms and object."""

    palm: Contact
    lifting: Contact = LIFTING
    """In a job on the floor: those between palms and object, and those of the floor with object and
    noses. Penetration has to be small compared with the thickness of a nose."""
    cone: str = "elliptic"
    impratio: float = 150.0
    integrator: str = "Euler"
    solver: str = "Newton"
    noslip: int = 0


DEFAULT = Engine(palm=PALM)


@dataclass(frozen=True)
class Servo:
    """Gains of a motor on angle [N m/rad] and speed [N m s/rad], and the inertia of its rotor at
    the joint [kg m²].

    The reflected inertia of a geared rotor is large. Without it, a wheel without grip or a palm
    without load has almost no inertia, and its motor overshoots. With steps h of 2 ms, kv h /
    inertia stays about 0.4 even without load, so no implicit damping is needed, which would take
    half as much time again.
    """

    kp: float
    kv: float
    armature: float


# For one wheel; gains per kg m² that it drives (half of the robot): 50 rad/s, well damped.
WHEEL = Servo(kp=50.0**2, kv=2 * 50.0, armature=2e-3)
SHOULDER = Servo(kp=300.0, kv=6.4, armature=0.03)
WRIST = Servo(kp=100.0, kv=2.1, armature=0.01)
# An arm that rises and sinks [N/m, N s/m, kg]; the armature is that of a geared lead screw.
MAST = Servo(kp=2e4, kv=230.0, armature=1.0)
ARM = 0.012  # m, thickness of the arm, from which its inertia follows
