# SPDX-License-Identifier: Apache-2.0
"""The bill of materials holds what is locked, and a damaged one is refused (`make sbom`)."""

import importlib
import json
import re
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("cyclonedx", reason="untested: `make sbom` installs cyclonedx-bom")

ROOT = Path(__file__).parents[2]


@pytest.fixture
def sbom(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(ROOT / "scripts")
    return importlib.import_module("sbom")


@pytest.mark.soak
def test_every_locked_package_is_in_the_bill(sbom: Any, tmp_path: Path) -> None:
    out = tmp_path / "sbom.json"
    assert sbom.main(out) == 0
    held = {
        (c["name"].lower(), c.get("version")) for c in json.loads(out.read_text())["components"]
    }
    lock = (ROOT / "requirements" / "carry.txt").read_text()
    python = set(re.findall(r"^([\w.-]+)==(\S+)", lock, re.MULTILINE))
    page = json.loads((ROOT / "site" / "package.json").read_text())["dependencies"]
    assert len(python) > 20 and page
    assert {(name.lower(), version) for name, version in python} | set(page.items()) <= held
    assert {"nanobind", "libc++", "libunwind"} <= {name for name, _ in held}


def test_a_bill_against_the_schema_is_refused(sbom: Any) -> None:
    bill = {"bomFormat": "CycloneDX", "specVersion": "1.6", "version": 1}
    sbom.check(bill)
    with pytest.raises(sbom.SbomError, match="no such type"):
        sbom.check(bill | {"components": [{"type": "no such type", "name": "x"}]})
