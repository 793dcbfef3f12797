# SPDX-License-Identifier: Apache-2.0
"""What shows that a certificate's claims hold, or that one fails, as in its file.

Numbers are exact decimals and fractions, as texts.
"""

from typing import Literal, TypedDict

from typing_extensions import TypeAliasType

Bisection = TypeAliasType("Bisection", 'Literal["corners"] | tuple[str, str, Bisection, Bisection]')
"""How a box is proved: at its corners, or, divided where a quantity has a value, by two boxes."""


class PairTable(TypedDict):
    """A quantity of each palm."""

    left: str
    right: str


class _Witness(TypedDict):
    claim: str
    fails: str
    angle_deg: PairTable
    contacts_m: PairTable
    offset_m: PairTable
    width_m: str


class ConditionWitness(_Witness):
    """A point of the box at which a condition fails."""

    friction: PairTable
    com_m: list[str]
    slope: str


class ClearanceWitness(_Witness):
    """A point of the box at which a palm touches an edge of the outline."""

    edge: int
    half_length_m: PairTable
