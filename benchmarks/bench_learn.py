# SPDX-License-Identifier: Apache-2.0
"""The learning environment: steps per second, and the returns of two policies.

    .venv/bin/python benchmarks/bench_learn.py

Writes benchmarks/results/learn.csv. The table is the one that examples/07_learning.py finds: both
robots shallow while they read - (closer) or 0, steep while they read + (away), without messages.
"""

import csv
import datetime
import time
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

from _machine import processor
from palmbots._util.confidence_intervals import wilson
from palmbots._version import __version__
from palmbots.learn import carry_v0
from palmbots.learn.baseline_policies import Baseline, EpisodeResult, run_episode
from palmbots.learn.spaces import action

RESULTS = Path(__file__).parent / "results" / "learn.csv"
STEPS, RUNS, EPISODES = {"quasistatic": 20_000, "mujoco": 300}, 3, 100
NOISES = (0.01, 0.02, 0.03, 0.04)


class Silent:
    """The table that was found."""

    actions = (
        action("shallow", "closer", messages=False),
        action("shallow", "hold", messages=False),
        action("steep", "away", messages=False),
    )

    def act(self, observation: np.ndarray) -> np.ndarray:
        """By the sign."""
        return self.actions[int(observation[0]) + 1]


def pace(world: str, ticks: int) -> float:
    """Steps a second of one core, both robots idle; the best of several runs."""
    env = carry_v0.parallel_env(world=world, ticks_per_step=ticks)
    still = {name: np.zeros(3, np.int64) for name in env.possible_agents}
    best = 0.0
    for _ in range(RUNS):
        env.reset(seed=0)
        began = time.process_time()
        for _ in range(STEPS[world] // (ticks if world == "mujoco" else 1)):
            if not env.agents:
                env.reset()
            env.step(still)
        spent = time.process_time() - began
        best = max(best, STEPS[world] // (ticks if world == "mujoco" else 1) / spent)
    return best


def played(env: Any, policy: Any) -> list[EpisodeResult]:
    """Episodes of the same seeds for everybody."""
    return [run_episode(env, policy, seed=seed) for seed in range(EPISODES)]


def main() -> None:
    """Measure, print, write."""
    console = Console(width=110)
    origin = (processor(), __version__, datetime.date.today().isoformat())
    rows: list[tuple[object, ...]] = []
    for world in STEPS:
        for ticks in (1, 10):
            rate = pace(world, ticks)
            console.print(f"{world}, {ticks} ticks a step: {rate:,.0f} steps/s of one core")
            rows.append(("steps_per_s", world, ticks, "", "", f"{rate:.0f}", "", ""))
    for noise in track(NOISES, console=Console(stderr=True)):
        scene = {"robot.noise_m_s": noise}
        for name, policy, keys in (
            ("baseline", Baseline, {}),
            ("silent table", Silent, {"messages": False, "ticks_per_step": 10}),
        ):
            done = played(carry_v0.parallel_env(overrides=scene, **keys), policy)
            delivered = sum(one.outcome == "delivered" for one in done)
            low, high = wilson(delivered, len(done))
            mean = float(np.mean([one.returned for one in done]))
            console.print(
                f"noise {noise:g} m/s, {name}: {delivered} of {len(done)} delivered "
                f"({100 * low:.1f} to {100 * high:.1f} %), mean return {mean:.3f}"
            )
            rows.append(
                ("episodes", "quasistatic", keys.get("ticks_per_step", 1), name, noise,
                 f"{mean:.4f}", delivered, len(done))
            )  # fmt: skip
    with RESULTS.open("w", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(("what", "world", "ticks_per_step", "policy", "noise_m_s", "value",
                        "delivered", "n", "machine", "palmbots", "date"))  # fmt: skip
        table.writerows((*row, *origin) for row in rows)


if __name__ == "__main__":
    main()
