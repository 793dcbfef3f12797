# SPDX-License-Identifier: Apache-2.0
"""Will it hold, by how much, and with which palm angles? Asked before anything moves."""

import palmbots as pb

found = pb.analyze("paper")
low, high = found.com_x_m or (0.0, 0.0)
print(f"5° and 15°: {'hold' if found.holds else 'fail'}; COM from {1e3 * low:.1f} to", end=" ")
print(f"{1e3 * high:.1f} mm, friction {found.friction[0][0]:.2f} to {found.friction[0][1]:.2f}")

# Not sure about friction and COM? Then prove it for all that they may be.
proof = pb.certify("paper", com_x_m=(0.12, 0.13), friction=(0.3, 0.5), common_friction=True)
print(f"friction 0.3 to 0.5, COM ± 5 mm: {proof.verdict}")

# Which angles tolerate the largest error of the COM, and what does that cost? (Without `maximize`
# `design` looks for those that tolerate the most noise, which takes longer.)
best = pb.design(
    "paper", maximize="com", friction=(0.3, 0.5), common_friction=True, region_m="palm"
)
print(f"best angles: {best.shallow_deg:g}° and {best.steep_deg:g}°, COM ±", end="")
print(f"{1e3 * best.tolerance:.1f} mm (5° and 15°: ±{1e3 * (best.paper_tolerance or 0):.1f} mm)")
for warning in best.warnings:
    print(f"but {warning}")
assert best.is_certified
