# SPDX-License-Identifier: Apache-2.0
"""Six household objects of the YCB set, from their scans in ../shared/data beside the project.

They lie or stand with their longer side along the direction of travel, on palms that have room
under them. Sizes and masses: B. Calli, A. Singh, J. Bruce, A. Walsman, K. Konolige, S. Srinivasa,
P. Abbeel, A. M. Dollar: Yale-CMU-Berkeley dataset for robotic manipulation research, The
International Journal of Robotics Research 36 (2017). The centre of mass is assumed to be in the
middle of the box around each object.
"""

from pathlib import Path
from typing import Any, NamedTuple

import palmbots as pb

SCANS = Path(__file__).resolve().parents[2] / "shared" / "data" / "shapes" / "ycb"


class Household(NamedTuple):
    """An object: its file, how it stands, its size, its mass, and the palms that carry it."""

    name: str
    file: str
    up: str  # axes of the file
    across: str
    size_mm: tuple[float, float]  # length and height as it stands
    mass_kg: float
    palm_m: float

    def keys(self) -> dict[str, Any]:
        """The keys of a scene with this object.

        Raises:
            FileNotFoundError: its scan is not there.
        """
        scan = SCANS / f"{self.file}_textured.gltf"
        if not scan.is_file():
            raise FileNotFoundError(f"object `{self.name}`: skipped, needs {scan}")
        made = pb.import_object(
            scan,
            up=self.up,
            across=self.across,
            align=True,
            view="silhouette",
            mass_kg=self.mass_kg,
            com_mm=(self.size_mm[0] / 2, self.size_mm[1] / 2),
        )
        names = ("vertices_m", "edge_radius_m", "contacts", "com_m", "mass_kg", "depth_m")
        return {
            "object": {name: getattr(made, name) for name in names},
            "palm.length_m": self.palm_m,
        }


HOUSEHOLD = (
    Household("cracker box", "003_cracker_box", "z", "x", (210, 158), 0.411, 0.15),
    Household("sugar box", "004_sugar_box", "-z", "x", (175, 89), 0.514, 0.15),
    Household("tomato soup can", "005_tomato_soup_can", "-z", "x", (101, 66), 0.349, 0.08),
    Household("mustard bottle", "006_mustard_bottle", "z", "x", (190, 58), 0.603, 0.12),
    Household("gelatin box", "009_gelatin_box", "y", "x", (85, 28), 0.097, 0.06),
    Household("potted meat can", "010_potted_meat_can", "y", "z", (101, 83), 0.370, 0.08),
)
