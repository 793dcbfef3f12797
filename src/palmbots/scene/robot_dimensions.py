# SPDX-License-Identifier: Apache-2.0
"""Dimensions of the robots, as figures, logs and the MuJoCo model draw them [m].

The paper states that its robots are "approximately the size of a 20 cm cube"; all other numbers are
assumed. The quasistatic mechanics uses none of them: it knows pivots and palms only. In the MuJoCo
world the scene section `mujoco` sets the wheels' radius and the place of the axle.
"""

import palmbots._core as _core

BODY_SIZE: float = _core.BODY_SIZE
"""Edge of the cubic body."""
BODY_GAP: float = _core.BODY_GAP
"""From the palm's pivot outward to the near face of the body."""
GROUND_CLEARANCE: float = _core.GROUND_CLEARANCE
"""From the floor to the body."""
PIVOT_HEIGHT: float = _core.PIVOT_HEIGHT
"""From the floor to the palms' pivots, at least; clears the body at usual palm angles."""
PALM_THICKNESS: float = _core.thin_plate_thickness
"""Of a palm whose `palm.thickness_m` is 0, in pictures and in the MuJoCo world."""
SHOULDER_INSET: float = _core.SHOULDER_INSET
"""From the near and the upper face of the body to the shoulder, where the arm begins."""
ARM_HALF_SPACING = 0.02
"""From the middle of the robot sideways to each of the arm's two bars."""
WHEEL_RADIUS = 0.04
"""Of the wheels in figures and logs."""
WHEEL_WIDTH = 0.02
WHEEL_INSET = 0.01
"""From the side of the body outward to the middle of a wheel."""
CASTER_RADIUS = 0.015
