# SPDX-License-Identifier: Apache-2.0
"""Old names in Python: each is refused in one line that gives the new name.

An old name is written where its new one is defined, and nowhere else. The text that stands for the
new name may continue with a remark: ``slope_deg, in degrees``. Signatures, help texts, types and
pickles are those of the new names alone.
"""

import functools
import sys
from collections.abc import Callable, Mapping
from opcode import opmap
from typing import Any, NoReturn, TypeVar

AnyFunction = TypeVar("AnyFunction", bound=Callable[..., Any])
AnyClass = TypeVar("AnyClass")

PROGRESS = {"progress": "on_progress"}
"""The argument of functions that report their progress."""


_MISSING = object()


def _line(old: str, new: str) -> str:
    return f"{old} is renamed to {new}"


def renamed_arguments(**new: str) -> Callable[[AnyFunction], AnyFunction]:
    """Decorate a function that refuses old keyword arguments with a TypeError."""

    def decorate(function: Any) -> Any:
        @functools.wraps(function)
        def call(*values: Any, **given: Any) -> Any:
            for name in given:
                if name in new:
                    raise TypeError(_line(f"{function.__name__}(): {name}", new[name]))
            return function(*values, **given)

        return call

    return decorate


def renamed_fields(**new: str) -> Callable[[type[AnyClass]], type[AnyClass]]:
    """Decorate a dataclass that refuses old fields, as attributes and as arguments."""

    def decorate(decorated: Any) -> Any:
        def __getattr__(self: Any, name: str) -> Any:
            if name in new:
                raise AttributeError(_line(f"{type(self).__name__}.{name}", new[name]))
            return object.__getattribute__(self, name)  # raises the usual error

        decorated.__getattr__ = __getattr__
        decorated.__init__ = _strict_init(decorated.__init__, new)
        return decorated

    return decorate


def _strict_init(init: Any, new: Mapping[str, str]) -> Any:
    """The ``__init__`` of a dataclass that refuses old arguments.

    The generated ``__init__`` lists its parameters explicitly, as a dataclass does. Some of these
    objects are created in every control period, and a wrapper with ``*values, **given`` would add
    half to the cost of creating one.
    """
    code, defaults = init.__code__, init.__defaults__ or ()
    names = code.co_varnames[1 : code.co_argcount]
    required = names[: len(names) - len(defaults)]

    def complain(self: Any, given: Mapping[str, Any]) -> None:
        for name in filter(new.__contains__, given):
            raise TypeError(_line(f"{type(self).__name__}(): {name}", new[name]))
        init(self, **{name: value for name, value in given.items() if value is not _MISSING})

    scope = {"_init": init, "_complain": complain, "_MISSING": _MISSING}
    exec(
        f"def __init__(self, {', '.join(names)}, **_old):\n"
        f"    if {' or '.join(['_old', *(f'{name} is _MISSING' for name in required)])}:\n"
        f"        _complain(self, {{{', '.join(f'{name!r}: {name}' for name in names)}, **_old}})\n"
        f"    _init(self, {', '.join(names)})\n",
        scope,
    )
    strict: Any = functools.wraps(init)(scope["__init__"])
    strict.__defaults__ = (_MISSING,) * len(required) + defaults
    return strict


class RenamedKeys(dict[Any, Any]):
    """A dictionary that refuses old keys with a KeyError."""

    def __init__(self, entries: Any, new: Mapping[str, str]) -> None:
        super().__init__(entries)
        self._new = new

    def __missing__(self, key: Any) -> NoReturn:
        raise KeyError(_line(key, self._new[key]) if key in self._new else key)


_MODULE_NAMES: dict[str, str] = {}
"""The new name of each old dotted name."""


def renamed_in_module(module: str, new: Mapping[str, str]) -> None:
    """Refuse old names of a module, and old modules of a package.

    Call it below the module's own ``__getattr__``.
    """
    _MODULE_NAMES.update({f"{module}.{old}": name for old, name in new.items()})
    names = vars(sys.modules[module])
    own = names.get("__getattr__")

    def __getattr__(name: str) -> Any:
        if name in new:
            # `from … import` replaces an AttributeError by an ImportError without its message.
            caller = sys._getframe(1)
            is_import = caller.f_code.co_code[caller.f_lasti] == opmap["IMPORT_FROM"]
            raise (ImportError if is_import else AttributeError)(
                _line(f"{module}.{name}", new[name])
            )
        if own is None:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        return own(name)

    names["__getattr__"] = __getattr__


class _OldModules:
    """The last import finder: it refuses the old names of modules."""

    @staticmethod
    def find_spec(name: str, path: object = None, target: object = None) -> None:
        """Refuse the module if it is an old one."""
        if name in _MODULE_NAMES:
            raise ModuleNotFoundError(_line(name, _MODULE_NAMES[name]))


sys.meta_path.append(_OldModules)
