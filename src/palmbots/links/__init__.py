# SPDX-License-Identifier: Apache-2.0
"""How packets travel between two robots and a station, and lines between programs of a machine."""
