# SPDX-License-Identifier: Apache-2.0
"""The box of a certificate as in its file: exact decimals and fractions as texts."""

from typing import TypedDict


class SidesTable(TypedDict):
    """The ends (low, high) of a quantity of each palm."""

    left: list[str]
    right: list[str]


class FrictionTable(SidesTable):
    """The ends of the coefficients of friction."""

    common: bool
    """Whether both palms have the same coefficient."""


class BoxTable(TypedDict):
    """The box; `parameter_box` explains the quantities."""

    com_m: list[list[str]]
    width_m: list[str]
    friction: FrictionTable
    shallow_deg: SidesTable
    steep_deg: SidesTable
    contacts_m: SidesTable
    beyond_m: str
    half_length_m: SidesTable
    offset_m: SidesTable
    slope: list[str]
    outline_m: list[list[str]]
    right_contact: int
