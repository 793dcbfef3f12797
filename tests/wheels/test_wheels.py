# SPDX-License-Identifier: Apache-2.0
"""The wheels and the source distribution that `make wheels` leaves in dist (`make test-wheels`).

Each Python that this machine has, from 3.11 on, installs its wheel into an empty environment from
packages that lie on the disk, and carries; the bits are those of this tree. The wheels for aarch64
do so under qemu-user with Pythons of Debian, and Python 3.14 is that of Debian unstable.
"""

import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tarfile
import time
import tomllib
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from cxx import ROOT
from palmbots.pair.pair_file import init_pair

DIST = Path(os.environ.get("PALMBOTS_DIST", ROOT / "dist"))
WORK = ROOT / "build" / "wheels"
VERSION = pb.__version__
TAGS = {
    "cp311": "cp311-cp311",
    "cp312-abi3": "cp312-abi3",
}
MACHINES = ("x86_64", "aarch64")
WHEELS = [
    DIST / f"palmbots-{VERSION}-{tag}-manylinux_2_17_{machine}.whl"
    for machine in MACHINES
    for tag in TAGS.values()
]
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
DEBIAN_PACKAGES = (
    "python{}-minimal", "libpython{}-minimal", "libpython{}-stdlib", "libc6", "libgcc-s1",
    "libstdc++6", "zlib1g", "libexpat1", "libbz2-1.0", "liblzma5", "libffi8", "libsqlite3-0",
    "libncursesw6", "libtinfo6", "libuuid1", "libcrypt1",
)  # fmt: skip
GLIBC = (2, 17)
STUBS = ("__init__", "runtime", "serial", "wire")
KEY = Path("/usr/share/keyrings/debian-archive-keyring.gpg")  # package debian-archive-keyring


def dependencies() -> list[str]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    return project["dependencies"]


def run(*command: str | Path, **options: Any) -> str:
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, check=False, **options
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def hash_here(*words: str) -> str:
    found = run(sys.executable, "-m", "palmbots", "carry", "--json", *words)
    return json.loads(found)["trace_hash"]


