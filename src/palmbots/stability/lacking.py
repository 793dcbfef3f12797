"""After a drop: what the scene lacks even in the best case, so that a user knows where to look.

The best case is the scene's nominal angles, friction and COM, and contacts that never leave the
sensor's zero zone. What fails there fails on the whole palm too, so `palmbots analyze` says why.
"""

import shlex
from collections.abc import Sequence

from palmbots.deadband import zero_zone_edges_m
from palmbots.errors import PalmbotsError
from palmbots.scene import Scene
from palmbots.sections import SIDES
from palmbots.stability.situation import Pair, permitted, situation_of

__all__ = ["lacking", "pointer"]


def lacking(scene: Scene, controller: str) -> tuple[int, ...]:
    """The properties (0, 1, 2) that the scene lacks with contacts in the zero zone.

    Of ``none``, which turns no palm, only that both palms hold the object while steep is asked for,
    and told as 0. Nothing is told of a scene that planar mechanics refuse, such as a curved path.
    """
    try:
        at = situation_of(scene, _zero_zone(scene))
    except PalmbotsError:
        return ()
    angles, numbers = at.angles, (0, 1, 2)
    if controller == "none":
        (_, left), (_, right) = angles
        angles, numbers = ((left, left), (right, right)), (0,)
    envelope, x = at.envelope(), at.com[0]

    def holds(number: int) -> bool:
        ends = (permitted(envelope, number, shallow, angles) for shallow in SIDES)
        return all(low <= x <= high for low, high in ends)

    return tuple(number for number in numbers if not holds(number))


def pointer(
    scene: Scene, controller: str, source: str, changes: Sequence[str] | None
) -> str | None:
    """One line that names the command which tells why; None: the scene lacks nothing.

    Args:
        scene: what was carried.
        controller: by which algorithm.
        source: the scene as it was named on the command line.
        changes: what ``--set`` was given.
    """
    lacks = lacking(scene, controller)
    if not lacks:
        return None
    words = ["palmbots", "analyze", source]
    try:
        situation_of(scene)
    except PalmbotsError:  # of whole palms nothing can be told, but of the zero zone
        words += ["--region-m", *map(str, _zero_zone(scene))]
    for change in changes or ():
        words += ["--set", change]
    if controller == "none":
        what = "does not hold the object between two steep palms"
    else:
        listed = " and ".join(filter(None, [", ".join(map(str, lacks[:-1])), str(lacks[-1])]))
        what = f"does not have propert{'y' if len(lacks) == 1 else 'ies'} {listed}"
    return f"the scene {what}, not even in its zero zone: {shlex.join(words)} tells more"


def _zero_zone(scene: Scene) -> Pair:
    """Where no sensor complains, as far as both palms reach [m]."""
    half = 0.5 * min(scene.palm_of(side).length_m for side in SIDES)
    low, high = zero_zone_edges_m(scene)
    return -min(max(-low, 0.0), half), min(max(high, 0.0), half)
