# SPDX-License-Identifier: Apache-2.0
"""A carry along a route, with the files of each stage."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Literal

from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item, Line, quiet, written_file
from palmbots.control.registry import ControllerLike, resolve
from palmbots.errors import PalmbotsError
from palmbots.mujoco.route_carry import RouteCarry, carry_route
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene

_PICTURE = "route.png"


@dataclass(frozen=True, repr=False)
class CarriedRoute(RouteCarry):
    """A carry along a route, and the files that were written."""

    to_count: str = field(default="", metadata=NOT_IN_JSON)
    """The command that counts how often the route fails; empty: it was counted."""
    written: tuple[Path, ...] = field(default=(), metadata=NOT_IN_JSON)

    def lines(self) -> Iterator[Item]:
        """The carry, and the files."""
        yield from super().lines()
        if self.to_count:
            yield quiet("one carry does not show how often this route fails:")
            yield Line(f"run: {self.to_count}", indent=2, is_whole=True)
        yield from map(written_file, self.written)


def refuse_on_route(**options: object) -> None:
    """Raise `PalmbotsError` for options of `palmbots carry` that a route does not have."""
    for name, is_given in options.items():
        if is_given:
            raise PalmbotsError(
                f"--{name}: is not available on a route (task.route); allowed: without it"
            )


def carry_stages(
    scene: Scene,
    controller: ControllerLike,
    *,
    world: str,
    seed: int,
    seeds: int | None,
    place: Path | None,
    folder: Path | None,
    animation: Literal["gif", "mp4", "none"],
    video: bool,
    on_warning: Callable[[str], None],
    on_stage: Callable[..., None],
) -> CarriedRoute:
    """Carry the object along the route of a scene, and write the files of all stages.

    Args:
        scene: with a route.
        controller: as in `palmbots.carry`.
        world: as in `palmbots.carry`.
        seed: as in `palmbots.carry`.
        seeds: count the outcomes of this many seeds; None: of none.
        place: where to write; None: nowhere.
        folder: the same, if it is a folder.
        animation: its format.
        video: write a video of each stage.
        on_warning: called with each warning before the carry.
        on_stage: called with the name of the present part and the completed fraction of it.
    """
    entry = resolve(controller)
    if folder is not None and video:
        from palmbots.mujoco.carry_files import check_video_file

        check_video_file(folder, on_warning)
    found = carry_route(
        scene, entry, world=world, seed=seed, seeds=seeds or 0, record=place is not None,
        on_stage=on_stage,
    )  # fmt: skip
    written: list[Path] = []
    if folder is not None:
        from palmbots.mujoco.carry_files import save_carry

        written.append(folder / _PICTURE)
        found.save_figure(written[0])
        for k, one in enumerate(found.carries, start=1):
            files, _ = save_carry(
                one, folder / f"stage-{k}", animation=animation, video=video, on_stage=on_stage
            )
            written += files
    elif place is not None:
        found.save_figure(place)
        written.append(place)
    count = command_text("carry", scene.spelled, controller=entry.spelled, world=world, seeds=100)
    values = {one.name: getattr(found, one.name) for one in fields(found)}
    return CarriedRoute(**values, to_count="" if seeds else count, written=tuple(written))
