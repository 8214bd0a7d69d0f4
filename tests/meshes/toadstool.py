"""A concave body of three boxes, whose contact with an edge is known by hand: a plinth, a stem, a wide cap."""

from pathlib import Path
from typing import Final

import numpy as np
import trimesh
from numpy.typing import NDArray

from meshes.solid import Solid, solid_from_mesh
from tests.meshes.shapes import slab, union

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

PLINTH_M: Final = 0.3
"""Half width of the plinth."""
CAP_M: Final = 1.0
"""Half width of the cap."""
UNDERSIDE_M: Final = 0.4
"""Height of the cap's underside."""
HEIGHT_M: Final = 0.6


def build(density_kg_m3: float = 2500.0) -> Solid:
    """The solid, 0.6 m deep; its weight falls through the middle of its base."""
    return solid_from_mesh(*surface(), density_kg_m3=density_kg_m3)


def write(path: Path) -> None:
    """Write its mesh in metres, z up, in the format of the path's suffix: a scan that is looked through in no time."""
    trimesh.Trimesh(*surface(), process=False).export(path)


def surface() -> tuple[Array, Faces]:
    """Its closed surface: vertices (n, 3) and outward faces (m, 3)."""
    return union(
        [slab(PLINTH_M, PLINTH_M, 0.0, 0.2), slab(0.1, 0.1, 0.1, 0.5), slab(CAP_M, 0.3, UNDERSIDE_M, HEIGHT_M)]
    )
