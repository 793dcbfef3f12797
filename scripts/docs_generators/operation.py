# SPDX-License-Identifier: Apache-2.0
"""The modes of a robot, from the table that it runs."""

import palmbots._core as _core

# What happens, in words.
MEANING = {
    "any": "always",
    "storage_failed": "what has to survive a boot cannot be stored",
    "stop_stored": "a stop was in force before the boot",
    "carry_stored": "a carry was under way before the boot, and `after_reboot` is `rejoin`",
    "stop": "a stop by the operator, heard from the station, or by hand",
    "partner_stop": "a stop heard from the partner",
    "release": "the operator releases",
    "disarm": "the operator disarms",
    "arm": "the operator arms, and every check passes",
    "arm_refused": "the operator arms, and a check fails",
    "start": "the operator starts",
    "driver_failed": "the motor board does not answer",
    "overrun": "too many control ticks come too late",
    "station_lost": "the station is silent for longer than its limit, and `station_lost` is `stop`",
    "covered": "the distance is covered",
    "partner_done": "the partner is heard to be done",
    "partner_ended": "the partner is heard to be disarmed, armed or in a fault",
    "partner_lost": "the partner is silent for longer than the lease, and `partner_lost` is `stop`",
    "job_failed": "a job on the floor has been tried as often as it may",
    "time_up": "the carry has reached the time limit",
    "partner_silent": "the partner is silent for longer than the lease",
    "partner_starts": "the partner is heard, within the lease, to be ready or to carry",
    "rests": "the controller does not travel",
    "travels": "the controller travels",
}


def _modes(modes: list[str]) -> str:
    everything = list(_core.wire.robot_modes)
    if modes == everything:
        return "every mode"
    missing = [mode for mode in everything if mode not in modes]
    if len(missing) <= 2:
        return "every mode but " + ", ".join(f"`{mode}`" for mode in missing)
    return ", ".join(f"`{mode}`" for mode in modes)


def table() -> str:
    """The rows, as Markdown."""
    rows = ["| in mode | what happens | next mode | fault code |", "|---|---|---|---|"]
    for modes, event, following, change, code in _core.mode_table():
        codes = {"keep": "as before", "set": f"`{code}`", "refusal": "the failed check"}
        rows.append(f"| {_modes(modes)} | {MEANING[event]} | `{following}` | {codes[change]} |")
    return "\n".join(rows)


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {"mode table": table()}
