# SPDX-License-Identifier: Apache-2.0
"""Neighbours of the sign controllers beside them."""

import csv
from pathlib import Path

RESULT = Path(__file__).parents[2] / "benchmarks" / "results" / "sign_neighbours.csv"
RULES = {
    "shared-sign": "`shared-sign`",
    "reverses": "the braking robot keeps its correction",
    "stands-if-steep": "it stands only with a steep palm",
    "stands-if-shallow": "it stands only with a shallow palm",
    "follower-stands": "only the follower stands, with both contacts outward",
    "leader-stands": "only the leader stands, with both contacts inward",
    "stands-shorter": "a leader does not stand while it announces its next palm",
    "stands-longer": "it stands until its own contact is centred, too",
    "partner-holds": "its partner keeps the nominal speed",
    "helper-holds": "a robot whose contact is centred does not correct",
    "apart-holds": "at opposite signs one robot keeps the nominal speed",
    "turns-0.8": "turns of 0.16 s",
    "turns-1.5": "turns of 0.3 s",
    "turns-2": "turns of 0.4 s",
    "turns-never": "no turns",
    "silent": "`silent`",
    "silent-patience-0.4": "… stops after 0.1 s off centre",
    "silent-patience-2": "… after 0.5 s",
    "silent-patience-4": "… after 1 s",
}


def neighbours() -> str:
    """The drops of each rule under each condition."""
    found = list(csv.DictReader(RESULT.open(encoding="utf-8")))
    conditions = dict.fromkeys((row["condition"], row["noise_m_s"]) for row in found)
    heads = [f"{name}, {100 * float(noise):.3g} cm/s" for name, noise in conditions]
    rows = [f"| dropped [%] | {' | '.join(heads)} |", "|---" * (1 + len(heads)) + "|"]
    for rule, words in RULES.items():
        drops = (
            f"{100 * int(row['dropped']) / int(row['carries']):.1f}"
            for row in found
            if row["rule"] == rule
        )
        rows.append(f"| {words} | {' | '.join(drops)} |")
    return "\n".join(rows)


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {"neighbours": neighbours()}
