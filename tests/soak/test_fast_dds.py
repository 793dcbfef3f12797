# SPDX-License-Identifier: Apache-2.0
"""Every message between this package and Fast DDS, the library under the default of ROS 2.

The other participant is `fast_dds_peer.cpp`. It prints each value that it reads and sends each
message back, so both directions are compared.
"""

import random
import shutil
import subprocess
import time
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, get_type_hints

import pytest

from dds_loopback import dds_environment
from palmbots.ros2.ros2_messages import MESSAGES, String
from palmbots.ros2.ros2_node import Ros2Node
from palmbots.ros2.ros2_topics import COMMANDS, PUBLISHED, READINGS, dds_type
from waiting import wait_until

pytestmark = [
    pytest.mark.soak,
    pytest.mark.skipif(
        not Path("/usr/include/fastdds").exists(),
        reason="needs Debian's libfastrtps-dev and libfastcdr-dev",
    ),
]
TOPICS = sorted({name for topic in (*PUBLISHED, *COMMANDS, *READINGS) for name in topic.types})


class Peer:
    """The other participant, and a node of this package."""

    def __init__(self, folder: Path, domain: int) -> None:
        program = folder / "peer"
        source = Path(__file__).with_name("fast_dds_peer.cpp")
        compiler = shutil.which("g++")
        assert compiler
        flags = ["-std=c++20", "-O1", "-Wall", "-Wextra", "-Werror", "-lfastrtps", "-lfastcdr"]
        command = [compiler, str(source), "-o", str(program), *flags]
        built = subprocess.run(command, capture_output=True, text=True)
        assert built.returncode == 0, built.stderr
        self.process = subprocess.Popen(
            [str(program), str(domain)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.node = Ros2Node(domain)
        self.latched = self.node.publisher("/latched", "std_msgs/msg/String", "latched")
        self.latched.publish(String("before"))
        assert self.line() == "ready"

    def line(self) -> str:
        assert self.process.stdout is not None
        return self.process.stdout.readline().rstrip("\n")

    def close(self) -> None:
        self.process.communicate(timeout=20)
        self.node.close()


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Peer]:
    with pytest.MonkeyPatch.context() as patch:
        environment = dds_environment(tagged=False)
        for name, value in environment.items():
            patch.setenv(name, value)
        made = Peer(tmp_path_factory.mktemp("peer"), int(environment["ROS_DOMAIN_ID"]))
        # What was published before the other side came, as it is latched.
        assert made.line() == "latched x" + b"before".hex()
        yield made
        made.close()


LIMITS = {
    "int8": (-128, 127), "uint8": (0, 255), "byte": (0, 255), "int32": (-(2**31), 2**31 - 1),
    "uint32": (0, 2**32 - 1),
}  # fmt: skip


def random_value(hint: Any, generator: random.Random) -> Any:
    """A random value of a field of a message, from its annotation."""
    if is_dataclass(hint):
        hints: Any = hint
        types = get_type_hints(hints, include_extras=True)
        return hints(**{name: random_value(one, generator) for name, one in types.items()})
    if hint is str:
        return "".join(generator.choices("abcäß€ /_", k=generator.randrange(9)))
    if hint is bool:
        return generator.random() < 0.5
    detail: Any = hint.__metadata__[0]
    if isinstance(detail, str):
        if detail in LIMITS:
            return generator.choice((*LIMITS[detail], generator.randint(*LIMITS[detail])))
        return generator.randrange(-(2**20), 2**20) / 1024  # exact in single precision, too
    length = getattr(detail, "length", None)
    count = generator.randrange(4) if length is None else length
    return [random_value(detail.subtype, generator) for _ in range(count)]


def shown(value: Any) -> list[str]:
    """A message as the other side prints it."""
    if is_dataclass(value):
        return [text for field in fields(value) for text in shown(getattr(value, field.name))]
    if isinstance(value, str):
        return ["x" + value.encode().hex()]
    if isinstance(value, (list, tuple)):
        texts = [text for one in value for text in shown(one)]
        is_fixed = len(value) == 36  # the covariances, the only arrays
        return texts if is_fixed else [str(len(value)), *texts]
    return [f"{float(value):.17g}"]


@pytest.mark.parametrize("name", TOPICS)
def test_both_directions(name: str, peer: Peer, soak_seed: int) -> None:
    short = dds_type(name).rpartition(":")[2].removesuffix("_")
    request = peer.node.publisher(f"/request/{short}", name, "default", lifespan_s=5.0)
    answer = peer.node.subscriber(f"/answer/{short}", name, "default")
    as_sensor = peer.node.subscriber(f"/answer/{short}", name, "sensor")
    wait_until(lambda: request.subscribers == 1)
    wait_until(lambda: len(as_sensor._reader.get_matched_publications()) == 1)
    wait_until(lambda: len(answer._reader.get_matched_publications()) == 1)
    time.sleep(0.2)  # the other side may learn of our subscribers a little later
    generator = random.Random(soak_seed)
    for _ in range(50):
        sent = random_value(MESSAGES[name], generator)
        request.publish(sent)
        assert peer.line().split(" ") == [short, *shown(sent)]
        wait_until(answer.take)
        assert shown(answer.message) == shown(sent)
    wait_until(lambda: as_sensor.take() or as_sensor.message)
