"""The statue's true outline as seen along y: hollows between arm and body's side included, where the record has a mesh."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.records.scene import SceneRecord
from reports.drawing.display_mesh import read_mesh

Array = NDArray[np.float64]

SMOOTHED: Final = 1.0 / 800.0
"""Bends of the outline smaller than this share of the height are left out: less than a pixel in every picture."""


def silhouette_m(scene: SceneRecord, mesh: Path | None) -> Array:
    """The outline (k, 2) in (x, z), statue frame: the mesh's shadow along y, or the section of a statue without one."""
    if mesh is None:
        return np.asarray(scene.statue.section_m, dtype=np.float64)
    return _shadow(mesh, mesh.stat().st_mtime_ns)


@lru_cache(maxsize=4)
def _shadow(mesh: Path, _changed_ns: int) -> Array:
    import shapely

    vertices, faces = read_mesh(mesh)
    corners = vertices[faces][:, :, [0, 2]]
    edges = corners[:, 1:] - corners[:, :1]
    towards = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0] > 0.0
    shadow: Any = shapely.union_all(shapely.polygons(corners[towards]))
    whole = max(shapely.get_parts(shadow), key=lambda part: float(part.area))
    outline = shapely.Polygon(whole.exterior).simplify(SMOOTHED * float(np.ptp(vertices[:, 2]))).exterior
    return np.asarray(outline.coords, dtype=np.float64)[:-1]
