# SPDX-License-Identifier: Apache-2.0
"""Commands and options of earlier versions, with their present names.

An old name is refused in one line that gives the new one. The table is the only place that knows
old names.
"""

OLD_COMMANDS = {"rare": "drop-rate", "speed": "speed-limits"}

OLD_OPTIONS = {
    ("carry", "--beyond-budget"): "--allow-drift-beyond-budget",
    ("certify", "--common"): "--common-friction",
    ("certify", "--slope"): "--slope-deg, in degrees instead of a tangent",
    ("design", "--angles-deg"): "--angle-range-deg",
    ("design", "--each"): "--independent-friction, which is the default",
    ("design", "--least-clearance-deg"): "--min-clearance-deg",
    ("design", "--least-difference-deg"): "--min-angle-difference-deg",
    ("design", "--slope"): "--slope-deg, in degrees instead of a tangent",
    ("derive", "--runs"): "--counterexamples",
    ("drop-rate", "--within-percent"): "--relative-error-percent",
    ("speed-limits", "--seeds"): "--carries",
    ("study", "--chunk"): "--chunk-size",
    ("study", "--explain"): "--estimate-cost",
    ("validate", "--seeds"): "--carries",
}


def renamed_command(name: str) -> str | None:
    """The refusal of an old command; None: there was no such command."""
    new = OLD_COMMANDS.get(name)
    return None if new is None else f"the command {name} is now called {new}"


def renamed_option(command: str, option: str) -> str | None:
    """The refusal of an old option of a command; None: the command had no such option."""
    new = OLD_OPTIONS.get((command, option))
    return None if new is None else f"{command}: the option {option} is now called {new}"
