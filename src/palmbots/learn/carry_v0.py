# SPDX-License-Identifier: Apache-2.0
"""The environment `carry_v0`: two robots carry one object; PettingZoo's parallel interface.

The agents ``left`` and ``right`` have the observations and actions of `palmbots.learn.spaces`. Each
may send one message per step over the radio of the scene. Both get the same reward
(`palmbots.learn.reward`). An episode terminates when the object is delivered or dropped, and it is
truncated at the time limit of the scene (`task.timeout_s`). A step has `ticks_per_step` control
periods.

`infos` has two flags for each robot. ``runs`` is false while a fault of the scene stops the robot's
program. ``boots`` is true when the program has just restarted, so that its policy should start
afresh. At the start of an episode `infos` also has the ``seed`` of the carry, and at its end the
``outcome``.

>>> from palmbots.learn import carry_v0
>>> env = carry_v0.parallel_env("paper")
>>> observations, infos = env.reset(seed=0)
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots._types import SIDES
from palmbots._util.arguments import one_of, seed_of, show, whole_number
from palmbots._util.optional_imports import missing_extra
from palmbots.errors import PalmbotsError, SceneError
from palmbots.learn.reward import RewardTerms, RewardWeights
from palmbots.learn.spaces import (
    ACTION,
    RobotAction,
    action_sizes,
    legal_actions,
    observation,
    observation_size,
)
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.episode import Episode, begin_episode
from palmbots.simulation.result import Carry
from palmbots.simulation.worlds import world_names

try:
    from gymnasium.spaces import Box, MultiDiscrete
    from pettingzoo import ParallelEnv
    from pettingzoo.utils import OrderEnforcingWrapper, parallel_to_aec
except ModuleNotFoundError as error:
    raise missing_extra(error.name or "pettingzoo", "learn") from None

AGENTS = list(SIDES)
_PETTINGZOO_PROBE = "options"  # its API tests call reset(options={"options": 1})
_MAX_TICKS = 1000
_STATE_SIZE = 8
StepResult = tuple[str, int, int, float, tuple[float, float]]
"""Outcome, ticks and messages so far, midpoint [m], contacts [m]."""
_SEED_LIMIT = 2**53  # below it a seed survives loggers that store numbers as floats


@dataclass(frozen=True)
class EnvState:
    """What `CarryEnv.save_state` returns; it can be pickled."""

    arguments: tuple[str, int, bool, bool]
    """World, ticks per step, messages and record of the environment."""
    random: Mapping[str, Any]
    """Of the generator of seeds."""
    scene: Scene | None
    """None: there is no episode."""
    seed: int
    steps: tuple[tuple[RobotAction, RobotAction], ...]
    """Of the episode so far; the episode is a function of these, its scene and its seed."""
    is_taken: bool
    """Whether the carry of the episode was returned."""


def parallel_env(scene: Any = "paper", **keys: Any) -> "CarryEnv":
    """The environment; the arguments are those of `CarryEnv`."""
    return CarryEnv(scene, **keys)


def raw_env(scene: Any = "paper", **keys: Any) -> Any:
    """The same environment in PettingZoo's AEC interface, in which agents take turns."""
    return parallel_to_aec(CarryEnv(scene, **keys))


def env(scene: Any = "paper", **keys: Any) -> Any:
    """`raw_env` with checks of the order of calls."""
    return OrderEnforcingWrapper(raw_env(scene, **keys))


