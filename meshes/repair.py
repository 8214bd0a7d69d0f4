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
from meshes.processing_log import Change, EdgeCount, Edges, Indices, by_part, measure, parts, rims, wound_alike
from meshes.solid import CONTACT_TOLERANCE_M
from meshes.survey import OUTSIDE_REL

# The outline of a base from a noisy rim: straight sides fitted where the rim is straight to within its own noise.
#
# The widest of many noisy points lies some standard deviations outside the true edge; a footprint made of such points would
# be too large on every side. Fitted sides are not.


NORMAL_MEDIAN = 0.6745
"""Median of the absolute value of a standard normal variable."""
STRAIGHT = 4.0
"""A run of the rim counts as straight if it stays within this many standard deviations of its noise: 1 in 16 000
leaves it."""
FITS = 1.4
"""Runs are joined if the common side's residual is at most this many times the noise, which is itself known to a third."""
BUMP = 6.0
"""No point of a joined run may lie further than this many standard deviations from its side."""
SHARP_RAD = np.deg2rad(15.0)
"""Fitted sides that meet at more than this angle are prolonged to their intersection; flatter ones are joined
midway."""
LAG_SHARE = 0.05
"""Noise is looked for between points up to this share of the outline's extent apart: further apart lies geometry."""
QUIET_SHARE = 1e-4
"""Noise below this share of the outline's extent is left alone."""


def fit_outline(rim_m: Array) -> tuple[Array, float]:
    """Outline of a closed rim (n, 2): each point moved to the fitted side of its run, a quiet rim as it is; and the noise across
    the sides (standard deviation), m.
    """
    extent = float(np.ptp(rim_m, axis=0).max())
    noise = _noise(rim_m, extent)
    if noise < QUIET_SHARE * extent or len(rim_m) < 12:
        return rim_m, 0.0
    corners = _merged(rim_m, _corners(rim_m, STRAIGHT * noise), noise)
    if len(corners) < 3:
        return rim_m, noise
    points, residuals = _on_sides(rim_m, corners, 2.0 * STRAIGHT * noise)
    return points, float(np.sqrt(np.mean(residuals**2)))


def _noise(rim: Array, extent: float) -> float:
    """Standard deviation across the rim, the largest over lags up to a small share of the extent.

    At each lag it follows from how the height of a point over the chord of its two neighbours at that lag changes from one to the
    next: for independent noise a height has variance 1.5 σ² and the next one covariance -σ², so their difference 5 σ²; steady
    curvature drops out. Scanners smooth their noise over a few millimetres, which only the longer lags see past.
    """
    edge = float(np.median(np.linalg.norm(np.roll(rim, -1, axis=0) - rim, axis=1)))
    longest = min(max(1, int(LAG_SHARE * extent / max(edge, 1e-300))), len(rim) // 12)
    return max(_noise_at(rim, lag) for lag in (1, *(2**k for k in range(1, 8) if 2**k <= longest)))


def _noise_at(rim: Array, lag: int) -> float:
    """Standard deviation across the rim seen at one lag."""
    before, after = np.roll(rim, lag, axis=0), np.roll(rim, -lag, axis=0)
    chord = after - before
    length = np.maximum(np.linalg.norm(chord, axis=1), 1e-300)
    offset = rim - before
    height = (chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0]) / length
    return float(np.median(np.abs(height - np.roll(height, lag))) / (NORMAL_MEDIAN * np.sqrt(5.0)))


def _corners(rim: Array, tolerance: float) -> Indices:
    """Indices of the points between which a closed line stays within `tolerance` of its chords (Douglas and Peucker)."""
    from shapely import LineString, get_coordinates

    start = int(np.argmax(np.linalg.norm(rim - rim.mean(axis=0), axis=1)))
    first, second = sorted((start, int(np.argmax(np.linalg.norm(rim - rim[start], axis=1)))))
    halves = (np.arange(first, second + 1), np.arange(second, first + len(rim) + 1) % len(rim))
    # The number of a point stands as its third coordinate, which is passed on.
    lines = [
        LineString(np.column_stack([rim[half], half])).simplify(tolerance, preserve_topology=False) for half in halves
    ]
    return np.unique(np.concatenate([get_coordinates(line, include_z=True)[:, 2] for line in lines])).astype(np.int64)


