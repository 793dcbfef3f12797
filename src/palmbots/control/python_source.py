# SPDX-License-Identifier: Apache-2.0
"""Where a Python controller is defined: loading it by reference, and the hash of its source.

A reference is ``module:Class`` or ``FILE.py:Class``. Carry logs and studies keep the reference and
the SHA-256 of the file that defines the class, so that a later run notices another version of it.
"""

import contextlib
import hashlib
import importlib
import importlib.util
import inspect
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palmbots._util.arguments import show
from palmbots._util.user_paths import user_path
from palmbots.control.own_code import own_code
from palmbots.errors import PalmbotsError


@dataclass(frozen=True)
class ControllerSource:
    """The reference to a Python controller, and the hash of its source."""

    reference: str | None
    """``module:Class`` or ``FILE.py:Class``; None: it cannot be found by name (a local class)."""
    sha256: str | None
    """Hash of the source file, or of the class if there is no file; None: there is no source."""


def load_class(
    reference: str, called: str = "controller", folder: str | None = None
) -> tuple[Callable[[], Any], ControllerSource]:
    """The class that a reference names.

    Raises:
        PalmbotsError: it cannot be loaded; one line says why.
    """
    place, _, name = reference.rpartition(":")
    if not place or not name:
        raise PalmbotsError(
            f"{called}: value is {show(reference)}; allowed: module:Class, FILE.py:Class"
        )
    module = _load_file(place, called, folder) if _is_file(place) else _load_module(place, called)
    with own_code(f"{called}: {name} of {place} cannot be used"):
        maker: Any = module
        for part in name.split("."):
            maker = getattr(maker, part, None)
        if maker is None:
            raise PalmbotsError(f"{called}: {place} has no {name}")
        return maker, ControllerSource(reference, source_of(maker).sha256)


def _is_file(place: str) -> bool:
    return place.endswith(".py")


def _path(place: str, folder: str | None) -> Path:
    return user_path(place, folder or "")


def _load_file(place: str, called: str, folder: str | None) -> Any:
    path = _path(place, folder)
    try:
        refuse_pipe(path, called)
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        reason = error.strerror or str(error)
        raise PalmbotsError(f"{called}: {place}: cannot be read: {reason}") from None
    # The name has the hash in it: the same source is the same module, so its classes are equal.
    name = f"_palmbots_controller_{path.stem}_{digest[:12]}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        with own_code(f"{called}: {place} cannot be loaded"), _importable(path.resolve().parent):
            spec.loader.exec_module(module)
    except BaseException:
        sys.modules.pop(name, None)
        raise
    return module


def refuse_pipe(path: Path, called: str) -> None:
    """Raise `PalmbotsError` for a pipe or a device: the file of a controller is read twice."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise PalmbotsError(f"{called}: {path} is not a regular file")


def _load_module(place: str, called: str) -> Any:
    with own_code(f"{called}: {place} cannot be imported"), _importable(Path.cwd()):
        return importlib.import_module(place)


@contextlib.contextmanager
def _importable(folder: Path) -> Iterator[None]:
    """Modules beside the controller can be imported while it is loaded."""
    entry = str(folder)
    sys.path.insert(0, entry)
    try:
        yield
    finally:
        with contextlib.suppress(ValueError):
            sys.path.remove(entry)


def source_of(maker: Any) -> ControllerSource:
    """Where a class is defined."""
    name = getattr(maker, "__qualname__", None)
    module = getattr(maker, "__module__", None)
    file = _source_file(maker)
    if name is None or module is None or "<" in name:
        return ControllerSource(None, _digest(maker, file))
    if file is not None and (module == "__main__" or module.startswith("_palmbots_controller_")):
        with contextlib.suppress(ValueError):
            file = file.relative_to(Path.cwd())
        return ControllerSource(f"{file.as_posix()}:{name}", _digest(maker, file))
    return ControllerSource(f"{module}:{name}", _digest(maker, file))


def _source_file(maker: Any) -> Path | None:
    try:
        name = inspect.getsourcefile(maker)
    except (TypeError, OSError):  # OSError: the class was not defined in a file
        return None
    path = None if name is None else Path(name)
    return path if path is not None and path.is_file() else None


def _digest(maker: Any, file: Path | None) -> str | None:
    if file is not None:
        with contextlib.suppress(OSError):
            return hashlib.sha256(file.read_bytes()).hexdigest()
    try:
        return hashlib.sha256(inspect.getsource(maker).encode()).hexdigest()
    except (OSError, TypeError):
        return None


def hash_of_reference(reference: str, folder: str | None = None) -> str | None:
    """The SHA-256 of the file that a reference names, without running it; None: it is not found."""
    place, _, name = reference.rpartition(":")
    if reference.endswith((".toml", ".toml@station")):
        path: Path | None = _path(reference.removesuffix("@station"), folder)
    elif _is_file(place):
        path = _path(place, folder)
    else:
        loaded = sys.modules.get(place)
        if loaded is not None:
            maker: Any = loaded
            for part in name.split("."):
                maker = getattr(maker, part, None)
            return source_of(maker).sha256
        try:
            with _importable(Path.cwd()):
                spec = importlib.util.find_spec(place)
        except (Exception, SystemExit):  # the package of a user may raise anything
            return None
        path = Path(spec.origin) if spec is not None and spec.origin else None
    try:
        return None if path is None else hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return None
