# SPDX-License-Identifier: Apache-2.0
"""The program of one robot: its control loop, live and in lockstep, its log, and what it shows."""
