# SPDX-License-Identifier: Apache-2.0
"""Each disturbance does what its scene key states: noise, limits, bumps, sensors, radio."""

import math
from typing import cast

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_seeds

CALM: dict[str, float] = {"robot.noise_m_s": 0.0}


def carried(controller: str = "none", seed: int = 0, **keys: object) -> pb.simulation.Carry:
    overrides = {key.replace("__", "."): value for key, value in keys.items()}
    return pb.carry("paper", controller, seed=seed, overrides=overrides)


def column(carry: pb.simulation.Carry, name: str) -> np.ndarray:
    assert carry.trace is not None
    return carry.trace[name].values


def test_speed_noise_against_its_closed_forms() -> None:
    """Ornstein-Uhlenbeck: standard deviation noise_m_s from the first tick on, correlation exp(-t /
    tau)."""
    sigma, tau, period, ticks, n = 0.004, 0.2, 0.01, 400, 600
    keys = {
        "robot.noise_m_s": sigma,
        "robot.noise_tau_s": tau,
        "robot.speed_m_s": 0.001,  # reached in the first tick
        "robot.acceleration_m_s2": 100.0,
        "task.timeout_s": ticks * period,
        "palm.friction": 0.3,
    }
    spec = to_spec(pb.load_scene("paper", keys))
    runs = [_core.run(spec, "none", seed, "double", True) for seed in range(n)]
    traces = [cast(dict[str, np.ndarray], run.trace) for run in runs]
    noise = np.array([trace["speed_m_s"][:-1] - 0.001 for trace in traces])
    assert noise.shape == (n, ticks, 2)
    memory = math.exp(-period / tau)
    margin = 5 * math.sqrt(2 * (1 + memory**2) / (1 - memory**2) / (2 * n * ticks))
    assert abs(noise.mean()) < 5 * sigma * math.sqrt(2 * tau / period / (2 * n * ticks))
    assert noise.var() / sigma**2 == pytest.approx(1, abs=margin)
    for lag in (1, 5, 20, 60):
        product = np.mean(noise[:, lag:] * noise[:, :-lag]) / sigma**2
        assert product == pytest.approx(memory**lag, abs=margin)
    at_once = noise[:, 0].var() / sigma**2
    assert at_once == pytest.approx(1, abs=5 * math.sqrt(2 / (2 * n)))
    between = np.mean(noise[:, :, 0] * noise[:, :, 1]) / sigma**2
    assert between == pytest.approx(0, abs=margin)


def test_bias_is_added_to_the_speed() -> None:
    biases = {"robot.left.bias_m_s": 0.002, "robot.right.bias_m_s": -0.001}
    speed = column(pb.carry("paper", "none", overrides=CALM | biases), "speed")
    assert len(speed) > 20
    np.testing.assert_allclose(speed[15:-1], [[0.062, 0.059]] * len(speed[15:-1]), rtol=1e-12)


@pytest.mark.parametrize("controller", ["none", "centralized", "distributed"])
def test_limits_of_speed_and_acceleration(controller: str) -> None:
    keys = CALM | {
        "robot.acceleration_m_s2": 0.3,
        "robot.max_speed_m_s": 0.08,
        "start.left_m": 0.02,
    }
    carry = pb.carry("paper", controller, overrides=keys)
    speed = column(carry, "speed")[:-1]
    wanted = column(carry, "commanded")[:-1]
    from_rest = np.vstack([[0.0, 0.0], speed])
    assert np.abs(np.diff(from_rest, axis=0)).max() <= 0.3 * 0.01 * (1 + 1e-9)
    assert np.abs(speed).max() <= 0.08
    if controller == "distributed":
        assert wanted.min() == pytest.approx(0.03)
        assert speed.min() <= 0.0301
    # Each tick goes as far towards what is wanted as the limits let it.
    target = np.clip(wanted, -0.08, 0.08)
    step = np.clip(target - from_rest[:-1], -0.003, 0.003)
    np.testing.assert_allclose(speed, from_rest[:-1] + step, atol=1e-15)


