# SPDX-License-Identifier: Apache-2.0
"""A damaged certificate is refused in one line of the project's words, never in those of Python."""

import copy
import json
import random
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from commands import Run
from palmbots.stability.certificates.prover import certify

# What an exception of Python, or a repr, would show.
PYTHON = re.compile(r"Error|Expecting|delimiter|NoneType|object (is|has) |unhash|<|Traceback")

# Values of each kind, in place of some other value.
VALUES = [
    None, True, False, 0, -1, 10**30, 1e300, "", "0", "1/0", "-1", "9" * 200, "9" * 201, "1e9",
    "\u0663", "\ud800", "a\nb", "\x1b[31m", "x" * 10_000, "corners", "\u201c<NoneType>\u201d",
    [], [[]], ["1", "0"], ["corners"] * 4, {}, {"left": 1},
]  # fmt: skip


@pytest.fixture(scope="module")
def certificates() -> list[dict[str, Any]]:
    """Two that hold, one that fails."""
    return [
        certify("paper", steep_deg=(14, 16), claims=("property 1",)).data,
        certify("paper", com_x_m=(0.12, 0.13), claims=("property 2", "clearance")).data,
        certify("paper", friction=(0.3, 0.5)).data,
    ]


def _places(value: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The keys and indices that lead to every value below."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in inner:
        yield (*at, key)
        if isinstance(item, dict | list):
            yield from _places(item, (*at, key))


def _changed(certificate: dict[str, Any], chance: random.Random) -> bytes:
    """With one value changed, removed or added."""
    data = copy.deepcopy(certificate)
    places = list(_places(data))
    shallow = [place for place in places if not place[3:]]
    place = chance.choice(shallow if chance.random() < 0.5 else places)
    last = place[-1]
    at: Any = data
    for key in place[:-1]:
        at = at[key]
    kind = chance.choice(["change", "change", "remove", "add"])
    if kind == "remove":
        del at[last]
    elif kind == "add" and isinstance(at, list):
        at.append(chance.choice(VALUES))
    elif kind == "add":
        at["extra"] = chance.choice(VALUES)
    else:
        at[last] = chance.choice(VALUES)
    return json.dumps(data).encode()


def _damaged(certificate: dict[str, Any], chance: random.Random) -> bytes:
    """Cut off, or with some bytes changed."""
    data = bytearray(json.dumps(certificate).encode())
    if chance.random() < 0.5:
        return bytes(data[: chance.randrange(len(data))])
    for _ in range(chance.randint(1, 4)):
        data[chance.randrange(len(data))] = chance.choice(b'0123456789.-"[]{},:/a\xff\x00\n')
    return bytes(data)


@pytest.mark.parametrize(("damage", "count"), [(_changed, 300), (_damaged, 100)])
def test_damaged_certificate_is_refused_in_one_line(
    damage: Any, count: int, certificates: list[dict[str, Any]], tmp_path: Path
) -> None:
    chance = random.Random(8)
    path = tmp_path / "box.json"
    seen: Counter[str] = Counter()
    for _ in range(count):
        path.write_bytes(damage(chance.choice(certificates), chance))
        try:
            result = pb.check(path)
        except pb.PalmbotsError as error:
            seen["refused"] += 1
            line = str(error)
            assert line.startswith(f"{path}: ")
        else:
            seen["valid" if result.valid else "invalid"] += 1
            line = result.reason
            assert bool(line) != result.valid
            assert json.dumps(result.summary(), allow_nan=False)
        assert line.isprintable()
        assert len(line) < 600
        quoted = re.sub(r'"[^"]*("|…)', "", line.removeprefix(str(path)))
        assert not PYTHON.search(quoted), line
    assert seen["refused"] + seen["invalid"] > count / 2
    assert min(seen["refused"], seen["invalid"]) > 0


def test_invalid_certificate_has_status_1_and_its_reason_on_stdout(
    certificates: list[dict[str, Any]], here: Run, tmp_path: Path
) -> None:
    path = tmp_path / "box.json"
    path.write_text(json.dumps({**certificates[0], "box": {}}))
    result = here("check", str(path))
    assert (result.returncode, result.stderr) == (1, "")
    assert result.stdout.startswith(f"INVALID  {path}\n  box.com_m is missing\n")


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "not valid JSON at line 1, column 1"),
        ('{"format":\n}', "not valid JSON at line 2, column 1"),
        ("[" * 100_000, "lists nested too deeply"),
        ("9" * 5000, "a number is too large or not finite"),
        ('{"x": NaN}', "a number is too large or not finite"),
        ('{"x": 1e999}', "a number is too large or not finite"),
        ("\ud800", "byte 1 is not UTF-8"),
        ("5", 'allowed: JSON with "format"'),
    ],
)
def test_file_that_is_no_certificate_is_refused(
    text: str, fault: str, here: Run, tmp_path: Path
) -> None:
    path = tmp_path / "no.json"
    path.write_bytes(text.encode(errors="surrogatepass"))
    result = here("check", str(path))
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith(f"palmbots: {path}: is not a certificate")
    assert fault in result.stderr
    assert result.stderr.count("\n") == 1


def test_endless_file_is_too_large(here: Run) -> None:
    assert (
        here("check", "/dev/zero").stderr == "palmbots: /dev/zero: is too large for a certificate\n"
    )
