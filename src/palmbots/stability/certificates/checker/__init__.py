# SPDX-License-Identifier: Apache-2.0
"""The checker of certificates. It shares no code with the prover."""
