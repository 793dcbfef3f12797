# SPDX-License-Identifier: Apache-2.0
"""The hooks in C (`hooks.c`), compiled at first use."""

import ctypes
import hashlib
import os
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

from unicorn import arm_const

_SOURCE = Path(__file__).with_name("hooks.c")
_BUILD = Path(__file__).parents[2] / "build" / "firmware"
RANGES = 4


class Meter(ctypes.Structure):
    """What the hooks count and check, as in `hooks.c`."""

    _fields_ = (
        ("instructions", ctypes.c_uint64),
        ("limit", ctypes.c_uint64),
        ("address", ctypes.c_uint32),
        ("begin", ctypes.c_uint32 * RANGES),
        ("end", ctypes.c_uint32 * RANGES),
        ("may_read", ctypes.c_uint32 * RANGES),
        ("trespasses", ctypes.c_uint32),
        ("trespassed_by", ctypes.c_uint32),
        ("addresses", ctypes.c_void_p),
        ("near_it", ctypes.c_void_p),
    )


def near_it_blocks(flash: bytes) -> bytes:
    """For each halfword of flash memory: 1 if it may be in an IT block.

    Whatever looks like an IT instruction counts as one, also in constants: too many cost only time.
    """
    found = bytearray(len(flash) // 2)
    for place in range(len(found)):
        if flash[2 * place + 1] == 0xBF and flash[2 * place] & 0x0F:
            found[place + 1 : place + 9] = b"\1" * 8  # up to four instructions of four bytes
    return bytes(found[: len(flash) // 2])


@cache
def hooks() -> Any:
    """The compiled hooks."""
    name = f"hooks-{hashlib.sha256(_SOURCE.read_bytes()).hexdigest()[:12]}.so"
    library = _BUILD / name
    if not library.exists():
        _BUILD.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=_BUILD, suffix=".so", delete=False) as file:
            made = Path(file.name)
        subprocess.run(
            ["cc", "-O2", "-shared", "-fPIC", f"-DXPSR={arm_const.UC_ARM_REG_XPSR}", "-o",
             str(made), str(_SOURCE)], check=True,
        )  # fmt: skip
        os.replace(made, library)  # another process may be doing the same
    return ctypes.CDLL(str(library))
