# SPDX-License-Identifier: Apache-2.0
"""Carries with default angles and with angles from probes, as benchmarks/bench_probes.py measured
them."""

import csv
from pathlib import Path

import numpy as np

from palmbots._util.confidence_intervals import wilson_bounds

RESULT = Path(__file__).parents[2] / "benchmarks" / "results" / "probes.csv"
CHOICES = {
    ("nothing", "default"): "none (default)",
    ("prior", "certificate"): "prior, certificate",
    ("probed", "certificate"): "probe, certificate",
    ("known", "certificate"): "the object itself, certificate",
    ("prior", "carries"): "prior, carries",
    ("probed", "carries"): "probe, carries",
    ("known", "carries"): "the object itself, carries",
}
KINDS = {
    ("same", "default"): "one coefficient, 0.15 to 0.6",
    ("different", "default"): "two coefficients, 0.15 to 0.6",
    ("same", "narrow"): "one coefficient, known to ±0.05",
}
RESAMPLES = 10_000
OFTEN = 0.01  # at 1 cm/s

Key = tuple[str, ...]


def rates(world: str) -> dict[Key, dict[int, float | None]]:
    """The drop rates of all objects, by kind of palms, choice and noise; None: no angles."""
    found: dict[Key, dict[int, float | None]] = {}
    with RESULT.open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            if row["world"] == world:
                key = row["palms"], row["prior"], row["known"], row["by"], row["noise_m_s"]
                share = int(row["dropped"]) / int(row["carries"]) if row["carries"] else None
                found.setdefault(key, {})[int(row["object"])] = share
    return found


def carried(of: dict[Key, dict[int, float | None]], *key: str) -> np.ndarray:
    """The drop rate of each object; without angles for it, the robots keep the default ones."""
    default, own = of[(*key[:2], "nothing", "default", key[-1])], of[key]
    return np.array([default[k] if own[k] is None else own[k] for k in sorted(own)], float)


def mean_interval(values: np.ndarray) -> tuple[float, float, float]:
    """The mean over objects and its 95 % interval, from resampled objects."""
    draw = np.random.default_rng(0)
    means = values[draw.integers(len(values), size=(RESAMPLES, len(values)))].mean(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return float(values.mean()), float(low), float(high)


def _text(values: np.ndarray) -> str:
    if not values.any():
        return "0"
    mean, low, high = (100 * one for one in mean_interval(values))
    return f"{mean:.1f} ({low:.1f} to {high:.1f})".replace("-", "−")


def often(of: dict[Key, dict[int, float | None]], *key: str) -> tuple[int, int]:
    """How many objects are dropped often, and how many there are."""
    rates = carried(of, *key)
    return int((rates > OFTEN).sum()), len(rates)


def _lines(world: str, noises: tuple[str, ...]) -> list[list[str]]:
    of = rates(world)
    lines = []
    for kind, friction in KINDS.items():
        for choice, angles in CHOICES.items():
            key = (*kind, *choice)
            if (*key, noises[0]) not in of:
                continue
            every = of[(*key, noises[0])]
            default = of[(*kind, "nothing", "default", noises[0])]
            has = sum(one is not None for one in every.values())
            cells = [_text(carried(of, *key, noise)) for noise in noises]
            worth = carried(of, *key, noises[0]) - [default[k] for k in sorted(every)]
            less = "" if choice[0] == "nothing" else _text(worth)
            number, count = often(of, *key, noises[0])
            low, high = (100 * one for one in wilson_bounds(number, count))
            share = f"{number} of {count} ({low:.0f} to {high:.0f} %)"
            lines.append([friction, angles, f"{has} of {count}", share, *cells, less])
    return lines


def _table(world: str, noises: tuple[str, ...]) -> str:
    head = ["friction", "angles from", "objects with angles", "objects dropped often"]
    head += [f"{100 * float(noise):g} cm/s" for noise in noises] + ["change at 1 cm/s"]
    rows = [head, ["---"] * len(head), *_lines(world, noises)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in rows)


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {
        "angles from probes": _table("quasistatic", ("0.01", "0.02", "0.03")),
        "angles from probes in MuJoCo": _table("mujoco", ("0.01", "0.03")),
    }
