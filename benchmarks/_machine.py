# SPDX-License-Identifier: Apache-2.0
"""Where a benchmark ran: what its CSV has to say so that the numbers mean something."""

import os
import platform
import subprocess
from pathlib import Path


def processor() -> str:
    """The processor's name and the number of cores."""
    names = [
        line.split(":")[1].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    return f"{names[0] if names else platform.processor()}, {os.cpu_count()} cores"


def load() -> float:
    """How many processes wanted to run in the last minute, on average; 0 on an idle machine."""
    return os.getloadavg()[0]


def compiler() -> str:
    """The C++ compiler's name and version."""
    version = subprocess.run(["g++", "--version"], capture_output=True, text=True, check=False)
    return version.stdout.splitlines()[0]
