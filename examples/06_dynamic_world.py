# SPDX-License-Identifier: Apache-2.0
"""The same carry with mass, wheels and a bump of the floor: pip install 'palmbots[mujoco]'."""

import palmbots as pb

scene = pb.load_scene(
    "paper",
    {
        "task.distance_m": 0.5,
        "mujoco.ridges": [{"at_m": 0.5, "height_m": 0.002, "length_m": 0.05}],
    },
)
for world in ("quasistatic", "mujoco"):
    done = pb.carry(scene, world=world, seed=1)
    print(f"{world:11}  {done.outcome} after {done.time_s:.1f} s, rms {done.contact_rms_m}")

assert done.trace is not None
force, pitch = done.trace["force"], done.trace["pitch"]
print(f"a palm bears {float(force.min()):.2f} to {float(force.max()):.2f} N")
print(f"robots pitch by up to {float(abs(pitch).max()):.3f} rad on the ridge")
