"""From `[statue.mesh]` to a statue: the solid of a scan, hollow or cored, set against a survey, adjusted where asked."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Final

import numpy as np

import meshes
from harness.input.files import existing_file
from harness.input.tables import AdjustTable, MeshTable, StatueTable
from harness.model import (
    Array,
    Axes,
    Finding,
    InputError,
    Mistake,
    Say,
    Shown,
    Statue,
    caution,
    info,
    new_axes,
    require,
)
from meshes import MeshError, Solid, load_solid, repair, solid_from_mesh
from meshes.doubts import doubts
from meshes.intake import must_be_closed, must_be_one, must_have_thickness, to_metres_z_up
from meshes.intake import read_mesh as read
from meshes.mesh import Doubt, Faces, RawMesh
from meshes.processing_log import ProcessingLog, measure
from meshes.survey import adjusted, agrees, load_hollow, with_mass
from meshes.text_cache import made_once

# A mesh as a library's user reads it: mass properties of any scan, and what makes them doubtful.

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

    require(density_kg_m3 > 0.0, "read_mesh", "a positive density", repr(density_kg_m3), key="density_kg_m3")
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

    done = []
    for step in (repair.drop_duplicates, repair.wind_alike, repair.turn_outward):
        mesh, made = step(mesh)
        if made is not None:
            done.append(info(made.code, **made.values))
    return mesh, tuple(done)


SURVEYED: Final[Mapping[str, str]] = {
    "centroid_height_m": "centroid_height_m",
    "corner_left_m": "corner_left_m",
    "corner_right_m": "corner_right_m",
    "inertia_kg_m2": "inertia_planar_kg_m2",
    "height_m": "height_m",
    "depth_m": "depth_m",
}
"""Keys of `[statue]` that are a survey's beside a mesh, and what a solid calls them."""


def statue_from_mesh(table: StatueTable, mesh: MeshTable, path: Path, found: list[Finding]) -> Statue:
    """The statue of a table with its mesh; what was reconciled, hollowed or adjusted is added to `found`. Raises `InputError`."""

    require(
        mesh.density_kg_m3 is not None or table.mass_kg is not None,
        str(path),
        "a density, or statue.mass_kg as weighed",
        "neither",
        key="statue.mesh.density_kg_m3",
    )
    file = existing_file(mesh.file, base_dir=path.parent, where=str(path), key="statue.mesh.file")
    inner = None
    if mesh.inner is not None:
        inner = existing_file(mesh.inner.file, base_dir=path.parent, where=str(path), key="statue.mesh.inner.file")
    changed = tuple(item.stat().st_mtime_ns for item in (file, inner) if item is not None)
    try:
        solid = _solid(file, inner, changed, mesh, table.mass_kg)
        found.extend(findings_of(_doubts(file, changed, mesh.unit, mesh.up)))
        if mesh.inner is not None:
            found.append(
                info(
                    "mesh_hollow",
                    file=mesh.inner.file,
                    inside_kg_m3=mesh.inner.density_kg_m3,
                    mass_kg=solid.mass_kg,
                    weighed_kg=table.mass_kg,
                    mean_kg_m3=solid.density_kg_m3,
                    centroid_height_m=solid.centroid_height_m,
                )
            )
        solid = _reconciled(solid, table, mesh, found)
        return statue_of(_adjusted(solid, mesh, found))
    except MeshError as error:
        raise InputError(mesh_mistake(error, f"{path}: {file.name}", "statue.mesh")) from error


def findings_of(doubts: Iterable[Doubt]) -> list[Finding]:
    """What is doubtful of a scan."""
    return [caution(each.code, **each.values) for each in doubts]


def steps_of(log: ProcessingLog, say: Say) -> list[str]:
    """What was done to a scan, step by step with its effect."""
    said = []
    for each in log.changes:
        effect = {name: getattr(each, name) for name in ("volume_rel", "centroid_m", "inertia_rel")}
        after = "" if each.volume_rel is None else f" {say(info('prepared_effect', **effect))}"
        said.append(f"{say(info(each.code, **each.values))}{after}")
    return said


def mesh_mistake(error: MeshError, where: str, key: str = "") -> Mistake:
    """What is wrong with a mesh, as a mistake of its user's."""
    return Mistake(where, key, error.wanted, error.got, error.advice)


