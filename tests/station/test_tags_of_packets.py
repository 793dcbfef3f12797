# SPDX-License-Identifier: Apache-2.0
"""The tag of a packet is computed twice: by the endpoint that sends it, and by the one that judges
it. Statistics compute none, and a log one of its own key for each packet that it holds."""

from pathlib import Path
from typing import Any

import pytest

import palmbots._core as _core
from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air, SimulatedPair


@pytest.mark.parametrize("logs", [False, True])
def test_only_endpoints_compute_the_tags_of_a_pair(
    logs: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    retagged = _core.wire.retagged
    count = 0

    def refuse(*_: Any) -> None:
        raise AssertionError("a packet was encoded or decoded outside its endpoints")

    def counted(data: bytes, key: bytes) -> bytes:
        nonlocal count
        count += 1
        return retagged(data, key)

    monkeypatch.setattr(_core.wire, "decode", refuse)
    monkeypatch.setattr(_core.wire, "encode", refuse)
    monkeypatch.setattr(_core.wire, "retagged", counted)
    pair = SimulatedPair(
        tmp_path, "shared-sign", Air(delay_ms=20, loss=0.1, duplicate=0.1), UP, logs=logs
    )
    assert pair.carry()
    assert all(end.copies and end.received for end in pair.station.statistics.ends.values())
    pair.close()
    assert (count > 0) == logs
