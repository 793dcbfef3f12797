# SPDX-License-Identifier: Apache-2.0
"""Scenes and carries in the formats of other programs."""
