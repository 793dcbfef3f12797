# SPDX-License-Identifier: Apache-2.0
"""How much noise the shipped controllers tolerate, as measured, and which one is recommended.

``tolerated_noise.toml`` holds the measured numbers. ``scripts/measure_tolerated_noise.py`` writes
it with `palmbots.noise_limit`; a test measures them again.
"""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import resources

RECOMMENDED = "shared-sign"
"""The controller that drops the fewest objects where the robots can stop."""


@dataclass(frozen=True)
class ToleratedNoise:
    """σ* of a controller: the noise at which 1 % of the carries of the default scene drop."""

    sigma_star_m_s: float
    interval: tuple[float, float]
    """95 % [m/s]."""
    command: str
    """The command that measured it."""


@cache
def _measured() -> dict[str, ToleratedNoise]:
    text = (resources.files("palmbots.control") / "tolerated_noise.toml").read_text("utf-8")
    return {
        name: ToleratedNoise(
            row["sigma_star_m_s"], (row["low_m_s"], row["high_m_s"]), row["command"]
        )
        for name, row in tomllib.loads(text).items()
    }


def tolerated_noise(controller: str) -> ToleratedNoise | None:
    """σ* of a controller in the default scene.

    None: it has no σ* (it drops more than 1 % without noise), or it is not shipped.
    """
    return _measured().get(controller)
