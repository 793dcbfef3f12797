# SPDX-License-Identifier: Apache-2.0
"""Pictures of few pixels, for tests of commands that write them and look at none."""

from typing import Any

from palmbots.viz.save_figure import _SAVING

COARSE: dict[str, Any] = {
    "palmbots.viz.save_figure._SAVING": {
        suffix: {**options, "dpi": 30} for suffix, options in _SAVING.items()
    }
}
"""What to replace by what."""
