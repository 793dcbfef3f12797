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
    integrator: str = "Euler"
    solver: str = "Newton"
    noslip: int = 0


PALM = Contact((0.02, 1.0), (0.8, 0.8, 0.001))
FLOOR = Contact((0.02, 1.0), (0.95, 0.95, 0.001))
DEFAULT = Engine(palm=PALM)


@dataclass(frozen=True)
class Servo:
    """A motor's gains on angle [N m/rad] and speed [N m s/rad], and its rotor's inertia as felt at
    the joint [kg m²].

    Gears make rotors heavy: without that inertia a wheel that loses its grip, or a palm that loses
    its load, weighs next to nothing, and its motor runs away or invents accelerations. With steps
    h of 2 ms kv h / inertia stays about 0.4, also without load. So nothing needs damping that is
    taken implicitly, which would cost half more time.
    """

    kp: float
    kv: float
    armature: float


# Of one wheel; gains for each kg m² that it drives, half of the robot's: 50 rad/s, well damped.
WHEEL = Servo(kp=50.0**2, kv=2 * 50.0, armature=2e-3)
SHOULDER = Servo(kp=300.0, kv=6.4, armature=0.03)
WRIST = Servo(kp=100.0, kv=2.1, armature=0.01)
ARM = 0.012  # m, radius of the arm drawn
