# SPDX-License-Identifier: Apache-2.0
"""The file of a certificate: its size, its format and the numbers in it."""

import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.stability.certificates.checker.enclosures import Ends
from palmbots.stability.certificates.checker.property_conditions import CheckFailed

__all__ = ["FORMAT", "interval", "number", "per_side", "read_certificate"]

_FORMAT_NAME = "palmbots certificate"
_FORMAT_NUMBER = 3
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
    try:
        if Path(path).stat().st_size > _MOST_BYTES:
            raise PalmbotsError(f"{path}: is too large for a certificate")
        certificate = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise PalmbotsError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise PalmbotsError(f"{path}: is not a certificate: {error}") from None
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


def number(value: Any) -> Fraction:
    """An exact number: a decimal or a quotient, as text."""
    # No exponents: a short text could then ask for more digits than fit into memory.
    if (
        not isinstance(value, str)
        or len(value) > _MOST_DIGITS
        or not value.isascii()
        or not _NUMBER.fullmatch(value)
    ):
        raise CheckFailed(f"{show(value)} is not an exact number")
    try:
        return Fraction(value)
    except ZeroDivisionError:
        raise CheckFailed(f"{show(value)} is not an exact number") from None


def interval(value: Any) -> Ends:
    """Two exact numbers, the lower one first."""
    low, high = (number(end) for end in value)
    if low > high:
        raise CheckFailed(f"{show(value)} has the higher end first")
    return low, high


def per_side(table: dict[str, Any], key: str) -> tuple[Ends, Ends]:
    """The intervals of the left and of the right palm."""
    return interval(table[key]["left"]), interval(table[key]["right"])
