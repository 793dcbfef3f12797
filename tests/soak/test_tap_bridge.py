# SPDX-License-Identifier: Apache-2.0
"""The impairment of `palmbots up --link` between two network namespaces, for UDP, Zenoh and DDS."""

import math

import pytest

import tap_bridge
from palmbots.links.impairment import Impairment
from tap_bridge import ADDRESSES, TapBridge

pytestmark = [
    pytest.mark.soak,
    pytest.mark.skipif(tap_bridge.missing() is not None, reason=tap_bridge.missing() or ""),
]
COUNT = 1000

RECEIVE = """
import socket, sys, time
one = socket.socket(type=socket.SOCK_DGRAM); one.bind((sys.argv[1], 7000)); one.settimeout(3)
print("ready", flush=True); seen = []; delays = []
try:
    while True:
        text = one.recv(100).decode().split(); seen.append(int(text[0]))
        delays.append(time.monotonic() - float(text[1]))
except TimeoutError:
    overtaken = sum(b < a for a, b in zip(seen, seen[1:]))
    print(len(seen), len(set(seen)), overtaken, sorted(delays)[len(delays) // 2])
"""
SEND = """
import socket, sys, time
one = socket.socket(type=socket.SOCK_DGRAM)
for k in range(int(sys.argv[2])):
    one.sendto(f"{k} {time.monotonic()}".encode(), (sys.argv[1], 7000)); time.sleep(0.002)
"""


def exchanged(bridge: TapBridge) -> tuple[int, int, int, float]:
    """Datagrams that arrived, different ones among them, overtaken ones, and the median delay."""
    receiver = bridge.run("b", RECEIVE, ADDRESSES["b"])
    assert receiver.stdout is not None and receiver.stdout.readline() == "ready\n"
    with bridge.run("a", SEND, ADDRESSES["b"], str(COUNT)) as sender:
        assert sender.wait(60) == 0
    printed, _ = receiver.communicate(timeout=60)
    arrived, different, overtaken, delay_s = printed.split()
    return int(arrived), int(different), int(overtaken), float(delay_s)


@pytest.mark.parametrize("seed", range(2))
def test_datagrams_meet_the_fate_that_was_asked_for(seed: int) -> None:
    bad = Impairment(loss=0.2, delay_ms=50.0, jitter_ms=30.0, duplicate=0.1)
    with TapBridge(bad, seed) as bridge:
        arrived, different, overtaken, delay_s = exchanged(bridge)
    error = 5 * math.sqrt(COUNT * 0.2 * 0.8)
    assert abs(different - 0.8 * COUNT) < error
    assert abs(arrived - 0.88 * COUNT) < 1.5 * error
    assert overtaken > 100
    assert 0.04 < delay_s < 0.1


def test_a_good_radio_loses_nothing() -> None:
    with TapBridge(Impairment()) as bridge:
        arrived, different, overtaken, _ = exchanged(bridge)
    assert (arrived, different, overtaken) == (COUNT, COUNT, 0)


ZENOH = """
import sys, time, zenoh
settings = zenoh.Config()
settings.insert_json5("scouting/multicast/enabled", "false")
settings.insert_json5(sys.argv[1] + "/endpoints", f'["udp/{sys.argv[2]}:7447"]')
session = zenoh.open(settings); got = []
if sys.argv[1] == "listen":
    session.declare_subscriber("palmbots", lambda sample: got.append(sample.payload.to_bytes()))
    print("ready", flush=True); end = time.monotonic() + 8
    while time.monotonic() < end and len(got) < 200: time.sleep(0.05)
    print(len(got))
else:
    time.sleep(1)
    for k in range(300):
        session.put("palmbots", bytes([k % 256])); time.sleep(0.01)
session.close()
"""


def test_zenoh_goes_through_it() -> None:
    pytest.importorskip("zenoh")
    with TapBridge(Impairment(loss=0.05, delay_ms=10.0, jitter_ms=5.0)) as bridge:
        receiver = bridge.run("b", ZENOH, "listen", ADDRESSES["b"])
        assert receiver.stdout is not None and receiver.stdout.readline() == "ready\n"
        sender = bridge.run("a", ZENOH, "connect", ADDRESSES["b"])
        printed, _ = receiver.communicate(timeout=60)
        sender.wait(60)
        sender.communicate()
    assert int(printed) > 100


DDS = """
import os, sys, time
from dataclasses import dataclass
os.environ["CYCLONEDDS_URI"] = f"<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='{sys.argv[2]}'/></Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery><Peers><Peer address='{sys.argv[3]}'/></Peers></Discovery></Domain></CycloneDDS>"
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
@dataclass
class Number(IdlStruct, typename="Number"):
    value: int
topic = Topic(participant := DomainParticipant(77), "numbers", Number)
end = time.monotonic() + 15; got = 0
if sys.argv[1] == "read":
    reader = DataReader(participant, topic); print("ready", flush=True)
    while time.monotonic() < end and got < 100:
        got += len(reader.take(50)); time.sleep(0.02)
    print(got)
else:
    writer = DataWriter(participant, topic)
    while time.monotonic() < end:
        writer.write(Number(1)); time.sleep(0.02)
"""  # noqa: E501


def test_dds_goes_through_it() -> None:
    pytest.importorskip("cyclonedds")
    with TapBridge(Impairment(loss=0.05, delay_ms=10.0, jitter_ms=5.0)) as bridge:
        receiver = bridge.run("b", DDS, "read", ADDRESSES["b"], ADDRESSES["a"])
        assert receiver.stdout is not None and receiver.stdout.readline() == "ready\n"
        sender = bridge.run("a", DDS, "write", ADDRESSES["a"], ADDRESSES["b"])
        printed, _ = receiver.communicate(timeout=60)
        sender.kill()
        sender.communicate()
    assert int(printed) >= 100
