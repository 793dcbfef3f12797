# SPDX-License-Identifier: Apache-2.0
"""The operator's station: what it knows of the robots, its loop, and its screens."""
