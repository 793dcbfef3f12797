# SPDX-License-Identifier: Apache-2.0
"""Unit and plain name of a scene key, for the axes of figures and of studies."""

from palmbots.scene.core_keys import ROWS
from palmbots.scene.key_reference import scene_keys
from palmbots.scene.overrides import HOLDERS

_SHOWN = {
    "m": ("m", "m"), "s": ("s", "s"), "kg": ("kg", "kg"), "N": ("N", "n"), "N m": ("N m", "n_m"),
    "m/s": ("m/s", "m_s", "m_per_s"), "m/s²": ("m/s²", "m_s2"), "m/√s": ("m/√s", "m_per_sqrt_s"),
    "degrees": ("°", "deg"), "degrees/s": ("°/s", "deg_s"), "parts per million": ("ppm", "ppm"),
    "bumps per metre": ("1/m", "per_m"),
}  # fmt: skip
"""How an axis shows each unit of the table of keys, and how names of keys end that have it."""


def unit_of(key: str) -> str | None:
    """The unit of a scene key; None if it has none."""
    unit = _unit(key)
    return _SHOWN[unit][0] if unit else None


def name_of(key: str) -> str:
    """The key in words, without its unit: `object.com_m[0]` → "object com [0]"."""
    name, bracket, index = key.partition("[")
    ends = _SHOWN[unit][1:] if (unit := _unit(key)) else ()
    end = next((f"_{end}" for end in ends if name.endswith(f"_{end}")), "")
    words = name.removesuffix(end).replace(".", " ").replace("_", " ")
    return f"{words} {bracket}{index}".rstrip()


def _unit(key: str) -> str:
    """The unit in the table of keys; that of the numbers of a list is that of the first one."""
    section, _, name = key.partition(".")
    holder, _, own = name.partition(".")
    common = f"{section}.{own}" if holder in HOLDERS.get(section, ()) else key
    for row in (common, f"{common}[0]", f"{common}[][0]", f"{common}[]"):
        if row in ROWS:
            return ROWS[row]["unit"]
    return next((one.unit for one in scene_keys() if one.name == common), "")
