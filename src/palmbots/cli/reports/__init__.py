# SPDX-License-Identifier: Apache-2.0
"""Text that the commands print for people."""
