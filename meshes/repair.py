"""Small repairs of a scan's triangles, each on its own: it returns the mesh and the change, None if there was nothing
to do."""

from collections import Counter
from collections.abc import Sequence
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from meshes.mesh import (
    Array,
    MeshError,
    RawMesh,
    area_vector,
    double_areas,
    drop_unused,
    fan,
    manifold,
    require,
    triangulated,
    unique_rows,
)
from meshes.outline import fit_outline
from meshes.processing_log import Change, EdgeCount, Edges, Indices, by_part, measure, parts, rims, wound_alike
from meshes.solid import CONTACT_TOLERANCE_M
from meshes.survey import OUTSIDE_REL

# Holes closed: the open base of a scan by a plane under its rim, every other hole by triangles over its own rim.

BASE_LEVEL = 0.25
"""The open base lies within this share of the height from the lowest point."""
BASE_AREA = 0.05
"""The open base covers at least this share of the plan of the bounding box (a bust overhangs its foot)."""
BASE_FACING = 0.8
"""The open base faces down: cosine of the angle between its normal and down."""

CLEAR_OF_CONTACT = 1.05
"""Vertices lifted off a fitted base stand this many contact tolerances above it: clear of it also after a last scaling."""


LARGEST_DEBRIS = 0.02
"""Share of the main part's area up to which another part is debris."""
WIDEST_HOLE = 0.15
"""The widest hole that is closed, as a share of the height."""
MOST_RAGGED = 0.05
"""The raggedest rim of a base that is closed, as a share of the height."""
MOST_BRANCHING = 1e-3
"""Share of the edges that may have more than two faces."""

Repaired = tuple[RawMesh, Change | None]


