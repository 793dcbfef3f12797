# SPDX-License-Identifier: Apache-2.0
"""Models of the peripherals, which check how the firmware uses them."""