@pytest.mark.parametrize("rate_deg_s", [20.0, 50.0, 333.0])
def test_palms_turn_at_their_rate(rate_deg_s: float) -> None:
    carry = carried("distributed", palm__rate_deg_s=rate_deg_s)
    palm = np.degrees(column(carry, "palm"))
    turn = np.abs(np.diff(palm, axis=0))
    assert turn.max() == pytest.approx(rate_deg_s * 0.01, rel=1e-9)
    assert palm.min() == pytest.approx(5, abs=1e-9)
    assert palm.max() == pytest.approx(15, abs=1e-9)
    turning = (turn > 0).any()
    assert turning


def test_scripted_bumps_shift_the_contacts() -> None:
    script = [
        {"robot": "left", "at_s": 1.0, "shift_m": 0.008},
        {"robot": "right", "at_m": 0.3, "shift_m": -0.006},
        {"robot": "right", "at_s": 1.0, "shift_m": 0.002},
    ]
    carry = carried(robot__noise_m_s=0.0, bumps__script=script)
    p, time, midpoint = (column(carry, name) for name in ("contact", "time", "midpoint"))
    late = (time >= 1.0 - 1e-9).astype(float)
    far = (midpoint >= 0.3).astype(float)
    np.testing.assert_allclose(p[:, 0], 0.008 * late, atol=1e-15)
    np.testing.assert_allclose(p[:, 1], 0.002 * late - 0.006 * far, atol=1e-15)
    assert carry.bump_count == 3
    # Nobody drives: the separation changes only with the bumps.
    assert np.count_nonzero(np.diff(column(carry, "separation"))) == 2


@pytest.mark.parametrize(("direction", "rate"), [("forward", 0.0), ("backward", 100.0)])
def test_longest_script_of_bumps(direction: str, rate: float) -> None:
    """Each bump comes once, at its time or place along the way, whatever their order. Random bumps
    that shift nothing change nothing."""
    draw = np.random.default_rng(3)
    bumps = [
        (SIDES[k % 3 % 2], ("at_s", "at_m")[k % 2], draw.uniform(0, 0.5), draw.uniform(-2e-4, 2e-4))
        for k in range(64)
    ]
    script = [{"robot": side, key: at, "shift_m": shift} for side, key, at, shift in bumps]
    random = {"bumps.rate_per_m": rate, "bumps.max_shift_m": 0.0}
    keys = {"task.direction": direction, "bumps.script": script}
    carry = pb.carry("paper", "none", overrides=CALM | random | keys)
    p, time, midpoint = (column(carry, name) for name in ("contact", "time", "midpoint"))
    reached = {"at_s": time, "at_m": midpoint if direction == "forward" else -midpoint}
    expected = np.zeros_like(p)
    for side, key, at, shift in bumps:
        expected[:, SIDES.index(side)] += shift * (reached[key] >= at)
    np.testing.assert_allclose(p, expected, atol=1e-14)
    assert carry.bump_count > 164 if rate else carry.bump_count == 64


def test_bump_past_the_end_of_the_palm_drops_the_object() -> None:
    script = [{"robot": "right", "at_s": 2.0, "shift_m": 0.1}]
    carry = carried("distributed", robot__noise_m_s=0.0, bumps__script=script)
    assert (carry.outcome, carry.reason) == ("dropped", "off-palm")
    assert carry.time_s == pytest.approx(2.0)


def test_bump_that_drops_the_object_ends_its_corrections() -> None:
    script = [{"robot": "left", "at_s": 3.0, "shift_m": 0.2}]
    carry = carried("distributed", bumps__script=script, robot__right__bias_m_s=-0.02)
    assert (carry.outcome, carry.time_s) == ("dropped", 3.0)
    assert column(carry, "case")[-2].tolist() == ["c", "a"]
    assert carry.corrections[-1].end_s == 3.0


