"""A hollow or cored statue from two surfaces: the scan outside, an inner shell in the same file frame."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from meshes.errors import MeshError
from meshes.intake import must_be_closed, must_be_one, read_mesh, to_metres_z_up
from meshes.mesh import RawMesh, manifold
from meshes.solid import Solid, mass_properties, solid_from_mesh
from meshes.survey import with_core

OUTSIDE_REL: Final = 1e-3
"""Share of an inner shell's volume that may lie outside the statue: two scans that touch differ by their noise."""


@dataclass(frozen=True)
class Filling:
    """Density inside the inner shell (0: empty), and of what is around it: given, or solved from the weighed mass."""

    inside_kg_m3: float
    around_kg_m3: float | None = None
    weighed_kg: float | None = None

    def around(self, outer_m3: float, inner_m3: float) -> float:
        """Density around the shell; raises MeshError unless it is given, or follows from the mass and is positive."""
        if (self.around_kg_m3 is None) == (self.weighed_kg is None):
            raise MeshError("either a density or a weighed mass", "both or neither", "give one of them")
        density = self.around_kg_m3
        if self.weighed_kg is not None:
            density = (self.weighed_kg - self.inside_kg_m3 * inner_m3) / (outer_m3 - inner_m3)
        if density is None or not density > 0.0:
            raise MeshError(
                f"a weighed mass above that of the core, {self.inside_kg_m3 * inner_m3:.5g} kg",
                f"{self.weighed_kg or 0.0:g} kg",
            )
        return density


def load_hollow(
    outer: str | Path,
    inner: str | Path,
    filling: Filling,
    *,
    unit: str | float,
    up: str,
    azimuth_deg: float,
    contact_tolerance_m: float,
) -> Solid:
    """The solid of two clean meshes in one file frame, the space inside `inner` filled as told, turned about the vertical.

    `density_kg_m3` of the result is the mean over the outer volume. Raises MeshError where a surface is not closed, faces
    inward, or the shell leaves the statue.
    """
    around, shell = (to_metres_z_up(read_mesh(path), unit, up) for path in (outer, inner))
    for mesh in (around, shell):
        must_be_closed(mesh)
        must_be_one(mesh)
    volume, hollow = (mass_properties(mesh.vertices, mesh.faces).volume_m3 for mesh in (around, shell))
    if hollow <= 0.0:
        raise MeshError(
            "an inner shell with its faces outward",
            f"a volume of {hollow:.4g} m³",
            "turn its faces (rockcheck mesh prepare does)",
            place=str(inner),
        )
    _must_be_inside(around, shell, hollow)
    density = filling.around(volume, hollow)
    solid = solid_from_mesh(
        around.vertices, around.faces, density_kg_m3=density, contact_tolerance_m=contact_tolerance_m
    )
    shift = solid.vertices_m[0] - around.vertices[0]
    filled = with_core(solid, shell.vertices + shift, np.array(shell.faces), filling.inside_kg_m3)
    return filled.rotated(azimuth_deg) if azimuth_deg else filled


def _must_be_inside(around: RawMesh, shell: RawMesh, hollow_m3: float) -> None:
    """Refuse a shell of which more than a trace lies outside (exact difference of the two bodies)."""
    outside = (manifold(shell.vertices, shell.faces) - manifold(around.vertices, around.faces)).volume() / hollow_m3
    if outside > OUTSIDE_REL:
        raise MeshError(
            "an inner shell inside the statue",
            f"one with {100.0 * outside:.3g} % of its volume outside",
            "both files must have the same origin, unit and axes",
            place=shell.source,
        )
