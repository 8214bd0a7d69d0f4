"""A flat base made uneven as a real one is: the edges of its outline divided, every base vertex lifted by a drawn height."""

from dataclasses import replace

import numpy as np

from meshes import footprint as base
from meshes.mesh import Array, Faces, require
from meshes.processing_log import Edges
from meshes.solid import Solid
from meshes.survey import with_mass


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