def test_random_bumps_have_the_given_rate() -> None:
    """Their number has mean rate × distance × 2 robots and the variance of a Poisson number."""
    n, rate, way = 400, 1.0, 1.5
    scene = pb.load_scene(
        "paper",
        CALM | {"bumps.rate_per_m": rate, "bumps.max_shift_m": 0.0, "task.distance_m": way},
    )
    counts = np.array(
        [_core.run(to_spec(scene), "none", s, "double", False).bumps for s in range(n)]
    )
    mean = 2 * rate * way
    assert counts.mean() == pytest.approx(mean, abs=5 * math.sqrt(mean / n) + 0.02)
    assert counts.var() == pytest.approx(mean, rel=5 * math.sqrt(2 / n))
    assert _core.run(to_spec(pb.load_scene("paper")), "none", 0, "double", False).bumps == 0


def test_random_bumps_are_uniform() -> None:
    """Up to max_shift_m in either direction, on either robot."""
    keys = CALM | {"bumps.rate_per_m": 2.0, "bumps.max_shift_m": 0.003}
    shifts = []
    for seed in range(150):
        steps = np.diff(
            column(pb.carry("paper", "none", seed=seed, overrides=keys), "contact"), axis=0
        )
        shifts += [steps[:, k][steps[:, k] != 0] for k in (0, 1)]
    left, right = (np.concatenate(shifts[k::2]) for k in (0, 1))
    both = np.concatenate([left, right])
    assert abs(len(left) - len(right)) < 5 * math.sqrt(len(both))
    assert np.abs(both).max() <= 0.003
    place = np.sort(both / 0.006 + 0.5)
    # Kolmogorov-Smirnov at a level below one in a million.
    distance = np.abs(place - (np.arange(len(place)) + 0.5) / len(place)).max()
    assert distance < 2.7 / math.sqrt(len(place))


@pytest.mark.parametrize("rate", [0.01, 0.2])
def test_false_readings_have_the_given_rate(rate: float) -> None:
    """A contact that stays at 0 reads + or -, each with half the rate: binomial, 5 sigma."""
    signs = np.concatenate(
        [
            column(carried(seed=s, robot__noise_m_s=0.0, tactile__false_rate=rate), "sign")[:-1]
            for s in range(4)
        ]
    ).ravel()
    n = len(signs)
    for sign in (-1, 1):
        expected, share = n * rate / 2, rate / 2
        spread = math.sqrt(n * share * (1 - share))
        assert abs(np.count_nonzero(signs == sign) - expected) < 5 * spread
    # Readings of successive ticks are independent.
    wrong = (signs != 0).astype(float)
    pairs = np.mean(wrong[2:] * wrong[:-2])
    assert pairs == pytest.approx(rate**2, abs=5 * rate / math.sqrt(n))


def test_jitter_never_reorders_messages() -> None:
    held_back = 0
    for seed in range(10):
        carry = carried("distributed", seed=seed, radio__jitter_s=0.5, radio__latency_s=0.02)
        for receiver in ("left", "right"):
            messages = [message for message in carry.message_log if message.receiver == receiver]
            got = [message.received_s for message in messages if message.received_s is not None]
            assert got == sorted(got)
            for message in messages:
                assert message.received_s is not None
                delay = message.received_s - message.sent_s
                assert delay >= 0.02 - 1e-9
                held_back += delay > 0.3
    assert held_back > 10


def test_lost_messages_leave_the_distributed_algorithm_waiting() -> None:
    """A robot that waits for a message waits forever, at nominal speed, as the algorithm
    prescribes."""
    for seed in range(10):
        carry = carried("distributed", seed=seed, radio__loss=1.0)
        assert carry.outcome in ("delivered", "dropped")
        assert carry.messages == carry.messages_lost > 0
        for column_, side in enumerate(SIDES):
            sent = [message for message in carry.message_log if message.sender == side]
            assert len(sent) <= 1  # no answer, no second message
            if sent:
                waited = carry.time_s - sent[0].sent_s
                assert carry.waiting_s[side] == pytest.approx(waited, abs=0.011)
                after = column(carry, "time")[:-1] >= sent[0].sent_s
                wanted = column(carry, "commanded")[:-1][after, column_]
                np.testing.assert_array_equal(wanted, 0.06)


