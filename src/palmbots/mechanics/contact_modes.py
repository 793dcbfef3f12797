# SPDX-License-Identifier: Apache-2.0
"""The nine contact modes: which balance, which are consistent with a motion, and which occurs.

`contact_modes` evaluates one state of a scene. `contact_modes_batch` evaluates arrays of states and
broadcasts its arguments like a NumPy ufunc. `feasible_contact_modes` does the same, faster, for
feasibility alone. The core has the mechanics. Source: paper, section 3.1. `contact_points` treats
states in which more than the two contact vertices touch the palms.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import SIDES, BySide, MaybeNaN, Overrides
from palmbots._util.command import Option, command
from palmbots._util.optional_imports import require
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Table
from palmbots._util.results import Result
from palmbots._util.text import plural
from palmbots.mechanics._state_arguments import with_state_arguments
from palmbots.mechanics.acting_object import acting_object
from palmbots.mechanics.array_arguments import FloatArray, columns_of
from palmbots.mechanics.consistent_modes import CODE_OF
from palmbots.mechanics.contact_points import Contact, Motions, touching
from palmbots.mechanics.mode_forces import ConsistentMode
from palmbots.mechanics.state import palm_state
from palmbots.scene.scene import Scene, SceneLike

if TYPE_CHECKING:
    import xarray as xr

ContactMode: TypeAlias = tuple[str, str]
ModeBits: TypeAlias = NDArray[np.uint16]

# Sticks, slides up, slides down: up is SL on the left palm and SR on the right.
_LEFT, _RIGHT = (tuple(code[motion] for motion in (0, 1, -1)) for code in CODE_OF)
_UP = (_LEFT[1], _RIGHT[1])
_DOWN = (_LEFT[2], _RIGHT[2])

CONTACT_MODES: tuple[ContactMode, ...] = tuple((left, right) for left in _LEFT for right in _RIGHT)
"""The nine contact modes (left, right), in the order of the arrays in `ContactModesBatch`."""

_CONSISTENT_CLOSING = tuple(m for m in CONTACT_MODES if m[0] == _UP[0] or m[1] == _UP[1])
_CONSISTENT_OPENING = tuple(m for m in CONTACT_MODES if m[0] == _DOWN[0] or m[1] == _DOWN[1])


@dataclass(frozen=True, repr=False)
class ContactModesBatch(Result):
    """The statics of many states; every array has the shape the arguments broadcast to."""

    squeeze: NDArray[np.float64]
    """I_L and I_R in units of the weight, shape (…, side, end): ends are low and high, infinite
    where unbounded; low > high: no squeeze lets that contact carry its load."""
    feasible: NDArray[np.bool_]
    """Which contact modes balance, shape (…, 9) in the order of `CONTACT_MODES`."""
    closing: NDArray[np.int8]
    """Index into `CONTACT_MODES` of the contact mode that occurs when the palms are driven
    together; -1: the object is not held, -2: no contact slides (jammed)."""
    opening: NDArray[np.int8]
    """The same when they are driven apart."""

    def lines(self) -> Iterator[Item]:
        """How many states there are, and how many are held."""
        yield f"contact modes of {plural(self.closing.size, 'state')}, shape {self.closing.shape}"
        held = int(np.count_nonzero(self.feasible[..., 0]))
        jammed = int(np.count_nonzero(self.closing == -2))
        yield Table([("  held (ST, ST)", str(held)), ("  jammed when closing", str(jammed))])

    def to_xarray(self) -> xr.Dataset:
        """The arrays as a dataset; the dimensions of the states are ``dim_0``, ``dim_1``, …"""
        import xarray as xr

        states = tuple(f"dim_{k}" for k in range(self.closing.ndim))
        names = [f"{left}-{right}" for left, right in CONTACT_MODES]
        return xr.Dataset(
            {
                "squeeze": ((*states, "side", "end"), self.squeeze),
                "feasible": ((*states, "mode"), self.feasible),
                "closing": (states, self.closing),
                "opening": (states, self.opening),
            },
            coords={"side": list(SIDES), "end": ["low", "high"], "mode": names},
        )

    def to_dataframe(self) -> Any:
        """One line per state as a `pandas.DataFrame`, with a column for each entry of the arrays.

        The columns ``dim_0``, ``dim_1``, … are the indices of the state.

        Raises:
            PalmbotsError: pandas is not installed.
        """
        frame: Any = require("pandas", "study").DataFrame
        n, shape = self.closing.size, self.closing.shape
        squeeze, feasible = self.squeeze.reshape(n, 2, 2), self.feasible.reshape(n, -1)
        indices = np.indices(shape).reshape(len(shape), n)
        columns: dict[str, Any] = {f"dim_{k}": indices[k] for k in range(len(shape))}
        for s, side in enumerate(SIDES):
            for e, end in enumerate(("low", "high")):
                columns[f"squeeze_{side}_{end}"] = squeeze[:, s, e]
        for m, (left, right) in enumerate(CONTACT_MODES):
            columns[f"{left}-{right}"] = feasible[:, m]
        columns |= {"closing": self.closing.ravel(), "opening": self.opening.ravel()}
        return frame(columns)


@with_state_arguments
def contact_modes_batch(
    *,
    width: FloatArray,
    com_x: FloatArray,
    com_y: FloatArray,
    theta_left: FloatArray,
    theta_right: FloatArray,
    p_left: FloatArray,
    p_right: FloatArray,
    friction_left: FloatArray,
    friction_right: FloatArray,
    offset_left: FloatArray = 0.0,
    offset_right: FloatArray = 0.0,
    slope: FloatArray = 0.0,
) -> ContactModesBatch:
    """The statics of states given as numbers or arrays, which broadcast against each other.

    {state arguments}
    """
    pairs = (
        (offset_left, offset_right),
        (friction_left, friction_right),
        (theta_left, theta_right),
        (p_left, p_right),
    )
    shape, n, columns = columns_of(width, com_x, com_y, slope, pairs)
    *ends, bits, closing, opening = _core.contact_modes(columns, n)
    return ContactModesBatch(
        squeeze=np.stack(ends, axis=-1).reshape(*shape, 2, 2),
        feasible=(bits[:, np.newaxis] >> np.arange(9) & 1).astype(bool).reshape(*shape, 9),
        closing=closing.reshape(shape),
        opening=opening.reshape(shape),
    )


@with_state_arguments
def feasible_contact_modes(
    *,
    width: FloatArray,
    com_x: FloatArray,
    com_y: FloatArray,
    theta_left: FloatArray,
    theta_right: FloatArray,
    p_left: FloatArray,
    p_right: FloatArray,
    friction_left: FloatArray,
    friction_right: FloatArray,
    offset_left: FloatArray = 0.0,
    offset_right: FloatArray = 0.0,
    slope: FloatArray = 0.0,
) -> ModeBits:
    """The contact modes that balance, as bits: bit k is set where ``CONTACT_MODES[k]`` balances.

    Faster than `contact_modes_batch`, in particular where only the contact coordinates are arrays.
    The result has the shape that the arguments broadcast to. 0 means that nothing holds the object,
    or that it does not reach from one contact to the other.

    {state arguments}
    """
    pairs = (
        (offset_left, offset_right),
        (friction_left, friction_right),
        (theta_left, theta_right),
        (p_left, p_right),
    )
    shape, n, columns = columns_of(width, com_x, com_y, slope, pairs)
    return _core.feasible_modes(columns, n).reshape(shape)


@dataclass(frozen=True, repr=False)
class ContactModes(Result):
    """One state. Modes are pairs (left, right) of ST, SL (to the left), SR (to the right)."""

    lines_of = "palmbots.mechanics.contact_mode_lines:contact_mode_lines"

    scene: Scene
    p_left_m: float
    p_right_m: float
    theta_left_deg: float
    theta_right_deg: float
    object_deg: float
    feasible: tuple[ContactMode, ...]
    """The modes in quasistatic balance."""
    consistent_closing: tuple[ContactMode, ...]
    consistent_opening: tuple[ContactMode, ...]
    closing: ContactMode | None
    """The contact mode when the palms are driven together; None: not held, or jammed."""
    opening: ContactMode | None
    wedged: BySide[bool]
    """Contacts that no squeeze frees: their friction cone contains the line to the other one."""
    squeeze: BySide[tuple[MaybeNaN, MaybeNaN]]
    """I_L and I_R in units of the weight; infinite where unbounded."""
    margin_rad: float
    """The angle by which both friction cones may shrink with the object still held; negative: the
    angle by which they would have to grow."""
    contacts: tuple[Contact, ...]
    """Every point at which the palms touch the object. All fields above assume that only the two
    contact vertices touch; with more contacts, the fields below hold instead."""
    held: bool | None = None
    """With more than two contacts: whether all sticking balances."""
    modes_closing: tuple[ConsistentMode, ...] | None = None
    """With more than two contacts: the contact modes that may occur when the palms are driven
    together, with forces and margins. There may be none, or several."""
    modes_opening: tuple[ConsistentMode, ...] | None = None
    """The same when they are driven apart."""

    @derived
    def motions_closing(self) -> tuple[Motions, ...] | None:
        """Of `modes_closing`: for each contact ST, SL, SR or BR (it leaves the palm)."""
        return None if self.modes_closing is None else tuple(m.motions for m in self.modes_closing)

    @derived
    def motions_opening(self) -> tuple[Motions, ...] | None:
        """The same when they are driven apart."""
        return None if self.modes_opening is None else tuple(m.motions for m in self.modes_opening)


@command(
    order=20,
    example="palmbots contact-modes --theta-left-deg 5 --p-left-m -0.02",
    p_left_m=Option(),
    p_right_m=Option(),
    theta_left_deg=Option(),
    theta_right_deg=Option(),
)
def contact_modes(
    scene: SceneLike = "paper",
    *,
    p_left_m: float = 0.0,
    p_right_m: float = 0.0,
    theta_left_deg: float | None = None,
    theta_right_deg: float | None = None,
    overrides: Overrides = None,
) -> ContactModes:
    """Report the contact modes of one state.

    The report states which of the nine contact modes balance, and which occur when the palms
    close or open.

    Args:
        scene: as in `palmbots.carry`.
        p_left_m: left contact coordinate, outward. It is 0 at the foot of the pivot.
        p_right_m: right contact coordinate, outward; of a pipe it follows from the left one.
        theta_left_deg: left palm angle; None: the scene's steep angle.
        theta_right_deg: right palm angle; None: the scene's steep angle.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is invalid.
        PalmbotsError: a coordinate is beyond its palm, an angle is not between -80° and 80°, the
            object cannot span the two contacts, or a palm would lie inside it.
    """
    state = palm_state(scene, p_left_m, p_right_m, theta_left_deg, theta_right_deg, overrides)
    touched = touching(state)
    spec = state.spec
    acting = acting_object(spec, np.transpose([state.theta_rad]), np.transpose([state.p_m]))
    numbers = [
        float(acting.width[0]),
        float(acting.com_left[0]),
        float(acting.com_right[0]),
        float(acting.com_height[0]),
        spec.slope,
        spec.palms[0].offset,
        spec.palms[1].offset,
        spec.palms[0].friction,
        spec.palms[1].friction,
        *state.theta_rad,
        *state.p_m,
    ]
    columns = [np.array([value]) for value in numbers]
    *ends, bits, closing, opening = _core.contact_modes(columns, 1)
    friction_angles = [math.atan(palm.friction) for palm in spec.palms]
    left_low, left_high, right_low, right_high = (float(end[0]) for end in ends)
    squeeze = BySide((left_low, left_high), (right_low, right_high))
    return ContactModes(
        scene=state.scene,
        p_left_m=state.p_m[0],
        p_right_m=state.p_m[1],
        theta_left_deg=state.theta_deg[0],
        theta_right_deg=state.theta_deg[1],
        object_deg=math.degrees(state.object_rad),
        feasible=tuple(m for bit, m in enumerate(CONTACT_MODES) if int(bits[0]) >> bit & 1),
        consistent_closing=_CONSISTENT_CLOSING,
        consistent_opening=_CONSISTENT_OPENING,
        closing=CONTACT_MODES[closing[0]] if closing[0] >= 0 else None,
        opening=CONTACT_MODES[opening[0]] if opening[0] >= 0 else None,
        wedged=squeeze.map(lambda ends: math.isinf(ends[1])),
        squeeze=squeeze,
        margin_rad=_core.margin(numbers, *friction_angles),
        contacts=touched.contacts,
        held=touched.held if touched.several else None,
        modes_closing=touched.modes_closing() if touched.several else None,
        modes_opening=touched.modes_opening() if touched.several else None,
    )
