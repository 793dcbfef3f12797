# SPDX-License-Identifier: Apache-2.0
"""The version of the package, as logs and results carry it."""

__version__ = "0.1.0"
"""The version of palmbots."""
