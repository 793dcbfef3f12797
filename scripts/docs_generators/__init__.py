# SPDX-License-Identifier: Apache-2.0
"""One module for each page of the docs with generated parts."""
