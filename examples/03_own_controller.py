# SPDX-License-Identifier: Apache-2.0
"""A controller of your own: the paper's algorithm, but short deviations are ignored.

A robot corrects a deviation only after it has lasted for a while, so it corrects less often.
"""

import palmbots as pb


class Patient:
    """Table 2, but a sign counts only after it has lasted 0.3 s (30 control periods)."""

    def __init__(self) -> None:
        self.table2 = pb.control.DistributedController()
        self.last = 0
        self.lasted = 0

    def step(self, seen: pb.control.StepInput) -> pb.control.StepOutput:
        """One control period."""
        self.lasted = self.lasted + 1 if seen.sign == self.last else 0
        self.last = seen.sign
        trusted = seen.sign if self.lasted >= 30 or seen.sign == 0 else 0
        return self.table2.step(pb.control.StepInput(trusted, seen.message, seen.palm_at_target))


for controller in ("distributed", Patient):
    result = pb.carry("paper", controller, seed=1)
    rms = 1000 * max(result.contact_rms_m.values())
    count = len(result.corrections)
    print(f"{result.controller}: {result.outcome}, {count} corrections, {rms:.1f} mm rms")