@lru_cache(maxsize=8)
def _solid(
    file: Path, inner: Path | None, changed_ns: tuple[int, ...], mesh: MeshTable, weighed_kg: float | None
) -> Solid:
    """The solid of a mesh file, read once for all scenes that use it as it is (`changed_ns` are the files' times of change)."""

    density = None if weighed_kg is not None else mesh.density_kg_m3
    load = partial(load_solid, file, density_kg_m3=density, mass_kg=weighed_kg)
    if inner is not None and mesh.inner is not None:
        load = partial(load_hollow, file, inner, mesh.inner.density_kg_m3, density_kg_m3=density, mass_kg=weighed_kg)
    return load(unit=mesh.unit, up=mesh.up, azimuth_deg=mesh.azimuth_deg, contact_tolerance_m=mesh.contact_tolerance_m)


@lru_cache(maxsize=8)
def _doubts(file: Path, changed_ns: tuple[int, ...], unit: str | float, up: str) -> tuple[Doubt, ...]:
    """What makes the surface of a mesh file doubtful as a single statue: looked at once for its content, and kept."""

    how = f"rockcheck mesh prepare {file} --unit {unit} --up {up} --out statue.ply"

    def looked_at() -> str:

        mesh = to_metres_z_up(read(file), unit, up)
        return json.dumps([asdict(each) for each in doubts(mesh.vertices, mesh.faces, how)])

    code = b"".join(each.read_bytes() for each in sorted(Path(meshes.__file__).parent.glob("*.py")))
    state = b"\0".join((file.read_bytes(), code, os.fsencode(how)))
    return tuple(Doubt(**each) for each in json.loads(made_once("doubts", state, looked_at)))


def _surveyed(key: str, survey: float, mesh: float, used: str) -> Finding:

    values = {"key": f"statue.{key}", "survey": survey, "mesh": mesh, "change": survey / mesh - 1.0, "used": used}
    return info("mesh_agrees", **values) if agrees(survey, mesh) else caution("mesh_differs", **values)


def _reconciled(solid: Solid, table: StatueTable, mesh: MeshTable, found: list[Finding]) -> Solid:
    """The survey's numbers set against the mesh, and those named in `use_survey` taken from it."""

    if table.mass_kg is not None and mesh.density_kg_m3 is not None and mesh.inner is None:
        found.append(_surveyed("mesh.density_kg_m3", mesh.density_kg_m3, solid.density_kg_m3, "weighed_mass"))
    given = {key: value for key in SURVEYED if (value := getattr(table, key)) is not None}
    missing = next((key for key in mesh.use_survey if key not in given), None)
    wanted = f"statue.{missing}, which is to be used"
    require(missing is None, "scene", wanted, "no such number", key="statue.mesh.use_survey")
    for key, value in given.items():
        used = "survey" if key in mesh.use_survey else "mesh"
        found.append(_surveyed(key, value, float(getattr(solid, SURVEYED[key])), used))
    if not mesh.use_survey:
        return solid
    height = given["centroid_height_m"] if "centroid_height_m" in mesh.use_survey else solid.centroid_height_m
    tensor = solid.inertia_kg_m2
    if "inertia_kg_m2" in mesh.use_survey:
        tensor = tensor * (given["inertia_kg_m2"] / solid.inertia_planar_kg_m2)
    return with_mass(solid, solid.mass_kg, np.array([0.0, 0.0, height]), tensor)


def _adjusted(solid: Solid, mesh: MeshTable, found: list[Finding]) -> Solid:

    wanted = mesh.adjust
    if wanted == AdjustTable():
        return solid
    shares = {"centroid": wanted.centroid_rel, "base": wanted.base_rel, "inertia": wanted.inertia_rel}
    if changes := {name: share for name, share in shares.items() if share}:
        found.append(info("mesh_adjusted", changes=changes))
    if wanted.flat_base:
        found.append(info("mesh_base_planed"))
    if not wanted.products:
        found.append(info("mesh_products_left_out"))
    return adjusted(solid, **dict(wanted))


def statue_of(solid: Solid) -> Statue:
    """The statue of a solid: every number is the mesh's own."""
    return Statue(
        mass_kg=solid.mass_kg,
        centroid_height_m=solid.centroid_height_m,
        corner_left_m=solid.corner_left_m,
        corner_right_m=solid.corner_right_m,
        inertia_kg_m2=solid.inertia_planar_kg_m2,
        height_m=solid.height_m,
        depth_m=solid.depth_m,
        section_m=solid.section_m,
        footprint_m=solid.footprint_m,
        inertia_tensor_kg_m2=solid.inertia_kg_m2,
        solid=solid,
    )
