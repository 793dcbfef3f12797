# SPDX-License-Identifier: Apache-2.0
"""Builds a source distribution, and wheels from it (`make wheels`).

    .venv/bin/python scripts/build_wheels.py [--out DIR] [--only WORD] [--python PATH]

For x86-64 and for aarch64 there are two wheels: one for Python 3.11, and one with the stable ABI
for Python 3.12 and later. The compiler is Clang in the package ziglang. It holds the headers and
the symbols of every glibc, so that the wheels run on systems with glibc 2.17 or later, and it links
its C++ library into the modules. The stubs of the compiled core are those of the native build.

Two builds have the same bytes: times in the files are those of the last commit
(`SOURCE_DATE_EPOCH`), and no path of this machine is in them.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tarfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "requirements" / "wheels.txt"
GLIBC = "2.17"
STUBS = ROOT / "src" / "palmbots" / "_core" / "__init__.pyi"
NEWER = ("python3.12", "python3.13", "python3.14")
TIME = "1704067200"  # without a history of commits: 2024-01-01


class BuildError(Exception):
    """Why there is no wheel, in one line."""


@dataclass(frozen=True)
class Target:
    """One wheel."""

    tag: str
    """Of the Python: cp311, or cp312-abi3."""
    machine: str

    @property
    def name(self) -> str:
        """What `--only` selects by."""
        return f"{self.tag}-{self.machine}"


TARGETS = [Target(tag, m) for m in ("x86_64", "aarch64") for tag in ("cp311", "cp312-abi3")]


def main(words: list[str]) -> int:
    """Build; returns the exit status."""
    parser = argparse.ArgumentParser(description="Build the sdist and the wheels.")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder of the results")
    parser.add_argument("--only", default="", help="only wheels with this in their name")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "wheels")
    parser.add_argument("--python", help="a Python from 3.12 on, with headers, for the stable ABI")
    options = parser.parse_args(words)
    targets = [target for target in TARGETS if options.only in target.name]
    try:
        if not targets:
            names = ", ".join(target.name for target in TARGETS)
            raise BuildError(f"--only: value is {options.only}; allowed: a part of {names}")
        if not STUBS.exists():
            raise BuildError("needs the stubs that a native build writes; run: make build")
        pythons = {"cp311": sys.executable}
        if sys.version_info[:2] != (3, 11):
            pythons["cp311"] = _found(("python3.11",), None, "3.11", range(11, 12))
        if any(target.tag == "cp312-abi3" for target in targets):
            newer = _found(NEWER, options.python, "3.12 or later", range(12, 100))
            pythons["cp312-abi3"] = newer
        _build(targets, pythons, options.out.resolve(), options.work.resolve())
    except BuildError as error:
        print(f"build_wheels: {error}", file=sys.stderr)
        return 2
    return 0


def _build(targets: list[Target], pythons: dict[str, str], out: Path, work: Path) -> None:
    work.mkdir(parents=True, exist_ok=True)
    out.mkdir(parents=True, exist_ok=True)
    environments = {
        tag: _environment(pythons[tag], work / f"env-{tag}")
        for tag in {"cp311"} | {target.tag for target in targets}
    }
    archive = _sdist(environments["cp311"], out)
    print(archive)
    source = _unpacked(archive, work)
    for target in targets:
        print(_wheel(target, environments[target.tag], source, out, work), flush=True)


def _found(names: tuple[str, ...], given: str | None, which: str, minors: range) -> str:
    """An interpreter of one of these versions that has the headers of C."""
    code = (
        "import os, sys, sysconfig; folder = sysconfig.get_path('include');"
        "os.stat(os.path.join(folder, 'Python.h'));"
        "print(sys.version_info[1], os.path.realpath(sys.executable))"
    )
    for path in _candidates(names, given):
        done = subprocess.run([path, "-c", code], capture_output=True, text=True, check=False)
        minor, _, real = done.stdout.strip().partition(" ")
        if done.returncode == 0 and int(minor) in minors:
            return real
    raise BuildError(f"needs Python {which} with its headers; name it with --python PATH")


def _candidates(names: tuple[str, ...], given: str | None) -> Iterator[str]:
    if given is not None:
        path = shutil.which(given)
        if path is None:
            raise BuildError(f"--python: value is {given}; allowed: a Python interpreter")
        yield path
        return
    folders = os.environ.get("PATH", os.defpath).split(os.pathsep)
    # The shims of pyenv do not answer for versions that are not chosen.
    folders += [str(p) for p in sorted(Path.home().glob(".pyenv/versions/*/bin"))]
    for name in names:
        for folder in folders:
            path = shutil.which(name, path=folder)
            if path is not None:
                yield path


def _environment(python: str, folder: Path) -> Path:
    """The interpreter of an environment with the locked packages that build."""
    done = folder / "done"
    if not done.exists() or done.read_bytes() != LOCK.read_bytes():
        _run(python, "-m", "venv", "--clear", str(folder))
        packages = ["install", "--quiet", "--disable-pip-version-check", "--no-deps"]
        packages += ["--require-hashes", "--requirement", str(LOCK)]
        _run(str(folder / "bin" / "python"), "-m", "pip", *packages)
        done.write_bytes(LOCK.read_bytes())
    return folder / "bin" / "python"


def _sdist(python: Path, out: Path) -> Path:
    code = (
        "import sys, scikit_build_core.build as build;print('\\n' + build.build_sdist(sys.argv[1]))"
    )
    text = _run(str(python), "-c", code, str(out), environment=_fixed_time())
    return out / text.strip().splitlines()[-1]


def _unpacked(archive: Path, work: Path) -> Path:
    """The sources in the archive, in a folder of their own."""
    folder = work / "source"
    shutil.rmtree(folder, ignore_errors=True)
    with tarfile.open(archive) as stream:
        stream.extractall(folder, filter="data")
    (top,) = folder.iterdir()
    return top


def _wheel(target: Target, python: Path, source: Path, out: Path, work: Path) -> Path:
    build = work / f"build-{target.name}"
    shutil.rmtree(build, ignore_errors=True)
    build.mkdir()
    compiler = _compiler(target, python, source, build)
    toolchain = build / "toolchain.cmake"
    toolchain.write_text(
        "set(CMAKE_SYSTEM_NAME Linux)\n"
        f"set(CMAKE_SYSTEM_PROCESSOR {target.machine})\n"
        f"set(CMAKE_CXX_COMPILER {compiler})\n"
    )
    environment = _fixed_time() | {
        "PATH": f"{python.parent}{os.pathsep}{os.environ['PATH']}",
        # The end of the modules' names.
        "SETUPTOOLS_EXT_SUFFIX": f".cpython-311-{target.machine}-linux-gnu.so",
    }
    arguments = ["wheel", "--quiet", "--disable-pip-version-check", "--no-build-isolation"]
    arguments += ["--no-deps", "--no-cache-dir", f"--wheel-dir={build / 'wheel'}"]
    arguments += [f"--config-settings=build-dir={build / 'cmake'}"]
    arguments += [f"--config-settings=cmake.define.CMAKE_TOOLCHAIN_FILE={toolchain}"]
    # The platform of the wheel's name. In the environment of the process it would hide the ABI of
    # Python 3.11 from the backend.
    platform = f"manylinux_{GLIBC.replace('.', '_')}_{target.machine}"
    arguments += [f"--config-settings=env._PYTHON_HOST_PLATFORM={platform}"]
    _run(str(python), "-m", "pip", *arguments, str(source), environment=environment)
    (made,) = (build / "wheel").glob("*.whl")
    return made.replace(out / made.name)


def _compiler(target: Target, python: Path, source: Path, build: Path) -> Path:
    """A program that compiles C++ for the target, without the paths of this machine."""
    maps = {source: "palmbots", python.parent.parent: "environment", build: "build"}
    flags = [f"-ffile-prefix-map={path}={name}" for path, name in maps.items()]
    # nanobind relies on what Python.h includes, and that is less with the stable ABI.
    flags += ["-include", "stdio.h"]
    script = build / "c++"
    words = " ".join(f"'{flag}'" for flag in flags)
    script.write_text(
        "#!/bin/sh\n"
        "# The levels of x86-64 have other names there.\n"
        "for word do\n"
        "    shift\n"
        "    case $word in -march=x86-64-v*) word=-mcpu=x86_64_v${word##*-v} ;; esac\n"
        '    set -- "$@" "$word"\n'
        "done\n"
        f"exec '{python}' -m ziglang c++ -target {target.machine}-linux-gnu.{GLIBC} "
        f'{words} "$@"\n'
    )
    script.chmod(0o755)
    return script


def _fixed_time() -> dict[str, str]:
    """The environment of builds: the time of the files is that of the last commit."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    if given is None:
        git = ["git", "-C", str(ROOT), "log", "-1", "--format=%ct"]
        done = subprocess.run(git, capture_output=True, text=True, check=False)
        given = done.stdout.strip() or TIME
    return {"SOURCE_DATE_EPOCH": given}


def _run(*command: str, environment: dict[str, str] | None = None) -> str:
    """The output of a command; what it prints is shown only where it fails.

    Raises:
        BuildError: it failed.
    """
    done = subprocess.run(
        command,
        cwd=ROOT,
        env=os.environ | (environment or {}),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        print(done.stdout, file=sys.stderr)
        raise BuildError(f"{Path(command[0]).name} {' '.join(command[1:4])} … failed")
    return done.stdout


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
