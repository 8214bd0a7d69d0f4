"""A solid in the statue frame: mass properties of a closed mesh and the planar quantities that a rocking model takes.

The statue frame has its origin on the base plane (z = 0) directly below the centroid; x lies in the rocking plane, y
across it.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from meshes import footprint as base
from meshes.mesh import Array, Faces, manifold, require

CONTACT_TOLERANCE_M = 1e-3
"""How far above the base plane a vertex still counts as touching: the flatness that a good photogrammetric scan
resolves."""


@dataclass(frozen=True)
class MassProperties:
    """Volume, centroid (3,) and inertia per unit density about the centroid (3, 3) of a closed mesh."""

    volume_m3: float
    centroid_m: Array
    inertia_per_density_m5: Array


@dataclass(frozen=True, eq=False)
class Solid:
    """A rigid statue in the statue frame; arrays are read-only float64 (faces int64).

    `vertices_m` (n, 3), `faces` (m, 3) outward by the right-hand rule, `inertia_kg_m2` (3, 3) about the centroid in the statue
    frame's axes, `footprint_m` (k, 3) the mesh's own touching vertices as a convex polygon, counter-clockwise seen from above,
    `contact_tolerance_m` the height up to which a vertex counted as touching.
    """

    vertices_m: Array = field(repr=False)
    faces: Faces = field(repr=False)
    mass_kg: float
    centroid_height_m: float
    inertia_kg_m2: Array
    density_kg_m3: float
    footprint_m: Array
    height_m: float
    contact_tolerance_m: float = CONTACT_TOLERANCE_M

    def __post_init__(self) -> None:
        for array in (self.vertices_m, self.faces, self.inertia_kg_m2, self.footprint_m):
            array.setflags(write=False)

    @property
    def corner_right_m(self) -> float:
        """Distance b_R > 0 from the centroid's vertical to the right corner, in the x-z plane."""
        return float(self.footprint_m[:, 0].max())

    @property
    def corner_left_m(self) -> float:
        """Distance b_L > 0 from the centroid's vertical to the left corner, in the x-z plane."""
        return float(-self.footprint_m[:, 0].min())

    @property
    def depth_m(self) -> float:
        """Extent of the base across the rocking plane."""
        return float(np.ptp(self.footprint_m[:, 1]))

    @property
    def inertia_planar_kg_m2(self) -> float:
        """Inertia J_G about the centroid's axis across the rocking plane."""
        return float(self.inertia_kg_m2[1, 1])

    @cached_property
    def section_m(self) -> Array:
        """Convex silhouette (k, 2) in (x, z), counter-clockwise as drawn with x right and z up, base vertices
        included."""
        return base.convex_hull(self.vertices_m[:, [0, 2]])

    @cached_property
    def base_profile_m(self) -> Array:
        """Base vertices (k, 2) in (x, z) on which the body can stand or rock, left to right (docs/model.md, section
        8)."""
        touching = self.vertices_m[self.vertices_m[:, 2] <= self.contact_tolerance_m]
        return base.lower_chain(touching[:, [0, 2]])

    @cached_property
    def feet_m(self) -> Array:
        """The mesh's own vertices (k, 3) that a flat support can touch: those on the lower hull of the base,
        raggedness kept."""
        return base.feet(self.vertices_m, self.contact_tolerance_m)

    @cached_property
    def principal(self) -> tuple[Array, Array]:
        """Principal moments (3,) ascending in kg m² and axes (3, 3) as columns of a right-handed frame."""
        moments, axes = np.linalg.eigh(self.inertia_kg_m2)
        if np.linalg.det(axes) < 0.0:
            axes[:, 0] = -axes[:, 0]
        return moments, axes

    @cached_property
    def digest(self) -> str:
        """SHA-256 of everything that can change a simulation: geometry, mass and inertia."""
        numbers = np.array([self.mass_kg, self.centroid_height_m, self.contact_tolerance_m])
        sha = hashlib.sha256()
        for array in (self.vertices_m, self.faces, self.inertia_kg_m2, self.footprint_m, numbers):
            sha.update(np.ascontiguousarray(array).tobytes())
        return sha.hexdigest()

    def rotated(self, azimuth_deg: float) -> Solid:
        """The same statue turned by `azimuth_deg` about the vertical through its centroid, counter-clockwise from
        above."""
        turn = turn_about_z(azimuth_deg)
        vertices = self.vertices_m @ turn.T
        return replace(
            self,
            vertices_m=vertices,
            inertia_kg_m2=turn @ self.inertia_kg_m2 @ turn.T,
            footprint_m=base.footprint(vertices, self.contact_tolerance_m),
        )


def turn_about_z(azimuth_deg: float) -> Array:
    """Rotation matrix (3, 3) about z, counter-clockwise seen from above; quarter turns are exact."""
    quarter, rest = divmod(azimuth_deg, 90.0)
    angle = np.deg2rad(rest)
    cos, sin = float(np.cos(angle)), float(np.sin(angle))
    for _ in range(int(quarter) % 4):
        cos, sin = -sin, cos
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def mass_properties(vertices_m: Array, faces: Faces) -> MassProperties:
    """Volume integrals of the closed mesh `vertices_m` (n, 3), `faces` (m, 3), outward by the right-hand rule.

    The origin is moved into the mesh first, so that a scan far from its file's origin loses no digits.
    """
    from trimesh import triangles

    middle = 0.5 * (vertices_m.min(axis=0) + vertices_m.max(axis=0))
    # A surface that encloses nothing has a centroid of 0/0; its volume is refused by whoever asked.
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = triangles.mass_properties((vertices_m - middle)[faces], density=1.0)
    return MassProperties(float(unit["volume"]), unit["center_mass"] + middle, np.asarray(unit["inertia"]))


