# SPDX-License-Identifier: Apache-2.0
"""Agreement of the MuJoCo world with the quasistatic one, and the speed limits."""
