# SPDX-License-Identifier: Apache-2.0
"""Learn to carry: the task as a PettingZoo environment.

What can two robots do that send no messages? Here both follow the same small table: for each sign
that the sensor can read, a palm and a move. There are 216 such tables. The example tries all of
them, with ten decisions a second, and compares the best with the paper's algorithm, which sends
messages.

This example needs the package of one extra: python -m pip install 'pettingzoo>=1.25'
"""

from itertools import product

import numpy as np

from palmbots.learn import carry_v0
from palmbots.learn.baseline_policies import run_episode
from palmbots.learn.spaces import MOVES, PALMS, action

CHOICES = [action(palm, move, messages=False) for palm in PALMS for move in MOVES]


class Table:
    """A policy: one of the choices for each sign."""

    def __init__(self, choices: tuple[int, ...]) -> None:
        self.actions = [CHOICES[k] for k in choices]

    def act(self, observation: np.ndarray) -> np.ndarray:
        """The sign is the observation's first entry: -1, 0 or 1."""
        return self.actions[int(observation[0]) + 1]


silent = carry_v0.parallel_env("paper", messages=False, ticks_per_step=10)


def worth(choices: tuple[int, ...], seeds: range) -> float:
    """Mean return of a table that both robots follow."""
    table = Table(choices)
    policies = {"left": table, "right": table}
    return float(np.mean([run_episode(silent, policies, seed=seed).returned for seed in seeds]))


every = list(product(range(6), repeat=3))
good = sorted(every, key=lambda choices: worth(choices, range(1)))[-10:]
best = max(good, key=lambda choices: worth(choices, range(8)))
for sign, choice in zip("-0+", best, strict=True):
    palm, move = CHOICES[choice]
    print(f"sensor reads {sign}: palm {PALMS[palm]}, {MOVES[move]}")

fresh = range(100, 120)
with_messages = carry_v0.parallel_env("paper")
paper = [run_episode(with_messages, seed=seed).returned for seed in fresh]
print(f"on fresh seeds the table earns {worth(best, fresh):.3f},", end=" ")
print(f"the paper's algorithm {np.mean(paper):.3f}; 2 is the most there is")
