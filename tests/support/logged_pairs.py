# SPDX-License-Identifier: Apache-2.0
"""A simulated pair whose programs write logs, as on real robots."""

from pathlib import Path
from typing import Any

import pytest

from palmbots.logs import run_log_writer
from palmbots.station.simulated_pair import SimulatedPair


class LoggedPair(SimulatedPair):
    """Everything logs, each on a clock of its own."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments, logs=True)

    def written(self) -> Path:
        """The folder with the whole logs."""
        self.close()
        assert not any(line.startswith("log: ") for line in self.lines)
        folder = self.pair.log_folder()
        assert folder is not None
        return folder


def simulated_clock(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """From now on logs take their time from the simulated radio in `air`."""
    place: dict[str, Any] = {"air": None}
    monkeypatch.setattr(
        run_log_writer, "_now_ns",
        lambda: 0 if place["air"] is None else round(1e7 * place["air"].now),
    )  # fmt: skip
    return place
