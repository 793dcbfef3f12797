"""The numbers of the dynamic world that are not the scene's: contacts, solver, servos.

Contacts are chosen by measurement (docs/dynamic.md, `palmbots validate`, tests/dynamic): MuJoCo's
default contacts creep and let the wrong contact slide.
"""

from dataclasses import dataclass

__all__ = [
    "ARM",
    "DEFAULT",
    "FLOOR",
    "PALM",
    "SHOULDER",
    "WHEEL",
    "WRIST",
    "Contact",
    "Engine",
    "Servo",
]


@dataclass(frozen=True)
class Contact:
    """How soft a contact is: MuJoCo's solref (time constant [s], damping ratio) and solimp."""

    solref: tuple[float, float]
    solimp: tuple[float, float, float]


@dataclass(frozen=True)
class Engine:
    """MuJoCo's solver options, and the contacts between palms and object."""

    palm: Contact
    cone: str = "elliptic"
    impratio: float = 150.0
    integrator: str = "implicitfast"
    solver: str = "Newton"
    noslip: int = 0


PALM = Contact((0.02, 1.0), (0.8, 0.8, 0.001))
FLOOR = Contact((0.02, 1.0), (0.95, 0.95, 0.001))
DEFAULT = Engine(palm=PALM)


@dataclass(frozen=True)
class Servo:
    """A motor's gains on angle [N m/rad] and speed [N m s/rad], and its rotor's inertia as felt at
    the joint [kg m²]. Gains keep kv h / inertia below 0.4 with steps h of 2 ms: above, servos
    invent accelerations."""

    kp: float
    kv: float
    armature: float


# A robot of 3.4 kg on wheels of 4 cm: 60 rad/s, critically damped; scaled with mass and radius.
WHEEL = Servo(kp=60.0**2, kv=2 * 60.0, armature=1e-4)  # for each kg m² at the axle
SHOULDER = Servo(kp=300.0, kv=6.4, armature=0.03)
WRIST = Servo(kp=100.0, kv=2.1, armature=0.01)
ARM = 0.012  # m, radius of the arm drawn
