# SPDX-License-Identifier: Apache-2.0
"""Section 5.3 of the paper: how much latency can each algorithm tolerate?"""

import palmbots as pb

controllers = ["centralized", "distributed"]
comparison = pb.compare(values=[0.0, 0.2, 0.4], controllers=controllers, carries=50)
for row in comparison.rows:
    print(
        f"{row.controller:12} {row.value:4.1f} s latency: {1000 * row.rms_m:5.1f} mm rms, "
        f"{100 * row.drop_rate:.0f} % dropped"
    )
