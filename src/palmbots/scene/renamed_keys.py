# SPDX-License-Identifier: Apache-2.0
"""Scene keys and values that have another name now; an old one is refused with the new one.

``[]`` stands for the index of a list's item.
"""

import re

RENAMED_KEYS = {
    "dynamic.body_kg": "mujoco.body_kg",
    "dynamic.arm_kg": "mujoco.arm_kg",
    "dynamic.palm_kg": "mujoco.palm_kg",
    "dynamic.wheel_radius_m": "mujoco.wheel_radius_m",
    "dynamic.wheel_mismatch": "mujoco.wheel_radius_mismatch",
    "dynamic.axle_m": "mujoco.axle_m",
    "dynamic.floor_friction": "mujoco.floor_friction",
    "dynamic.ridges": "mujoco.ridges",
    "dynamic.press_n": "mujoco.switch_force_n",
    "dynamic.debounce_s": "mujoco.switch_debounce_s",
    "dynamic.step_s": "mujoco.step_s",
    "palm.slip_deg": "palm.friction_angle_deg",
    "palm.left.slip_deg": "palm.left.friction_angle_deg",
    "palm.right.slip_deg": "palm.right.friction_angle_deg",
    "task.inertia_lag_s": "task.inertia_tau_s",
    "task.path.ease_m": "task.path.transition_m",
    "task.path.lead_m": "task.path.lead_in_m",
    "radio.burst_share": "radio.burst_fraction",
    "radio.script[].fate": "radio.script[].effect",
    "radio.script[].late_s": "radio.script[].delay_s",
    "faults.reboots": "faults.random_reboots",
    "faults.script[].for_s": "faults.script[].duration_s",
    "faults.script[].reads": "faults.script[].stuck_at",
    "faults.script[].rate": "faults.script[].probability",
}

RENAMED_VALUES = {
    "radio.script[].effect": {"late": "delayed", "copied": "duplicated"},
    "faults.script[].kind": {"flicker": "intermittent", "station": "station-down"},
}

_INDEX = re.compile(r"\[\d+\]")
_OLD_SECTION, _NEW_SECTION = "dynamic", "mujoco"


def new_key(key: str) -> str | None:
    """The new name of an old dotted key, with the same indices; None where it has none."""
    name = _INDEX.sub("[]", key)
    section, dot, rest = name.partition(".")
    if section == _OLD_SECTION:
        name = RENAMED_KEYS.get(name, f"{_NEW_SECTION}{dot}{rest}")
    else:  # an old name may stand in the new section, too
        old = f"{_OLD_SECTION}.{rest}" if section == _NEW_SECTION else name
        renamed = RENAMED_KEYS.get(old, name)
        if renamed == name:
            return None
        name = renamed
    for index in _INDEX.findall(key):
        name = name.replace("[]", index, 1)
    return name


def new_value(key: str, value: object) -> str | None:
    """The new name of an old value of a key; None where it has none."""
    names = RENAMED_VALUES.get(_INDEX.sub("[]", key), {})
    return names.get(value) if isinstance(value, str) else None