class CarryEnv(ParallelEnv[str, Any, Any]):
    """Two robots carry an object: one episode is one carry.

    Args:
        scene: a built-in scene, a TOML file, a table or a `Scene`.
        overrides: scene keys to set, such as ``{"robot.noise_m_s": 0.02}``.
        world: ``quasistatic``, or ``mujoco`` (needs the extra ``palmbots[mujoco]``).
        messages: whether the robots can send messages. If not, observations and actions have no
            entries for them.
        ticks_per_step: control periods for which an action holds, 1 to 1000.
        rewards: weights of the terms of the reward.
        record: store every tick, so that `carry` has a trace (takes time and memory).
        render_mode: ``rgb_array``, or None.

    Raises:
        SceneError: the scene is invalid, or its object is not held at the start.
        PalmbotsError: another argument is not allowed.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - the type that PettingZoo declares
        "name": "carry_v0",
        "render_modes": ["rgb_array"],
        "render_fps": 100,
        "is_parallelizable": True,
    }

    def __init__(
        self,
        scene: Any = "paper",
        *,
        overrides: Mapping[str, Any] | None = None,
        world: str = "quasistatic",
        messages: bool = True,
        ticks_per_step: int = 1,
        rewards: RewardWeights | None = None,
        record: bool = False,
        render_mode: str | None = None,
    ) -> None:
        self._base = load_scene(scene, overrides)
        one_of("world", world, world_names())
        for name, value in (("messages", messages), ("record", record)):
            if value not in (True, False):
                raise PalmbotsError(f"{name}: value is {show(value)}; allowed: true, false")
        if rewards is not None and not isinstance(rewards, RewardWeights):
            raise PalmbotsError(
                f"rewards: value is {show(rewards)}; allowed: carry_v0.RewardWeights"
            )
        ticks_per_step = whole_number("ticks_per_step", ticks_per_step, 1, _MAX_TICKS)
        if render_mode not in (None, "rgb_array"):
            raise PalmbotsError(
                f"render_mode: value is {show(render_mode)}; allowed: rgb_array, or None"
            )
        self.possible_agents = list(AGENTS)
        self.agents = []
        self.render_mode = render_mode
        self.metadata = self.metadata | {
            "render_fps": max(1, round(1 / (ticks_per_step * self._base.control.period_s)))
        }
        self._world, self._messages, self._record = world, bool(messages), bool(record)
        self._ticks = ticks_per_step
        self._rewards = rewards if rewards is not None else RewardWeights()
        entries = observation_size(self._messages)
        self._spaces: dict[str, tuple[Box, MultiDiscrete]] = {
            name: (
                Box(-1.0, 1.0, (entries,), np.float32),
                MultiDiscrete(action_sizes(self._messages)),
            )
            for name in AGENTS
        }
        self._legal_actions = legal_actions(self._messages)
        self.state_space = Box(-np.inf, np.inf, (_STATE_SIZE,), np.float64)
        self._random = np.random.default_rng()
        self._episode: Episode | None = None
        self._view: Any = None
        self._begin(self._base, 0)  # refuses a scene that cannot be carried
        self._episode = None

    # --- PettingZoo -----------------------------------------------------------------------------

    def observation_space(self, agent: str) -> Box:
        """The entries of `palmbots.learn.spaces.OBSERVATION`; those of messages only with them."""
        return self._spaces[agent][0]

    def action_space(self, agent: str) -> MultiDiscrete:
        """The entries of `palmbots.learn.spaces.ACTION`; `send` only with messages."""
        return self._spaces[agent][1]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Begin an episode.

        Args:
            seed: random seed of the carry, as in ``palmbots carry --seed``. Later episodes without
                a seed get seeds that depend on it; these are below 2^53, so a logger that stores
                numbers as floats keeps all their digits. `infos` has the seed as ``seed``.
            options: ``{"overrides": {…}}`` sets scene keys for this episode only. The key
                ``options``, which PettingZoo's own tests pass, has no effect.

        Raises:
            SceneError: a scene key is wrong, or the object is not held at the start.
            PalmbotsError: an option is unknown, or the seed is not allowed.
        """
        scene = self._scene_for(options)
        if seed is None:
            own = int(self._random.integers(_SEED_LIMIT))
        else:
            own = seed_of(seed)
            self._random = np.random.default_rng(own)
        self._begin(scene, own)
        self.agents = list(AGENTS)
        return self._observe(), {name: info | {"seed": own} for name, info in self._infos().items()}

    def step(
        self, actions: Mapping[str, Any]
    ) -> tuple[
        dict[str, Any],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Both robots act for `ticks_per_step` control periods, or until the carry ends.

        After the end of an episode there are no agents: no actions are allowed, and the results
        are empty.

        Raises:
            PalmbotsError: there is no episode (before `reset`, after `close`), or the actions are
                not exactly one for each agent.
        """
        episode = self._current_episode()
        self._check_agents(actions)
        if not self.agents:
            return {}, {}, {}, {}, {}
        self._actions = self._action("left", actions), self._action("right", actions)
        self._steps.append(self._actions)
        _, ticks, sent, midpoint, _ = self._last_step
        self._last_step = step = episode.step(*self._actions, self._ticks)
        outcome = step[0]
        reward = self._terms.step(
            step[3] - midpoint, step[1] - ticks, step[4], step[2] - sent, outcome
        )
        observations, infos = self._observe(), self._infos()
        terminated, truncated = outcome in ("delivered", "dropped"), outcome == "stalled"
        if terminated or truncated:
            self.agents = []
            for info in infos.values():
                info["outcome"] = outcome
        return (
            observations,
            dict.fromkeys(AGENTS, reward),
            dict.fromkeys(AGENTS, terminated),
            dict.fromkeys(AGENTS, truncated),
            infos,
        )

    def state(self) -> np.ndarray:
        """The full state, which no robot knows, for critics in training.

        Contact coordinates (left, right) [m], palm angles (left, right) [rad], separation [m],
        height of the right contact vertex above the left one [m], distance travelled and distance
        to go [m].
        """
        task, at = self._current_episode().scene.task, self._current_episode().sight()
        travelled = at.midpoint * (1.0 if task.direction == "forward" else -1.0)
        to_go = task.distance_m - travelled
        return np.array([*at.contacts, *at.palms, at.separation, at.rise, travelled, to_go])

    def render(self) -> np.ndarray | None:
        """The side view of the present state, in either world: (height, width, 3) of uint8."""
        if self.render_mode is None:
            return None
        from palmbots.learn.rendering import EpisodeView

        if self._view is None:
            self._view = EpisodeView(self._current_episode())
        return self._view.draw(self._actions, self._messages)

    def close(self) -> None:
        """End the present episode; `reset` begins another one."""
        self._episode, self._view = None, None
        self.agents = []

    # --- further --------------------------------------------------------------------------------

    def carry(self, controller: str = "learned") -> Carry:
        """The carry of the finished episode, for figures, animations and logs.

        Raises:
            PalmbotsError: the episode has not ended, or its carry was returned before.
        """
        episode = self._current_episode()
        if episode.outcome == "running" or self._is_taken:
            why = "its carry was returned before" if self._is_taken else "it has not ended"
            raise PalmbotsError(f"carry: each episode has one carry, after its end, but {why}")
        self._is_taken = True
        return episode.make_carry(controller)

    def save_state(self) -> EnvState:
        """The present state, from which `load_state` goes on with the same bits."""
        episode = self._episode
        return EnvState(
            (self._world, self._ticks, self._messages, self._record),
            self._random.bit_generator.state,
            episode.scene if episode else None,
            episode.seed if episode else 0,
            tuple(self._steps) if episode else (),
            self._is_taken,
        )

    def load_state(self, state: EnvState) -> None:
        """Return to a state that this environment, or one with the same arguments, has saved.

        The steps of its episode are run again.

        Raises:
            PalmbotsError: the state is that of an environment with other arguments.
        """
        own = (self._world, self._ticks, self._messages, self._record)
        if not isinstance(state, EnvState) or state.arguments != own:
            raise PalmbotsError(
                "state: is not one of such an environment; allowed: what save_state returned, with "
                "the same world, ticks_per_step, messages and record"
            )
        self._random.bit_generator.state = state.random
        self.close()
        if state.scene is None:
            return
        self._begin(state.scene, state.seed)
        self._steps, self._is_taken = list(state.steps), state.is_taken
        for actions in state.steps:
            self._actions = actions
            self._last_step = self._current_episode().step(*actions, self._ticks)
        self.agents = list(AGENTS) if self._last_step[0] == "running" else []
        self._observe()

    def __getstate__(self) -> dict[str, Any]:
        """For `pickle` and `copy`."""
        rest = vars(self) | {"_episode": None, "_view": None, "_steps": []}
        return {"rest": rest, "state": self.save_state()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        vars(self).update(kept["rest"])
        self.load_state(kept["state"])

    # --- inside ---------------------------------------------------------------------------------

    def _scene_for(self, options: dict[str, Any] | None) -> Scene:
        given: Any = {} if options is None else options
        if not isinstance(given, Mapping):
            raise PalmbotsError(f"options: value is {show(given)}; allowed: {{overrides = …}}")
        for key in given:
            if key != _PETTINGZOO_PROBE:
                one_of("options, key", key, ("overrides",))
        return load_scene(self._base, given.get("overrides"))

    def _begin(self, scene: Scene, seed: int) -> None:
        episode = begin_episode(scene, self._world, seed, self._record)
        if episode.outcome != "running":
            reason = episode.make_carry("none").reason
            raise SceneError(
                f"scene: the object is not held at the start ({reason}); "
                "run: palmbots contact-modes"
            )
        self._episode, self._view, self._is_taken = episode, None, False
        self._terms = RewardTerms(self._rewards, scene)
        self._actions: tuple[RobotAction, RobotAction] = ((0, 0, 0), (0, 0, 0))
        self._steps: list[tuple[RobotAction, RobotAction]] = []
        self._last_step: StepResult = ("running", 0, 0, 0.0, (0.0, 0.0))

    def _current_episode(self) -> Episode:
        if self._episode is None:
            raise PalmbotsError("carry_v0: there is no episode yet; call reset first")
        return self._episode

    def _check_agents(self, actions: Mapping[str, Any]) -> None:
        """Refuse actions of an agent that is unknown or, after the end, of any agent."""
        for name in actions:
            if name not in self.agents:
                why = f"there is no agent {show(name)}; allowed: {', '.join(AGENTS)}"
                if name in AGENTS:
                    why = f"the episode has ended, so {name} cannot act; call reset first"
                raise PalmbotsError(f"actions: {why}")

    def _action(self, name: str, actions: Mapping[str, Any]) -> RobotAction:
        given: Any = None
        try:
            given = actions[name]
            numbers = given.tolist() if isinstance(given, np.ndarray) else given
            return self._legal_actions[tuple(numbers)]
        except (KeyError, TypeError, IndexError):
            entries = zip(ACTION, action_sizes(self._messages), strict=False)
            legal = ", ".join(f"{what} 0 to {n - 1}" for what, n in entries)
            raise PalmbotsError(f"action of {name}: value is {given!r}; allowed: {legal}") from None

    def _observe(self) -> dict[str, Any]:
        self._seen = self._current_episode().seen()
        return {
            name: observation(seen, last, self._messages)
            for name, seen, last in zip(AGENTS, self._seen, self._actions, strict=True)
        }

    def _infos(self) -> dict[str, dict[str, Any]]:
        return {
            name: {"runs": runs, "boots": boots}
            for name, (*_, runs, boots) in zip(AGENTS, self._seen, strict=True)
        }
