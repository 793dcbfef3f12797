# SPDX-License-Identifier: Apache-2.0
"""The quasistatic world: the compiled core runs the whole carry."""

from collections.abc import Callable, Sequence
from typing import Any

import palmbots._core as _core
from palmbots.scene.scene import Scene
from palmbots.simulation.driven_world import DrivenQuasistatic
from palmbots.simulation.prepare import Prepared, prepare
from palmbots.simulation.result import Carry, make_carry
from palmbots.simulation.worlds import PRECISIONS, WorldEntry, WorldRun


def run(
    prepared: Prepared,
    seed: int,
    *,
    precision: str = "double",
    record: bool = False,
    on_tick: Callable[[Any], None] | None = None,
    on_progress: Callable[[float], None] | None = None,
    forks: Sequence[tuple[float, int]] = (),
) -> WorldRun:
    """Run one carry; it takes milliseconds, so the callbacks are not called."""
    core = prepared.controller.for_core(prepared.spec)
    return WorldRun(_core.run(prepared.spec, core, seed, precision, record, list(forks)))


class QuasistaticEpisode:
    """A carry that is stepped from outside."""

    def __init__(self, scene: Scene, seed: int, record: bool) -> None:
        self._prepared = prepare(scene, "none", "quasistatic")
        self.scene, self.spec, self.seed = scene, self._prepared.spec, seed
        self._record = record
        self._core: Any = _core.Episode(self.spec, seed, record)
        self.seen, self.step = self._core.observations, self._core.step

    def __getattr__(self, name: str) -> Any:
        return getattr(self._core, name)

    def make_carry(self, controller: str) -> Carry:
        """The carry, once it is over."""
        run = WorldRun(self._core.run())
        return make_carry(self._prepared.renamed(controller), self.seed, run, record=self._record)


WORLD = WorldEntry(
    "quasistatic",
    "planar, without inertia and impacts; fast",
    run=run,
    episode=QuasistaticEpisode,
    driven=DrivenQuasistatic,
    precisions=PRECISIONS,
    supports_bumps=True,
    supports_forks=True,
    supports_references=True,
)
