# SPDX-License-Identifier: Apache-2.0
"""The contact forces between the palms and the object, as MuJoCo computes them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from palmbots._types import SIDES
from palmbots.mujoco.contact_events import ExtraContact, extra_contact
from palmbots.mujoco.mjcf import Layout

_OUT = (-1.0, 1.0)
Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class PalmLoads:
    """The loads on both palms at one instant."""

    sums: list[list[list[float]]]
    """By palm: normal force [N] and its moment about the foot of the pivot [N m], first of all
    further contacts, then of the contact vertex."""
    friction: tuple[float, float]
    """Force on each palm along it, outward [N]; 0 unless it was requested."""
    further: list[ExtraContact]
    """The contacts that carry load besides the contact vertices."""
    heel: tuple[float, float]
    """Force on each heel [N]."""

    @property
    def force(self) -> tuple[float, float]:
        """The normal force on each palm [N]."""
        left, right = self.sums
        return left[0][0] + left[1][0], right[0][0] + right[1][0]


class PalmContacts:
    """Finds the contacts between palms and object among all contacts of a model."""

    def __init__(self, model: Any, layout: Layout) -> None:
        m, thing = model, model.body("object").id
        self._is_palm = [str(m.geom(k).name).startswith(SIDES) for k in range(m.ngeom)]
        # The pairs of geoms: the palm, and the further contact, None for the contact vertex.
        self._pairs: dict[tuple[int, int], tuple[int, ExtraContact | None]] = {}
        for pair in zip(m.pair_geom1.tolist(), m.pair_geom2.tolist(), strict=True):
            of_object = [k for k in pair if m.geom_bodyid[k] == thing]
            of_palm = [k for k in pair if self._is_palm[k]]
            if not of_object or not of_palm or any("_lip_" in m.geom(k).name for k in pair):
                continue  # lips hold the object laterally; no switch feels them
            side = SIDES.index(m.geom(of_palm[0]).name.split("_")[0])
            name = m.geom(of_object[0]).name
            is_vertex = name.startswith(f"vertex_{layout.contact_vertices[side]}_")
            further = None if is_vertex else extra_contact(side, name, layout)
            if "_heel" in m.geom(of_palm[0]).name:
                edge = further.along if further else None
                further = ExtraContact(side, edge, own=False, on_heel=True)
            self._pairs[pair] = self._pairs[pair[::-1]] = (side, further)

    def loads(
        self,
        data: Any,
        to_palm: Callable[[int, Point], Point],
        palm_axes: list[Any],
        *,
        with_friction: bool,
    ) -> PalmLoads:
        """The present loads.

        Args:
            data: MuJoCo's data.
            to_palm: converts a point to the frame of a palm.
            palm_axes: the orientation of each palm (nine numbers).
            with_friction: compute the friction forces too, which takes time.
        """
        sums = [[[0.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 0.0]]]
        friction, heel = [0.0, 0.0], [0.0, 0.0]
        further: list[ExtraContact] = []
        contact, forces = data.contact, data.efc_force
        places, frames = contact.pos, contact.frame
        for i, (pair, address) in enumerate(
            zip(contact.geom.tolist(), contact.efc_address.tolist(), strict=True)
        ):
            found = self._pairs.get((pair[0], pair[1]))
            if found is None or address < 0:
                continue
            k, extra = found
            push, one, other = forces[address : address + 3].tolist()
            if extra is not None and push > 0:
                further.append(extra)
            if extra is not None and extra.on_heel:
                heel[k] += push
                continue  # the force of a heel acts along the palm
            sums[k][extra is None][0] += push
            sums[k][extra is None][1] += push * to_palm(k, places[i].tolist())[0]
            if not with_friction:
                continue
            frame, mat = frames[i], palm_axes[k]
            # MuJoCo's force acts on the second geom, which is either the palm or the object.
            sign = 1.0 if self._is_palm[pair[1]] else -1.0
            fx, fy, fz = (one * float(frame[3 + i]) + other * float(frame[6 + i]) for i in range(3))
            along = fx * float(mat[0]) + fy * float(mat[3]) + fz * float(mat[6])
            friction[k] += sign * _OUT[k] * along
        return PalmLoads(sums, (friction[0], friction[1]), further, (heel[0], heel[1]))
