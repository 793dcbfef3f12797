"""The nine contact modes: which balance, which can move, and which one happens.

`modes` answers for one state of a scene; `states` for as many as you like, broadcasting its
arguments like a NumPy ufunc. The mechanics are the core's. Source: MECHANICS sections 2 and 4;
paper, section 3.1. States with more than the two contact vertices on the palms: `touching`.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palmbots import _core
from palmbots.columns import columns_of
from palmbots.palm_state import palm_state
from palmbots.scene import Scene
from palmbots.touching import Contact, Motions, touching

__all__ = ["MODES", "ContactModes", "Mode", "States", "modes", "states"]

Mode = tuple[str, str]

# ST sticks, SL slides to the left, SR to the right: up is SL on the left palm and SR on the right.
_LEFT = ("ST", "SL", "SR")
_RIGHT = ("ST", "SR", "SL")
_UP = (_LEFT[1], _RIGHT[1])
_DOWN = (_LEFT[2], _RIGHT[2])

MODES: tuple[Mode, ...] = tuple((left, right) for left in _LEFT for right in _RIGHT)
"""The nine modes (left, right), in the order of the arrays in `States`."""

_CONSISTENT_CLOSING = tuple(m for m in MODES if m[0] == _UP[0] or m[1] == _UP[1])
_CONSISTENT_OPENING = tuple(m for m in MODES if m[0] == _DOWN[0] or m[1] == _DOWN[1])


@dataclass(frozen=True)
class States:
    """The statics of many states; every array has the shape the arguments broadcast to."""

    squeeze: NDArray[np.float64]
    """I_L and I_R in units of the weight, shape (…, side, end): ends are low and high, infinite
    where unbounded; low > high: that contact cannot bear its share at any squeeze."""
    feasible: NDArray[np.bool_]
    """Which modes balance, shape (…, 9) in the order of `MODES`."""
    closing: NDArray[np.int8]
    """Index into `MODES` of the mode that happens when the palms are driven together; -1: the
    object is not held, -2: nothing lets go (jammed)."""
    opening: NDArray[np.int8]
    """The same when they are driven apart."""


def states(
    *,
    width: ArrayLike,
    com_x: ArrayLike,
    com_y: ArrayLike,
    theta_left: ArrayLike,
    theta_right: ArrayLike,
    p_left: ArrayLike,
    p_right: ArrayLike,
    friction_left: ArrayLike,
    friction_right: ArrayLike,
    offset_left: ArrayLike = 0.0,
    offset_right: ArrayLike = 0.0,
    slope: ArrayLike = 0.0,
) -> States:
    """Statics of states given as numbers or arrays, which broadcast against each other.

    Args:
        width: distance w between the contact vertices [m].
        com_x: COM from the left contact along the line of contacts [m].
        com_y: COM above that line [m].
        theta_left: palm angle, positive when the palm rises outward [rad, not degrees].
        theta_right: the same on the right.
        p_left: contact coordinate from the foot of the pivot, outward [m].
        p_right: the same on the right.
        friction_left: coefficient of friction.
        friction_right: the same on the right.
        offset_left: distance of the palm's surface from its pivot [m].
        offset_right: the same on the right.
        slope: sideways specific force s towards -x: acceleration / g, or the floor's slope.

    Raises:
        ValueError: the arguments do not broadcast.
        PalmbotsError: a number cannot be: an angle that is not between -π/2 and π/2 (degrees?), a
            width that is not positive, negative friction, NaN or infinity.
    """
    pairs = (
        (offset_left, offset_right),
        (friction_left, friction_right),
        (theta_left, theta_right),
        (p_left, p_right),
    )
    shape, n, columns = columns_of(width, com_x, com_y, slope, pairs)
    left_low, left_high, right_low, right_high, bits, closing, opening = _core.modes(columns, n)
    ends = np.stack([left_low, left_high, right_low, right_high], axis=-1)
    return States(
        squeeze=ends.reshape(*shape, 2, 2),
        feasible=(bits[:, np.newaxis] >> np.arange(9) & 1).astype(bool).reshape(*shape, 9),
        closing=closing.reshape(shape),
        opening=opening.reshape(shape),
    )


@dataclass(frozen=True)
class ContactModes:
    """One state. Modes are pairs (left, right) of ST, SL (to the left), SR (to the right)."""

    scene: Scene
    p_left_m: float
    p_right_m: float
    theta_left_deg: float
    theta_right_deg: float
    object_deg: float
    feasible: tuple[Mode, ...]
    """The modes in quasistatic balance."""
    consistent_closing: tuple[Mode, ...]
    consistent_opening: tuple[Mode, ...]
    closing: Mode | None
    """What happens when the palms are driven together; None: not held, or jammed."""
    opening: Mode | None
    wedged: dict[str, bool]
    """Contacts that no squeeze frees: their friction cone contains the line to the other one."""
    squeeze: dict[str, tuple[float, float]]
    """I_L and I_R in units of the weight; infinite where unbounded."""
    margin_rad: float
    """The angle by which both friction cones may shrink with the object still held; negative: by
    which they would have to grow."""
    contacts: tuple[Contact, ...]
    """Every point at which the palms touch the object. All above is about the two contact vertices
    alone; where there are more contacts, what follows takes over."""
    held: bool | None = None
    """With more than two contacts: whether all sticking balances."""
    motions_closing: tuple[Motions, ...] | None = None
    """With more than two contacts: what may happen when the palms are driven together, for each
    contact ST, SL, SR or BR (it leaves the palm). There may be none, or several."""
    motions_opening: tuple[Motions, ...] | None = None
    """The same when they are driven apart."""

    def summary(self) -> dict[str, Any]:
        """What ``palmbots modes --json`` prints."""
        told = {
            "feasible": [list(m) for m in self.feasible],
            "consistent_closing": [list(m) for m in self.consistent_closing],
            "consistent_opening": [list(m) for m in self.consistent_opening],
            "closing": list(self.closing) if self.closing else None,
            "opening": list(self.opening) if self.opening else None,
            "wedged": self.wedged,
            "squeeze": {
                side: [end if math.isfinite(end) else None for end in ends]
                for side, ends in self.squeeze.items()
            },
            "margin_rad": self.margin_rad,
            "object_deg": self.object_deg,
            "p_left_m": self.p_left_m,
            "p_right_m": self.p_right_m,
            "theta_left_deg": self.theta_left_deg,
            "theta_right_deg": self.theta_right_deg,
            "contacts": [contact.summary() for contact in self.contacts],
            "scene": self.scene.model_dump(),
        }
        if self.motions_closing is not None and self.motions_opening is not None:
            told["held"] = self.held
            told["motions_closing"] = [list(m) for m in self.motions_closing]
            told["motions_opening"] = [list(m) for m in self.motions_opening]
        return told


def modes(
    scene: Any = "paper",
    *,
    p_left_m: float = 0.0,
    p_right_m: float = 0.0,
    theta_left_deg: float | None = None,
    theta_right_deg: float | None = None,
    overrides: Any = None,
) -> ContactModes:
    """The contact modes of one state of a scene.

    Args:
        scene: as in `palmbots.carry`.
        p_left_m: contact coordinate, outward from the foot of the pivot.
        p_right_m: the same on the right.
        theta_left_deg: palm angle; None: the scene's steep angle.
        theta_right_deg: the same on the right.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or makes no sense.
        PalmbotsError: a coordinate is beyond its palm, an angle is not between -80° and 80°, or the
            object cannot span the two contacts, or a palm would lie in it.
    """
    state = palm_state(scene, p_left_m, p_right_m, theta_left_deg, theta_right_deg, overrides)
    touched = touching(state)
    spec = state.spec
    numbers = [
        spec.width,
        spec.com_left,
        spec.com_right,
        spec.com_height,
        spec.slope,
        spec.palms[0].offset,
        spec.palms[1].offset,
        spec.palms[0].friction,
        spec.palms[1].friction,
        *state.theta_rad,
        *state.p_m,
    ]
    columns = [np.array([value]) for value in numbers]
    left_low, left_high, right_low, right_high, bits, closing, opening = _core.modes(columns, 1)
    friction_angles = [math.atan(palm.friction) for palm in spec.palms]
    squeeze = {
        "left": (float(left_low[0]), float(left_high[0])),
        "right": (float(right_low[0]), float(right_high[0])),
    }
    return ContactModes(
        scene=state.scene,
        p_left_m=state.p_m[0],
        p_right_m=state.p_m[1],
        theta_left_deg=state.theta_deg[0],
        theta_right_deg=state.theta_deg[1],
        object_deg=math.degrees(state.object_rad),
        feasible=tuple(m for bit, m in enumerate(MODES) if int(bits[0]) >> bit & 1),
        consistent_closing=_CONSISTENT_CLOSING,
        consistent_opening=_CONSISTENT_OPENING,
        closing=MODES[closing[0]] if closing[0] >= 0 else None,
        opening=MODES[opening[0]] if opening[0] >= 0 else None,
        wedged={side: math.isinf(ends[1]) for side, ends in squeeze.items()},
        squeeze=squeeze,
        margin_rad=_core.margin(numbers, *friction_angles),
        contacts=touched.contacts,
        held=touched.held if touched.several else None,
        motions_closing=touched.closing() if touched.several else None,
        motions_opening=touched.opening() if touched.several else None,
    )
