# SPDX-License-Identifier: Apache-2.0
"""The link through a serial line, over real pseudo-terminals."""

import random
import struct
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
import serial_oracle
from palmbots.links.link import LinkSettings
from palmbots.links.link_registry import open_link
from palmbots.links.serial_link import SerialLink
from serial_lines import frames_in, lines
from waiting import wait_until

PACKET, REPORT = serial_oracle.KINDS["packet"], serial_oracle.KINDS["bridge_report"]
LINES: list[str] = []


def opened(device: Path) -> SerialLink:
    LINES.clear()
    ends: dict[Any, str] = {"left": str(device), "right": "?", "station": "?"}
    link = open_link("serial", LinkSettings("left", ends, on_line=LINES.append))
    assert isinstance(link, SerialLink)
    return link


def received(link: SerialLink, count: int) -> list[bytes]:
    found: list[bytes] = []
    wait_until(lambda: (found.extend(link.receive()), len(found) >= count)[1])
    return found


def test_packets_become_frames_and_back(tmp_path: Path) -> None:
    chance = random.Random(1)
    packets = [chance.randbytes(32) for _ in range(50)]
    with lines(tmp_path / "tty") as (line,):
        link = opened(tmp_path / "tty")
        sent = b""
        for packet in packets:
            link.send("right", packet)
            sent += line.read()
        sent += line.read()
        assert frames_in(sent) == [(PACKET, packet) for packet in packets]
        # In pieces that do not end where frames end.
        stream = b"".join(serial_oracle.frame(PACKET, packet) for packet in packets)
        found = []
        for at in range(0, len(stream), 11):
            line.write(stream[at : at + 11])
            found += link.receive()
        found += received(link, len(packets) - len(found))
        assert found == packets
        link.close()
    assert LINES == []


def test_damage_and_reports_are_counted(tmp_path: Path) -> None:
    with lines(tmp_path / "tty") as (line,):
        link = opened(tmp_path / "tty")
        good = serial_oracle.frame(PACKET, b"packet")
        line.write(b"noise\0" + good + good[:-3] + b"\x07\0" + serial_oracle.frame(0x7F, b"?"))
        line.write(serial_oracle.frame(REPORT, struct.pack("<6I", 1, 2, 3, 4, 5, 6)) + good)
        assert received(link, 2) == [b"packet", b"packet"]
        names = ("sent", "received", "radio_full", "serial_full", "radio_damaged")
        expected = dict(zip((*names, "serial_damaged"), range(1, 7), strict=True))
        details = link.details
        assert details["bridge"]._asdict() == expected
        assert (details["damaged"], details["unknown"], details["open"]) == (2, 1, True)
        link.close()


def test_a_busy_line_never_waits_and_drops_whole_packets(tmp_path: Path) -> None:
    """Nobody reads the other end: the system's buffer fills up, and to wait would be for ever."""
    with lines(tmp_path / "tty") as (line,):
        link = opened(tmp_path / "tty")
        for number in range(5000):
            link.send("right", struct.pack("<I", number) * 8)
        assert link.details["dropped"] > 1000
        sent = b""
        while data := line.read():
            sent += data
            link.receive()  # writes the rest of a frame
        found = frames_in(sent)
        assert len(found) == 5000 - link.details["dropped"]
        link.send("right", b"after")
        assert frames_in(line.read()) == [(PACKET, b"after")]
        link.close()


def test_an_unplugged_line_comes_back(tmp_path: Path) -> None:
    with lines(tmp_path / "tty") as (line,):
        link = opened(tmp_path / "tty")
        line.write(serial_oracle.frame(PACKET, b"before") + b"half a fra")
        assert received(link, 1) == [b"before"]
        line.unplug()
        wait_until(lambda: link.receive() == [] and not link.details["open"])
        link.send("right", b"lost")
        assert link.details["dropped"] == 1
        line.plug()
        wait_until(lambda: link.receive() == [] and link.details["open"])
        line.write(serial_oracle.frame(PACKET, b"after"))
        assert received(link, 1) == [b"after"]
        link.send("right", b"heard")
        wait_until(lambda: (data := line.read()) and frames_in(data) == [(PACKET, b"heard")])
        link.close()
    lost, back = LINES
    assert lost.startswith(f"link.left: {tmp_path / 'tty'} is lost: ")
    assert back == f"link.left: {tmp_path / 'tty'} is back"


def test_a_device_of_another_program_is_refused(tmp_path: Path) -> None:
    with lines(tmp_path / "tty"):
        link = opened(tmp_path / "tty")
        with pytest.raises(pb.PalmbotsError, match=r"^link.left: cannot open .*another program"):
            opened(tmp_path / "tty")
        link.close()
        opened(tmp_path / "tty").close()