def base_rim(mesh: RawMesh) -> Indices | None:
    """The rim of the open base of a body with z up, or None."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    best, best_area = None, BASE_AREA * float(np.prod((high - low)[:2]))
    for rim in rims(mesh.faces):
        points = mesh.vertices[rim]
        vector = area_vector(points[::-1])
        area = float(np.linalg.norm(vector))
        near = points[:, 2].mean() - low[2] < BASE_LEVEL * (high[2] - low[2])
        if near and area > best_area and -vector[2] > BASE_FACING * area:
            best, best_area = rim, area
    return best


def close_base(mesh: RawMesh) -> Repaired:
    """The body let down from the ragged rim of its open base, straight, to the base plane, and closed there.

    The base plane passes through the rim's lowest points less what the scan's own noise puts below it; the outline on that plane
    is fitted to the rim (meshes/outline.py). Only scanned vertices below the base plane are moved, up to it, and in a noisy scan
    to just above the contact tolerance, so that the fitted outline and not the widest noise is what touches. Raises MeshError for
    a rim that is too ragged.
    """
    rim = base_rim(mesh)
    if rim is None:
        return mesh, None
    points = mesh.vertices[rim]
    ragged, most = float(np.ptp(points[:, 2])), MOST_RAGGED * float(np.ptp(mesh.vertices[:, 2]))
    require(
        ragged <= most,
        f"an open base ragged by at most {most:.3g} m",
        f"a rim that rises by {ragged:.3g} m",
        "cut the scan level above its ragged edge (MeshLab, Blender: Bisect) or set the up axis",
        place=mesh.source,
    )
    outline, noise_m = fit_outline(points[:, :2])
    floor = _base_level(mesh.vertices[:, 2], points[:, 2], noise_m)
    below = np.column_stack([outline, np.full(len(rim), floor)])
    new = len(mesh.vertices) + np.arange(len(rim))
    ahead, new_ahead = np.roll(rim, -1), np.roll(new, -1)
    skirt = np.vstack([np.column_stack([ahead, rim, new]), np.column_stack([ahead, new, new_ahead])])
    cap = new[::-1][triangulated(below[::-1], np.array([0.0, 0.0, -1.0]))]
    clear = floor + (CLEAR_OF_CONTACT * CONTACT_TOLERANCE_M if noise_m > 0.0 else 0.0)
    lifted = np.maximum(mesh.vertices, [-np.inf, -np.inf, clear])
    closed = RawMesh(np.vstack([lifted, below]), np.vstack([mesh.faces, skirt, cap]), mesh.source)
    values = {
        "edges": len(rim),
        "ragged_m": ragged,
        "noise_m": noise_m,
        "fitted_m": float(np.linalg.norm(outline - points[:, :2], axis=1).max()),
        "lifted": int((mesh.vertices[:, 2] < clear).sum()),
        "lifted_m": float(clear - mesh.vertices[:, 2].min()),
    }
    return closed, Change("prepared_base", "base", values, len(rim)).measured(mesh, closed)


def _base_level(z: Array, rim_z: Array, noise_m: float) -> float:
    """Height of the base plane: the lowest point, raised by the depth that the lowest of n points has from noise alone.

    n counts the rim's points within four standard deviations of its lowest; the lowest of n normal deviations lies about Φ⁻¹(1 -
    1/n) of them below zero. Never above a body that is lower than its rim by more than that.
    """
    lowest = float(z.min())
    count = int((rim_z < rim_z.min() + 4.0 * noise_m).sum())
    if noise_m == 0.0 or count < 2:
        return lowest
    return lowest + noise_m * NormalDist().inv_cdf(1.0 - 1.0 / count)


def close_pinches(mesh: RawMesh) -> RawMesh:
    """Every hole closed by a fan to a new vertex in its middle: two rims side by side then share no new edge."""
    vertices, faces = [mesh.vertices], [mesh.faces]
    for number, rim in enumerate(rims(mesh.faces)):
        vertices.append(mesh.vertices[rim].mean(axis=0)[None, :])
        hub = np.full(len(rim), len(mesh.vertices) + number)
        faces.append(np.column_stack([np.roll(rim, -1), rim, hub]))
    return RawMesh(np.vstack(vertices), np.vstack(faces), mesh.source)


def close_holes(mesh: RawMesh) -> Repaired:
    """Every hole closed over its own rim, without new vertices if that can be; raises MeshError for one that is too wide."""
    added, widest, widest_allowed = [], 0.0, WIDEST_HOLE * float(np.ptp(mesh.vertices[:, 2]))
    holes = rims(mesh.faces)
    if not holes:
        return mesh, None
    for rim in holes:
        points = mesh.vertices[rim]
        width = float(np.linalg.norm(np.ptp(points, axis=0)))
        middle = ", ".join(f"{value:.3g}" for value in points.mean(axis=0))
        require(
            width <= widest_allowed,
            f"holes no wider than {widest_allowed:.3g} m",
            f"one of {width:.3g} m around ({middle}) with {len(rim)} edges",
            "too much would be invented: scan that part again, or close it in MeshLab (Filters,"
            " Remeshing, Close Holes) or Blender (Fill, then sculpt)",
            place=mesh.source,
        )
        widest = max(widest, width)
        around = rim[::-1]
        vector = area_vector(mesh.vertices[around])
        without_area = np.linalg.norm(vector) == 0.0
        added.append(around[fan(len(rim)) if without_area else triangulated(mesh.vertices[around], vector)])
    closed = RawMesh(mesh.vertices, np.vstack([mesh.faces, *added]), mesh.source)
    if EdgeCount.of(closed.faces).branching > EdgeCount.of(mesh.faces).branching:
        closed = close_pinches(mesh)  # a new edge lay on an old one beside the hole
    values = {"holes": len(holes), "widest_m": widest}
    return closed, Change("prepared_holes", "holes", values, len(holes)).measured(mesh, closed)


Part = tuple[NDArray[np.float64], NDArray[np.int64]]
"""Vertices (n, 3) and outward triangles (m, 3) of a closed surface."""


def drop_duplicates(mesh: RawMesh) -> Repaired:
    """Faces over the same three vertices made one."""
    unique = np.sort(unique_rows(np.sort(mesh.faces, axis=1))[0])
    removed = len(mesh.faces) - len(unique)
    if not removed:
        return mesh, None
    return mesh.with_faces(mesh.faces[unique]), Change("prepared_duplicates", "duplicates", {"faces": removed}, removed)


def drop_debris(mesh: RawMesh) -> Repaired:
    """Separate parts with less than `LARGEST_DEBRIS` of the largest part's area removed."""
    number = parts(mesh.faces)
    areas = np.bincount(number, weights=0.5 * np.linalg.norm(double_areas(mesh.vertices, mesh.faces), axis=1))
    small = areas < LARGEST_DEBRIS * areas.max()
    if not small.any():
        return mesh, None
    cleaned = mesh.with_faces(mesh.faces[~small[number]])
    count = int(small.sum())
    values = {"pieces": count, "largest": float(areas[small].max() / areas.max())}
    return cleaned, Change("prepared_debris", "debris", values, count).measured(mesh, cleaned)


