# SPDX-License-Identifier: Apache-2.0
"""Conversion of a scene to the `Spec` that the core runs.

A `Spec` has SI units and radians, the object in its own frame, left and right resolved, and times
in control periods. All its numbers affect the trace. They are therefore computed with + − × ÷ √ and
the core's own tangent only, and the spec of a mirrored scene is the mirror image of the scene's
spec to the last bit.
"""

import copyreg

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.arguments import show
from palmbots.errors import SceneError
from palmbots.scene.recorded_traces import put_traces
from palmbots.scene.scene import Scene
from palmbots.scene.section import as_given


def refuse_curved(scene: Scene) -> None:
    """Raise `SceneError` for a curved path, which planar mechanics does not cover."""
    if scene.task.path.is_curved:
        raise SceneError(
            f"task.path.kind: {show(scene.task.path.kind)} is a curved path, but the quasistatic "
            "world and its mechanics are planar; allowed: straight, or carry --world mujoco"
        )


def contact_radii(spec: _core.Spec) -> tuple[float, float]:
    """Radii of the arcs that round the left and the right contact vertex [m]; 0: sharp."""
    outline = spec.outline
    return outline[0][3], outline[spec.contact_right][3]


def refuse_pipe(scene: Scene, what: str = "this analysis") -> None:
    """Raise `SceneError` for a pipe, whose two contacts move together: no analysis covers it."""
    if refusal := _core.pipe_refusal(to_spec(scene, unrolled=True), what):
        raise SceneError(refusal)


def refuse_rounded_contacts(scene: Scene) -> None:
    """Raise `SceneError` for rounded contact vertices, which the bound does not cover.

    Other corners may be rounded: the sharp outline contains the rounded one.
    """
    refuse_pipe(scene, "this proof")
    if any(contact_radii(to_spec(scene, unrolled=True))):
        raise SceneError(
            f"object.edge_radius_m: {show(scene.object.edge_radius_m)} rounds a contact vertex, "
            "but this proof assumes that both are sharp; allowed: 0 there; analyze, certify, "
            "design, carry and drop-rate take rounded ones"
        )


def refuse_low_noses(scene: Scene) -> None:
    """Raise `SceneError` where the nose of a palm can touch a part of the object below the contact
    vertices. Only worlds consider such a contact."""
    spec = to_spec(scene, unrolled=True)
    # Heights count from the centres of the arcs that round the contact vertices (`sim/build.hpp`).
    heights = [height for _, _, height, _ in spec.outline]
    others = [h for k, h in enumerate(heights) if k not in (0, spec.contact_right)]
    hangs = min(others) < -min(contact_radii(spec)) - 1e-9 * spec.width
    thick = max(
        (palm.thickness_m for palm in map(scene.palm_of, SIDES) if palm.nose_m != 0), default=0.0
    )
    if hangs and thick > 0:
        raise SceneError(
            f"palm.thickness_m: {show(thick)} gives the palms noses, which a part "
            "of the object below its contact vertices can touch, but this analysis assumes thin "
            "palms; allowed: 0 or nose_m = 0; palmbots carry and drop-rate simulate noses"
        )


def refuse_heels(scene: Scene) -> None:
    """Raise `SceneError` for palms with a heel, which no certificate covers."""
    for side in SIDES:
        heel = scene.palm_of(side).heel_m
        if heel > 0:
            raise SceneError(
                f"palm.heel_m: {show(heel)} is a stop that the object may touch, but no "
                "certificate covers this; allowed: 0 (the object may then leave the palm)"
            )


def refuse_floor(scene: Scene, what: str) -> None:
    """Raise `SceneError` for a job that begins or ends on the floor or on a stand, where `what` has
    no arms."""
    for key, on in zip(("from", "to"), scene.task.ends, strict=True):
        if on != "palms":
            raise SceneError(
                f'task.{key}: "{on}" needs arms that rise and fall, which {what} not have; '
                "allowed: palms, or carry --world quasistatic"
            )


def to_spec(scene: Scene, *, unrolled: bool = False) -> _core.Spec:
    """The core's description of a scene; left is index 0, right index 1.

    The core is planar. With `unrolled` a curved path is replaced by a straight one of its length;
    without it, a curved path raises `SceneError`. So does a recording that cannot be read.
    """
    if not unrolled:
        refuse_curved(scene)
    spec = _core.spec_of_scene(as_given(scene))
    put_traces(spec, scene)
    return spec


def _spec_from_bytes(data: bytes) -> _core.Spec:
    (spec,) = _core.Spec.list_from_bytes(data)
    return spec


# How pickle and `copy` treat a spec.
copyreg.pickle(_core.Spec, lambda spec: (_spec_from_bytes, (spec.to_bytes(),)))
