"""From a photogrammetric scan to a solid: mass properties, footprint, collision shapes."""

from meshes.intake import load_solid
from meshes.mesh import MeshError
from meshes.solid import Solid, solid_from_mesh

__all__ = ["MeshError", "Solid", "load_solid", "solid_from_mesh"]
