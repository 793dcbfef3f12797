# SPDX-License-Identifier: Apache-2.0
"""A registry: entries by name, some of them loaded on first use.

An entry is an object, or the text ``"module:attribute"``, which is imported when the entry is asked
for. A registry also has the entries that `palmbots._util.offers` holds for its kind: with them, a
low room provides what a higher room defines, and does not name it.
"""

import importlib
from typing import Any, Generic, TypeVar

from palmbots._util.arguments import one_of, show
from palmbots._util.offers import offered_entries, offered_modules
from palmbots.errors import PalmbotsError

Entry = TypeVar("Entry")


class Registry(Generic[Entry]):
    """Entries by name, in the order in which they were registered."""

    def __init__(self, kind: str, **entries: "Entry | str") -> None:
        """A registry of entries of this kind; messages name the kind, such as ``controller``.

        It begins with `entries`, followed by those that are offered for this kind. Modules that
        are offered are imported when the registry is first read.
        """
        self._kind = kind
        self._entries: dict[str, Any] = {**entries, **offered_entries(kind)}
        self._modules = offered_modules(kind)

    def _load_modules(self) -> None:
        while self._modules:
            importlib.import_module(self._modules.pop())

    def register(self, name: str, entry: "Entry | str") -> None:
        """Add an entry.

        Raises:
            PalmbotsError: the name is no text, or is taken by another entry.
        """
        if not isinstance(name, str) or not name:
            raise PalmbotsError(f"{self._kind}: name is {show(name)}; allowed: a text")
        if self._entries.get(name, entry) != entry:
            raise PalmbotsError(f"{self._kind}: {show(name)} is registered already")
        self._entries[name] = entry

    def unregister(self, name: str) -> None:
        """Remove an entry; nothing happens where there is none."""
        self._entries.pop(name, None)

    def names(self) -> tuple[str, ...]:
        """The names of all entries."""
        self._load_modules()
        return tuple(self._entries)

    def __contains__(self, name: object) -> bool:
        self._load_modules()
        return name in self._entries

    def get(self, name: str, called: str | None = None) -> Entry:
        """The entry of a name; messages call it `called` instead of the kind.

        Raises:
            PalmbotsError: there is no such entry; the message lists those that exist.
        """
        one_of(called or self._kind, name, self.names())
        entry = self._entries[name]
        if isinstance(entry, str):
            module, _, attribute = entry.partition(":")
            entry = self._entries[name] = getattr(importlib.import_module(module), attribute)
        return entry
