# SPDX-License-Identifier: Apache-2.0
"""The trace of a carry: which variables it has, and their arrays as a labelled dataset.

Every variable has the attributes ``units``, ``long_name`` and ``log_field``, its name in carry
logs, so that a log writer needs no list of its own.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from palmbots._core import Spec
from palmbots._types import SIDES
from palmbots.scene.placement import floor_level, placements
from palmbots.scene.spec import contact_radii

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr


def _attrs(units: str, long_name: str, log_field: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name, "log_field": log_field}


# The field in logs is also the name in the core.
VARIABLES = {
    "contact": _attrs("m", "contact coordinate p, outward from the pivot", "contact_m"),
    "vertex_height": _attrs("m", "height of the contact vertex above its palm", "vertex_height_m"),
    "palm": _attrs("rad", "palm angle", "palm_rad"),
    "speed": _attrs("m/s", "speed over the following tick", "speed_m_s"),
    "commanded": _attrs("m/s", "commanded speed", "commanded_m_s"),
    "separation": _attrs("m", "separation of the pivots", "separation_m"),
    "midpoint": _attrs("m", "advance of the midpoint of the pivots", "midpoint_m"),
    "object": _attrs("rad", "angle of the object", "object_rad"),
    "sign": _attrs("1", "tactile sign", "sign"),
    "case": _attrs("1", "case of the controller, blank for none", "case"),
    "motion": _attrs("1", "contact slides down (-1), sticks (0), slides up (+1)", "motion"),
}
"""Attributes of the variables that every world records."""

HEIGHTS = {
    "pivot_height": _attrs(
        "m", "height of the pivot above the floor, in a job on the floor", "pivot_height_m"
    )
}
"""Attributes of the variables that every world adds in a job that begins or ends on the floor."""


POSE = {
    "object_x": {
        "units": "m",
        "long_name": "x of the object's COM, from the middle between the pivots at the start",
    },
    "object_height": {"units": "m", "long_name": "height of the object's COM above the floor"},
}
"""Attributes of the variables that follow from others, and that logs therefore do not have. With
``object`` they are the pose of the object."""


def with_pose(trace: "xr.Dataset", spec: Spec) -> "xr.Dataset":
    """A trace with the variables of `POSE` added."""
    com = _com(trace, spec)
    values = com[:, 0], com[:, 1] - floor_level(spec)
    return trace.assign(
        {name: ("time", one, dict(POSE[name])) for name, one in zip(POSE, values, strict=True)}
    )


def _com(trace: "xr.Dataset", spec: Spec) -> "np.ndarray":
    """The COM of each row: the mean of its places from both contacts, so that the mirrored carry
    has the mirrored ones to the last bit."""
    import numpy as np

    place = placements(spec, trace, slice(None))
    lift = trace["vertex_height"].transpose("time", "side").values
    cos, sin = np.cos(place.turn), np.sin(place.turn)
    found = np.zeros_like(place.com)
    for side, (outward, along) in enumerate(((-1, spec.com_left), (1, -spec.com_right))):
        angle = outward * place.palm_turn[:, side]
        above = lift[:, side] + contact_radii(spec)[side]
        x = above * (-outward * np.sin(angle)) + (cos * along - sin * spec.com_height)
        y = above * np.cos(angle) + (sin * along + cos * spec.com_height)
        with np.errstate(invalid="ignore"):  # a log may have an infinite separation
            found += 0.5 * (place.contact[:, side] + np.stack([x, y], axis=-1))
    return found


def heights_of(measured: Any) -> dict[str, "tuple[np.ndarray, Mapping[str, str]]"]:
    """Their values in such a job, of the core's record."""
    return {name: (measured.pivot_heights_m, attrs) for name, attrs in HEIGHTS.items()}


def trace_dataset(
    trace: Mapping[str, "np.ndarray"],
    more: Mapping[str, "tuple[np.ndarray, Mapping[str, str]]"] | None = None,
) -> "xr.Dataset":
    """The arrays of a trace, named as the core names them, as a labelled dataset.

    Args:
        trace: the arrays of the core.
        more: variables (values, attributes) that a world adds, or that replace those of the core.
    """
    variables: dict[str, Any] = {}
    for name, attrs in VARIABLES.items():
        values = trace[attrs["log_field"]]
        if name == "case":
            values = values.view("S1").astype("U1")
        dims = ("time", "side") if values.ndim == 2 else ("time",)
        variables[name] = (dims, values, dict(attrs))
    for name, (values, attrs) in (more or {}).items():
        variables[name] = (("time", "side"), values, dict(attrs))
    time = ("time", trace["time_s"], _attrs("s", "time", "time_s"))
    import xarray as xr  # here, because importing it takes longer than a carry

    return xr.Dataset(variables, coords={"time": time, "side": list(SIDES)})
