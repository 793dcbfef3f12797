"""What `render` shows: the side view of the animation, of a carry that is still under way."""

import math

import numpy as np

from palmbots.geometry import Placement, place
from palmbots.learn.episodes import Episode
from palmbots.learn.meaning import LETTERS, MOVES, PALMS, Do
from palmbots.sideview import Moment, Stage
from palmbots.sideview_world import Message

__all__ = ["Picture"]

_DOES = {"hold": "carries on", "away": "moves away", "closer": "moves closer"}


class Picture:
    """The scene's stage, to scale as it was when this was made."""

    def __init__(self, episode: Episode) -> None:
        self._episode = episode
        scene = episode.scene
        title = f"carry_v0, seed {episode.seed}"
        self._stage = Stage(episode.spec, self._placed(), (), scene.timeout_s, title)

    def draw(self, told: tuple[Do, Do], messages: bool) -> np.ndarray:
        """(height, width, 3) of uint8: the moment, with what the robots have been told."""
        at = self._episode
        self._stage.move(self._placed())
        seen = at.seen()
        message = None
        for k, (_, _, letter) in enumerate(told):
            text = LETTERS[letter]
            if messages and text is not None:
                message = Message("right" if k else "left", "left" if k else "right", text)
        ended = at.outcome != "running"
        moment = Moment(
            row=0,
            time=at.ticks * at.scene.control.period_s,
            case=("", ""),
            sign=(seen[0][0], seen[1][0]),
            motion=at.motion,
            contact=at.contacts,
            message=message,
            ending=at.outcome if ended else None,
            good=at.outcome == "delivered",
            does=(_does(told[0]), _does(told[1])),
        )
        return np.asarray(self._stage.frame(moment))

    def _placed(self) -> Placement:
        at = self._episode
        return place(
            at.spec,
            separation=[at.separation],
            midpoint=[at.midpoint],
            palm=[at.palms],
            contact=[at.contacts],
            turn=[math.asin(at.rise / at.spec.width)],
            lift=[at.lift],
        )


def _does(told: Do) -> str:
    text = _DOES[MOVES[told[1]]]
    return f"palm up, {text}" if PALMS[told[0]] == "shallow" else text
