"""The paper's distributed algorithm as a policy of `carry_v0`, and what runs any policies.

The policy knows nothing but the observations: it is the shipped Table 2 (`palmbots.Distributed`)
with an inbox of its own, since the environment hands a letter over once, while Table 2 leaves one
that it cannot use yet where it is.
"""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from palmbots.controllers import Distributed, Letter, StepInput
from palmbots.errors import PalmbotsError
from palmbots.learn.meaning import LETTERS, OBSERVATION, action

__all__ = ["Baseline", "Played", "Policy", "play"]


class Policy(Protocol):
    """One robot's policy."""

    def act(self, observation: Any, /) -> Any:
        """The action for an observation."""
        ...


class Baseline:
    """Table 2 for one robot; one for each episode and agent."""

    def __init__(self) -> None:
        self._table2 = Distributed()
        self._inbox: deque[Letter | None] = deque()

    def act(self, observation: Any) -> Any:
        """The action for an observation. Raises `PalmbotsError` where robots may not talk."""
        if len(observation) != len(OBSERVATION):
            raise PalmbotsError("baseline: Table 2 needs letters; allowed: messages=True")
        sign, _, turned, _, *heard = np.asarray(observation).tolist()
        if 1 in heard:
            self._inbox.append(LETTERS[1 + heard.index(1)])
        oldest = self._inbox[0] if self._inbox else None
        seen = StepInput(-1 if sign < 0 else (1 if sign > 0 else 0), oldest, turned > 0)
        done = self._table2.step(seen)
        if done.read and self._inbox:
            self._inbox.popleft()
        return action(done.palm, done.move, done.send)


@dataclass(frozen=True)
class Played:
    """One episode."""

    outcome: str
    """``delivered``, ``dropped`` or ``stalled``."""
    steps: int
    returned: float
    """Sum of the rewards, not discounted."""


def play(
    env: Any,
    policies: Callable[[], Policy] | Mapping[str, Policy] = Baseline,
    *,
    seed: int | None = None,
    options: dict[str, Any] | None = None,
) -> Played:
    """Run one episode of a parallel environment.

    `policies` makes a policy for each agent when called, or is a table of them. A robot whose
    program does not run (a fault of the scene) is not asked; when it begins anew, so does a policy
    that can be made.
    """
    observations, infos = env.reset(seed=seed, options=options)
    if isinstance(policies, Mapping):
        made, each = None, dict(policies)
    else:
        made = policies
        each = {name: made() for name in env.agents}
    still = {name: np.zeros_like(env.action_space(name).nvec) for name in env.agents}
    steps, returned, outcome = 0, 0.0, "running"
    while env.agents:
        for name in env.agents:
            if infos[name]["boots"] and made:
                each[name] = made()
        actions = {
            name: each[name].act(observations[name]) if infos[name]["runs"] else still[name]
            for name in env.agents
        }
        observations, rewards, _, _, infos = env.step(actions)
        steps += 1
        returned += sum(rewards.values()) / len(rewards)
        outcome = next(iter(infos.values())).get("outcome", outcome)
    return Played(outcome, steps, returned)
