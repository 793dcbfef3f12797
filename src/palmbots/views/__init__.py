# SPDX-License-Identifier: Apache-2.0
"""What people see of a run of robots: live views, players of logs, figures."""
