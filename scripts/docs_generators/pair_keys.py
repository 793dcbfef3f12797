# SPDX-License-Identifier: Apache-2.0
"""The keys of ``pair.toml``."""

from palmbots.runtime.pair_file import pair_keys

PAGE = "docs/guide/robots.md"


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    rows = ["| key | default | meaning |", "|---|---|---|"]
    # Those of [ros2] stand on a page of their own.
    for key in (key for key in pair_keys() if not key.name.startswith("ros2.")):
        default = f"`{key.default_text}`" if key.default_text else ""
        rows.append(f"| `{key.name}` | {default} | {key.meaning} |")
    return {"pair keys": "\n".join(rows)}
