# SPDX-License-Identifier: Apache-2.0
"""Carry the paper's box once and see what the robots had to correct."""

import palmbots as pb

done = pb.carry("paper", controller="distributed", seed=0)
print(f"{done.outcome} after {done.time_s:.1f} s and {done.distance_m:.2f} m")
for c in done.corrections[:8]:
    helper = f", {c.assistant} assists" if c.assistant else ""
    print(f"  {c.label}: {c.robot} ({c.case}) from {c.start_s:.2f} s to {c.end_s:.2f} s{helper}")

trace = done.trace
assert trace is not None
for side in ("left", "right"):
    farthest = float(abs(trace.contact.sel(side=side)).max())
    print(f"{side}: never farther than {1000 * farthest:.1f} mm from the pivot")
