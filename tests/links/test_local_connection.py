# SPDX-License-Identifier: Apache-2.0
"""Connections between processes, over real sockets."""

import socket
import threading
from pathlib import Path

import pytest

import palmbots as pb
from palmbots.links.local_connection import Connection, ConnectionLost, connect, listen
from palmbots.links.udp import UdpLink


def pair_of(address: str) -> tuple[Connection, Connection]:
    door = listen(address)
    if not address.startswith("unix:"):
        address = "{}:{}".format(*door.getsockname())
    near = connect(address, "far", within_s=10)
    stream, _ = door.accept()
    door.close()
    return near, Connection(stream, "near")


@pytest.fixture(params=["127.0.0.1:0", "unix"])
def ends(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Connection, Connection]:
    address = f"unix:{tmp_path / 's'}" if request.param == "unix" else request.param
    return pair_of(address)


def test_frames_arrive_whole_and_in_order(ends: tuple[Connection, Connection]) -> None:
    near, far = ends
    frames = [["left", 1], "end", None, {"long": "x" * 300_000}, 5]
    sender = threading.Thread(target=lambda: [near.send(frame) for frame in frames])
    sender.start()
    assert [far.receive(10) for _ in frames] == frames
    sender.join()
    far.send([1])
    assert near.receive(10) == [1]
    near.close()
    far.close()


def test_a_closed_end_and_silence_are_named(ends: tuple[Connection, Connection]) -> None:
    near, far = ends
    with pytest.raises(ConnectionLost, match=r"^near: no answer within 0.01 s$"):
        far.receive(0.01)
    near.close()
    with pytest.raises(ConnectionLost, match=r"^near: has closed the connection$"):
        far.receive(10)
    far.close()
    with pytest.raises(ConnectionLost, match=r"^near: "):
        far.send(1)


def test_what_is_no_frame_is_refused(ends: tuple[Connection, Connection]) -> None:
    near, far = ends
    near._stream.sendall(b"\xff\n")
    with pytest.raises(ConnectionLost, match=r"^near: sends no frames$"):
        far.receive(10)
    near.close()
    far.close()


def test_the_socket_of_a_file_goes_with_the_door(tmp_path: Path) -> None:
    address = f"unix:{tmp_path / 's'}"
    door = listen(address)
    with pytest.raises(
        pb.PalmbotsError, match=r"cannot listen at .*: it is taken; end the program"
    ):
        listen(address)
    door.close()
    assert [*tmp_path.iterdir()] == []


def test_a_socket_that_was_left_behind_is_replaced(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as killed:
        killed.bind(str(tmp_path / "s"))
    with listen(f"unix:{tmp_path / 's'}"):
        pass


def test_an_offer_never_waits_and_no_frame_is_cut(ends: tuple[Connection, Connection]) -> None:
    near, far = ends
    for number in range(20_000):
        near.offer([number, "x" * 1000])
    got = [far.receive(10)]
    while (frame := far.poll()) is not None:
        got.append(frame)
    near.offer(["late", ""])  # first the rest of the frame that was cut
    while (frame := far.poll()) is not None:
        got.append(frame)
    numbers = [frame[0] for frame in got if frame[0] != "late"]
    assert numbers == sorted(set(numbers))
    assert 10 < len(numbers) < 20_000
    near.close()
    far.close()


def test_a_taken_udp_address_has_a_remedy() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        own = f"127.0.0.1:{other.getsockname()[1]}"
        with pytest.raises(pb.PalmbotsError, match=r"cannot use .*: it is taken; end the program"):
            UdpLink("left", {"left": own, "right": "127.0.0.1:9", "station": "127.0.0.1:10"})
