"""A solid back to a file that viewers open."""

from __future__ import annotations

from pathlib import Path

from meshes.solid import Solid


def write_glb(solid: Solid, path: Path) -> None:
    """Write the solid's surface as binary glTF, in metres, z up as in the statue's frame."""
    import trimesh

    mesh = trimesh.Trimesh(solid.vertices_m, solid.faces, process=False)
    mesh.export(path, file_type="glb")
