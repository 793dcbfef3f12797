# SPDX-License-Identifier: Apache-2.0
"""Many carries with a radio that loses packets, for tests and for benchmarks/bench_loss.py."""

from typing import Any

import numpy as np

import palmbots as pb
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_seeds


def many(overrides: dict[str, Any], controller: str, n: int) -> dict[str, np.ndarray]:
    """Metrics of n carries."""
    return run_seeds(to_spec(pb.load_scene("paper", overrides)), controller, 0, n, "double")


def lossy(loss: float) -> dict[str, Any]:
    """Scene keys: half of the losses single, half in bursts; duplicates, reordering, one reboot.

    A carry ends when it has stood six times as long as it needs.
    """
    single = loss / 2
    return {
        "radio.loss": single,
        "radio.burst_fraction": (loss - single) / (1 - single),
        "radio.duplicate": 0.05,
        "radio.jitter_s": 0.03,
        "radio.reorder": True,
        "faults.random_reboots": 1,
        "task.timeout_s": 150.0,
    }
