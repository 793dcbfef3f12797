# SPDX-License-Identifier: Apache-2.0
"""The environment: PettingZoo's own tests, observations, rewards, seeds and state."""

import copy
import json
import pickle
from typing import Any

import numpy as np
import pytest
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test, seed_test
from pettingzoo.utils.conversions import aec_to_parallel

from palmbots.errors import PalmbotsError
from palmbots.learn import carry_v0
from palmbots.learn.spaces import ACTION, OBSERVATION, action
from short_episodes import SHORT, ended, short

# PettingZoo recommends other names of agents and other action spaces. Agents are named after their
# sides as everywhere in palmbots, and an action has several components.
pytestmark = [
    pytest.mark.filterwarnings("ignore:We recommend agents to be named:UserWarning"),
    pytest.mark.filterwarnings("ignore:Action space for each agent probably:UserWarning"),
]

KINDS = [
    {},
    {"messages": False},
    {"ticks_per_step": 10},
    {"world": "mujoco", "ticks_per_step": 10},
]


@pytest.mark.parametrize("keys", KINDS, ids=repr)
def test_pettingzoo_accepts_the_parallel_environment(keys: dict[str, Any]) -> None:
    parallel_api_test(short(**keys), num_cycles=200)


@pytest.mark.parametrize("keys", KINDS, ids=repr)
def test_pettingzoo_accepts_the_aec_environment(keys: dict[str, Any]) -> None:
    api_test(carry_v0.env("paper", overrides=SHORT, **keys), num_cycles=200)
    parallel_api_test(aec_to_parallel(carry_v0.raw_env(overrides=SHORT, **keys)), num_cycles=50)


@pytest.mark.parametrize("keys", KINDS, ids=repr)
def test_equal_seeds_give_equal_episodes(keys: dict[str, Any]) -> None:
    parallel_seed_test(lambda: short(**keys), num_cycles=60)
    seed_test(lambda: carry_v0.env("paper", overrides=SHORT, **keys), num_cycles=60)


def contacts_of(env: Any, actions: int = 200) -> list[float]:
    for _ in range(actions):
        env.step({name: np.zeros(3, np.int64) for name in env.agents})
    return env.state()[:2].tolist()


def test_different_seeds_give_different_episodes() -> None:
    env = carry_v0.parallel_env()
    found = []
    for seed in (0, 1, None, None):
        _, infos = env.reset(seed=seed)
        found.append((infos["left"]["seed"], *contacts_of(env)))
    assert len({f[1] for f in found}) == 4
    assert [f[0] for f in found[:2]] == [0, 1]
    env.reset(seed=1)  # what comes after a seed depends on it
    assert env.reset()[1]["left"]["seed"] == found[2][0]
    env.reset(seed=found[2][0])  # each can be had again by its own
    assert contacts_of(env) == list(found[2][1:])


def rest_of(env: Any) -> Any:
    """What follows: the rest of this episode, and the seed of the next one."""
    found = contacts_of(env, 20), env.carry().summary() if not env.agents else None
    return found, env.reset()[1]["left"]["seed"]


@pytest.mark.parametrize("world", ["quasistatic", "mujoco"])
def test_a_saved_or_copied_environment_goes_on_with_the_same_bits(world: str) -> None:
    env, other = (short(world=world, ticks_per_step=10) for _ in range(2))
    env.reset(seed=3)
    contacts_of(env, 5)
    state = env.save_state()
    twins = [copy.deepcopy(env), pickle.loads(pickle.dumps(env)), other]
    other.load_state(pickle.loads(pickle.dumps(state)))
    expected = rest_of(env)
    assert [rest_of(twin) for twin in twins] == [expected] * 3
    env.load_state(state)
    assert rest_of(env) == expected


def test_environments_whose_agents_take_turns_are_copied() -> None:
    env = carry_v0.env("paper", overrides=SHORT)
    env.reset(seed=3)
    env.step(np.zeros(3, np.int64))
    twins = copy.deepcopy(env), pickle.loads(pickle.dumps(env))
    for one in (env, *twins):
        for _ in range(9):
            one.step(np.zeros(3, np.int64))
    assert all((one.state() == env.state()).all() for one in twins)


