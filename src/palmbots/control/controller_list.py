# SPDX-License-Identifier: Apache-2.0
"""The list of controllers for people, with the noise that each tolerates."""

from collections.abc import Iterator
from dataclasses import dataclass

from palmbots._types import Interval
from palmbots._util.command import command
from palmbots._util.report import Item, Line, bold, good, quiet
from palmbots._util.results import Result
from palmbots.control.registry import controller_names, describe
from palmbots.control.tolerated_noise import RECOMMENDED, tolerated_noise


@dataclass(frozen=True)
class ListedController:
    """A controller, and the noise that it tolerates in the default scene."""

    name: str
    meaning: str
    messages: tuple[str, ...]
    requirements: tuple[str, ...]
    sigma_star_m_s: float | None
    sigma_star_interval: Interval | None
    sigma_star_command: str | None
    """The command that measured it."""


@dataclass(frozen=True, repr=False)
class ControllerList(Result):
    """The controllers."""

    controllers: tuple[ListedController, ...]

    def lines(self) -> Iterator[Item]:
        """Each controller with σ*, its messages, what it requires, and its meaning."""
        for one in self.controllers:
            noise = one.sigma_star_m_s
            star = "" if noise is None else f"  σ* {100 * noise:.2f} cm/s"
            mark = good("  recommended") if one.name == RECOMMENDED else ""
            yield Line(bold(one.name), star, mark)
            yield Line(one.meaning, indent=4)
            if one.messages:
                yield Line(quiet(f"messages: {', '.join(one.messages)}"), indent=4)
            for need in one.requirements:
                yield Line(quiet(f"needs {need}"), indent=4)
        yield quiet(
            "σ*: the speed noise at which 1 % of carries drop the object in the default scene; "
            "measured with: palmbots noise-limit -c CONTROLLER --relative-error-percent 0.3"
        )


@command(order=180, example="palmbots controllers")
def controllers() -> ControllerList:
    """List the controllers, and how much noise they tolerate.

    The option --controller also takes a class of your own, as module:Class or FILE.py:Class.
    """
    return ControllerList(tuple(map(_listed, controller_names())))


def _listed(name: str) -> ListedController:
    entry, noise = describe(name), tolerated_noise(name)
    return ListedController(
        name,
        entry.description,
        entry.messages,
        entry.requirements,
        noise.sigma_star_m_s if noise else None,
        noise.interval if noise else None,
        noise.command if noise else None,
    )
