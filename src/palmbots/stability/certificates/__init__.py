# SPDX-License-Identifier: Apache-2.0
"""Certificates: the prover, and a checker that shares no code with it."""
