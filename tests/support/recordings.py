# SPDX-License-Identifier: Apache-2.0
"""Recordings of a simulated robot: its commands, and where it was seen; and of packets."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

HIDDEN = {
    "robot.gain": 1.04,
    "robot.bias_m_s": 0.001,
    "robot.gain_sd": 0.03,
    "robot.noise_m_s": 0.004,
    "robot.noise_tau_s": 0.4,
    "robot.white_noise_m_per_sqrt_s": 0.0015,
    "position_noise_m": 0.0004,
}

TICK_S = 0.01
LAG_S = 0.31
_STRETCH_S, _PAUSE_S = 4.0, 1.0
_LAST_S = 6.0
_SLOWING = 0.5 * TICK_S  # m/s in a tick, at an acceleration of 0.5 m/s²


def recorded(
    folder: Path,
    hidden: Mapping[str, float],
    *,
    seed: int,
    stretches: int,
    speeds: tuple[float, float] = (0.03, 0.09),
) -> tuple[Path, Path]:
    """Write commands.csv and positions.csv.

    The robot drives and stands in turns, in the direction 0.7 rad. It is simulated tick by tick as
    the core simulates it, apart from its code: gain once for each stretch, noise that never resets.

    Args:
        folder: for the files.
        hidden: the values to be found again.
        seed: of the random numbers.
        stretches: number of stretches.
        speeds: between which commands are drawn.
    """
    random = np.random.default_rng(seed)
    per = round((_STRETCH_S + _PAUSE_S) / TICK_S)
    ticks = stretches * per + round(_LAST_S / TICK_S)
    wanted = np.zeros(ticks)
    gain = np.ones(ticks)
    for k in range(stretches):
        on = slice(k * per + round(_PAUSE_S / TICK_S), (k + 1) * per)
        wanted[on] = round(random.uniform(*speeds), 4)
        gain[k * per : (k + 1) * per] = random.normal(hidden["robot.gain"], hidden["robot.gain_sd"])
    speed = np.zeros(ticks)
    for k, goal in enumerate(wanted.tolist()[1:], 1):
        before = float(speed[k - 1])
        speed[k] = before + min(max(goal - before, -_SLOWING), _SLOWING)
    memory = np.exp(-TICK_S / hidden["robot.noise_tau_s"])
    drive = np.full(ticks, hidden["robot.noise_m_s"] * np.sqrt(1 - memory**2))
    drive[0] = hidden["robot.noise_m_s"]
    noise = lfilter([1.0], [1.0, -memory], drive * random.normal(size=ticks))
    white = hidden["robot.white_noise_m_per_sqrt_s"] / np.sqrt(TICK_S) * random.normal(size=ticks)
    actual = np.where(speed > 0, gain * speed + hidden["robot.bias_m_s"] + noise + white, 0.0)
    way = np.concatenate([[0.0], np.cumsum(actual * TICK_S)])
    times = TICK_S * np.arange(ticks + 1)
    error = hidden["position_noise_m"] * random.normal(size=(2, ticks + 1))
    commands, positions = folder / "commands.csv", folder / "positions.csv"
    rows = np.column_stack([times[:-1], wanted])[::2]
    np.savetxt(commands, rows, "%.6f", ",", header="time_s,speed_m_s", comments="")
    seen = np.column_stack(
        [times + LAG_S, way * np.cos(0.7) + error[0], way * np.sin(0.7) + error[1]]
    )
    np.savetxt(positions, seen[::2], "%.6f", ",", header="time_s,x_m,y_m", comments="")
    return commands, positions


def packets_csv(folder: Path, name: str, header: str, *columns: NDArray[np.float64]) -> str:
    """Write a recording of packets; returns its name.

    Args:
        folder: for the file.
        name: of the file.
        header: names of the columns.
        columns: the numbers.
    """
    folder.mkdir(exist_ok=True)
    file = folder / name
    np.savetxt(file, np.column_stack(columns), "%.9g", ",", header=header, comments="")
    return str(file)


def gilbert(
    random: np.random.Generator, sent: int, loss: float, share: float, length: float
) -> NDArray[np.bool_]:
    """Which packets are lost: periods of both states are drawn in continuous time.

    Args:
        random: the source of chance.
        sent: number of packets, one in each unit of time.
        loss: probability of a loss while the link is not dead.
        share: of the time in which the link is dead.
        length: mean of such a period.
    """
    edges, time = [], 0.0
    is_dead = random.random() < share
    first = is_dead
    while time < sent:
        time += random.exponential(length if is_dead else length * (1 - share) / share)
        edges.append(time)
        is_dead = not is_dead
    dead = (np.searchsorted(edges, np.arange(sent), side="right") + first) % 2 == 1
    return dead | (random.random(sent) < loss)
