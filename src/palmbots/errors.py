# SPDX-License-Identifier: Apache-2.0
"""The exceptions of palmbots: one line each, written for the user.

A message about input names the file, the key, the value and what is allowed. File names, keys and
values come from outside, so unprintable characters in them are escaped: a message is always one
line that every terminal can print.
"""


class PalmbotsError(Exception):
    """An error that the user can correct; ``str(error)`` is one line."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


class MissingExtra(PalmbotsError):
    """An optional package is not installed."""

    def __init__(self, message: str, extra: str = "") -> None:
        super().__init__(message)
        self.extra = extra
        """The extra that brings the package, such as ``study``."""


class SceneError(PalmbotsError):
    """A scene that cannot be read or is not valid."""


class UnknownSceneKey(SceneError):
    """A key that no scene has."""

    def __init__(self, message: str, key: str = "", suggestion: str | None = None) -> None:
        super().__init__(message)
        self.key = key
        """The dotted key as it was given."""
        self.suggestion = suggestion
        """The key that is probably meant; None: no key resembles it."""


def one_line(text: str) -> str:
    """The text with everything unprintable (line breaks, lone surrogates, …) escaped."""
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape", "backslashreplace").decode()
        for c in text
    )
