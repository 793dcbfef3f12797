# SPDX-License-Identifier: Apache-2.0
"""Section 5.3 of the paper: how much latency does each algorithm bear?"""

import palmbots as pb

found = pb.compare(values=[0.0, 0.2, 0.4], controllers=["centralized", "distributed"], carries=50)
for row in found.rows:
    print(
        f"{row.controller:12} {row.value:4.1f} s latency: {1000 * row.rms_m:5.1f} mm rms, "
        f"{100 * row.drop_rate:.0f} % dropped"
    )
