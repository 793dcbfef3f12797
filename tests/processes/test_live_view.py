# SPDX-License-Identifier: Apache-2.0
"""Views for Foxglove over a real WebSocket: a log that is played, and a running station."""

import contextlib
import json
import re
import struct
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

import palmbots as pb
from json_output import records, validator
from pair_programs import new_pair, running, started
from palmbots.pair.pair_file import load_pair, station_address
from palmbots.station.station_client import StationClient
from waiting import wait_until

pytest.importorskip("foxglove")
client = pytest.importorskip("websockets.sync.client")

PROTOCOL = "foxglove.sdk.v1"


class Viewer:
    """A plain WebSocket client that subscribes to everything."""

    def __init__(self, socket: Any) -> None:
        self.socket = socket
        assert self.socket.subprotocol == PROTOCOL
        self.server: dict[str, Any] = {}
        self.topics: dict[int, dict[str, Any]] = {}
        self.messages: dict[str, list[tuple[int, bytes]]] = {}

    def receive(self, seconds: float = 30.0) -> None:
        """Take in one message."""
        data = self.socket.recv(timeout=seconds)
        if isinstance(data, str):
            news = json.loads(data)
            if news["op"] == "serverInfo":
                self.server = news
            elif news["op"] == "advertise":
                wanted = [{"id": c["id"], "channelId": c["id"]} for c in news["channels"]]
                self.topics |= {c["id"]: c for c in news["channels"]}
                self.socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
        elif data[0] == 1:
            number, instant = struct.unpack_from("<IQ", data, 1)
            topic = self.topics[number]["topic"]
            self.messages.setdefault(topic, []).append((instant, data[13:]))

    def until(self, *topics: str, within_s: float = 60.0) -> None:
        """Receive until there is a message of each topic."""
        give_up = time.monotonic() + within_s
        while not set(topics) <= self.messages.keys():
            assert time.monotonic() < give_up, (topics, self.messages.keys())
            self.receive()


@contextlib.contextmanager
def viewer(process: "subprocess.Popen[str]") -> Iterator[Viewer]:
    assert process.stdout is not None
    line = process.stdout.readline()
    found = re.match(r"serves (ws://127\.0\.0\.1:\d+); ", line)
    assert found, line
    with client.connect(found[1], subprotocols=[PROTOCOL], max_size=None) as socket:
        yield Viewer(socket)


def test_a_log_is_played(tmp_path: Path) -> None:
    carry = pb.carry("paper", "distributed", record=True, overrides={"task.distance_m": 0.2})
    pb.write_log(carry, tmp_path / "carry.mcap")
    command = ["view", "carry.mcap", "--serve", "127.0.0.1:0", "--rate", "2"]
    with running(command, folder=tmp_path) as (process,), viewer(process) as seen:
        seen.until("/tf", "/solids", "/contacts", "/left", "/right", "/pair", "/robot_description")
    assert seen.server["capabilities"] == []
    kinds = {c["topic"]: (c["encoding"], c["schemaName"]) for c in seen.topics.values()}
    assert kinds["/tf"] == ("protobuf", "foxglove.FrameTransforms")
    assert kinds["/solids"] == ("protobuf", "foxglove.SceneUpdate")
    assert kinds["/robot_description"] == ("cdr", "std_msgs/msg/String")
    frames = FrameTransforms.FromString(seen.messages["/tf"][0][1])
    assert {t.child_frame_id for t in frames.transforms} >= {"left_robot", "right_palm", "object"}
    assert len(SceneUpdate.FromString(seen.messages["/solids"][0][1]).entities) >= 5


def test_a_station_is_shown_live_and_takes_nothing(tmp_path: Path) -> None:
    """The view starts without the key, which it does not need."""
    new_pair(tmp_path)
    pair = load_pair(tmp_path / "pair.toml")
    (tmp_path / "pair.key").rename(tmp_path / "hidden.key")
    world = ["world", "paper", "--serve", f"unix:{tmp_path / 'world'}"]
    view = ["view", "pair.toml", "--serve", "127.0.0.1:0", "--wait-s", "60"]
    with running(view, folder=tmp_path) as (process,):
        (tmp_path / "hidden.key").rename(tmp_path / "pair.key")
        robots = [["robot", "pair.toml", "--side", side] for side in ("left", "right")]
        station = ["station", "pair.toml", "--no-screen"]
        with running(world, *robots, station, folder=tmp_path), viewer(process) as seen:
            seen.until("/tf", "/solids", "/contacts", "/left", "/right", "/pair")
            assert {c["topic"] for c in seen.topics.values()} > {"/corrections", "/station/lines"}
            assert seen.server["capabilities"] == []
            # A viewer that tries to publish is not heard.
            wish = {"wish": "arm", "operation": "arm"}
            channel = {"id": 1, "topic": "/operate", "encoding": "json", "schemaName": ""}
            seen.socket.send(json.dumps({"op": "advertise", "channels": [channel]}))
            seen.socket.send(struct.pack("<BI", 1, 1) + json.dumps(wish).encode())
            before = len(seen.messages["/left"])
            wait_until(lambda: (seen.receive(), len(seen.messages["/left"]) > before + 10)[1])
            with StationClient(station_address(pair), "viewer", 10) as screen:
                wait_until(lambda: (screen.poll(), screen.state)[1])
                assert screen.state is not None
                assert screen.state["wish"] is None
                assert screen.state["robots"]["left"]["mode"] == "disarmed"
    topics = set()
    for log in (tmp_path / "pair-logs").glob("*.mcap"):
        for record in records(log):
            validator("log").validate(record)
            topics.add(record["topic"])
    expected = {"/left/ticks", "/right/ticks", "/station/sent", "/station/received"}
    assert topics >= expected | {"/station/lines"}


def test_bad_addresses_and_files_are_one_line(tmp_path: Path) -> None:
    (tmp_path / "no.mcap").write_text("no log")
    new_pair(tmp_path)
    for words, line in (
        (["no.mcap", "--serve", "127.0.0.1:0"], "palmbots: no.mcap: is no MCAP log, or is damaged"),
        (["no.mcap", "--serve", "here"], 'palmbots: --serve: value is "here"; allowed: HOST:PORT'),
        (["pair.toml"], "palmbots: station: none of this pair runs on this machine; start it with "
                        "palmbots station PAIR"),
    ):  # fmt: skip
        done = started(["view", *words], tmp_path)
        printed, errors = done.communicate(timeout=60)
        assert (done.returncode, printed, errors) == (2, "", line + "\n")
