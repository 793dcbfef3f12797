# SPDX-License-Identifier: Apache-2.0
"""A layout for Foxglove: the carry in three dimensions, what both robots sense, and events.

It fits carry logs and the live view of a station, which have the same channels.
"""

import json
from typing import Any

from palmbots._types import SIDES
from palmbots.viz.style import HUE


def layout_text() -> str:
    """The layout as JSON, to be imported in Foxglove (Layouts, Import from file)."""
    panels = {
        "3D!carry": {
            "followTf": "pair",
            "followMode": "follow-position",
            "scene": {"transforms": {"visible": False}},
            "cameraState": {
                "distance": 1.6,
                "phi": 70,
                "thetaOffset": 0,
                "targetOffset": [0, 0, 0],
                "target": [0, 0, 0],
                "targetOrientation": [0, 0, 0, 1],
                "perspective": True,
                "fovy": 45,
                "near": 0.05,
                "far": 100,
            },
            "topics": {
                "/solids": {"visible": True},
                "/contacts": {"visible": True},
                "/robot_description": {"visible": False},
            },
        },
        "Plot!contact": _plot("contact [m]", "contact_m"),
        "Plot!sign": _plot("sign", "sign"),
        "Plot!palm": _plot("palm [rad]", "palm_rad"),
        "RawMessages!corrections": {"topicPath": "/corrections"},
    }
    layout = {
        "first": "3D!carry",
        "second": {
            "first": {
                "first": "Plot!contact",
                "second": "Plot!sign",
                "direction": "column",
            },
            "second": {
                "first": "Plot!palm",
                "second": "RawMessages!corrections",
                "direction": "column",
            },
            "direction": "row",
        },
        "direction": "column",
        "splitPercentage": 55,
    }
    content = {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": layout,
    }
    return json.dumps(content, indent=2) + "\n"


def _plot(title: str, field: str) -> dict[str, Any]:
    """A plot of one field of both robots."""
    paths = [
        {
            "value": f"/{side}.{field}",
            "label": side,
            "enabled": True,
            "timestampMethod": "receiveTime",
            "color": HUE[side],
        }
        for side in SIDES
    ]
    return {
        "title": title,
        "paths": paths,
        "showLegend": True,
        "isSynced": True,
        "xAxisVal": "timestamp",
        "sidebarDimension": 240,
    }
