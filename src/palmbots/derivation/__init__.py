# SPDX-License-Identifier: Apache-2.0
"""Derives local rules from a global policy, and checks controllers against the policy."""
