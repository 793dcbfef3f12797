# SPDX-License-Identifier: Apache-2.0
"""What importing the public rooms costs: no package that takes long is loaded."""

import inspect
import subprocess
import sys

import palmbots as pb

SLOW = {
    "SALib", "distributed", "flint", "gymnasium", "matplotlib", "mujoco", "pettingzoo", "scipy",
    "xarray", "zarr",
}  # fmt: skip


def test_rooms_leave_slow_packages_alone() -> None:
    rooms = [f"palmbots.{name}" for name in dir(pb) if inspect.ismodule(getattr(pb, name))]
    program = f"import sys, {', '.join(rooms)}; print(*({SLOW} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert len(rooms) > 8 and done.stdout == "\n"
