# SPDX-License-Identifier: Apache-2.0
"""Two shipped controllers as policies of `carry_v0`, and a function that runs policies.

The policies use nothing but the observations. `Baseline` is the paper's distributed algorithm, the
shipped controller of Table 2 (`palmbots.control.DistributedController`), with an inbox of its own:
the environment delivers a message once, while Table 2 leaves a message that it cannot use yet in
the inbox. `SilentBaseline` is the shipped controller `silent` with ``control.brake = false``: it
needs no messages and never stops.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

import numpy as np

from palmbots._util.report import Item, Table
from palmbots._util.results import Result
from palmbots.control.interface import DistributedController, MessageKind, StepInput
from palmbots.control.stepped_by_hand import SilentController
from palmbots.errors import PalmbotsError
from palmbots.learn.spaces import MESSAGES, OBSERVATION, action
from palmbots.scene.scene import Scene, load_scene


class Policy(Protocol):
    """One robot's policy."""

    def act(self, observation: Any, /) -> Any:
        """The action for an observation."""
        ...


class Baseline:
    """Table 2 for one robot. Each agent needs a new one for each episode."""

    def __init__(self) -> None:
        self._table2 = DistributedController()
        self._inbox: deque[MessageKind | None] = deque()

    def act(self, observation: Any) -> Any:
        """The action for an observation.

        Raises:
            PalmbotsError: the environment has no messages.
        """
        if len(observation) != len(OBSERVATION):
            raise PalmbotsError("baseline: Table 2 needs messages; pass messages=True")
        sign, _, turned, _, *heard = np.asarray(observation).tolist()
        if 1 in heard:
            self._inbox.append(MESSAGES[1 + heard.index(1)])
        oldest = self._inbox[0] if self._inbox else None
        seen = StepInput(-1 if sign < 0 else (1 if sign > 0 else 0), oldest, turned > 0)
        output = self._table2.step(seen)
        if output.consume and self._inbox:
            self._inbox.popleft()
        return action(output.palm, output.move, output.send)


class SilentBaseline:
    """The controller `silent` for one robot. Each agent needs a new one for each episode.

    An agent cannot stop, so this is the rule with ``control.brake = false``.

    Args:
        scene: the scene of the environment, which determines when a robot pauses.
        messages: whether the environment has messages; none is sent.
    """

    def __init__(self, scene: Scene | str = "paper", messages: bool = True) -> None:
        self._silent = SilentController(load_scene(scene, {"control.brake": False}))
        self._messages = messages

    def act(self, observation: Any) -> Any:
        """The action for an observation."""
        sign, _, turned = np.asarray(observation).tolist()[:3]
        seen = StepInput(-1 if sign < 0 else (1 if sign > 0 else 0), None, turned > 0)
        output = self._silent.step(seen)
        return action(output.palm, output.move, messages=self._messages)


@dataclass(frozen=True, repr=False)
class EpisodeResult(Result):
    """The result of one episode."""

    outcome: str
    """``delivered``, ``dropped`` or ``stalled``."""
    steps: int
    returned: float
    """Sum of the rewards, without discount."""

    def lines(self) -> Iterator[Item]:
        """The outcome, and the sum of the rewards."""
        yield f"{self.outcome} after {self.steps} steps"
        yield Table(self.value_rows("returned"))


PolicyLike: TypeAlias = "Callable[[], Policy] | Mapping[str, Policy]"
"""A class of policies, or a policy for each agent."""


def run_episode(
    env: Any,
    policies: PolicyLike = Baseline,
    *,
    seed: int | None = None,
    options: dict[str, Any] | None = None,
) -> EpisodeResult:
    """Run one episode of a parallel environment.

    Args:
        env: a parallel environment, such as `carry_v0.parallel_env` makes.
        policies: makes the policy of an agent when called, or a table of policies by agent. A robot
            whose program does not run (a fault of the scene) takes no action. When it restarts, so
            does its policy, unless `policies` is a table.
        seed: random seed of the episode.
        options: as in `CarryEnv.reset`.
    """
    observations, infos = env.reset(seed=seed, options=options)
    if isinstance(policies, Mapping):
        make, each = None, dict(policies)
    else:
        make = policies
        each = {name: make() for name in env.agents}
    still = {name: np.zeros_like(env.action_space(name).nvec) for name in env.agents}
    steps, returned, outcome = 0, 0.0, "running"
    while env.agents:
        for name in env.agents:
            if infos[name]["boots"] and make:
                each[name] = make()
        actions = {
            name: each[name].act(observations[name]) if infos[name]["runs"] else still[name]
            for name in env.agents
        }
        observations, rewards, _, _, infos = env.step(actions)
        steps += 1
        returned += sum(rewards.values()) / len(rewards)
        outcome = next(iter(infos.values())).get("outcome", outcome)
    return EpisodeResult(outcome, steps, returned)
