# SPDX-License-Identifier: Apache-2.0
"""One carry in both worlds. In MuJoCo the robots have mass and drive over a ridge on the floor.

This example needs the packages of one extra: python -m pip install 'mujoco>=3.3' 'scipy>=1.12'
"""

import palmbots as pb

scene = pb.load_scene(
    "paper",
    {
        "task.distance_m": 0.5,
        "mujoco.ridges": [{"at_m": 0.5, "height_m": 0.002, "length_m": 0.05}],
    },
)
for world in ("quasistatic", "mujoco"):
    result = pb.carry(scene, world=world, seed=1)
    rms = 1000 * max(result.contact_rms_m.values())
    print(f"{world:11}  {result.outcome} after {result.time_s:.1f} s, {rms:.1f} mm rms")

assert result.trace is not None  # of the carry in MuJoCo
force, pitch = result.trace["force"], result.trace["pitch"]
print(f"a palm carries {float(force.min()):.2f} to {float(force.max()):.2f} N")
print(f"robots pitch by up to {float(abs(pitch).max()):.3f} rad on the ridge")
