# SPDX-License-Identifier: Apache-2.0
"""Two emulated boards carry as one program does, bit for bit."""

from typing import Any

import pytest

from emulator.__main__ import CONTROLLERS, FAULTS, carried
from emulator.board import Image

HARD_RADIO = {
    "radio.loss": 0.1, "radio.latency_s": 0.03, "radio.jitter_s": 0.04, "radio.reorder": True,
    "radio.duplicate": 0.1, "radio.corruption": 0.05,
}  # fmt: skip
DRIFT = {"robot.left.clock_ppm": 20000.0, "robot.right.clock_ppm": -15000.0}
MOST_INSTRUCTIONS = 32_000
MOST_STACK = 2048
CASES: dict[str, tuple[str, dict[str, Any]]] = {name: (name, {}) for name in CONTROLLERS} | {
    "resilient, everything": ("resilient", HARD_RADIO | FAULTS | DRIFT),
}
MORE: dict[str, tuple[str, dict[str, Any]]] = {
    f"{name}, everything": (name, HARD_RADIO | FAULTS | DRIFT)
    for name in ("shared-sign", "silent", "centralized")
} | {
    "distributed, losses": ("distributed", {"radio.loss": 0.02}),
    "examples/policies/table-1.toml, losses": (
        "examples/policies/table-1.toml", {"radio.loss": 0.02},
    ),
}  # fmt: skip


def check(image: Image, controller: str, overrides: dict[str, Any], seed: int = 3) -> None:
    row, result, host = carried(image, controller, seed, overrides)
    assert row["trace_hash"] == row["host_trace_hash"]
    assert result.summary() == host.summary()
    assert result.message_log == host.message_log
    assert row["instructions_per_tick"]["worst"] <= MOST_INSTRUCTIONS
    assert row["stack_bytes"] <= MOST_STACK
    if FAULTS.items() <= overrides.items():
        assert row["faults"] == ["power", "watchdog"]


@pytest.mark.parametrize("case", CASES)
def test_boards_carry_as_one_program(image: Image, case: str) -> None:
    check(image, *CASES[case])


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("case", MORE)
def test_boards_carry_as_one_program_in_all_conditions(image: Image, case: str, seed: int) -> None:
    check(image, *MORE[case], seed=seed)


def test_the_image_of_another_compiler_carries_as_one_program(clang_image: Image) -> None:
    check(clang_image, "resilient", {"task.distance_m": 0.5})
