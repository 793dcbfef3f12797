# SPDX-License-Identifier: Apache-2.0
"""The defaults of the core's `Spec` are those of the default scene.

`spec.hpp` keeps its defaults because users of the headers need them. This test compares them with
the scene's, field by field.
"""

import palmbots._core as _core
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

# Fields without a default in the core: the object, the palms' angles and rate, the sensor's zones,
# and what follows from them. `bump_max` matters only with a bump rate, which is 0 in both.
WITHOUT_DEFAULT = {
    "width", "com_left", "com_right", "com_height", "outline", "contact_right", "zones",
    "safe_reach", "bump_max",
    "palms.shallow", "palms.steep", "palms.rate",
}  # fmt: skip


def fields(spec: object) -> dict[str, object]:
    """The public data of a compiled structure, with the palms and robots of both sides."""
    result: dict[str, object] = {}
    for name in dir(spec):
        value = getattr(spec, name)
        if name.startswith("_") or callable(value):
            continue
        if name in ("palms", "robots"):
            pairs = [fields(side) for side in value]
            result |= {f"{name}.{key}": [side[key] for side in pairs] for key in pairs[0]}
        else:
            result[name] = value
    return result


def test_core_and_scene_have_the_same_defaults() -> None:
    core, scene = fields(_core.Spec()), fields(to_spec(Scene()))
    assert set(core) == set(scene) > WITHOUT_DEFAULT
    assert len(core) - len(WITHOUT_DEFAULT) > 35
    assert {name for name in core if core[name] != scene[name]} == WITHOUT_DEFAULT
