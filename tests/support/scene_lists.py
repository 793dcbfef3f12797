# SPDX-License-Identifier: Apache-2.0
"""What the tables of refusals (tests/laws/refusals) do not spell out, by the names in braces."""

import functools

import palmbots as pb
from palmbots.scene.scene import Scene


@functools.cache
def of_scenes() -> dict[str, str]:
    """Lists that grow with each scene, object and key."""
    scene = pb.load_scene("paper")
    tables = {name: type(getattr(scene, name)) for name in Scene.model_fields}
    tables["path"] = type(scene.task.path)
    keys = {
        f"keys_of_{name}": ", ".join(
            field.alias or key for key, field in table.model_fields.items()
        )
        for name, table in tables.items()
    }
    return keys | {
        "scenes": ", ".join(row.name for row in pb.scenes().scenes),
        "objects": ", ".join(row.name for row in pb.objects().objects),
        "sections": ", ".join(Scene.model_fields),
        "sorted_sections": ", ".join(sorted(Scene.model_fields)),
    }
