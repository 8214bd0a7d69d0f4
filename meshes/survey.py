"""What a surface cannot tell: hollow or inhomogeneous statues, weighed and surveyed numbers set against the mesh."""

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from meshes import footprint as base
from meshes.intake import closed_mesh
from meshes.mesh import Array, Faces, manifold, require
from meshes.processing_log import Edges
from meshes.solid import Solid, mass_properties, solid_from_mesh

AGREES_REL = 5e-3
"""A survey's number and the mesh's agree within this relative difference."""


def with_mass(solid: Solid, mass_kg: float, centroid_m: Array, inertia_kg_m2: Array) -> Solid:
    """The same surface with other mass properties; `centroid_m` (3,) in the solid's present frame, inertia about it
    (3, 3).

    The frame moves so that its origin is again below the centroid. Raises MeshError for a mass or tensor that no body has, or a
    centroid outside the base.
    """
    moments = np.linalg.eigvalsh(inertia_kg_m2)
    require(
        mass_kg > 0.0 and np.isfinite(mass_kg) and moments[0] > 0.0 and moments[0] + moments[1] >= moments[2],
        "a positive mass and the inertia of a body",
        f"{mass_kg:g} kg and principal moments {moments}",
        "no moment may exceed the sum of the others",
    )
    shift = np.array([centroid_m[0], centroid_m[1], 0.0])
    footprint = solid.footprint_m - shift
    require(
        base.margin_m(footprint) > 0.0,
        "a centroid above the base",
        f"one at ({centroid_m[0]:.4g}, {centroid_m[1]:.4g}) m, beside it",
    )
    return replace(
        solid,
        vertices_m=solid.vertices_m - shift,
        footprint_m=footprint,
        mass_kg=mass_kg,
        centroid_height_m=float(centroid_m[2]),
        inertia_kg_m2=np.array(inertia_kg_m2),
        density_kg_m3=mass_kg / mass_properties(solid.vertices_m, solid.faces).volume_m3,
    )


def with_core(solid: Solid, vertices_m: Array, faces: Faces, core_density_kg_m3: float = 0.0) -> Solid:
    """The statue with the space inside a closed inner shell filled at another density (0: hollow, 7850: an iron core).

    The shell (n, 3), (m, 3) lies in the solid's frame, inside it and its faces outward (`meshes.survey` sees to both).
    """
    core = mass_properties(vertices_m, faces)
    change = core_density_kg_m3 - solid.density_kg_m3
    mass = solid.mass_kg + change * core.volume_m3
    outer_centroid = np.array([0.0, 0.0, solid.centroid_height_m])
    centroid = (solid.mass_kg * outer_centroid + change * core.volume_m3 * core.centroid_m) / mass
    inertia = _moved(solid.inertia_kg_m2, solid.mass_kg, outer_centroid - centroid) + _moved(
        change * core.inertia_per_density_m5, change * core.volume_m3, core.centroid_m - centroid
    )
    return with_mass(solid, mass, centroid, inertia)


def _moved(inertia: Array, mass: float, offset: Array) -> Array:
    """Inertia about a point at `offset` from the body's centroid (Huygens and Steiner)."""
    return np.asarray(inertia + mass * (offset @ offset * np.eye(3) - np.outer(offset, offset)))


def adjusted(
    solid: Solid,
    *,
    centroid_rel: float = 0.0,
    base_rel: float = 0.0,
    inertia_rel: float = 0.0,
    flat_base: bool = False,
    products: bool = True,
) -> Solid:
    """The statue as it would be if a survey were off by these shares, or with its base planed or its products of
    inertia left out.

    `centroid_rel` raises the centroid, `base_rel` widens every horizontal distance of the surface, `inertia_rel` grows the tensor
    about the centroid; mass is kept throughout. Raises MeshError for shares that leave nothing.
    """
    require(
        min(centroid_rel, base_rel, inertia_rel) > -1.0,
        "shares above -1 (nothing left)",
        f"{centroid_rel:g}, {base_rel:g}, {inertia_rel:g} for centroid, base and inertia",
    )
    inertia = (1.0 + inertia_rel) * solid.inertia_kg_m2
    if not products:
        inertia = np.diag(np.diag(inertia))
    grow = np.array([1.0 + base_rel, 1.0 + base_rel, 1.0])
    vertices, footprint = solid.vertices_m * grow, solid.footprint_m * grow
    if flat_base:
        vertices[vertices[:, 2] <= solid.contact_tolerance_m, 2] = 0.0
        footprint[:, 2] = 0.0
    changed = replace(solid, vertices_m=vertices, footprint_m=footprint)
    centroid = np.array([0.0, 0.0, (1.0 + centroid_rel) * solid.centroid_height_m])
    return with_mass(changed, solid.mass_kg, centroid, inertia)


def agrees(survey: float, mesh: float) -> bool:
    """Whether a survey's number is the mesh's within `AGREES_REL`."""
    return abs(survey / mesh - 1.0) <= AGREES_REL


# A hollow or cored statue from two surfaces: the scan outside, an inner shell in the same file frame.

OUTSIDE_REL: Final = 1e-3
"""Share of an inner shell's volume that may lie outside the statue: two scans that touch differ by their noise."""


