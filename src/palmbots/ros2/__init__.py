# SPDX-License-Identifier: Apache-2.0
"""Robots in ROS 2: a driver for bases that are nodes, and a bridge that publishes."""