def test_spaces_with_and_without_messages() -> None:
    talk, mute = short(), short(messages=False)
    assert talk.observation_space("left").shape == (7,)
    assert talk.action_space("right").nvec.tolist() == [2, 3, 4]
    assert mute.observation_space("left").shape == (4,)
    assert mute.action_space("right").nvec.tolist() == [2, 3]
    assert (len(OBSERVATION), len(ACTION)) == (7, 3)


@pytest.mark.parametrize("world", ["quasistatic", "mujoco"])
def test_observation_has_own_palm_move_and_delayed_messages(world: str) -> None:
    env = carry_v0.parallel_env(overrides={"robot.noise_m_s": 0.0}, world=world)
    seen, _ = env.reset(seed=0)
    assert {name: one.tolist() for name, one in seen.items()} == {
        "left": [0, -1, 1, 0, 0, 0, 0],
        "right": [0, -1, 1, 0, 0, 0, 0],
    }
    say = action("shallow", "away", "Ack")
    hold = action("shallow", "hold")
    still = action("steep", "hold")
    seen, *_ = env.step({"left": say, "right": still})
    assert seen["left"].tolist() == [0, 1, 0, 1, 0, 0, 0]
    heard, turned = [], []
    for tick in range(1, 40):
        heard += [tick] * int(seen["right"][6] == 1)
        assert seen["right"][4:].sum() == (tick == 5) and not seen["left"][4:].any()
        turned += [tick] * int(seen["left"][2] == 1)
        seen, *_ = env.step({"left": hold, "right": still})
        assert seen["left"].tolist()[1:4:2] == [1, 0]
    assert heard == [5]  # 0.05 s of latency, once
    # 10 degrees at 50 degrees a second are 20 ticks; a real wrist lags and has some slack.
    assert turned[0] == 20 if world == "quasistatic" else 18 <= turned[0] <= 24


def test_long_step_sends_one_message() -> None:
    env = carry_v0.parallel_env(record=True, ticks_per_step=20, overrides=SHORT)
    env.reset(seed=0)
    steps = 0
    while env.agents:
        env.step({name: action("steep", "hold", "TiltUp") for name in env.agents})
        steps += 1
    done = env.carry()
    assert done.messages == 2 * steps
    assert {message.kind for message in done.message_log} == {"TiltUp"}


def test_without_messages_the_radio_is_silent() -> None:
    env = short(messages=False, record=True)
    env.reset(seed=3)
    while env.agents:
        env.step({name: env.action_space(name).sample() for name in env.agents})
    assert env.carry().messages == 0


def test_termination_truncation_and_outcome() -> None:
    quiet = {"robot.noise_m_s": 0.0, "task.distance_m": 0.1}
    _, rewards, terminal, cut, infos = ended(carry_v0.parallel_env(overrides=quiet), 0)
    assert terminal == {"left": True, "right": True} and cut == {"left": False, "right": False}
    assert infos["left"]["outcome"] == "delivered" and rewards["left"] == rewards["right"] > 1

    _, rewards, terminal, cut, infos = ended(carry_v0.parallel_env(), 0, "away")
    assert all(terminal.values()) and not any(cut.values())
    assert infos["right"]["outcome"] == "dropped" and rewards["left"] < -0.9

    late = carry_v0.parallel_env(overrides=quiet | {"task.timeout_s": 0.5})
    _, rewards, terminal, cut, infos = ended(late, 0)
    assert not any(terminal.values()) and all(cut.values())
    assert infos["left"]["outcome"] == "stalled" and abs(rewards["left"]) < 0.1
    assert late.step({}) == ({}, {}, {}, {}, {})
    with pytest.raises(PalmbotsError, match="episode has ended, so left cannot act; call reset"):
        late.step({"left": [0, 0, 0], "right": [0, 0, 0]})


