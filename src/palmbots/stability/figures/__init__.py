# SPDX-License-Identifier: Apache-2.0
"""The figures of the stability analysis and of the palm-angle design."""
