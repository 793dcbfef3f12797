# SPDX-License-Identifier: Apache-2.0
"""The task in MuJoCo: contacts that hold (elliptic cone, impratio 100, Newton), 1 ms steps.

The palms are so heavy that nothing moves them but the speeds set here.
"""

import importlib
from typing import Any

from peers.common_task import COM_HEIGHT, FRICTION, HALF_PALM, HEIGHT, MASS, STEEP, WIDTH

# Its wheel has no types that a checker could follow; without the wheel it is not there at all.
mujoco: Any = importlib.import_module("mujoco")

STEP = 0.001
THICK = 0.005
INERTIA = MASS * (WIDTH**2 + HEIGHT**2) / 12  # only the one about y plays a part
MODEL = f"""
<mujoco>
  <compiler angle="radian"/>
  <option timestep="{STEP}" cone="elliptic" impratio="100" integrator="implicitfast"
          solver="Newton" gravity="0 0 -9.80665"/>
  <default>
    <geom friction="{FRICTION} 0.005 0.0001" solref="0.02 1" solimp="0.8 0.8 0.001 0.5 2"/>
  </default>
  <worldbody>
    {{palms}}
    <body name="box" pos="{WIDTH / 2} 0 {COM_HEIGHT}">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
      <joint type="hinge" axis="0 -1 0"/>
      <inertial pos="0 0 0" mass="{MASS}"
        diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
      <geom type="box" size="{WIDTH / 2} 0.05 {HEIGHT / 2}" pos="0 0 {HEIGHT / 2 - COM_HEIGHT}"
        contype="1" conaffinity="2"/>
    </body>
  </worldbody>
</mujoco>"""
PALM = """
<body name="palm{side}" pos="{x} 0 0" gravcomp="1">
  <joint type="slide" axis="1 0 0"/><joint type="hinge" axis="0 -1 0"/>
  <inertial pos="0 0 0" mass="1e5" diaginertia="1e5 1e5 1e5"/>
  <geom type="box" size="{half} 0.035 {thick}" pos="0 0 {down}" contype="2" conaffinity="1"/>
</body>"""


class Mujoco:
    """See `task.Engine`."""

    def __init__(self) -> None:
        palms = "".join(
            PALM.format(side=side, x=x, half=HALF_PALM, thick=THICK, down=-THICK)
            for side, x in ((0, 0.0), (1, WIDTH))
        )
        self.model = mujoco.MjModel.from_xml_string(MODEL.format(palms=palms))
        self.data = mujoco.MjData(self.model)
        self.data.qpos[1], self.data.qpos[3] = -STEEP, STEEP
        self.speeds = [0.0, 0.0, 0.0, 0.0]
        mujoco.mj_forward(self.model, self.data)

    def drive(self, side: int, speed: float, turn_rate: float) -> None:
        """Sets how a palm moves."""
        self.speeds[2 * side : 2 * side + 2] = [speed, turn_rate]

    def step(self, seconds: float) -> None:
        """Advances the engine."""
        for _ in range(round(seconds / STEP)):
            self.data.qvel[:4] = self.speeds
            mujoco.mj_step(self.model, self.data)

    def palm(self, side: int) -> tuple[float, float]:
        """Pivot and angle."""
        x = (0.0, WIDTH)[side] + float(self.data.qpos[2 * side])
        return x, float(self.data.qpos[2 * side + 1])

    def corner(self, side: int) -> tuple[float, float]:
        """A lower corner of the box."""
        half = -WIDTH / 2 if side == 0 else WIDTH / 2
        at = self.data.body("box").xpos + self.data.body("box").xmat.reshape(3, 3) @ [
            half,
            0,
            -COM_HEIGHT,
        ]
        return float(at[0]), float(at[2])


def version() -> str:
    """The engine's version."""
    return mujoco.__version__
