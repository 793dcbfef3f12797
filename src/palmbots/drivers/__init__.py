# SPDX-License-Identifier: Apache-2.0
"""How a robot's program reaches its sensors and motors."""
