# SPDX-License-Identifier: Apache-2.0
"""A table as TOML text.

Python reads TOML but does not write it. The library tomli-w is not used here for two reasons. It
writes whole documents only, but error messages quote single values on one line (`toml_value`). And
it puts every item of a list on a line of its own: the scene figure8 with the object tray takes 132
lines instead of 85, and an outline is no longer readable as a list of points.

Numbers, strings, lists, tables and lists of small tables are all that a scene holds;
`tomllib.loads` gives the same table back.
"""

import json
from collections.abc import Mapping
from datetime import date, time
from typing import Any


def toml_text(table: Mapping[str, Any], name: str = "") -> str:
    """The TOML text of a table whose keys are bare keys; `name` is its dotted name."""
    tables = {key: value for key, value in table.items() if isinstance(value, Mapping)}
    lines = [f"{key} = {toml_value(value)}\n" for key, value in table.items() if key not in tables]
    if name and (lines or not tables):
        lines.insert(0, f"[{name}]\n")
    parts = ["".join(lines)] if lines else []
    parts += [toml_text(inner, f"{name}.{key}" if name else key) for key, inner in tables.items()]
    return "\n".join(parts)


def toml_value(value: Any) -> str:
    """One value in TOML; a value that TOML cannot express as Python's `repr`."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)  # TOML's basic strings escape as JSON does
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, date | time):
        return value.isoformat()
    if isinstance(value, list | tuple):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    return repr(value)
