# SPDX-License-Identifier: Apache-2.0
"""Numbers and colours as attributes of XML."""


def numbers(*values: float) -> str:
    """Numbers separated by spaces, with ten digits: lengths are exact to a nanometre."""
    return " ".join(f"{value + 0.0:.10g}" for value in values)


def rgb(colour: str) -> str:
    """A colour "#RRGGBB" as three numbers from 0 to 1."""
    return " ".join(f"{int(colour[i : i + 2], 16) / 255:.4g}" for i in (1, 3, 5))


def rgba(colour: str, opacity: float = 1.0) -> str:
    """The same with the opacity as a fourth number."""
    return f"{rgb(colour)} {opacity:.4g}"
