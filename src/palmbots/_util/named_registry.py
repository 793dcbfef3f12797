# SPDX-License-Identifier: Apache-2.0
"""A registry: entries by name, some of them loaded on first use.

An entry is an object, or the text ``"module:attribute"``, which is imported when the entry is asked
for. With such a text a low room can offer what a higher room provides, without importing it.
"""

import importlib
from typing import Any, Generic, TypeVar

from palmbots._util.arguments import one_of, show
from palmbots.errors import PalmbotsError

__all__ = ["Registry"]

Entry = TypeVar("Entry")


class Registry(Generic[Entry]):
    """Entries by name, in the order in which they were registered."""

    def __init__(self, kind: str, home: str | None = None) -> None:
        """A registry of entries of this kind; messages name the kind, such as ``controller``.

        `home` is a module that registers entries when it is imported. It is imported when the
        registry is first read.
        """
        self._kind = kind
        self._home = home
        self._entries: dict[str, Any] = {}

    def _load_home(self) -> None:
        home, self._home = self._home, None
        if home is not None:
            importlib.import_module(home)

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
        self._load_home()
        return tuple(self._entries)

    def __contains__(self, name: object) -> bool:
        self._load_home()
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
