# SPDX-License-Identifier: Apache-2.0
"""The type of the arrays of points."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Points: TypeAlias = NDArray[np.float64]
"""Points as rows, or one point."""
