# SPDX-License-Identifier: Apache-2.0
"""Files, arguments, text, confidence intervals and optional packages; nothing about robots."""
