# SPDX-License-Identifier: Apache-2.0
"""Which contact slides, anywhere on the palms? A million states in one call.

The COM is 2.5 cm off the middle: then property 1 does not hold everywhere.
"""

import math

import numpy as np

import palmbots as pb

p = np.linspace(-0.075, 0.075, 1000)
left, right = np.meshgrid(p, p, indexing="ij")
found = pb.contact_modes_batch(
    width=0.25,
    com_x=0.1,
    com_y=0.04,
    theta_left=math.radians(5),  # shallow
    theta_right=math.radians(15),  # steep
    p_left=left,
    p_right=right,
    friction_left=0.3,
    friction_right=0.3,
)
names = [" ".join(mode) for mode in pb.mechanics.CONTACT_MODES]
for what, happens in (("closing", found.closing), ("opening", found.opening)):
    for i, count in zip(*np.unique(happens, return_counts=True), strict=True):
        print(f"{what}: {names[i]} in {100 * count / happens.size:.1f} % of the states")
