# SPDX-License-Identifier: Apache-2.0
"""The keys of ``pair.toml``."""

from palmbots.runtime.pair_file import pair_keys

PAGE = "docs/guide/robots.md"


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    rows = ["| key | default | meaning |", "|---|---|---|"]
    for key in pair_keys():
        default = f"`{key.default_text}`" if key.default_text else ""
        rows.append(f"| `{key.name}` | {default} | {key.meaning} |")
    return {"pair keys": "\n".join(rows)}
