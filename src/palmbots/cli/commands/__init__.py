# SPDX-License-Identifier: Apache-2.0
"""One module for each command; `palmbots.cli.main` collects them and states what each defines."""