def load_hollow(
    outer: str | Path,
    inner: str | Path,
    inside_kg_m3: float,
    *,
    density_kg_m3: float | None = None,
    mass_kg: float | None = None,
    unit: str | float,
    up: str,
    azimuth_deg: float,
    contact_tolerance_m: float,
) -> Solid:
    """The solid of two clean meshes in one file frame, turned about the vertical, with `inside_kg_m3` inside `inner` (0: empty).

    The density around `inner` is given, or solved from the weighed mass; `density_kg_m3` of the result is the mean over the outer
    volume. Raises MeshError where a surface is not closed, faces inward, or the shell leaves the statue.
    """
    around, shell = (closed_mesh(path, unit, up) for path in (outer, inner))
    volume, hollow = (mass_properties(mesh.vertices, mesh.faces).volume_m3 for mesh in (around, shell))
    require(
        hollow > 0.0,
        "an inner shell with its faces outward",
        f"a volume of {hollow:.4g} m³",
        "turn its faces (rockcheck mesh prepare does)",
        place=str(inner),
    )
    outside = (manifold(shell.vertices, shell.faces) - manifold(around.vertices, around.faces)).volume() / hollow
    require(
        outside <= OUTSIDE_REL,
        "an inner shell inside the statue",
        f"one with {100.0 * outside:.3g} % of its volume outside",
        "both files must have the same origin, unit and axes",
        place=shell.source,
    )
    require(
        (density_kg_m3 is None) != (mass_kg is None),
        "either a density or a weighed mass",
        "both or neither",
        "give one of them",
    )
    density = density_kg_m3 if mass_kg is None else (mass_kg - inside_kg_m3 * hollow) / (volume - hollow)
    require(
        density is not None and density > 0.0,
        f"a weighed mass above that of the core, {inside_kg_m3 * hollow:.5g} kg",
        f"{mass_kg or 0.0:g} kg",
    )
    solid = solid_from_mesh(
        around.vertices, around.faces, density_kg_m3=density, contact_tolerance_m=contact_tolerance_m
    )
    shift = solid.vertices_m[0] - around.vertices[0]
    filled = with_core(solid, shell.vertices + shift, np.array(shell.faces), inside_kg_m3)
    return filled.rotated(azimuth_deg) if azimuth_deg else filled


# A flat base made uneven as a real one is: the edges of its outline divided, every base vertex lifted by a drawn height.


def ragged(solid: Solid, depth_m: float, *, spacing_m: float, seed: int) -> Solid:
    """The solid with its base's outline cut every `spacing_m` or less, and each base vertex lifted by up to `depth_m`.

    Heights are uniform, drawn from the seed; mass, centroid and inertia are kept: what changes is where it touches. Raises
    MeshError for a depth beyond the contact tolerance, or a base that no longer carries the statue.
    """
    require(
        0.0 < depth_m <= solid.contact_tolerance_m and spacing_m > 0.0,
        f"a depth up to the contact tolerance of {solid.contact_tolerance_m:g} m and a positive spacing",
        f"{depth_m:g} m and {spacing_m:g} m",
    )
    vertices, faces = _divided(solid.vertices_m, solid.faces, spacing_m)
    low = vertices[:, 2] < 1e-9
    heights = np.random.default_rng(seed).uniform(0.0, depth_m, int(low.sum()))
    vertices[low, 2] = heights - heights.min()
    footprint = base.footprint(vertices, solid.contact_tolerance_m)
    changed = replace(solid, vertices_m=vertices, faces=faces, footprint_m=footprint)
    return with_mass(changed, solid.mass_kg, np.array([0.0, 0.0, solid.centroid_height_m]), solid.inertia_kg_m2)


def _divided(vertices: Array, faces: Faces, spacing_m: float) -> tuple[Array, Faces]:
    """The mesh with every edge between the base and what rises from it cut into equal pieces; the faces beside are fanned."""
    cuts: dict[tuple[int, int], list[int]] = {}
    new = list(vertices)
    for a, b in _rim(vertices, faces):
        pieces = int(np.ceil(np.linalg.norm(vertices[b] - vertices[a]) / spacing_m))
        inner = [vertices[a] + (vertices[b] - vertices[a]) * k / pieces for k in range(1, pieces)]
        cuts[a, b] = list(range(len(new), len(new) + len(inner)))
        cuts[b, a] = cuts[a, b][::-1]
        new.extend(inner)
    whole = []
    for face in faces.tolist():
        outline = [
            point for a, b in zip(face, face[1:] + face[:1], strict=True) for point in (a, *cuts.get((a, b), ()))
        ]
        if len(outline) == 3:
            whole.append(face)
            continue
        # A fan from the face's middle leaves no triangle without an area, wherever the cuts lie.
        new.append(vertices[face].mean(axis=0))
        middle = len(new) - 1
        whole.extend([a, b, middle] for a, b in zip(outline, outline[1:] + outline[:1], strict=True))
    return np.array(new), np.array(whole, dtype=np.int64)


def _rim(vertices: Array, faces: Faces) -> list[tuple[int, int]]:
    """Edges whose one face lies in the base plane and whose other does not."""
    edges = Edges.of(faces)
    pair = edges.first[edges.faces_at == 2]
    flat = np.asarray((vertices[faces][:, :, 2] < 1e-9).all(axis=1))
    between = flat[edges.face[pair]] != flat[edges.face[pair + 1]]
    return list(zip(edges.start[pair[between]].tolist(), edges.end[pair[between]].tolist(), strict=True))
