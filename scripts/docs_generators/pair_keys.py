# SPDX-License-Identifier: Apache-2.0
"""The keys of ``pair.toml``, and of the imperfections of simulated robots."""

from collections.abc import Iterable

from palmbots.pair.pair_keys import pair_keys
from palmbots.scene.key_reference import SceneKey
from palmbots.simulation.imperfections import imperfection_keys


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    imperfect = [
        SceneKey(key.name.removeprefix("imperfect."), key.default, key.unit, key.meaning)
        for key in imperfection_keys()
    ]
    return {"pair keys": _table(pair_keys()), "imperfection keys": _table(imperfect)}


def _table(keys: Iterable[SceneKey]) -> str:
    rows = ["| key | default | meaning |", "|---|---|---|"]
    # Those of [ros2] stand on a page of their own.
    for key in (key for key in keys if not key.name.startswith("ros2.")):
        default = f"`{key.default_text}`" if key.default_text else ""
        rows.append(f"| `{key.name}` | {default} | {key.meaning} |")
    return "\n".join(rows)
