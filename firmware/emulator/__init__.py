# SPDX-License-Identifier: Apache-2.0
"""An emulator of the boards: the processor by Unicorn, the peripherals by models in Python."""
