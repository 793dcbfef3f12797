# SPDX-License-Identifier: Apache-2.0
"""The ticks of a control loop: those of this computer, or granted by another program."""
