"""One carry that is told what to do, in either world.

Both kinds have the same face: `seen` and `step` in the numbers of the core, and what a reward or a
picture needs. SI units, radians; pairs are (left, right).
"""

from typing import Any, Protocol

from palmbots import _core
from palmbots.learn.meaning import Do, Seen
from palmbots.lowering import lower
from palmbots.result import Carry, finished
from palmbots.scene import Scene

__all__ = ["Episode", "Now", "begun"]

Pair = tuple[float, float]
Now = tuple[str, int, int, float, Pair]
"""Outcome, ticks and letters so far, midpoint, contacts: as the episode's attributes."""


class Episode(Protocol):
    """A carry under way."""

    scene: Scene
    spec: _core.Spec
    seed: int
    outcome: str
    """``running``, ``delivered``, ``dropped`` or ``stalled``."""
    ticks: int
    """Control periods so far."""
    sent: int
    """Letters so far."""
    contacts: Pair
    lift: Pair
    palms: Pair
    motion: tuple[int, int]
    separation: float
    midpoint: float
    """Of the pivots, from where it started, towards +x [m]."""
    rise: float
    """Of the right contact vertex over the left one [m]."""

    def seen(self) -> tuple[Seen, Seen]:
        """What each robot sees."""
        ...

    def step(self, left: Do, right: Do, ticks: int) -> Now:
        """So many ticks of this."""
        ...

    def finished(self, controller: str) -> Carry:
        """The carry, once it is over; with its trace if it was begun with `record`."""
        ...


def begun(scene: Scene, world: str, seed: int, record: bool) -> Episode:
    """A carry at its start; it may be over already (an object that is not held)."""
    made: Any = _InMujoco if world == "mujoco" else _Quasistatic
    return made(scene, seed, record)


class _Quasistatic:
    """The compiled carry itself."""

    def __init__(self, scene: Scene, seed: int, record: bool) -> None:
        self.scene, self.seed, self._record = scene, seed, record
        self.spec = lower(scene)
        self._core: Any = _core.Episode(self.spec, seed, record)
        self.seen, self.step = self._core.seen, self._core.step

    def __getattr__(self, name: str) -> Any:
        return getattr(self._core, name)

    def finished(self, controller: str) -> Carry:
        run = self._core.run()
        return finished(run, self.scene, controller, "quasistatic", self.seed, self._record)


class _InMujoco:
    """MuJoCo around a crew that is told."""

    def __init__(self, scene: Scene, seed: int, record: bool) -> None:
        from palmbots.dynamic.curved import world_of
        from palmbots.dynamic.run import Keeper
        from palmbots.dynamic.settings import DEFAULT
        from palmbots.dynamic.world import SLACK

        self.scene, self.seed = scene, seed
        self.world = world_of(scene, DEFAULT, measures=record)
        self.spec = self.world.layout.spec
        self._sight = self.world.sight(first=True)
        self._crew: Any = _core.ToldCrew(self.spec, seed, self._sight, SLACK)
        self._keeper = Keeper(self.world) if record else None
        self.seen = self._crew.seen

    def step(self, left: Do, right: Do, ticks: int) -> Now:
        crew, world = self._crew, self.world
        crew.tell(left, right)
        for _ in range(ticks):
            world.move(*crew.command())
            self._sight = world.sight()
            crew.observe(self._sight)
            if self._keeper is not None:
                self._keeper.keep(world)
            if crew.done:
                break
        sight = self._sight
        return crew.outcome, crew.ticks, crew.sent, sight.midpoint, sight.contacts

    @property
    def outcome(self) -> str:
        return self._crew.outcome

    @property
    def ticks(self) -> int:
        return self._crew.ticks

    @property
    def sent(self) -> int:
        return self._crew.sent

    def __getattr__(self, name: str) -> Any:
        return getattr(self._sight, name)

    def finished(self, controller: str) -> Carry:
        from palmbots.dynamic.settings import DEFAULT

        physics = self._keeper.physics(self.world, DEFAULT) if self._keeper is not None else None
        return finished(
            self._crew.run(), self.scene, controller, "mujoco", self.seed, physics is not None,
            physics=physics, left=self.world,
        )  # fmt: skip
