# SPDX-License-Identifier: Apache-2.0
"""Measure σ* of every shipped controller in the default scene (minutes).

    .venv/bin/python scripts/measure_tolerated_noise.py

Writes src/palmbots/control/tolerated_noise.toml, which `palmbots controllers` shows.
"""

from pathlib import Path
from typing import Any

import palmbots as pb
from palmbots.control.registry import shipped_names
from palmbots.errors import PalmbotsError

FILE = Path(__file__).resolve().parent.parent / "src/palmbots/control/tolerated_noise.toml"
PERCENT = 0.3  # half-width of the interval
# A robot of `silent` that stops stands, and a simulated robot that stands has no noise. A real one
# has, so σ* is measured without stopping.
OVERRIDES: dict[str, dict[str, Any]] = {"silent": {"control.brake": False}}
HEAD = """\
# SPDX-License-Identifier: Apache-2.0
# The noise at which 1 % of the carries of the default scene drop the object, with a 95 % interval.
# scripts/measure_tolerated_noise.py wrote this file.
"""


def main() -> None:
    """Measure and write the file."""
    text = HEAD
    for name in shipped_names():
        try:
            keys = OVERRIDES.get(name, {})
            found = pb.noise_limit("paper", name, relative_half_width=PERCENT / 100, overrides=keys)
        except PalmbotsError as error:
            print(f"{name}: {error}")
            continue
        print(found.headline(), flush=True)
        low, high = found.interval
        options = "".join(f" --set {key}={str(value).lower()}" for key, value in keys.items())
        options += f" --relative-error-percent {PERCENT}"
        text += (
            f"\n[{name}]\n"
            f"sigma_star_m_s = {found.sigma_star_m_s:.5f}\n"
            f"low_m_s = {low:.5f}\n"
            f"high_m_s = {high:.5f}\n"
            f'command = "palmbots noise-limit -c {name}{options}"\n'
        )
    FILE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
