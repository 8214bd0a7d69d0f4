"""A mesh as a library's user reads it: mass properties of any scan, and what makes them doubtful."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from harness.input.mesh_statue import findings_of, mesh_mistake
from harness.model.errors import InputError, Mistake
from harness.model.finding import Finding, caution, info
from harness.model.history import Array
from harness.model.shown import Shown, new_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from meshes import Solid
    from meshes.mesh import Faces, RawMesh

MARBLE_KG_M3: Final = 2700.0
"""Density assumed for a statue of which nothing is said, and said so: marble."""


@dataclass(frozen=True, eq=False, repr=False)
class Mesh(Shown):
    """A surface in metres, z up, as its file places it, and its mass properties; holes count as closed, each by a cone.

    `vertices_m` (n, 3), `faces` (m, 3), `centroid_m` (3,), `inertia_kg_m2` (3, 3) about the centroid. `doubts` are what makes
    these uncertain, by code, none for a clean scan; `solid` is the statue that stands on its base, None where there is none.
    """

    file: str
    vertices_m: Array
    faces: Faces
    density_kg_m3: float
    volume_m3: float
    centroid_m: Array
    inertia_kg_m2: Array
    doubts: tuple[Finding, ...]
    solid: Solid | None

    @property
    def mass_kg(self) -> float:
        """Mass at its density."""
        return self.density_kg_m3 * self.volume_m3

    @property
    def size_m(self) -> Array:
        """Extent (3,) along x, y and z."""
        return np.asarray(np.ptp(self.vertices_m, axis=0))

    def facts(self) -> dict[str, str]:
        """File, size, mass, centroid, doubts."""
        x, y, z = self.centroid_m
        return {
            "file": self.file,
            "size": " × ".join(f"{extent:.4g}" for extent in self.size_m) + " m",
            "mass": f"{self.mass_kg:.5g} kg at {self.density_kg_m3:g} kg/m³",
            "centroid": f"({x:.4g}, {y:.4g}, {z:.4g}) m",
            "doubts": ", ".join(each.code for each in self.doubts) or "none",
        }

    def columns(self) -> dict[str, Array]:
        """One row for each vertex."""
        x, y, z = self.vertices_m.T
        return {"vertex": np.arange(len(x), dtype=np.float64), "x_m": x, "y_m": y, "z_m": z}

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw its vertices in the rocking plane, and its centroid."""
        ax = new_axes(ax)
        ax.plot(self.vertices_m[:, 0], self.vertices_m[:, 2], ",", label=Path(self.file).name)
        ax.plot(self.centroid_m[0], self.centroid_m[2], "+", label="centroid")
        ax.set(xlabel="x [m]", ylabel="z [m]", aspect="equal")
        return ax


def read_mesh(path: Path | str, unit: str | float = "m", *, up: str = "z", density_kg_m3: float = MARBLE_KG_M3) -> Mesh:
    """Mass properties of a mesh file (OBJ, PLY, STL, GLB, …), also of a scan that is not clean, with what is doubtful of it.

    >>> mesh = harness.read_mesh("scenes/togatus.ply", unit="m")
    >>> mesh.mass_kg, mesh.centroid_m, mesh.inertia_kg_m2, mesh.doubts

    `unit` is the file's unit of length (m, dm, cm, mm, in, ft) or its length in metres, `up` its vertical axis. Raises
    `InputError` for a file that holds no such surface.
    """
    from meshes import MeshError
    from meshes.intake import must_have_thickness, to_metres_z_up
    from meshes.intake import read_mesh as read
    from meshes.processing_log import measure

    if not density_kg_m3 > 0.0:
        raise InputError(Mistake("read_mesh", "density_kg_m3", "a positive density", repr(density_kg_m3)))
    try:
        mesh = to_metres_z_up(read(path), unit, up)
        must_have_thickness(mesh)
        solid, doubts = _stood(mesh, density_kg_m3)
    except MeshError as error:
        raise InputError(mesh_mistake(error, str(path))) from error
    if solid is None:
        mesh, done = _wound_alike(mesh)
        doubts += done
    found = measure(mesh)
    # What is inside out has a negative volume, and moments of that sign.
    sign = 1.0 if found.volume_m3 >= 0.0 else -1.0
    return Mesh(
        file=str(path),
        vertices_m=mesh.vertices,
        faces=mesh.faces,
        density_kg_m3=density_kg_m3,
        volume_m3=sign * found.volume_m3,
        centroid_m=found.centroid_m,
        inertia_kg_m2=sign * density_kg_m3 * found.inertia_per_density_m5,
        doubts=doubts,
        solid=solid,
    )


def _stood(mesh: RawMesh, density_kg_m3: float) -> tuple[Solid | None, tuple[Finding, ...]]:
    """The statue that stands on its base, where the surface is closed and whole, and what is doubtful of it."""
    from meshes import MeshError, solid_from_mesh
    from meshes.doubts import doubts
    from meshes.intake import must_be_closed, must_be_one

    try:
        must_be_closed(mesh)
        must_be_one(mesh)
        solid = solid_from_mesh(mesh.vertices, mesh.faces, density_kg_m3=density_kg_m3)
    except MeshError as error:
        return None, (caution("mesh_not_solid", message=str(error)),)
    how = f"rockcheck mesh prepare {mesh.source} --out statue.ply"
    return solid, tuple(findings_of(doubts(mesh.vertices, mesh.faces, how)))


def _wound_alike(mesh: RawMesh) -> tuple[RawMesh, tuple[Finding, ...]]:
    """The surface without what is there twice, its faces outward as far as they hang together, and what was changed for it."""
    from meshes import MeshError, repair

    done = []
    for step in (repair.drop_duplicates, repair.wind_alike, repair.turn_outward):
        try:
            mesh, made = step(mesh)
        except MeshError as error:
            done.append(caution("mesh_not_solid", message=str(error)))
            continue
        if made is not None:
            done.append(info("mesh_repaired", message=str(made)))
    return mesh, tuple(done)
