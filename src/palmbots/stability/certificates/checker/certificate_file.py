# SPDX-License-Identifier: Apache-2.0
"""The file of a certificate: its size, its format, and the values in it with their places."""

import json
import math
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from palmbots._util.arguments import show
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.scene.file_kinds import CERTIFICATE, refuse_other_kind
from palmbots.stability.certificates.checker.enclosures import Ends
from palmbots.stability.certificates.checker.property_conditions import CheckFailed

_FORMAT_NAME = "palmbots certificate"
_FORMAT_NUMBER = 4
FORMAT = f"{_FORMAT_NAME} {_FORMAT_NUMBER}"

_MOST_BYTES = 50_000_000
_MOST_DIGITS = 200
_NUMBER = re.compile(r"-?[0-9]+(\.[0-9]+|/[0-9]+)?")
_ANY_FORMAT = re.compile(rf"{_FORMAT_NAME} ([0-9]{{1,9}})")


def read_certificate(path: Any) -> dict[str, Any]:
    """The content of a certificate file.

    Raises:
        PalmbotsError: the file cannot be read, is not a certificate or has another format.
    """
    refuse_other_kind(path, CERTIFICATE)
    try:
        with open(user_path(path), "rb") as stream:
            data = stream.read(_MOST_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = (isinstance(error, OSError) and error.strerror) or error
        raise PalmbotsError(f"{path}: cannot be read: {reason}") from None
    if len(data) > _MOST_BYTES:
        raise PalmbotsError(f"{path}: is too large for a certificate")
    certificate = _json(path, data)
    name = certificate.get("format") if isinstance(certificate, dict) else None
    if name == FORMAT:
        return certificate
    other = _ANY_FORMAT.fullmatch(name) if isinstance(name, str) else None
    if other is not None:
        raise PalmbotsError(
            f"{path}: has certificate format {int(other[1])}, but this version of palmbots reads "
            f"format {_FORMAT_NUMBER}; create it again with palmbots certify or palmbots design"
        )
    raise PalmbotsError(f'{path}: is not a certificate; allowed: JSON with "format": "{FORMAT}"')


def _json(path: Any, data: bytes) -> Any:
    try:
        return json.loads(data.decode(), parse_float=_finite, parse_constant=_finite)
    except json.JSONDecodeError as error:
        fault = f"not valid JSON at line {error.lineno}, column {error.colno}"
    except UnicodeDecodeError as error:
        fault = f"byte {error.start + 1} is not UTF-8"
    except RecursionError:
        fault = "lists nested too deeply"
    except ValueError:  # int() refuses very long numbers, `_finite` others
        fault = "a number is too large or not finite"
    raise PalmbotsError(f"{path}: is not a certificate: {fault}")


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError
    return number


@dataclass(frozen=True)
class Entry:
    """A value of a certificate, and its place in the file, as in ``box.friction.left[0]``.

    All methods raise `CheckFailed` where the value has another form; the message names the place.
    """

    value: Any
    place: str = ""

    def fault(self, allowed: str) -> CheckFailed:
        """The error that states the value and what is allowed."""
        return CheckFailed(f"{self.place}: value is {show(self.value)}; allowed: {allowed}")

    def __getitem__(self, key: str) -> "Entry":
        if not isinstance(self.value, dict):
            raise self.fault("a table")
        place = f"{self.place}.{key}" if self.place else key
        if key not in self.value:
            raise CheckFailed(f"{place} is missing")
        return Entry(self.value[key], place)

    def items(self, count: int | None = None) -> list["Entry"]:
        """The entries of a list, which has this many where a count is given."""
        if not isinstance(self.value, list) or count not in (None, len(self.value)):
            raise self.fault("a list" if count is None else f"a list of {count}")
        return [Entry(item, f"{self.place}[{k}]") for k, item in enumerate(self.value)]

    def text(self) -> str:
        """A text."""
        if not isinstance(self.value, str):
            raise self.fault("a string")
        return self.value

    def index(self, least: int, end: int) -> int:
        """A whole number from `least` to below `end`."""
        if type(self.value) is not int or not least <= self.value < end:
            raise self.fault(f"a whole number from {least} to {end - 1}")
        return self.value

    def number(self) -> Fraction:
        """An exact number: a decimal or a quotient, as text."""
        value = self.value
        # No exponents: a short text could then ask for more digits than fit into memory.
        if isinstance(value, str) and len(value) <= _MOST_DIGITS and value.isascii():
            _, _, bottom = value.partition("/")
            if _NUMBER.fullmatch(value) and (not bottom or int(bottom)):
                return Fraction(value)
        raise self.fault('an exact number as text, as in "0.25" or "1/3"')

    def interval(self) -> Ends:
        """Two exact numbers, the lower one first."""
        low, high = (end.number() for end in self.items(2))
        if low > high:
            raise self.fault("two numbers, the lower one first")
        return low, high

    def sides(self) -> tuple[Ends, Ends]:
        """The intervals of the left and of the right palm."""
        return self["left"].interval(), self["right"].interval()