def solid_from_mesh(
    vertices_m: Array,
    faces: Faces,
    *,
    density_kg_m3: float | None = None,
    mass_kg: float | None = None,
    contact_tolerance_m: float = CONTACT_TOLERANCE_M,
) -> Solid:
    """The solid of a closed mesh standing on its lowest point, z up, with the density given or solved from the
    weighed mass.

    Raises MeshError if neither or both of density and mass are given, or if the mesh has no volume or does not stand.
    """
    properties = mass_properties(vertices_m, faces)
    density, mass = _density_and_mass(properties.volume_m3, density_kg_m3, mass_kg)
    origin = np.array([properties.centroid_m[0], properties.centroid_m[1], vertices_m[:, 2].min()])
    placed = np.ascontiguousarray(vertices_m - origin, dtype=np.float64)
    polygon = base.footprint(placed, contact_tolerance_m)
    margin = base.margin_m(polygon)
    require(
        margin > 0.0,
        "a statue that stands",
        f"a centroid {-margin:.4g} m outside the polygon of its {len(polygon)} vertices that touch"
        f" within {1000.0 * contact_tolerance_m:g} mm",
        "check the up axis and the base plane, or give a larger contact tolerance",
    )
    require(
        np.linalg.eigvalsh(properties.inertia_per_density_m5)[0] > 0.0,
        "a surface with its faces outward throughout",
        "a moment of inertia that is not positive: parts of it lie inside out",
        "repair the surface (rockcheck mesh prepare does, with a log)",
    )
    return Solid(
        vertices_m=placed,
        faces=np.array(faces, dtype=np.int64),
        mass_kg=mass,
        centroid_height_m=float(properties.centroid_m[2] - origin[2]),
        inertia_kg_m2=density * properties.inertia_per_density_m5,
        density_kg_m3=density,
        footprint_m=polygon,
        height_m=float(placed[:, 2].max()),
        contact_tolerance_m=contact_tolerance_m,
    )


def _density_and_mass(volume_m3: float, density_kg_m3: float | None, mass_kg: float | None) -> tuple[float, float]:
    """The pair (density, mass) from the one that is given."""
    require(
        volume_m3 > 0.0,
        "a closed mesh with its faces outward",
        f"a signed volume of {volume_m3:g} m³",
        "turn the faces outward (rockcheck mesh prepare does, with a log)",
    )
    require(
        (density_kg_m3 is None) != (mass_kg is None),
        "either a density or a weighed mass",
        f"density {density_kg_m3} and mass {mass_kg}",
        "give one of them; the other follows from the volume",
    )
    density = density_kg_m3 if density_kg_m3 is not None else float(mass_kg or 0.0) / volume_m3
    given = f"density {density_kg_m3}" if mass_kg is None else f"mass {mass_kg}"
    require(density > 0.0 and np.isfinite(density), "a positive density or mass", given)
    return density, mass_kg if mass_kg is not None else density * volume_m3


def write_glb(solid: Solid, path: Path) -> None:
    """Write the solid's surface as binary glTF, in metres, z up as in the statue's frame."""
    import trimesh

    trimesh.Trimesh(solid.vertices_m, solid.faces, process=False).export(path, file_type="glb")


# A convex hull within a vertex budget, and how far a statue's hull is from the statue.
#
# The base touches through the mesh's own vertices (`Solid.feet_m`) in every case, and so does whatever a flat wall meets. Hull
# and convex parts (`meshes.decomposition`) stand for the body above the base where a pedestal's edge can be met.


def thinned(points_m: Array, max_vertices: int) -> tuple[Array, float]:
    """At most `max_vertices` corners (k, 3) of the hull of points (n, 3), and how far the hull stands out of theirs at most, m.

    The outermost along the axes come first, then always the one that stands out furthest: the hull of what is chosen lies within
    the full one.
    """
    from scipy.spatial import ConvexHull

    corners = points_m[np.sort(ConvexHull(points_m).vertices)]
    if len(corners) <= max_vertices:
        return corners, 0.0
    extremes = np.unique([*corners.argmax(axis=0), *corners.argmin(axis=0), *_spread(corners)])
    chosen = np.unique(corners[extremes], axis=0)
    while True:
        sides = ConvexHull(chosen).equations
        outside = (corners @ sides[:, :3].T + sides[:, 3]).max(axis=1)
        furthest = int(np.argmax(outside))
        gap = float(outside[furthest])
        if len(chosen) >= max_vertices or gap <= 1e-9:
            return chosen, gap
        chosen = np.vstack([chosen, corners[furthest]])


def _spread(corners: Array) -> list[int]:
    """Indices of four corners that span a volume, whatever the body's position: furthest from a point, a line, a plane."""
    chosen = [int(np.argmax(np.linalg.norm(corners - corners.mean(axis=0), axis=1)))]
    offset = corners - corners[chosen[0]]
    chosen.append(int(np.argmax(np.linalg.norm(offset, axis=1))))
    away = np.cross(offset, offset[chosen[1]])
    chosen.append(int(np.argmax(np.linalg.norm(away, axis=1))))
    return [*chosen, int(np.argmax(np.abs(offset @ away[chosen[2]])))]


@lru_cache(maxsize=8)
def hull_excess_rel(solid: Solid, below_m: float) -> float:
    """Volume of the statue's hull below a height over that of the mesh, less one: 0 for a convex statue; exact cuts."""
    from manifold3d import Manifold

    down = (0.0, 0.0, -1.0)
    hull_part = Manifold.hull_points(np.array(solid.vertices_m)).trim_by_plane(down, -below_m)
    body = manifold(solid.vertices_m, solid.faces).trim_by_plane(down, -below_m)
    return float(hull_part.volume() / body.volume() - 1.0)
