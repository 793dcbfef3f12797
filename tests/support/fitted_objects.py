# SPDX-License-Identifier: Apache-2.0
"""Objects and palms fitted to simulated carries with hidden values."""

from typing import Any

import numpy as np

import palmbots as pb
from palmbots.fitting.fitted_values import Estimate
from palmbots.fitting.object_fit import Touch, fit_object, touch_of

SHORT = {"task.distance_m": 0.5}


def touches(keys: dict[str, Any], carries: int = 2, controller: str = "shared-sign") -> list[Touch]:
    return [
        touch_of(pb.carry("paper", controller, seed=seed, overrides=SHORT | keys), f"{seed}.mcap")
        for seed in range(carries)
    ]


def found(keys: dict[str, Any], carries: int = 2) -> dict[str, Estimate]:
    """Of carries over half a metre, if the keys do not say otherwise."""
    return {one.key: one for one in fit_object(touches(keys, carries), ()).estimates}


def object_fitted(seed: int) -> list[tuple[str, Estimate, float]]:
    """COM and friction of a random object on random palms: key, estimate and hidden value."""
    random = np.random.default_rng(seed)
    com, *palms = random.uniform((0.11, 0.2, 0.2), (0.14, 0.5, 0.5)).tolist()
    keys = dict(zip(("palm.left.friction", "palm.right.friction"), palms, strict=True))
    of = found({"object.com_m": [com, 0.04], **keys})
    return [(key, of[key], value) for key, value in {"object.com_m": com, **keys}.items()]