def _merged(rim: Array, corners: Indices, noise: float) -> Indices:
    """The corners left when runs that one straight side fits to within the noise are joined, the best fitting first.

    A single bump of the noise beyond the tolerance would otherwise break a straight side, and its two ends be fitted to it.
    """
    left = corners.tolist()
    while len(left) > 3:
        misfits = np.array([_misfit(rim, left[k - 1], left[(k + 1) % len(left)]) for k in range(len(left))])
        fits = (misfits <= [FITS * noise, BUMP * noise]).all(axis=1)
        if not fits.any():
            break
        del left[int(np.argmin(np.where(fits, misfits[:, 0], np.inf)))]
    return np.array(left, dtype=np.int64)


def _misfit(rim: Array, first: int, last: int) -> tuple[float, float]:
    """Root mean square and largest distance of a run of the rim from its best straight line."""
    count = (last - first) % len(rim)
    run = rim[np.arange(first, first + count + 1) % len(rim)]
    normal = np.linalg.svd(run - run.mean(axis=0), full_matrices=False)[2][1]
    away = np.abs((run - run.mean(axis=0)) @ normal)
    return float(np.sqrt(np.mean(away**2))), float(away.max())


def _on_sides(rim: Array, corners: Indices, reach: float) -> tuple[Array, Array]:
    """The rim's points moved onto their fitted sides, corners onto the meeting of two, and the distances moved
    across."""
    count = len(rim)
    points, sides, residuals = rim.copy(), [], []
    for a, b in zip(corners, np.r_[corners[1:], corners[0] + count], strict=True):
        run = np.arange(a, b + 1) % count
        fitted = rim[run[1:-1] if len(run) > 6 else run]
        middle = fitted.mean(axis=0)
        direction = np.linalg.svd(fitted - middle, full_matrices=False)[2][0]
        inner = run[1:-1]
        points[inner] = middle + ((rim[inner] - middle) @ direction)[:, None] * direction
        residuals.append(np.linalg.norm(rim[inner] - points[inner], axis=1))
        sides.append((middle, direction))
    for k, corner in enumerate(corners):
        points[corner] = _meeting(sides[k - 1], sides[k], rim[corner], reach)
    return points, np.concatenate(residuals)


def _meeting(one: tuple[Array, Array], other: tuple[Array, Array], near: Array, reach: float) -> Array:
    """Where two sides meet; midway between the feet of `near` on both if that is further than `reach` or they are
    almost one."""
    (p, d), (q, e) = one, other
    cross = d[0] * e[1] - d[1] * e[0]
    if abs(cross) > np.sin(SHARP_RAD):
        offset = q - p
        met = p + (offset[0] * e[1] - offset[1] * e[0]) / cross * d
        if np.linalg.norm(met - near) <= reach:
            return np.asarray(met)
    return np.asarray(0.5 * (p + ((near - p) @ d) * d + q + ((near - q) @ e) * e))


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
    is fitted to the rim (`fit_outline`). Only scanned vertices below the base plane are moved, up to it, and in a noisy scan
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
        faces.append(np.column_stack([np.roll(rim, -1), rim, np.full(len(rim), len(mesh.vertices) + number)]))
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
        flat = triangulated(mesh.vertices[around], vector) if np.linalg.norm(vector) > 0.0 else fan(len(rim))
        added.append(around[flat])
    closed = RawMesh(mesh.vertices, np.vstack([mesh.faces, *added]), mesh.source)
    if EdgeCount.of(closed.faces).branching > EdgeCount.of(mesh.faces).branching:
        closed = close_pinches(mesh)  # a new edge lay on an old one beside the hole
    made = Change("prepared_holes", "holes", {"holes": len(holes), "widest_m": widest}, len(holes))
    return closed, made.measured(mesh, closed)


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
    fins = np.intersect1d(bad, edges.face[np.repeat(edges.faces_at == 1, edges.faces_at)])
    if len(fins):
        trimmed = mesh.with_faces(np.delete(mesh.faces, fins, axis=0))
        if EdgeCount.of(trimmed.faces).branching == 0:
            return trimmed, Change("prepared_fins", "non-manifold", {"edges": count, "faces": len(fins)}, len(fins))
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