@pytest.mark.parametrize(
    "keys",
    [{}, {"radio__latency_s": 0.3}, {"radio__loss": 0.1}, {"radio__loss": 1.0}],
)
def test_assistant_is_the_robot_that_answered(keys: dict[str, float]) -> None:
    """From the trace: the partner that entered (c) in the meantime, or that is in (b) too."""
    for seed in range(8):
        carry = carried("distributed", seed, **keys)
        cases = np.vstack([[" ", " "], column(carry, "case")[:-1]])
        answered = []
        for c in carry.corrections:
            if c.case == "d":
                assert c.assistant is None
                continue
            partner = "left" if c.robot == "right" else "right"
            first, last = 1 + round(c.start_s / 0.01), 1 + math.ceil(c.end_s / 0.01 - 1e-6)
            there = cases[:, 0 if partner == "left" else 1]
            now, before = there[first:last], there[first - 1 : last - 1]
            came = (now == "c") & (before != "c") | (now == "b") & (c.case == "b")
            assert c.assistant == (partner if came.any() else None), (seed, c)
            if c.end_s < carry.time_s:
                answered.append(c.assistant is not None)
        if carry.messages_lost == 0:
            assert all(answered) and len(answered) > 1
        if keys == {"radio__loss": 1.0}:
            assert [(c.case, c.assistant) for c in carry.corrections if c.case == "a"]
            assert {c.assistant for c in carry.corrections} == {None}


def test_robot_that_waits_forever_gives_a_warning() -> None:
    """Every wait begins with its own message. That message and the palm show in the trace which
    robot waits."""
    steep, shallow = math.radians(15), math.radians(5)
    waits = {
        ("a", "TiltUp"): (steep, "an Ack"),
        ("b", "Ack"): (steep, "an Ack"),
        ("b", "TiltDown"): (shallow, "a TiltDown"),
        ("c", "Ack"): (shallow, "a TiltDown"),
    }
    seen = set()
    for seed in range(30):
        carry = carried("distributed", seed, radio__loss=0.1)
        hangs = []
        for k, side in enumerate(("left", "right")):
            case, palm = column(carry, "case")[-2, k], column(carry, "palm")[-1, k]
            sent = [m for m in carry.message_log if m.sender == side]
            if not sent:
                continue
            message = sent[-1]
            angle, what = waits.get((case, message.kind), (None, ""))
            nominal = column(carry, "commanded")[-2, k] == pytest.approx(0.06)
            if palm == angle and nominal and carry.time_s - message.sent_s > 2.1:
                seen.add((case, what))
                hangs.append(
                    f"the {side} robot has waited since {message.sent_s:.1f} s for {what} that "
                    "does not arrive (a message was lost)"
                )
        assert [w for w in carry.warnings if "does not arrive" in w] == hangs
        bare = pb.carry("paper", seed=seed, record=False, overrides={"radio.loss": 0.1})
        assert bare.warnings == carry.warnings
    assert seen == {("a", "an Ack"), ("b", "an Ack"), ("b", "a TiltDown"), ("c", "a TiltDown")}


def test_python_controller_that_waits_forever_gives_a_warning() -> None:
    lost = pb.carry("paper", pb.control.DistributedController, overrides={"radio.loss": 1.0})
    hangs = "the left robot has waited since 0.9 s for a message that does not arrive"
    assert hangs in lost.warnings[0]


def test_late_messages_give_no_warning() -> None:
    """However late the messages are."""
    for latency in (0.05, 2.0):
        carry = carried("distributed", radio__latency_s=latency)
        assert not any("does not arrive" in w for w in carry.warnings)


