# SPDX-License-Identifier: Apache-2.0
"""Arguments, options, actions and calls that the environment refuses, each in one line."""

import subprocess
import sys
from typing import Any

import pytest

from palmbots.errors import PalmbotsError, SceneError
from palmbots.learn import carry_v0
from palmbots.learn.spaces import action
from short_episodes import ended, short


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ({"world": "gazebo"}, 'world: value is "gazebo"; allowed: quasistatic, mujoco'),
        ({"messages": "no"}, 'messages: value is "no"; allowed: true, false'),
        ({"record": "x"}, 'record: value is "x"; allowed: true, false'),
        ({"rewards": 3}, "rewards: value is 3; allowed: carry_v0.RewardWeights"),
        ({"ticks_per_step": 0}, "ticks_per_step: value is 0; allowed: 1 to 1000"),
        ({"ticks_per_step": True}, "ticks_per_step: value is true; allowed: 1 to 1000"),
        ({"render_mode": "human"}, 'render_mode: value is "human"; allowed: rgb_array, or None'),
        ({"overrides": {"robot.speed": 1}}, "robot.speed"),
    ],
)
def test_invalid_argument_is_refused(keys: dict[str, Any], says: str) -> None:
    with pytest.raises(PalmbotsError) as caught:
        carry_v0.parallel_env(**keys)
    assert says in str(caught.value) and "\n" not in str(caught.value)


def test_object_that_is_not_held_is_refused() -> None:
    with pytest.raises(SceneError, match=r"not held at the start \(sliding\)"):
        carry_v0.parallel_env(overrides={"palm.friction": 0.01, "object.com_m": [0.2, 0.04]})


@pytest.mark.parametrize(
    "action", [[0, 3, 0], [0, 0], [0, 0, 0, 0], [-1, 0, 0], 5, None, ["a", 0, 0]]
)
def test_invalid_action_is_refused_and_changes_nothing(action: Any) -> None:
    env = short()
    env.reset(seed=0)
    before = env.state()
    with pytest.raises(
        PalmbotsError, match=r"action of right: .* allowed: palm 0 to 1, move 0 to 2"
    ):
        env.step({"left": [0, 0, 0], "right": action})
    assert (env.state() == before).all()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"overides": {"start.left_m": 0.03}}, "overides.*did you mean overrides"),
        ({"start.left_m": 0.03}, "start.left_m.*allowed: overrides"),
        ({"overrides": {}, 3: 4}, "3.*allowed: overrides"),
        ("overrides", "allowed: {overrides"),
        ({"overrides": 3}, "overrides"),
    ],
)
def test_misspelt_option_is_refused(options: Any, words: str) -> None:
    """And the seeds of later episodes are as if it had not been asked for."""
    env, other = short(), short()
    env.reset(seed=5)
    other.reset(seed=5)
    with pytest.raises(PalmbotsError, match=words):
        env.reset(seed=6, options=options)
    assert env.reset()[1] == other.reset()[1]


def test_wrong_calls_are_refused() -> None:
    env = short()
    with pytest.raises(PalmbotsError, match="call reset first"):
        env.state()
    with pytest.raises(SceneError, match=r"noise"):
        env.reset(options={"overrides": {"noise": 1}})
    for seed in (-1, 2**64, 0.5, True):
        with pytest.raises(PalmbotsError, match=r"seed: .* allowed"):
            env.reset(seed=seed)  # type: ignore[arg-type]
    env.reset(seed=2**64 - 1)
    with pytest.raises(PalmbotsError, match="but it has not ended"):
        env.carry()
    ended(env, 0)
    assert env.carry().trace is None
    with pytest.raises(PalmbotsError, match="its carry was returned before"):
        env.carry()
    wrong: list[dict[str, Any]] = [{"progress": -1}, {"message": float("nan")}, {"dropped": "much"}]
    for weights in wrong:
        with pytest.raises(PalmbotsError, match=r"^rewards\.\w+: value is .*; allowed: at least 0"):
            carry_v0.RewardWeights(**weights)


@pytest.mark.parametrize("world", ["quasistatic", "mujoco"])
def test_step_without_an_episode_is_refused(world: str) -> None:
    """Before the first reset, and after close, with and without actions."""
    env = short(world=world)
    still = dict.fromkeys(env.possible_agents, action("steep", "hold"))
    for _ in range(2):
        for actions in (still, {}):
            with pytest.raises(PalmbotsError, match="there is no episode yet; call reset first"):
                env.step(actions)
        env.reset(seed=0)
        assert env.step(still)[0].keys() == {"left", "right"}
        env.close()


@pytest.mark.parametrize("name", ["middle", "Left", "", 0])
def test_action_of_an_unknown_agent_is_refused_and_nothing_happens(name: Any) -> None:
    env = short()
    env.reset(seed=0)
    before = env.state()
    still = dict.fromkeys(env.agents, action("steep", "hold"))
    with pytest.raises(PalmbotsError, match=r"there is no agent .*; allowed: left, right"):
        env.step({**still, name: action("steep", "hold")})
    assert (env.state() == before).all()
    env.step(still)


def test_missing_pettingzoo_is_reported_in_one_line() -> None:
    program = (
        "import sys; sys.modules['pettingzoo'] = None\n"
        "from palmbots.errors import PalmbotsError\n"
        "try:\n    from palmbots.learn import carry_v0\n"
        "except PalmbotsError as error:\n    print(error)"
    )
    caught = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert caught.stdout.startswith("learn: the package pettingzoo is missing; run: ")
    assert caught.stdout.count("\n") == 1