def test_return_follows_from_the_trace() -> None:
    """From the recorded trace, by the formula in `palmbots.learn.reward`."""
    weights = carry_v0.RewardWeights(progress=2.0, centring=5.0, delivered=0.5, message=0.01)
    env = carry_v0.parallel_env(
        record=True, rewards=weights, overrides={"task.distance_m": 0.3, "palm.left.length_m": 0.2}
    )
    random = np.random.default_rng(0)
    env.reset(seed=4)
    paid = 0.0
    while env.agents:
        send = int(random.integers(4)) if random.random() < 0.1 else 0
        order = np.array([0, 0, send])
        _, rewards, *_ = env.step({"left": order, "right": np.zeros(3, np.int64)})
        paid += rewards["left"]
    done = env.carry()
    assert done.trace is not None and done.outcome == "delivered"
    way = float(done.trace["midpoint"][-1])
    p = done.trace["contact"].to_numpy()[1:] / [0.1, 0.075]
    centring = 5.0 * (0.01 * 0.06 / 0.3) * float((p**2).mean(axis=1).sum())
    assert paid == pytest.approx(2.0 * way / 0.3 - centring + 0.5 - 0.01 * done.messages, rel=1e-9)
    assert done.messages > 5


def test_reset_options_change_the_scene_of_one_episode() -> None:
    env = short()
    _, infos = env.reset(seed=1, options={"overrides": {"start.left_m": 0.03}})
    assert env.state()[0] == 0.03 and infos["left"]["seed"] == 1
    env.reset(seed=1)
    assert env.state()[0] == 0.0


def test_first_observation_includes_a_bump() -> None:
    bump = {"bumps.script": [{"at_s": 0.0, "robot": "left", "shift_m": 0.01}]}
    env = carry_v0.parallel_env(overrides=bump)
    seen, _ = env.reset(seed=0)
    assert seen["left"][0] == 1 and seen["right"][0] == 0


def test_frozen_robot_does_not_run() -> None:
    freeze = {
        "faults.script": [{"kind": "freeze", "robot": "left", "at_s": 0.05, "duration_s": 0.05}]
    }
    env = carry_v0.parallel_env(overrides=freeze)
    _, infos = env.reset(seed=0)
    runs = []
    for _ in range(15):
        runs.append(infos["left"]["runs"])
        *_, infos = env.step({name: np.zeros(3, np.int64) for name in env.agents})
    assert [k for k, one in enumerate(runs) if not one] == [5, 6, 7, 8, 9]


def test_render_shows_the_present_state() -> None:
    for world in ("quasistatic", "mujoco"):
        env = short(render_mode="rgb_array", world=world)
        env.reset(seed=0)
        first = env.render()
        for _ in range(30):
            env.step({name: np.array([1, 1, 1]) for name in env.agents})
        later = env.render()
        assert first is not None and later is not None
        assert first.shape == later.shape and first.dtype == np.uint8 and first.shape[2] == 3
        assert (first != later).any()
    assert short().render() is None


def test_seeds_of_infos_survive_floats_and_json() -> None:
    """The own seeds of 200 episodes: none loses a digit as a 64-bit float, and each repeats its
    episode."""
    env = short()
    _, infos = env.reset(seed=3)
    seed = infos["left"]["seed"]
    for _ in range(200):
        _, infos = env.reset()
        seed = infos["left"]["seed"]
        assert int(float(seed)) == seed == json.loads(json.dumps(seed)) == infos["right"]["seed"]
        assert float(seed) < 2.0**53
    still = dict.fromkeys(env.agents, action("steep", "hold"))
    first = [env.step(still)[0]["left"].tolist() for _ in range(20)]
    env.reset(seed=int(float(seed)))
    assert [env.step(still)[0]["left"].tolist() for _ in range(20)] == first


def test_state_equals_the_world() -> None:
    env = carry_v0.parallel_env(overrides={"robot.noise_m_s": 0.0})
    env.reset(seed=0)
    for _ in range(100):
        env.step({name: np.zeros(3, np.int64) for name in env.agents})
    left, right, one, other, separation, rise, gone, rest = env.state()
    assert (left, right) == (0, 0) and one == other == pytest.approx(np.radians(15))
    assert separation == pytest.approx(0.25) and rise == 0
    assert gone == pytest.approx(0.06 - 0.06 * 0.06 / 0.5 / 2, abs=1e-3)
    assert gone + rest == pytest.approx(1.5)
    assert env.state_space.contains(env.state())


