# SPDX-License-Identifier: Apache-2.0
"""Axes name a scene key in words, with the unit that the table of keys states."""

import pytest

from palmbots.scene.key_reference import scene_keys
from palmbots.scene.key_units import name_of, unit_of

SYMBOLS = {
    "": None, "degrees": "°", "degrees/s": "°/s", "parts per million": "ppm",
    "bumps per metre": "1/m",
}  # fmt: skip


def test_every_key_with_a_unit_has_it_beside_its_name() -> None:
    for key in scene_keys():
        if key.unit:
            assert unit_of(key.name) == SYMBOLS.get(key.unit, key.unit), key.name
            words = key.name.replace(".", " ").split("_")
            assert name_of(key.name).split() < " ".join(words).split(), key.name


@pytest.mark.parametrize(
    ("key", "name", "unit"),
    [
        ("bumps.rate_per_m", "bumps rate", "1/m"),
        ("arm.rate_m_per_s", "arm rate", "m/s"),
        ("mujoco.palm_torque_n_m", "mujoco palm torque", "N m"),
        ("robot.white_noise_m_per_sqrt_s", "robot white noise", "m/√s"),
        ("robot.left.noise_m_s", "robot left noise", "m/s"),
        ("radio.station.latency_s", "radio station latency", "s"),
        ("object.com_m[0]", "object com [0]", "m"),
        ("palm.friction", "palm friction", None),
    ],
)
def test_names_and_units(key: str, name: str, unit: str | None) -> None:
    assert (name_of(key), unit_of(key)) == (name, unit)
