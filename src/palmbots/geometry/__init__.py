# SPDX-License-Identifier: Apache-2.0
"""Polygons, the object frame, and the placement of bodies from contact coordinates."""
