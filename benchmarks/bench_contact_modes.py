# SPDX-License-Identifier: Apache-2.0
"""All nine contact modes of ten million states in one call, against general solvers, in one run.

    .venv/bin/python benchmarks/bench_contact_modes.py

Prints a table with ratios and writes results/contact_modes.csv; times are per state. Needs scipy,
which `make test` installs.

The peers answer whether one contact mode balances in one state, as anyone would ask a general
solver: are there shares ≥ 0 of the edges of the friction cones that add up to the weight and its
moment? Their matrices are made beforehand and their time is that of the solver alone. Their answers
are compared with ours. Everything runs on one core; a time is the least of several repeats.
"""

import csv
import datetime
import math
import platform
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.optimize import linprog, nnls

import palmbots as pb
from _machine import compiler, processor

RESULTS = Path(__file__).parent / "results" / "contact_modes.csv"
STATES, REPEATS, PEER_STATES = 10**7, 9, 40
WIDTH, COM, FRICTION = 0.25, (0.125, 0.04), 0.3
SHALLOW, STEEP = math.radians(5), math.radians(15)
BOX = {
    "width": WIDTH, "com_x": COM[0], "com_y": COM[1],
    "friction_left": FRICTION, "friction_right": FRICTION,
}  # fmt: skip
# Where on its friction cone a contact's force is: which edges it may be made of, by φ.
LEANS = {"ST": (-1.0, 1.0), "up": (1.0,), "down": (-1.0,)}
WAYS = ({"ST": "ST", "SL": "up", "SR": "down"}, {"ST": "ST", "SR": "up", "SL": "down"})

Floats = NDArray[np.float64]
Problem = tuple[Floats, Floats]


def least_s(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """The least time of several repeats [s]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def problem(p: Floats, mode: tuple[str, str]) -> Problem:
    """Equations A x = b for the shares x of the cone edges: forces and moment, weight 1."""
    theta, phi = (SHALLOW, STEEP), math.atan(FRICTION)
    tilt = math.asin((p[1] * math.sin(theta[1]) - p[0] * math.sin(theta[0])) / WIDTH)
    along = np.array([math.cos(tilt), math.sin(tilt)])
    com_x = COM[0] * along[0] - COM[1] * along[1]
    columns = []
    for side, at in ((0, np.zeros(2)), (1, WIDTH * along)):
        for edge in LEANS[WAYS[side][mode[side]]]:
            lean = theta[side] + edge * phi
            force = (math.sin(lean) * (1 - 2 * side), math.cos(lean))
            columns.append([*force, at[0] * force[1] - at[1] * force[0]])
    return np.array(columns).T, np.array([0.0, 1.0, com_x])


def by_linprog(of: Problem) -> bool:
    """Whether a contact mode balances, by linear programming."""
    found = linprog(np.zeros(of[0].shape[1]), A_eq=of[0], b_eq=of[1], method="highs")
    return found.status == 0


def by_nnls(of: Problem) -> bool:
    """Whether a contact mode balances, by least squares with x ≥ 0."""
    return float(nnls(*of)[1]) < 1e-9


def main() -> None:
    """Time everything, print a table and write the CSV."""
    console = Console()
    rng = np.random.default_rng(0)
    p = rng.uniform(-0.075, 0.075, (2, STATES))
    theta = np.radians(rng.uniform(-10, 35, (2, STATES)))
    fixed = BOX | {"theta_left": SHALLOW, "theta_right": STEEP}

    def contacts(count: int) -> dict[str, Floats]:
        return {"p_left": p[0, :count], "p_right": p[1, :count]}

    nine, version = "nine contact modes", pb.__version__
    alike = least_s(lambda: pb.feasible_contact_modes(**fixed, **contacts(STATES)))
    varied = least_s(
        lambda: pb.feasible_contact_modes(
            **BOX, theta_left=theta[0], theta_right=theta[1], **contacts(STATES)
        )
    )
    everything = least_s(lambda: pb.contact_modes_batch(**fixed, **contacts(STATES // 10)), 3)
    rows = [
        ("feasible_contact_modes, contacts vary", version, 1e9 * alike / STATES, nine, ""),
        ("feasible_contact_modes, angles too", version, 1e9 * varied / STATES, nine, ""),
        ("states, contacts vary", version, 1e10 * everything / STATES, nine, ""),
    ]

    bits = pb.feasible_contact_modes(**fixed, **contacts(PEER_STATES))
    ours = [bool(b >> k & 1) for b in bits for k in range(len(pb.mechanics.CONTACT_MODES))]
    modes = pb.mechanics.CONTACT_MODES
    problems = [problem(p[:, i], mode) for i in range(PEER_STATES) for mode in modes]
    for name, solve in (("linprog (HiGHS)", by_linprog), ("nnls", by_nnls)):

        def solve_all(solve: Callable[[Problem], bool] = solve) -> list[bool]:
            return [solve(one) for one in problems]

        agreed = sum(a == b for a, b in zip(ours, solve_all(), strict=True))
        rows.append(
            (f"scipy {name}", scipy.__version__, 1e9 * least_s(solve_all, 5) / len(problems),
             "one contact mode", f"{agreed} of {len(problems)} as ours")
        )  # fmt: skip

    table = Table("one state", "version", "for", "ns", "ratio", "answers")
    for what, of, ns, per, answers in rows:
        table.add_row(what, of, per, f"{ns:,.1f}", f"{ns / rows[0][2]:,.1f}", answers)
    console.print(table)
    machine, built, python = processor(), compiler(), platform.python_version()
    console.print(f"{machine}; Python {python}, NumPy {np.__version__}")
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(
            ["what", "version", "for", "ns", "ratio", "answers",
             "machine", "python", "numpy", "compiler", "date"]
        )  # fmt: skip
        for what, of, ns, per, answers in rows:
            out.writerow(
                [what, of, per, f"{ns:.1f}", f"{ns / rows[0][2]:.2f}", answers,
                 machine, python, np.__version__, built, datetime.date.today().isoformat()]
            )  # fmt: skip
    console.print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()
