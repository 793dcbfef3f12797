# SPDX-License-Identifier: Apache-2.0
"""The side view that `render` returns: that of the animation, for an episode that still runs."""

import math

import numpy as np

from palmbots.learn.spaces import MESSAGES, MOVES, PALMS, RobotAction
from palmbots.scene.placement import Placement, place
from palmbots.simulation.episode import Episode
from palmbots.viz.side_view import Moment, Stage
from palmbots.viz.side_view_scene import Message

_MOVE_TEXTS = {"hold": "carries on", "away": "moves away", "closer": "moves closer"}


class EpisodeView:
    """The side view of an episode. Its scale is fixed when it is created."""

    def __init__(self, episode: Episode) -> None:
        self._episode = episode
        scene = episode.scene
        title = f"carry_v0, seed {episode.seed}"
        self._stage = Stage(episode.spec, self._placed(), (), scene.timeout_s, title)

    def draw(self, actions: tuple[RobotAction, RobotAction], messages: bool) -> np.ndarray:
        """The present state with the last actions of the robots: (height, width, 3) of uint8."""
        at = self._episode
        self._stage.move(self._placed())
        seen = at.seen()
        message = None
        for k, (_, _, kind) in enumerate(actions):
            text = MESSAGES[kind]
            if messages and text is not None:
                message = Message("right" if k else "left", "left" if k else "right", text)
        ended = at.outcome != "running"
        moment = Moment(
            row=0,
            time=at.time_s,
            case=("", ""),
            sign=(seen[0][0], seen[1][0]),
            motion=at.sight().motion,
            contact=at.sight().contacts,
            message=message,
            ending=at.outcome if ended else None,
            good=at.outcome == "delivered",
            does=(_action_text(actions[0]), _action_text(actions[1])),
        )
        return np.asarray(self._stage.frame(moment))

    def _placed(self) -> Placement:
        spec, at = self._episode.spec, self._episode.sight()
        return place(
            spec,
            separation=[at.separation],
            midpoint=[at.midpoint],
            palm=[at.palms],
            contact=[at.contacts],
            turn=[math.asin(at.rise / spec.width) if spec.width > 0 else at.turn],
            lift=[at.lift],
        )


def _action_text(action: RobotAction) -> str:
    text = _MOVE_TEXTS[MOVES[action[1]]]
    return f"palm up, {text}" if PALMS[action[0]] == "shallow" else text
