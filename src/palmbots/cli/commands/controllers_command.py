# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots controllers`."""

from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, JsonOption

ORDER = 180
EXAMPLE = "palmbots controllers"


def controllers(as_json: JsonOption = False) -> int:
    """List the controllers, and how much noise they tolerate.

    The option --controller also takes a class of your own, as module:Class or
    FILE.py:Class.
    """
    from palmbots.cli.reports.lists_report import controllers_report
    from palmbots.control.registry import controller_names, describe
    from palmbots.control.tolerated_noise import tolerated_noise

    entries = [describe(name) for name in controller_names()]
    if not as_json:
        controllers_report(entries)
        return DONE
    rows = []
    for entry in entries:
        noise = tolerated_noise(entry.name)
        rows.append(
            {
                "name": entry.name,
                "meaning": entry.description,
                "messages": list(entry.messages),
                "requirements": list(entry.requirements),
                "sigma_star_m_s": noise.sigma_star_m_s if noise else None,
                "sigma_star_interval": list(noise.interval) if noise else None,
                "sigma_star_command": noise.command if noise else None,
            }
        )
    print_json({"controllers": rows})
    return DONE


COMMAND = controllers
