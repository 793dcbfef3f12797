# SPDX-License-Identifier: Apache-2.0
"""Classes and functions with old names behave otherwise as if they had none."""

import copy
import inspect
import pickle
import sys
import types
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields, replace

import pytest

from palmbots._util.renamed_names import (
    RenamedKeys,
    renamed_arguments,
    renamed_fields,
    renamed_in_module,
)


@dataclass(frozen=True, slots=True)
class Bare:
    """A class."""

    size: int
    missing: str = "no"
    tags: list[str] = field(default_factory=list)


@renamed_fields(length="size", lost="missing")
@dataclass(frozen=True, slots=True)
class Slotted:
    """A class."""

    size: int
    missing: str = "no"
    tags: list[str] = field(default_factory=list)


@renamed_fields(length="size")
@dataclass
class Open:
    """A class without slots."""

    size: int

    @property
    def broken(self) -> int:
        """Fails."""
        return self.nothing  # type: ignore[attr-defined]


@renamed_arguments(length="size")
def measure(size: int = 1, **others: int) -> tuple[int, dict[str, int]]:
    """Measure."""
    return size, others


def test_class_looks_as_without_old_names() -> None:
    assert inspect.signature(Slotted) == inspect.signature(Bare)
    assert Slotted.__init__.__annotations__ == Bare.__init__.__annotations__
    assert Slotted.__init__.__qualname__ == "Slotted.__init__"
    assert [f.name for f in fields(Slotted)] == ["size", "missing", "tags"]
    assert Slotted.__match_args__ == Bare.__match_args__


def test_objects_work_as_without_old_names() -> None:
    one = Slotted(3, tags=["a"])
    assert repr(one) == "Slotted(size=3, missing='no', tags=['a'])"
    assert one == Slotted(size=3, tags=["a"]) and one != Slotted(4)
    assert pickle.loads(pickle.dumps(one)) == copy.copy(one) == copy.deepcopy(one) == one
    assert asdict(replace(one, size=5)) == {"size": 5, "missing": "no", "tags": ["a"]}
    assert Slotted(1).tags is not Slotted(1).tags
    assert not hasattr(one, "length") and getattr(one, "length", None) is None


@pytest.mark.parametrize(
    "given", [{}, {"missing": "a"}, {"size": 1, "other": 2}, {"other": 2}], ids=str
)
def test_other_wrong_arguments_get_the_usual_error(given: dict[str, object]) -> None:
    with pytest.raises(TypeError) as usual:
        Bare(**given)  # type: ignore[arg-type]
    with pytest.raises(TypeError) as error:
        Slotted(**given)  # type: ignore[arg-type]
    assert str(error.value) == str(usual.value).replace("Bare", "Slotted")


def test_old_argument_of_a_constructor_is_refused_also_without_required_ones() -> None:
    for given in ({"length": 3}, {"size": 3, "lost": ""}, {"lost": "", "other": 1}):
        with pytest.raises(TypeError, match=r"^Slotted\(\): (length|lost) is renamed to \w+$"):
            Slotted(**given)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="length is renamed to size"):
        replace(Slotted(3), length=4)  # type: ignore[call-arg]


def test_other_missing_attributes_get_the_usual_error() -> None:
    with pytest.raises(AttributeError, match=r"^'Slotted' object has no attribute 'other'$"):
        Slotted(1).other  # type: ignore[attr-defined]  # noqa: B018
    with pytest.raises(AttributeError, match=r"^'Open' object has no attribute 'nothing'$"):
        Open(1).broken  # noqa: B018


def test_function_looks_and_works_as_without_old_names() -> None:
    assert str(inspect.signature(measure)) == (
        "(size: int = 1, **others: int) -> tuple[int, dict[str, int]]"
    )
    assert measure(2, width=3) == (2, {"width": 3})
    assert pickle.loads(pickle.dumps(measure)) is measure
    with pytest.raises(TypeError, match=r"^measure\(\): length is renamed to size$"):
        measure(length=2)


def test_keys() -> None:
    counts = RenamedKeys({"new": 1}, {"old": "new"})
    assert counts == {"new": 1} and repr(counts) == "{'new': 1}" and counts.get("old") is None
    assert pickle.loads(pickle.dumps(counts)) == counts
    with pytest.raises(KeyError, match=r"^'old is renamed to new'$"):
        counts["old"]
    with pytest.raises(KeyError, match=r"^'other'$"):
        counts["other"]


@pytest.fixture
def module(monkeypatch: pytest.MonkeyPatch) -> Iterator[types.ModuleType]:
    made = types.ModuleType("made_for_a_test")
    made.__dict__["present"] = 1
    monkeypatch.setitem(sys.modules, made.__name__, made)
    yield made


def test_names_of_a_module(module: types.ModuleType) -> None:
    renamed_in_module(module.__name__, {"former": "present"})
    expected = "made_for_a_test.former is renamed to present"
    with pytest.raises(AttributeError, match=f"^{expected}$"):
        module.former  # noqa: B018
    with pytest.raises(ImportError, match=f"^{expected}$"):
        exec("from made_for_a_test import present, former")
    with pytest.raises(ImportError, match="cannot import name 'other'"):
        exec("from made_for_a_test import other")
    with pytest.raises(AttributeError, match="no attribute 'other'"):
        module.other  # noqa: B018


def test_own_getattr_of_a_module_is_asked_for_other_names(module: types.ModuleType) -> None:
    module.__dict__["__getattr__"] = str.upper
    renamed_in_module(module.__name__, {"former": "present"})
    assert module.later == "LATER"
    assert not hasattr(module, "former")
