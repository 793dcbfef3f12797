# SPDX-License-Identifier: Apache-2.0
"""Derives local rules from a global policy, and checks controllers against the policy."""

from palmbots.derivation.abstract_world import CONTROLLERS, system_of
from palmbots.derivation.global_policy import Policy, Wiring, as_printed, mirrored, table_1
from palmbots.derivation.local_rules import Derivation, Rule, derive
from palmbots.derivation.refinement import Departure, Refinement, check_refinement
from palmbots.derivation.table2_programs import table_2

__all__ = [
    "CONTROLLERS",
    "Departure",
    "Derivation",
    "Policy",
    "Refinement",
    "Rule",
    "Wiring",
    "as_printed",
    "check_refinement",
    "derive",
    "mirrored",
    "system_of",
    "table_1",
    "table_2",
]
