"""A scanner of known truth: what photogrammetry would deliver of a solid, with each of its faults to choose."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshes import Solid
from meshes.mesh import RawMesh, drop_unused
from meshes.orientation import UP_ROTATION

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Faults:
    """Noise (standard deviation of every coordinate), raggedness of the open base, debris, up axis, units per metre."""

    edge_m: float = 0.012
    noise_m: float = 1e-3
    ragged_m: float = 0.006
    open_below: bool = True
    debris: int = 12
    up: str = "y"
    units_per_m: float = 1000.0
    seed: int = 5


COARSE = Faults(edge_m=0.02)


def scan(solid: Solid, faults: Faults) -> RawMesh:
    """The solid's surface as scanned: dense, noisy, open below, with debris, in the wrong axes and unit."""
    from trimesh import remesh

    random = np.random.default_rng(faults.seed)
    vertices, faces = remesh.subdivide_to_size(  # type: ignore[no-untyped-call]
        solid.vertices_m, solid.faces, max_edge=faults.edge_m
    )
    mesh = weld_exact(np.asarray(vertices), np.asarray(faces, dtype=np.int64))
    if faults.open_below:
        mesh = _without_base(mesh, faults.ragged_m)
    vertices = mesh.vertices + faults.noise_m * _noise(mesh.vertices, faults.edge_m, random)
    vertices, faces = _with_debris(vertices, mesh.faces, faults.debris, random)
    turn = np.array(UP_ROTATION[faults.up], dtype=np.float64)
    return RawMesh(faults.units_per_m * vertices @ turn, faces, "scan")


def _noise(vertices: Array, cell_m: float, random: np.random.Generator) -> Array:
    """Unit noise (n, 3) that is independent beyond `cell_m`: trilinear between the random values of a lattice.

    Noise of its own at every vertex would fold the slivers that a Boolean union leaves, which no scan has.
    """
    place = (vertices - vertices.min(axis=0)) / cell_m
    cell = np.floor(place).astype(np.int64)
    lattice = random.normal(size=(*(cell.max(axis=0) + 2), 3))
    share = place - cell
    noise = np.zeros_like(vertices)
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, share, 1.0 - share), axis=1)
        noise += weight[:, None] * lattice[tuple((cell + corner).T)]
    return np.asarray(noise / noise.std())


def weld_exact(vertices: Array, faces: NDArray[np.int64]) -> RawMesh:
    """Coincident vertices made one."""
    from meshes.mesh import weld

    return weld(RawMesh(vertices, faces, "scan"))


def _without_base(mesh: RawMesh, ragged_m: float) -> RawMesh:
    """The faces that lie below a wavy level between 0 and `ragged_m` removed: the camera did not see them."""
    corner = mesh.vertices[mesh.faces]
    middle = corner.mean(axis=1)
    level = 0.5 * ragged_m * (1.0 + np.sin(37.0 * middle[:, 0] + 1.0) * np.cos(23.0 * middle[:, 1]))
    return RawMesh(*drop_unused(mesh.vertices, mesh.faces[middle[:, 2] > level]), mesh.source)


def _with_debris(
    vertices: Array, faces: NDArray[np.int64], count: int, random: np.random.Generator
) -> tuple[Array, NDArray[np.int64]]:
    """Small tetrahedra floating beside the statue."""
    shape = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    sides = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    for _ in range(count):
        place = random.uniform([-0.6, -0.6, 0.2], [0.6, 0.6, 1.4])
        faces = np.vstack([faces, sides + len(vertices)])
        vertices = np.vstack([vertices, place + random.uniform(0.005, 0.02) * shape])
    return vertices, faces


def write(mesh: RawMesh, path: Path) -> Path:
    """The scan as a file."""
    import trimesh

    trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(path)
    return path
