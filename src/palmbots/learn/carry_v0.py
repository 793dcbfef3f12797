"""The environment `carry_v0`: two robots, one object, PettingZoo's parallel interface.

Agents ``left`` and ``right`` see and do what `palmbots.learn.meaning` lists, at most one letter a
step each way, over the scene's radio. Both get the same reward (`palmbots.learn.reward`). The
episode terminates when the object is delivered or dropped, and is truncated at the scene's time
limit (`task.timeout_s`). A step is `ticks_per_step` control periods.

Of each robot `info` tells ``runs``: whether its program does, false while a fault of the scene
keeps it from acting, and ``boots``: whether it has just begun anew, so that its policy should
forget. At the start it tells the carry's ``seed``, at the end its ``outcome``.

>>> from palmbots.learn import carry_v0
>>> env = carry_v0.parallel_env("paper")
>>> observations, infos = env.reset(seed=0)
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from palmbots.carry import WORLDS
from palmbots.errors import PalmbotsError, SceneError, one_of, show
from palmbots.learn.episodes import Episode, Now, begun
from palmbots.learn.meaning import ACTION, Do, action_sizes, observation, observation_size, orders
from palmbots.learn.reward import Rewards, Scale
from palmbots.result import Carry
from palmbots.scene import Scene, load_scene

try:
    from gymnasium.spaces import Box, MultiDiscrete
    from pettingzoo import ParallelEnv
    from pettingzoo.utils import OrderEnforcingWrapper, parallel_to_aec
except ModuleNotFoundError as error:
    raise PalmbotsError(
        f"learn: the package {(error.name or 'pettingzoo').partition('.')[0]} is missing; "
        "run: pip install 'palmbots[learn]'"
    ) from None

__all__ = ["CarryEnv", "Rewards", "env", "parallel_env", "raw_env"]

AGENTS = ["left", "right"]
_PETTINGZOO_PROBE = "options"  # its API tests call reset(options={"options": 1})
_MOST_TICKS = 1000
_STATE = 8


def parallel_env(scene: Any = "paper", **keys: Any) -> "CarryEnv":
    """The environment; arguments as of `CarryEnv`."""
    return CarryEnv(scene, **keys)


def raw_env(scene: Any = "paper", **keys: Any) -> Any:
    """The same in PettingZoo's other interface (AEC), in which agents take turns."""
    return parallel_to_aec(CarryEnv(scene, **keys))


def env(scene: Any = "paper", **keys: Any) -> Any:
    """`raw_env` that complains of calls in a wrong order."""
    return OrderEnforcingWrapper(raw_env(scene, **keys))


