# SPDX-License-Identifier: Apache-2.0
"""The description of the arguments of `contact_modes_batch` and `feasible_contact_modes`."""

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

_PLACE = "    {state arguments}\n"
_TEXT = """\
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
        slope: lateral specific force s towards -x: acceleration / g, or the floor's slope.

    Raises:
        ValueError: the arguments do not broadcast.
        PalmbotsError: a number is impossible: an angle that is not between -π/2 and π/2 (degrees?),
            a width that is not positive, negative friction, NaN or infinity.
"""


def with_state_arguments(function: Function) -> Function:
    """Insert the description into the docstring of a function."""
    if function.__doc__ is not None:  # it is None with python -OO
        # Python 3.13 and later strip the common indentation of docstrings.
        text = function.__doc__
        if _PLACE in text:
            function.__doc__ = text.replace(_PLACE, _TEXT)
        else:
            lines = [line.removeprefix("    ") for line in _TEXT.splitlines(keepends=True)]
            function.__doc__ = text.replace(_PLACE.lstrip(), "".join(lines))
    return function
