# SPDX-License-Identifier: Apache-2.0
"""Units of scene keys, from the suffix of their names: ``radio.latency_s`` is in seconds."""

_UNITS = {
    "s": "s", "m": "m", "deg": "°", "m_s": "m/s", "m_s2": "m/s²", "m_per_sqrt_s": "m/√s",
    "deg_s": "°/s", "kg": "kg",
}  # fmt: skip


def unit_of(key: str) -> str | None:
    """The unit of a scene key; None if its name has no unit."""
    return _split(key)[1]


def name_of(key: str) -> str:
    """`object.com_m[0]` → "object com [0]"."""
    return _split(key)[0]


def _split(key: str) -> tuple[str, str | None]:
    name, bracket, index = key.partition("[")
    words = name.replace(".", " ").split("_")
    for size in (4, 2, 1):
        unit = _UNITS.get("_".join(words[-size:]))
        if unit is not None and len(words) > size:
            return " ".join(words[:-size]) + (f" {bracket}{index}" if bracket else ""), unit
    return " ".join(words) + bracket + index, None
