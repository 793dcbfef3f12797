# SPDX-License-Identifier: Apache-2.0
"""A missing package is reported in one line, with a command that installs its extra."""

import importlib.metadata
import pickle
import shlex
import sys
import tomllib
from pathlib import Path

import pytest

from palmbots._util.optional_imports import missing_extra, require
from palmbots.errors import MissingExtra

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]


def metadata(_: str) -> list[str]:
    """The requirements as build back ends write them into the metadata of a package."""
    lines = [f'{package} ; extra == "{extra}"' for extra in EXTRAS for package in EXTRAS[extra]]
    return [*PROJECT["dependencies"], *lines]


def test_present_module_is_returned() -> None:
    assert require("json", "study") is __import__("json")


@pytest.mark.parametrize("extra", EXTRAS)
def test_command_installs_the_packages_of_the_extra(
    extra: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.metadata, "requires", metadata)
    monkeypatch.setitem(sys.modules, "absent", None)
    with pytest.raises(MissingExtra) as error:
        require("absent.part", extra)
    assert error.value.extra == extra
    message, command = str(error.value).split("; run: ")
    assert message == f"{extra}: the package absent is missing"
    packages = [
        package
        for given in EXTRAS[extra]
        for package in EXTRAS.get(given.removeprefix("palmbots[").removesuffix("]"), [given])
    ]
    assert shlex.split(command) == [sys.executable, "-m", "pip", "install", *packages]


def test_without_metadata_the_command_names_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    def requires(name: str) -> list[str]:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "requires", requires)
    assert str(missing_extra("zarr.codecs", "study")).endswith("-m pip install zarr")


def test_broken_module_is_reported_with_its_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "broken_module.py").write_text("raise ImportError('libx.so: not found')\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(MissingExtra) as error:
        require("broken_module", "mujoco")
    assert str(error.value) == "mujoco: broken_module cannot be imported: libx.so: not found"


def test_error_survives_pickling() -> None:
    error = pickle.loads(pickle.dumps(missing_extra("zarr", "study")))
    assert isinstance(error, MissingExtra) and error.extra == "study"
