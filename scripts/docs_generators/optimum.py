# SPDX-License-Identifier: Apache-2.0
"""Variants of shared-sign beside the optimum."""

import csv
from pathlib import Path

BRAKES = Path(__file__).parents[2] / "benchmarks" / "results" / "brake_rules.csv"
NEVER_S = 100.0
CARRIES = 20_000


def early_brakes() -> str:
    """The results of benchmarks/bench_brake_rules.py at the greater noise."""
    found = list(csv.DictReader(BRAKES.open()))
    noise = max(float(row["noise_m_s"]) for row in found)
    rows = ["| a robot also brakes after | dropped | mean time |", "|---|---|---|"]
    for row in found:
        if float(row["noise_m_s"]) < noise:
            continue
        after = float(row["patience_s"])
        rows.append(
            f"| {'never' if after >= NEVER_S else f'{after:g} s'} "
            f"| {100 * int(row['dropped']) / CARRIES:.2f} % | {float(row['time_s']):.1f} s |"
        )
    return "\n".join(rows)


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {"early brakes": early_brakes()}