def test_centralized_tolerates_lost_packets() -> None:
    """Only the newest state packet counts, so losing half of them makes little difference."""

    def runs(loss: float, latency_s: float = 0.05) -> dict[str, np.ndarray]:
        keys = {"radio.loss": loss, "radio.latency_s": latency_s}
        return run_seeds(to_spec(pb.load_scene("paper", keys)), "centralized", 0, 100, "double")

    def rms(result: dict[str, np.ndarray]) -> float:
        return float(np.sqrt(np.mean(result["contact_rms_m"] ** 2)))

    sure, lossy, slower = runs(0.0), runs(0.5), runs(0.0, 0.1)
    assert (lossy["outcome"] == 1).all()
    assert rms(lossy) < 1.1 * rms(sure)
    assert rms(lossy) < rms(slower)
    carry = carried("centralized", radio__loss=0.5)
    # Two reports every tick, two commands from the first report of both on.
    assert carry.messages == pytest.approx(4 * carry.time_s / 0.01, rel=0.01)
    assert carry.messages_lost == pytest.approx(carry.messages / 2, rel=0.05)
    silent = carried("centralized", radio__loss=1.0)
    assert silent.corrections == ()
    assert not (column(silent, "commanded")[:-1] != 0.06).any()
    assert silent.trace_hash == carried("none").trace_hash


# --- pushes of a robot ---

PUSHES = [
    {"robot": "left", "at_s": 0.5, "duration_s": 0.25, "speed_m_s": 0.08},
    {"robot": "right", "at_s": 0.6, "duration_s": 0.3, "speed_m_s": -0.04},
]
SHORT = {"task.distance_m": 0.3}


def separations(**keys: object) -> np.ndarray:
    result = pb.carry("paper", "none", overrides={"robot.noise_m_s": 0.0, **SHORT, **keys})
    assert result.trace is not None
    return result.trace["separation"].to_numpy()


def test_a_push_moves_its_robot_by_speed_times_duration() -> None:
    moved = np.diff(separations(**{"bumps.pushes": PUSHES}))
    expected = np.zeros_like(moved)
    expected[50:75] += 0.01 * 0.08
    expected[60:90] -= 0.01 * 0.04
    np.testing.assert_allclose(moved, expected, atol=1e-15)
    assert np.ptp(separations()) == 0  # without a push nothing moves


def test_a_push_adds_to_a_calibration_error() -> None:
    bias = {"robot.left.bias_m_s": 0.002}
    both = separations(**{"bumps.pushes": PUSHES[:1]}, **bias)
    alone = separations(**bias)
    np.testing.assert_allclose(both[76] - alone[76], 0.08 * 0.25, atol=1e-12)


def test_a_push_of_speed_zero_changes_no_bit() -> None:
    still = [{**PUSHES[0], "speed_m_s": 0.0}]
    with_push = pb.carry("paper", seed=4, overrides={**SHORT, "bumps.pushes": still})
    assert with_push.trace_hash == pb.carry("paper", seed=4, overrides=SHORT).trace_hash


def test_brakes_hold_a_robot_against_a_push() -> None:
    off = [{"kind": "reboot", "robot": "right", "at_s": 0.1, "duration_s": 5.0}]
    late = [{"robot": "right", "at_s": 2.0, "duration_s": 0.5, "speed_m_s": 0.05}]
    keys = {"robot.noise_m_s": 0.0, "faults.script": off, "task.timeout_s": 3.0}
    hashes = {
        pb.carry("paper", "resilient", overrides={**keys, "bumps.pushes": pushes}).trace_hash
        for pushes in ([], late)
    }
    assert len(hashes) == 1


def test_a_push_moves_the_robots_of_the_mujoco_world() -> None:
    pytest.importorskip("mujoco")
    keys = {"robot.noise_m_s": 0.0, "task.distance_m": 0.08}
    push = {"robot": "left", "at_s": 0.6, "duration_s": 0.25, "speed_m_s": 0.04}
    ends = []
    for pushes in ([], [push]):
        overrides = {**keys, "bumps.pushes": pushes}
        trace = pb.carry("paper", "none", world="mujoco", overrides=overrides).trace
        assert trace is not None
        ends.append(float(trace["separation"][-1]))
    still, moved = ends
    assert moved - still == pytest.approx(0.25 * 0.04, abs=5e-4)