def test_backward_motion_is_progress() -> None:
    back = {"robot.noise_m_s": 0.0, "task.direction": "backward", "task.distance_m": 0.5}
    env = carry_v0.parallel_env(overrides=back, rewards=carry_v0.RewardWeights(centring=0.0))
    env.reset(seed=0)
    paid = 0.0
    for _ in range(100):
        _, rewards, *_ = env.step({name: np.zeros(3, np.int64) for name in env.agents})
        paid += rewards["left"]
    gone, rest = env.state()[6:]
    assert gone == pytest.approx(0.06 - 0.06 * 0.06 / 0.5 / 2, abs=1e-3)
    assert gone + rest == pytest.approx(0.5)
    assert paid == pytest.approx(gone / 0.5)


def test_state_has_left_before_right_and_positive_rise_upwards() -> None:
    env = carry_v0.parallel_env(overrides={"robot.noise_m_s": 0.0})
    env.reset(seed=0)
    up, still = action("shallow", "hold"), action("steep", "hold")
    for _ in range(60):
        env.step({"left": up, "right": still})
    left, right = np.degrees(env.state()[2:4])
    assert left == pytest.approx(5.0) and right == pytest.approx(15.0)
    env.reset(seed=0, options={"overrides": {"start.left_m": -0.03, "start.right_m": 0.03}})
    # Palms rise outward: an object whose right contact is farther out is higher there.
    assert env.state()[5] == pytest.approx(0.06 * np.sin(np.radians(15)), rel=0.05)


def test_vector_environment_equals_single_ones() -> None:
    """As in docs/guide/learning.md: SuperSuit's vector of environments."""
    import supersuit

    single = carry_v0.parallel_env(ticks_per_step=10)
    many: Any = supersuit.concat_vec_envs_v1(
        supersuit.pettingzoo_env_to_vec_env_v1(single), 3, num_cpus=0, base_class="gymnasium"
    )
    seen, _ = many.reset(seed=5)  # the environments get the seeds 5, 6, 7
    assert seen.shape == (6, 7)
    moving = np.tile([action("steep", "away"), action("steep", "hold")], (3, 1))
    alone = [carry_v0.parallel_env(ticks_per_step=10) for _ in range(3)]
    for seed, env in zip((5, 6, 7), alone, strict=True):
        env.reset(seed=seed)
    paid = np.zeros(6)
    for _ in range(20):
        seen, paid, *_ = many.step(moving)
        for k, env in enumerate(alone):
            one, reward, *_ = env.step(dict(zip(("left", "right"), moving[:2], strict=True)))
            assert (seen[2 * k] == one["left"]).all() and (seen[2 * k + 1] == one["right"]).all()
            assert paid[2 * k] == pytest.approx(reward["left"])
    assert len(set(paid[::2].tolist())) == 3


def test_spaces_are_the_same_objects() -> None:
    env = short()
    assert env.action_space("left") is env.action_space("left")
    assert copy.copy(env.possible_agents) == ["left", "right"]


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


def test_refused_calls_change_nothing() -> None:
    """The lines of all of them are in tests/laws/refusals."""
    env, other = short(), short()
    for one in (env, other):
        one.reset(seed=5)
    with pytest.raises(PalmbotsError):
        env.reset(seed=6, options={"start.left_m": 0.03})
    assert env.reset()[1] == other.reset()[1]
    before = env.state()
    still = dict.fromkeys(env.agents, action("steep", "hold"))
    for wrong in ({"right": [0, 3, 0]}, {"middle": [0, 0, 0]}):
        with pytest.raises(PalmbotsError):
            env.step({**still, **wrong})
        assert (env.state() == before).all()
    env.reset(seed=2**64 - 1)
    ended(env, 0)
    assert env.carry().trace is None
    with pytest.raises(PalmbotsError, match="its carry was returned before"):
        env.carry()
