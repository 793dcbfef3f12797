# SPDX-License-Identifier: Apache-2.0
"""The bill of materials of palmbots as CycloneDX JSON (`make sbom`).

    .venv/bin/python scripts/sbom.py OUT

It lists the locked Python packages of `palmbots carry`, what the wheels link (nanobind, and the C++
library of Clang in the package ziglang), the npm packages in the bundle of the page, and the
description of a board from which its registers are derived. Versions come from the lock files; the
registers have none. The result is checked against the schema of CycloneDX.
"""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

ROOT = Path(__file__).resolve().parent.parent
LOCKS = ROOT / "requirements"


class SbomError(Exception):
    """Why the bill is not valid, in one line."""


def locked(name: str, lock: str) -> str:
    """The version of a package in a lock file."""
    text = (LOCKS / lock).read_text(encoding="utf-8")
    found = re.findall(rf"^{re.escape(name)}==(\S+)", text, re.MULTILINE)
    if len(found) != 1:
        raise SbomError(f"{lock}: {name}: expected one version")
    return found[0]


def linked() -> list[dict[str, Any]]:
    """What the compiler links into the wheels, and what the firmware is derived from."""
    zig = locked("ziglang", "wheels.txt")
    llvm = {"expression": "Apache-2.0 WITH LLVM-exception"}
    parts: list[dict[str, Any]] = [
        {
            "type": "library",
            "name": name,
            "bom-ref": f"ziglang-{name}",
            "description": f"as it is in ziglang {zig}; linked into the wheels",
            "licenses": [llvm],
            "properties": [{"name": "palmbots:part-of", "value": f"pkg:pypi/ziglang@{zig}"}],
        }
        for name in ("libc++", "libc++abi", "libunwind")
    ]
    parts.append(
        {
            "type": "file",
            "name": "registers of the nRF52833",
            "bom-ref": "nrf52833-registers",
            "description": "firmware/board/nrf52833/registers.hpp, from Nordic's description",
            "licenses": [{"license": {"id": "BSD-3-Clause"}}],
        }
    )
    return parts


def bundled() -> list[dict[str, Any]]:
    """The npm packages in the bundle of the page."""
    lock = json.loads((ROOT / "site" / "package-lock.json").read_text(encoding="utf-8"))
    found = []
    for path, package in lock["packages"].items():
        if path and not package.get("dev"):
            name = path.rpartition("node_modules/")[2]
            purl = f"pkg:npm/{name.replace('@', '%40')}@{package['version']}"
            found.append(
                {
                    "type": "library",
                    "name": name,
                    "version": package["version"],
                    "purl": purl,
                    "bom-ref": purl,
                    "description": "in the bundle of the page",
                    "licenses": [{"license": {"id": package["license"]}}],
                }
            )
    return found


def bill(out: Path) -> dict[str, Any]:
    """The whole bill, of which cyclonedx-py makes the part for Python in the file `out`.

    Raises:
        SbomError: the bill does not follow the schema.
    """
    tool = [Path(sys.executable).parent / "cyclonedx-py", "requirements", LOCKS / "carry.txt"]
    tool += ["--pyproject", ROOT / "pyproject.toml", "--output-reproducible"]
    subprocess.run([*tool, "--output-file", out], check=True)
    made = json.loads(out.read_text(encoding="utf-8"))
    made["components"] += [*linked(), *bundled()]
    check(made)
    return made


def check(made: dict[str, Any]) -> None:
    """Raise SbomError if a bill does not follow the schema of its version."""
    version = SchemaVersion.from_version(made["specVersion"])
    fault = JsonStrictValidator(version).validate_str(json.dumps(made))
    if fault is not None:
        raise SbomError(str(fault).partition("\n")[0])


def main(out: Path) -> int:
    """Write the bill; returns the exit status."""
    out.parent.mkdir(parents=True, exist_ok=True)
    try:
        made = bill(out)
    except SbomError as error:
        out.unlink(missing_ok=True)
        print(f"sbom: {error}", file=sys.stderr)
        return 2
    out.write_text(json.dumps(made, indent=2) + "\n", encoding="utf-8")
    print(f"{out}: {len(made['components'])} components")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