def open_branches(mesh: RawMesh, largest_share: float = MOST_BRANCHING) -> Repaired:
    """At edges with more than two faces those that stick out removed, else all, to be closed as holes.

    Raises MeshError if they are too many.
    """
    edges = Edges.of(mesh.faces)
    branching = np.repeat(edges.faces_at > 2, edges.faces_at)
    count = int((edges.faces_at > 2).sum())
    if count == 0:
        return mesh, None
    require(
        count <= max(3, largest_share * len(edges.faces_at)),
        "edges with two faces each",
        f"{count} of {len(edges.faces_at)} with more (non-manifold)",
        "in MeshLab use Repair Non Manifold Edges, in Blender select Non Manifold and dissolve",
        place=mesh.source,
    )
    bad = np.unique(edges.face[branching])
    free = np.unique(edges.face[np.repeat(edges.faces_at == 1, edges.faces_at)])
    fins = np.intersect1d(bad, free)
    if len(fins):
        trimmed = mesh.with_faces(np.delete(mesh.faces, fins, axis=0))
        if EdgeCount.of(trimmed.faces).branching == 0:
            values = {"edges": count, "faces": len(fins)}
            return trimmed, Change("prepared_fins", "non-manifold", values, len(fins))
    opened = mesh.with_faces(np.delete(mesh.faces, bad, axis=0))
    return opened, Change("prepared_branches", "non-manifold", {"edges": count, "faces": len(bad)}, len(bad))


def wind_alike(mesh: RawMesh) -> Repaired:
    """Neighbouring faces given one sense."""
    if EdgeCount.of(mesh.faces).misoriented == 0:
        return mesh, None
    faces, turned = wound_alike(mesh.faces)
    made = Change("prepared_wound", "orientation", {"faces": turned}, turned)
    return RawMesh(mesh.vertices, faces, mesh.source), made


def turn_outward(mesh: RawMesh) -> Repaired:
    """A surface that is inside out turned, its holes thought closed."""
    if measure(mesh).volume_m3 >= 0.0:
        return mesh, None
    turned = RawMesh(mesh.vertices, np.ascontiguousarray(mesh.faces[:, ::-1]), mesh.source)
    return turned, Change("prepared_inside_out", "orientation", {}, len(mesh.faces))


def join_bodies(mesh: RawMesh) -> Repaired:
    """Several closed parts made one body, the largest first: one that faces inward inside it becomes a hollow, others are joined.

    Raises MeshError for parts that stay apart, and a shell that faces inward partly outside.
    """
    pieces = _apart((mesh.vertices, mesh.faces))
    count = len(pieces)
    if count == 1:
        return mesh, None
    if all(EdgeCount.of(faces).closed for _, faces in pieces):
        body, kinds = _assembled(pieces, mesh.source)
        if sum(measure(RawMesh(*part, "")).volume_m3 > 0.0 for part in _apart(body)) == 1:
            joined = RawMesh(*body, mesh.source)
            return joined, Change("prepared_bodies", "bodies", kinds, count).measured(mesh, joined)
    sizes = ", ".join(" × ".join(f"{value:.3g}" for value in np.ptp(vertices, axis=0)) for vertices, _ in pieces[:4])
    raise MeshError(
        "one statue",
        f"{count} separate bodies of {sizes} units",
        "export each to a file of its own (MeshLab: Split in Connected Components), or give a hollow"
        " statue's inner shell as a second file",
        place=mesh.source,
    )


def _apart(surface: Part) -> list[Part]:
    return [drop_unused(surface[0], faces) for faces in by_part(surface[1])]


def _assembled(pieces: Sequence[Part], source: str) -> tuple[Part, dict[str, int]]:
    """The body of closed parts, and how many beside the largest were joined, turned, kept as hollows, counted as solid."""
    volumes = [measure(RawMesh(*piece, source)).volume_m3 for piece in pieces]
    body, kinds = manifold(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)), list[str]()
    for volume, (vertices, faces) in sorted(zip(volumes, pieces, strict=True), key=lambda each: -abs(each[0])):
        piece = manifold(vertices, faces if volume >= 0.0 else faces[:, ::-1])
        inside = (piece ^ body).volume() / max(abs(volume), np.finfo(np.float64).tiny)
        require(
            volume >= 0.0 or not 0.5 < inside < 1.0 - OUTSIDE_REL,
            "an inner shell inside the statue",
            f"one that faces inward with {100.0 * (1.0 - inside):.3g} % of its volume outside",
            "cut both shells where they meet, or turn its faces if it is a part of the body",
            place=source,
        )
        hollow = volume < 0.0 and inside > 0.5
        buried = volume > 0.0 and inside > 1.0 - OUTSIDE_REL
        kinds.append("hollow" if hollow else "turned" if volume < 0.0 else "buried" if buried else "joined")
        body = body - piece if hollow else body + piece
    mesh = body.to_mesh64()
    return (
        np.asarray(mesh.vert_properties[:, :3], dtype=np.float64),
        np.asarray(mesh.tri_verts, dtype=np.int64),
    ), dict(Counter(kinds[1:]))
