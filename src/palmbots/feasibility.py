"""Which of the nine contact modes balance, for arrays of states, and nothing more: fast.

The answers are those of `palmbots.states`, which tells more of each state and takes longer. Source:
MECHANICS section 2; paper, section 3.1.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palmbots import _core
from palmbots.columns import columns_of

__all__ = ["feasible_modes"]


def feasible_modes(
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
) -> NDArray[np.uint16]:
    """The modes that balance, as bits: bit k is set where ``MODES[k]`` does.

    It is fastest where only the contact coordinates are arrays.

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

    Returns:
        An array of the shape the arguments broadcast to; 0: nothing holds the object, or it cannot
        reach from one contact to the other.

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
    return _core.feasible_modes(columns, n).reshape(shape)
