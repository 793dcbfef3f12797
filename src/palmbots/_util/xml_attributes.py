# SPDX-License-Identifier: Apache-2.0
"""Numbers and colours as attributes of XML."""

__all__ = ["numbers", "rgba"]


def numbers(*values: float) -> str:
    """Numbers separated by spaces, with ten digits: lengths are exact to a nanometre."""
    return " ".join(f"{value + 0.0:.10g}" for value in values)


def rgba(colour: str, opacity: float = 1.0) -> str:
    """A colour "#RRGGBB" with its opacity as four numbers from 0 to 1."""
    parts = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return " ".join(f"{part:.4g}" for part in (*parts, opacity))
