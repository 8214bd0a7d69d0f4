"""Simple closed meshes with known properties."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from meshes import Solid
from meshes.mesh import manifold
from meshes.repair import Part
from tests.meshes.loft import loft

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

LOWER_FACES = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4]]
UPPER_FACES = [[1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]]
BOX_FACES = np.array([*LOWER_FACES, *UPPER_FACES])


def box(
    width: float, depth: float, height: float, corner: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> tuple[Array, Faces]:
    """An axis-parallel box from its lowest corner."""
    plan = np.array([[0.0, 0.0], [width, 0.0], [width, depth], [0.0, depth]])
    low = np.column_stack([plan, np.zeros(4)])
    return np.vstack([low, low + np.array([0.0, 0.0, height])]) + np.array(corner), BOX_FACES.copy()


def slab(half_width: float, half_depth: float, low: float, high: float) -> tuple[Array, Faces]:
    """A box about the z axis, between two heights."""
    return box(2.0 * half_width, 2.0 * half_depth, high - low, (-half_width, -half_depth, low))


def prism(outline: Array, depth: float) -> tuple[Array, Faces]:
    """An outline (n, 2) in (x, z), counter-clockwise as drawn with x right and z up, drawn out over `depth` along y."""
    front = np.column_stack([outline[:, 0], np.full(len(outline), -0.5 * depth), outline[:, 1]])
    vertices, faces = loft(np.stack([front, front + np.array([0.0, depth, 0.0])]))
    return vertices, faces[:, ::-1]


def cylinder(radius: float, height: float, around: int = 128) -> tuple[Array, Faces]:
    """A cylinder about z from z = 0."""
    turn = 2.0 * np.pi * np.arange(around) / around
    ring = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros(around)])
    return loft(np.stack([ring, ring + np.array([0.0, 0.0, height])]))


def together(*parts: Part) -> Part:
    """The surfaces of all parts in one mesh, as they are."""
    begin = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    return np.vstack([part[0] for part in parts]), np.vstack([p[1] + k for p, k in zip(parts, begin, strict=False)])


def union(parts: Sequence[Part]) -> Part:
    """The closed surface around all parts together, by an exact Boolean union."""
    from manifold3d import Manifold, OpType

    mesh = Manifold.batch_boolean([manifold(*part) for part in parts], OpType.Add).to_mesh64()
    return np.asarray(mesh.vert_properties[:, :3], dtype=np.float64), np.asarray(mesh.tri_verts, dtype=np.int64)


def misfit(solid: Solid, parts: Sequence[Array]) -> tuple[float, float]:
    """Volume of convex parts outside a mesh (overlaps counted once) and of the mesh outside them, over the mesh's; exact."""
    from manifold3d import Manifold, OpType

    body = manifold(solid.vertices_m, solid.faces)
    union = Manifold.batch_boolean([Manifold.hull_points(points) for points in parts], OpType.Add)
    both, volume = float((union ^ body).volume()), float(body.volume())
    return (float(union.volume()) - both) / volume, 1.0 - both / volume
