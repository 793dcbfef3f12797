# SPDX-License-Identifier: Apache-2.0
"""The kinds of designs: how the points of a study are chosen. One entry of `DESIGNS` each.

A design draws points of the unit cube, which `palmbots.studies.points` maps to the values of the
keys. Scrambled Sobol and Halton points and Latin hypercubes come from SciPy, and Saltelli's points
for Sobol indices (Saltelli 2010) from SALib. Philox with the seed of the design drives them.
"""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots._util.optional_imports import require

GRID = "grid"
"""The default: every combination of values. It is no sample."""


@dataclass(frozen=True)
class DesignKind:
    """One kind of design."""

    sample: Callable[[int, int, int], NDArray[np.float64]] | None
    """(dimensions, points, seed) → points of the unit cube, one in each row; None: a grid."""
    needs_power_of_two: bool = False
    """Whether the number of points has to be a power of 2."""


def _random(dims: int, n: int, seed: int) -> NDArray[np.float64]:
    return _philox(seed).random((n, dims))


def _sobol(dims: int, n: int, seed: int) -> NDArray[np.float64]:
    return require("scipy.stats.qmc", "study").Sobol(dims, rng=_philox(seed)).random(n)


def _halton(dims: int, n: int, seed: int) -> NDArray[np.float64]:
    return require("scipy.stats.qmc", "study").Halton(dims, rng=_philox(seed)).random(n)


def _latin_hypercube(dims: int, n: int, seed: int) -> NDArray[np.float64]:
    return require("scipy.stats.qmc", "study").LatinHypercube(dims, rng=_philox(seed)).random(n)


def _saltelli(dims: int, n: int, seed: int) -> NDArray[np.float64]:
    """n (dims + 2) points, as the estimators of Sobol indices need them."""
    sample = require("SALib.sample.sobol", "study").sample
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sample(sobol_problem(dims), n, calc_second_order=False, seed=seed % 2**32)


DESIGNS: Mapping[str, DesignKind] = {
    GRID: DesignKind(None),
    "random": DesignKind(_random),
    "sobol": DesignKind(_sobol, needs_power_of_two=True),
    "halton": DesignKind(_halton),
    "latin-hypercube": DesignKind(_latin_hypercube),
    "sobol-indices": DesignKind(_saltelli, needs_power_of_two=True),
}
"""The kinds of designs by name."""


def sobol_problem(dims: int) -> dict[str, Any]:
    """The unit cube in the form that SALib expects."""
    return {"num_vars": dims, "names": [str(k) for k in range(dims)], "bounds": [[0, 1]] * dims}


def _philox(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.Philox(seed))
