# SPDX-License-Identifier: Apache-2.0
"""Numbers and colours as attributes of XML."""


def numbers(*values: float) -> str:
    """Numbers separated by spaces, with ten digits: lengths are exact to a nanometre."""
    return " ".join(f"{value + 0.0:.10g}" for value in values)


def parts_of(colour: str) -> tuple[int, int, int]:
    """Red, green and blue of a colour "#RRGGBB", from 0 to 255."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue


def rgb(colour: str) -> str:
    """A colour "#RRGGBB" as three numbers from 0 to 1."""
    return " ".join(f"{part / 255:.4g}" for part in parts_of(colour))


def rgba(colour: str, opacity: float = 1.0) -> str:
    """The same with the opacity as a fourth number."""
    return f"{rgb(colour)} {opacity:.4g}"
