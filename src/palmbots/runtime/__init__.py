# SPDX-License-Identifier: Apache-2.0
"""Robots and worlds as processes of their own, which exchange packets over sockets."""