class CarryEnv(ParallelEnv[str, Any, Any]):
    """Two robots carry an object: one episode is one carry.

    Args:
        scene: as in `palmbots.carry`.
        overrides: scene keys to set, such as ``{"robot.noise_m_s": 0.02}``.
        world: ``quasistatic``, or ``mujoco`` (needs the extra ``palmbots[mujoco]``).
        messages: the robots may talk; without, letters are neither seen nor sent.
        ticks_per_step: control periods for which an action holds, 1 to 1000.
        rewards: weights of the reward's terms.
        record: keep every tick, so that `carry` has a trace (costs time and memory).
        render_mode: ``rgb_array``, or None.

    Raises:
        SceneError: the scene makes no sense, or its object is not held at the start.
        PalmbotsError: another argument is not one of those above.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - so PettingZoo has it
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
        rewards: Rewards | None = None,
        record: bool = False,
        render_mode: str | None = None,
    ) -> None:
        self._base = load_scene(scene, overrides)
        one_of("world", world, WORLDS)
        for name, told in (("messages", messages), ("record", record)):
            if told not in (True, False):
                raise PalmbotsError(f"{name}: value is {show(told)}; allowed: true, false")
        if rewards is not None and not isinstance(rewards, Rewards):
            raise PalmbotsError(f"rewards: value is {show(rewards)}; allowed: carry_v0.Rewards")
        if type(ticks_per_step) is not int or not 1 <= ticks_per_step <= _MOST_TICKS:
            raise PalmbotsError(
                f"ticks_per_step: value is {show(ticks_per_step)}; allowed: 1 to {_MOST_TICKS}"
            )
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
        self._rewards = rewards if rewards is not None else Rewards()
        entries = observation_size(self._messages)
        self._spaces = {
            name: (
                Box(-1.0, 1.0, (entries,), np.float32),
                MultiDiscrete(action_sizes(self._messages)),
            )
            for name in AGENTS
        }
        self._orders = orders(self._messages)
        self.state_space = Box(-np.inf, np.inf, (_STATE,), np.float64)
        self._random = np.random.default_rng()
        self._episode: Episode | None = None
        self._picture: Any = None
        self._begin(self._base, 0)  # complains of what cannot be carried now, not later
        self._episode = None

    # --- PettingZoo -----------------------------------------------------------------------------

    def observation_space(self, agent: str) -> Box:
        """The entries of `palmbots.learn.meaning.OBSERVATION`, the letters only with messages."""
        return self._spaces[agent][0]

    def action_space(self, agent: str) -> MultiDiscrete:
        """The entries of `palmbots.learn.meaning.ACTION`, `send` only with messages."""
        return self._spaces[agent][1]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Begin a carry.

        Args:
            seed: of this carry, as in ``palmbots carry --seed``; carries begun after it without a
                seed get others that depend on it. Each `info` tells the carry's own as ``seed``.
            options: ``{"overrides": {…}}`` sets scene keys for this carry alone. No other option is
                known but ``options``, which PettingZoo's own tests give and which does nothing.

        Raises:
            SceneError: a scene key is wrong, or the object is not held at the start.
            PalmbotsError: an option is unknown, or the seed is none.
        """
        scene = self._scene_for(options)
        if seed is not None:
            if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
                raise PalmbotsError(f"seed: value is {show(seed)}; allowed: 0 to 2^64-1")
            self._random = np.random.default_rng(int(seed))
        own = int(self._random.integers(2**63)) if seed is None else int(seed)
        if own >= 2**64:
            raise PalmbotsError(f"seed: value is {show(seed)}; allowed: 0 to 2^64-1")
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
        """Both robots act for `ticks_per_step` control periods, or until the carry is over."""
        if not self.agents:
            return {}, {}, {}, {}, {}
        told = self._order("left", actions), self._order("right", actions)
        self._told = told
        _, ticks, sent, midpoint, _ = self._now
        self._now = now = self._under_way().step(*told, self._ticks)
        outcome = now[0]
        paid = self._scale.step(now[3] - midpoint, now[1] - ticks, now[4], now[2] - sent, outcome)
        observations, infos = self._observe(), self._infos()
        terminal, cut = outcome in ("delivered", "dropped"), outcome == "stalled"
        if terminal or cut:
            self.agents = []
            for info in infos.values():
                info["outcome"] = outcome
        return (
            observations,
            dict.fromkeys(AGENTS, paid),
            dict.fromkeys(AGENTS, terminal),
            dict.fromkeys(AGENTS, cut),
            infos,
        )

    def state(self) -> np.ndarray:
        """What no robot knows, for critics in training: contacts of both [m], their palms [rad],
        separation [m], object's rise [m], way made and way to go [m]."""
        at = self._under_way()
        gone = at.midpoint * (1.0 if at.scene.task.direction == "forward" else -1.0)
        rest = at.scene.task.distance_m - gone
        return np.array([*at.contacts, *at.palms, at.separation, at.rise, gone, rest])

    def render(self) -> np.ndarray | None:
        """The carry from the side as it is now: (height, width, 3) of uint8, in either world."""
        if self.render_mode is None:
            return None
        from palmbots.learn.picture import Picture

        if self._picture is None:
            self._picture = Picture(self._under_way())
        return self._picture.draw(self._told, self._messages)

    def close(self) -> None:
        """Forget the carry under way."""
        self._episode, self._picture = None, None
        self.agents = []

    # --- besides --------------------------------------------------------------------------------

    def carry(self, controller: str = "learnt") -> Carry:
        """The finished carry, for figures, animations and logs; once for each episode.

        Raises `PalmbotsError` while it is under way.
        """
        episode = self._under_way()
        if episode.outcome == "running" or self._taken:
            why = "given away already" if self._taken else "still under way"
            raise PalmbotsError(f"carry: is {why}; allowed: once, after the end of an episode")
        self._taken = True
        return episode.finished(controller)

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
        episode = begun(scene, self._world, seed, self._record)
        if episode.outcome != "running":
            reason = episode.finished("none").reason
            raise SceneError(
                f"scene: the object is not held at the start ({reason}); "
                "`palmbots modes` tells more"
            )
        self._episode, self._picture, self._taken = episode, None, False
        self._scale = Scale(self._rewards, scene)
        self._told: tuple[Do, Do] = ((0, 0, 0), (0, 0, 0))
        self._now: Now = ("running", 0, 0, 0.0, (0.0, 0.0))

    def _under_way(self) -> Episode:
        if self._episode is None:
            raise PalmbotsError("carry_v0: there is no episode yet; call reset first")
        return self._episode

    def _order(self, name: str, actions: Mapping[str, Any]) -> Do:
        given: Any = None
        try:
            given = actions[name]
            numbers = given.tolist() if isinstance(given, np.ndarray) else given
            return self._orders[tuple(numbers)]
        except (KeyError, TypeError, IndexError):
            entries = zip(ACTION, action_sizes(self._messages), strict=False)
            legal = ", ".join(f"{what} 0 to {n - 1}" for what, n in entries)
            raise PalmbotsError(f"action of {name}: is {given!r}; allowed: {legal}") from None

    def _observe(self) -> dict[str, Any]:
        self._seen = self._under_way().seen()
        return {
            name: observation(seen, told, self._messages)
            for name, seen, told in zip(AGENTS, self._seen, self._told, strict=True)
        }

    def _infos(self) -> dict[str, dict[str, Any]]:
        return {
            name: {"runs": runs, "boots": boots}
            for name, (*_, runs, boots) in zip(AGENTS, self._seen, strict=True)
        }
