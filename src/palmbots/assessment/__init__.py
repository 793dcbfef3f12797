# SPDX-License-Identifier: Apache-2.0
"""The answers that a user needs about a scene: on one page, or after one carry."""
