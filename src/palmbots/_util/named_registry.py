# SPDX-License-Identifier: Apache-2.0
"""A registry: entries by name, most of them loaded on first use.

An entry is an object, or the text ``"module:attribute"``, which is imported when the entry is asked
for. Entries come from four places: the registry itself; the rooms above it (`palmbots._OFFERS`:
thus a low room provides what a higher one defines, and does not name it); programs that register
one; and other distributions, which name theirs in ``pyproject.toml`` as entry points of a group::

    [project.entry-points."palmbots.drivers"]
    mine = "my_package:MyDriver"
"""

import importlib
import sys
from collections.abc import Mapping
from typing import Any, Generic, TypeVar

from palmbots._util.arguments import one_of, show
from palmbots.errors import PalmbotsError

Entry = TypeVar("Entry")


class Registry(Generic[Entry]):
    """Entries by name, in the order in which they were registered."""

    def __init__(
        self,
        kind: str,
        entries: "Mapping[str, Entry | str] | None" = None,
        group: str | None = None,
    ) -> None:
        """A registry of entries of this kind; messages name the kind, such as ``controller``.

        It begins with `entries`, followed by those that are offered for this kind. An offer
        without a colon is a module that registers entries; it is imported when the registry is
        first read. `group` is that of the entry points of other distributions.
        """
        self._kind = kind
        self._entries: dict[str, Any] = {**(entries or {}), **_offers().get(kind, {})}
        self._group = group

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
        """The names of all entries, without those of other distributions."""
        for name, entry in list(self._entries.items()):
            if isinstance(entry, str) and ":" not in entry:
                del self._entries[name]
                importlib.import_module(entry)
        return tuple(self._entries)

    def __contains__(self, name: object) -> bool:
        return name in self.names()

    def get(self, name: str, called: str | None = None) -> Entry:
        """The entry of a name; messages call it `called` instead of the kind.

        Raises:
            PalmbotsError: there is no such entry; the message lists those that exist. Or another
                distribution has it, and it cannot be imported.
        """
        if self._group is not None and name not in self:
            return self._installed(name, self._group, called or self._kind)
        one_of(called or self._kind, name, self.names())
        entry = self._entries[name]
        if isinstance(entry, str):
            module, _, attribute = entry.partition(":")
            entry = self._entries[name] = getattr(importlib.import_module(module), attribute)
        return entry

    def _installed(self, name: str, group: str, called: str) -> Entry:
        """The entry of another distribution."""
        import importlib.metadata  # here, because every program of a robot imports this module

        installed = importlib.metadata.entry_points(group=group)
        if name not in installed.names:
            allowed = ", ".join([*self._entries, *sorted(installed.names - self._entries.keys())])
            raise PalmbotsError(
                f"{called}: value is {show(name)}; allowed: {allowed}, or an installed entry point "
                f"of {group}"
            )
        try:
            return installed[name].load()
        except Exception as error:  # whatever a module of somebody else does
            why = f"{type(error).__name__}: {error}"
            value = installed[name].value
            raise PalmbotsError(f"{called}: {name} ({value}) cannot be imported: {why}") from None


def _offers() -> Mapping[str, Mapping[str, str]]:
    return sys.modules["palmbots"]._OFFERS