@pytest.mark.parametrize("wheel", WHEELS, ids=lambda path: path.name)
def test_wheel_is_complete_and_needs_only_old_libraries(wheel: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        held = set(archive.namelist())
        archive.extractall(tmp_path)
    sources = {
        path.relative_to(ROOT / "src").as_posix()
        for path in (ROOT / "src" / "palmbots").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert sources <= held
    assert {"palmbots/boards/data/robot.hex", "palmbots/scene/data/scene-keys.md"} <= held
    assert {f"palmbots/_core/{name}.pyi" for name in STUBS} <= held
    modules = sorted(tmp_path.rglob("*.so"))
    names = {module.name.partition(".")[0] for module in modules}
    more = {"_batch_v3", "_batch_v4"} if "x86_64" in wheel.name else set()
    assert names == {"_core", "_batch"} | more
    for module in modules:
        needed = re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-dW", module))
        assert not [name for name in needed if re.match(r"lib(stdc\+\+|gcc|c\+\+)", name)], needed
        versions = re.findall(r"GLIBC_(\d+)\.(\d+)", run("readelf", "-VW", module))
        assert versions
        assert max((int(a), int(b)) for a, b in versions) <= GLIBC
        assert str(ROOT).encode() not in module.read_bytes()


def test_source_distribution_holds_what_a_build_needs() -> None:
    with tarfile.open(DIST / f"palmbots-{VERSION}.tar.gz") as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    needed = {"CMakeLists.txt", "pyproject.toml", "docs/reference/scene-keys.md", "LICENSE"}
    headers = {str(p.relative_to(ROOT)) for p in (ROOT / "include").rglob("*.hpp")}
    assert needed | headers | {f"src/palmbots/_core/{name}.pyi" for name in STUBS} <= names
    assert not [name for name in names if name.startswith(("build/", ".venv/", "out/"))]


def work() -> float:
    """Processor time of what has ended [s]."""
    used = os.times()
    return used.children_user + used.children_system


def interpreter(version: str) -> str | None:
    """An interpreter of this version; the shims of pyenv do not answer for all that there are."""
    folders = [*os.environ.get("PATH", os.defpath).split(os.pathsep)]
    folders += [str(p) for p in Path.home().glob(f".pyenv/versions/{version}*/bin")]
    for folder in folders:
        path = shutil.which(f"python{version}", path=folder)
        if path is None:
            continue
        if subprocess.run([path, "-c", ""], check=False, capture_output=True).returncode == 0:
            return path
    return None


@pytest.mark.parametrize("version", PYTHONS)
def test_wheel_is_installed_and_carries(version: str, tmp_path: Path) -> None:
    python = interpreter(version)
    if python is None:
        pytest.skip(f"untested: this machine has no Python {version}")
    tag = TAGS["cp311" if version == "3.11" else "cp312-abi3"]
    wheel = DIST / f"palmbots-{VERSION}-{tag}-manylinux_2_17_{platform.machine()}.whl"
    run(python, "-m", "venv", tmp_path / "env")
    own = tmp_path / "env" / "bin" / "python"
    packages = WORK / f"packages-{version}"
    pip = (own, "-m", "pip", "--disable-pip-version-check")
    run(*pip, "download", "-q", "--only-binary=:all:", "-d", packages, *dependencies())

    began, worked = time.monotonic(), work()
    run(*pip, "install", "-q", "--no-index", "--find-links", packages, wheel)
    installed = time.monotonic()
    out = run(own, "-m", "palmbots", "carry", cwd=tmp_path)
    done = time.monotonic()
    print(
        f"Python {version}: install {installed - began:.1f} s, carry {done - installed:.1f} s, "
        f"together {done - began:.1f} s ({work() - worked:.1f} s of processor)"
    )
    assert "DELIVERED" in out
    words = ("--seed", "3")
    found = json.loads(run(own, "-m", "palmbots", "carry", "--json", *words, cwd=tmp_path))
    assert found["trace_hash"] == hash_here(*words)
    code = (
        "import palmbots as pb; print(pb.__file__);"
        "print(pb.compare('paper', carries=64, values=[0.1]).rows[0].n)"
    )
    where, carried = run(own, "-c", code, cwd=tmp_path).splitlines()
    assert where.startswith(str(tmp_path))
    assert carried == "64"


@dataclass(frozen=True)
class Place:
    """A Debian whose Python runs here without being installed: its files are unpacked."""

    suite: str
    version: str
    machine: str

    @property
    def name(self) -> str:
        return f"{self.suite}-{self.version}-{self.machine}"

    @property
    def tag(self) -> str:
        return TAGS["cp311" if self.version == "3.11" else "cp312-abi3"]

    def command(self) -> list[str]:
        """Its Python, under emulation where the processor is another one."""
        root = self.root()
        python = str(root / f"usr/bin/python{self.version}")
        if self.machine == "aarch64":
            return ["qemu-aarch64-static", "-L", str(root), python]
        loader, libraries = root / "usr/lib64/ld-linux-x86-64.so.2", "usr/lib/x86_64-linux-gnu"
        return [str(loader), "--library-path", str(root / libraries), python]

    def root(self) -> Path:
        root = WORK / f"root-{self.name}"
        if root.exists():
            return root
        folder = WORK / f"apt-{self.name}"
        (folder / "lists" / "partial").mkdir(parents=True, exist_ok=True)
        (folder / "archives").mkdir(exist_ok=True)
        sources = f"deb [signed-by={KEY}] http://deb.debian.org/debian {self.suite} main\n"
        (folder / "sources.list").write_text(sources)
        kind = {"x86_64": "amd64", "aarch64": "arm64"}[self.machine]
        settings = {"APT::Architecture": kind, "APT::Architectures": kind}
        settings |= {"Dir::State::Lists": str(folder / "lists"), "APT::Sandbox::User": "root"}
        settings |= {"Dir::Etc::SourceParts": "/dev/null"}
        settings |= {"Dir::Etc::SourceList": str(folder / "sources.list")}
        apt = ("apt-get", "-qq", *(f"-o{key}={value}" for key, value in settings.items()))
        run(*apt, "update")
        late = self.suite != "bookworm"  # names since the change to 64-bit times
        names = [name.format(self.version) for name in DEBIAN_PACKAGES]
        names += ["libssl3t64", "libreadline8t64", "libzstd1"] if late else ["libssl3"]
        run(*apt, "download", *names, cwd=folder / "archives")
        for archive in (folder / "archives").glob("*.deb"):
            run("dpkg", "-x", archive, folder / "root")
        for name in ("lib", "lib64"):  # what a newer Debian has in /usr only
            if not (folder / "root" / name).exists() and (folder / "root" / "usr" / name).exists():
                (folder / "root" / name).symlink_to(f"usr/{name}")
        return (folder / "root").rename(root)


PLACES = [
    Place("bookworm", "3.11", "aarch64"), Place("sid", "3.14", "aarch64"),
    Place("sid", "3.14", "x86_64"),
]  # fmt: skip
Palmbots = tuple[list[str], dict[str, str]]


@pytest.fixture(scope="module", params=PLACES, ids=lambda place: place.name)
def palmbots_of_debian(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Palmbots:
    """The command palmbots of a wheel, with a Python of Debian, and its environment."""
    place: Place = request.param
    tools = ("apt-get", "dpkg", *(("qemu-aarch64-static",) if place.machine == "aarch64" else ()))
    if platform.machine() != "x86_64" or not all(map(shutil.which, tools)):
        pytest.skip(f"untested: needs x86-64 and {', '.join(tools)}")
    if not KEY.exists() and not (WORK / f"root-{place.name}").exists():
        pytest.skip(f"untested: needs {KEY}, from the package debian-archive-keyring")
    site, own = WORK / f"site-{place.name}", tmp_path_factory.mktemp("own")
    platforms = [f"manylinux_2_{n}_{place.machine}" for n in (28, 27, 26, 24, 17)]
    kind = ["--only-binary=:all:", "--python-version", place.version, "--implementation", "cp"]
    kind += [f"--abi={abi}" for abi in (f"cp{place.version.replace('.', '')}", "abi3", "none")]
    kind += [f"--platform={name}" for name in (*platforms, f"manylinux2014_{place.machine}")]
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "-q")
    if not site.exists():
        run(*pip, "--no-compile", "--target", site, *kind, *dependencies())
    wheel = DIST / f"palmbots-{VERSION}-{place.tag}-manylinux_2_17_{place.machine}.whl"
    run(*pip, "--no-compile", "--no-deps", "--target", own, *kind, wheel)
    environment = {"PYTHONPATH": f"{own}:{site}", "PATH": os.defpath}
    environment["PYTHONHOME"] = str(place.root() / "usr")
    return [*place.command(), "-m", "palmbots"], environment


def test_wheel_carries_the_same_bits_with_a_python_of_debian(
    palmbots_of_debian: Palmbots, tmp_path: Path
) -> None:
    command, environment = palmbots_of_debian
    words = ("--seed", "3", "--set", "task.distance_m=0.3", "--set", "robot.noise_m_s=0.02")
    found = json.loads(run(*command, "carry", "--json", *words, env=environment, cwd=tmp_path))
    assert found["outcome"] == "delivered"
    assert found["trace_hash"] == hash_here(*words)


@pytest.mark.parametrize("controller", ["resilient", "shared-sign"])
def test_robots_there_and_a_world_here_carry_the_same_bits(
    controller: str, palmbots_of_debian: Palmbots, tmp_path: Path
) -> None:
    """On aarch64 the programs of both robots run under emulation, and their world does not."""
    command, environment = palmbots_of_debian
    scene = pb.load_scene("paper", {"task.distance_m": 0.3, "radio.loss": 0.1})
    (tmp_path / "scene.toml").write_text(scene.to_toml())
    words = ("scene.toml", "--controller", controller, "--seed", "3", "--json")
    address = f"unix:{tmp_path / 'world'}"
    init_pair(tmp_path / "pair.toml", scene="scene.toml", controller=controller, address=address)
    here = [sys.executable, "-m", "palmbots"]
    serve = [*here, "world", *words, "--lockstep", "--serve", address]
    robots = []
    with subprocess.Popen(serve, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as world:
        for side in ("left", "right"):
            robot = [*command, "robot", "pair.toml", "--side", side, "--lockstep"]
            robots.append(subprocess.Popen(robot, cwd=tmp_path, env=environment))
        printed, _ = world.communicate(timeout=300)
    assert [robot.wait(60) for robot in robots] == [0, 0]
    carried = json.loads(run(*here, "carry", *words, cwd=tmp_path))
    carried["scene_statistics"] = None  # of many carries, which a world of processes does not run
    assert json.loads(printed) == carried and carried["outcome"] == "delivered"
