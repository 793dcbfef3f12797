# SPDX-License-Identifier: Apache-2.0
"""Learn to carry: the task as a PettingZoo environment (pip install 'palmbots[learn]').

What can two robots do that may not talk? Here each follows the same small table: for every sign
that its sensor may read, a palm and a move. There are 216 such tables; try them all, ten decisions
a second, and see how the best one does beside the paper's algorithm, which talks.
"""

from itertools import product

import numpy as np

from palmbots.learn import carry_v0
from palmbots.learn.baseline import run_episode
from palmbots.learn.spaces import MOVES, PALMS, action

CHOICES = [action(palm, move, messages=False) for palm in PALMS for move in MOVES]


class Table:
    """A policy: one of the choices for each sign."""

    def __init__(self, choices: tuple[int, ...]) -> None:
        self.actions = [CHOICES[k] for k in choices]

    def act(self, observation: np.ndarray) -> np.ndarray:
        """The sign is the observation's first entry: -1, 0 or 1."""
        return self.actions[int(observation[0]) + 1]


mute = carry_v0.parallel_env("paper", messages=False, ticks_per_step=10)


def worth(choices: tuple[int, ...], seeds: range) -> float:
    """Mean return of a table that both robots follow."""
    table = Table(choices)
    policies = {"left": table, "right": table}
    return float(np.mean([run_episode(mute, policies, seed=seed).returned for seed in seeds]))


every = list(product(range(6), repeat=3))
good = sorted(every, key=lambda choices: worth(choices, range(1)))[-10:]
best = max(good, key=lambda choices: worth(choices, range(8)))
for sign, choice in zip("-0+", best, strict=True):
    palm, move = CHOICES[choice]
    print(f"sensor reads {sign}: palm {PALMS[palm]}, {MOVES[move]}")

fresh = range(100, 120)
talking = carry_v0.parallel_env("paper")
paper = [run_episode(talking, seed=seed).returned for seed in fresh]
print(f"on fresh seeds the table earns {worth(best, fresh):.3f},", end=" ")
print(f"the paper's algorithm {np.mean(paper):.3f}; 2 is the most there is")
