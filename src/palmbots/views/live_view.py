# SPDX-License-Identifier: Apache-2.0
"""A live view of a station for Foxglove, with the channels of a carry log.

It attaches to the station as a viewer: it holds no key, and sends nothing to the robots.
"""

import time
from collections.abc import Callable
from typing import Any

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.logs import scene_updates
from palmbots.logs.channels import CorrectionEvent, StateChannel, channels_of_worlds
from palmbots.logs.robot_description import urdf
from palmbots.logs.run_channels import LineEvent
from palmbots.pair.pair_file import Pair
from palmbots.station.station_client import StationClient
from palmbots.views.estimated_carry import EstimatedCarry
from palmbots.views.foxglove_server import FoxgloveServer
from palmbots.viz.solids import contact_balls, solids

_AGAIN_S = 2.0  # what does not change is sent again, for viewers that come later


class LiveView:
    """What is shown of a station.

    Args:
        pair: the pair; its key is not used.
        server: where viewers connect; its channels are announced here.
    """

    def __init__(self, pair: Pair, server: FoxgloveServer) -> None:
        self._server = server
        self._scene = pair.checked_scene()
        self._carry = EstimatedCarry(self._scene)
        self._parts = solids(self._scene, self._carry.spec)
        self._channels = _state_channels()
        self._sent_s = -_AGAIN_S
        self._time_s = -1.0
        self._corrections: set[str] = set()
        self._printed = 0
        server.add("/robot_description", "cdr", ("std_msgs/msg/String", "ros2msg", _STRING))
        kinds = {
            "/tf": FrameTransforms,
            "/solids": SceneUpdate,
            "/contacts": SceneUpdate,
            "/pair": type(self._channels["pair"].message({})),
            **{f"/{side}": type(self._channels["robot"].message({})) for side in SIDES},
            "/corrections": CorrectionEvent,
            "/station/lines": LineEvent,
        }
        for topic, kind in kinds.items():
            server.add_type(topic, kind)

    def run(
        self,
        client: StationClient,
        restarts_within_s: float,
        is_ended: Callable[[], bool] = lambda: False,
    ) -> None:
        """Show a station until it ends.

        Args:
            client: attached to the station as a viewer.
            restarts_within_s: how long to wait for a station that was killed and starts again.
            is_ended: whether to end.

        Raises:
            PalmbotsError: the station is gone.
        """
        lost_s: float | None = None
        while client.end is None and not is_ended():
            if client.is_connected:
                lost_s = None
                client.wait(0.1)
                client.poll()
                self.show(client)
                continue
            lost_s = lost_s or time.monotonic()
            if not client.reconnect() and time.monotonic() - lost_s >= restarts_within_s:
                raise PalmbotsError("station: its process is gone")
            self._printed = 0

    def show(self, client: StationClient) -> None:
        """Send what is new."""
        now = time.time_ns()
        for line in client.lines[self._printed :]:
            self._server.send_message("/station/lines", LineEvent(text=line), now)
        self._printed = len(client.lines)
        state = client.state
        if state is None or state["time_s"] == self._time_s:
            return
        self._time_s = state["time_s"]
        if time.monotonic() - self._sent_s >= _AGAIN_S:
            self._sent_s = time.monotonic()
            self._send_solids(now)
        self._send_state(state, now)

    def _send_solids(self, now: int) -> None:
        self._server.send_message("/solids", scene_updates.scene_update(self._parts), now)
        text = urdf([*self._parts, *contact_balls()])
        self._server.send("/robot_description", scene_updates.ros_string(text), now)

    def _send_state(self, state: dict[str, Any], now: int) -> None:
        place = self._carry.at(state["robots"], state["time_s"])
        self._server.send_message("/tf", scene_updates.transforms(place, 0, now), now)
        # Real robots do not know whether a contact slides.
        self._server.send_message("/contacts", scene_updates.contact_update((0, 0), now), now)
        angles = self._carry.palm_rad()
        for k, side in enumerate(SIDES):
            robot = state["robots"].get(side)
            if robot is not None:
                values = {
                    "time": state["time_s"],
                    "palm": angles[k],
                    "contact": float("nan"),
                    "sign": robot["sign"],
                    "case": robot["case"] or " ",
                }
                message = self._channels["robot"].message(values)
                self._server.send_message(f"/{side}", message, now)
        pivots = place.pivot[0]
        values = {
            "time": state["time_s"],
            "separation": float(pivots[1][0] - pivots[0][0]),
            "midpoint": float(pivots[:, 0].mean()),
        }
        self._server.send_message("/pair", self._channels["pair"].message(values), now)
        for label, robot, case, assistant in state["corrections"]:
            if label not in self._corrections:
                self._corrections.add(label)
                event = CorrectionEvent(
                    label=label, robot=robot, case=case, assistant=assistant or "",
                    start_s=state["time_s"], end_s=float("nan"),
                )  # fmt: skip
                self._server.send_message("/corrections", event, now)


_STRING = b"string data"


def _state_channels() -> dict[str, StateChannel]:
    """The channels of a carry log for the state of a robot, and of the pair."""
    channels = channels_of_worlds()
    return {"robot" if len(one.topics) > 1 else "pair": one for one in channels}
