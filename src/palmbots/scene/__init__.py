# SPDX-License-Identifier: Apache-2.0
"""What a scene is, where it is read from, what is wrong with it, and its `Spec`."""
