# SPDX-License-Identifier: Apache-2.0
"""Two robots that belong together: their file, what they remember, their check and calibration."""
