# SPDX-License-Identifier: Apache-2.0
"""What higher rooms offer to the registries of lower ones (`palmbots._util.named_registry`).

`palmbots/__init__.py` makes the offers, as texts: nothing is imported until it is used, and no room
has to name a higher one. This module imports nothing, because ``import palmbots`` imports it.
"""

_entries: dict[str, dict[str, str]] = {}
_modules: dict[str, list[str]] = {}


def offer_entry(kind: str, name: str, entry: str) -> None:
    """Offer an entry, ``"module:attribute"``, to the registry of this kind."""
    _entries.setdefault(kind, {})[name] = entry


def offer_module(kind: str, module: str) -> None:
    """Offer a module that registers entries of this kind when it is imported."""
    _modules.setdefault(kind, []).append(module)


def offered_entries(kind: str) -> dict[str, str]:
    """The offered entries by name."""
    return dict(_entries.get(kind, {}))


def offered_modules(kind: str) -> list[str]:
    """The offered modules."""
    return list(_modules.get(kind, ()))
