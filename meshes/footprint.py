"""The part of a body that really touches its support: polygon, corner distances at any azimuth, feet and base profile.

Heights are kept: a base is never planed flat here. Azimuths are directions in the body's own frame, in degrees counter-clockwise
from x seen from above: the direction towards which the body would topple.
"""

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshes.mesh import Array, MeshError, require

STRAIGHT_RAD: Final = 4e-12
"""Turns that rounding makes of a straight side: two facets that the model takes as level differ by less than half of it."""


def convex_hull(points: Array) -> Array:
    """Corners (k, 2) of the convex hull of points (n, 2), counter-clockwise, from the points themselves; collinear
    ones left out.

    Raises MeshError for points on a line.
    """
    return points[_hull_indices(points)]


def _hull_indices(points: Array) -> NDArray[np.intp]:
    """Indices of the hull's corners, in counter-clockwise order starting at the lowest-leftmost one."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        order = np.asarray(ConvexHull(points).vertices, dtype=np.intp)
    except QhullError as error:
        raise MeshError(
            "a base or outline with an area",
            f"{len(points)} points on a line or in one place",
            "the mesh is a flat sheet, stands on an edge or a tip, or needs a larger contact tolerance",
        ) from error
    corners = points[order]
    scale = float(np.ptp(points, axis=0).max())
    before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
    along, ahead = corners - before, after - corners
    turning = along[:, 0] * ahead[:, 1] - along[:, 1] * ahead[:, 0]
    order = order[turning > 1e-12 * scale**2]
    first = int(np.lexsort((points[order, 0], points[order, 1]))[0])
    return np.roll(order, -first)


def footprint(vertices_m: Array, tolerance_m: float) -> Array:
    """Touching polygon (k, 3), counter-clockwise from above: the vertices within `tolerance_m` of the lowest, heights
    kept.

    Raises MeshError if they do not enclose an area.
    """
    low = vertices_m[vertices_m[:, 2] <= vertices_m[:, 2].min() + tolerance_m]
    require(
        len(low) >= 3,
        "a base of at least three touching vertices",
        f"{len(low)} within {1000.0 * tolerance_m:g} mm of the lowest point",
        "check the up axis and the base plane, or give a larger contact tolerance",
    )
    return np.array(low[_hull_indices(low[:, :2])])


def lower_chain(points: Array) -> Array:
    """Lower convex chain (k, 2) of points (n, 2) in (x, z), from the leftmost to the rightmost (monotone chain).

    A vertex at which it turns by less than `STRAIGHT_RAD` is left out.
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    chain: list[list[float]] = []
    for point in points[order].tolist():
        if chain and point[0] == chain[-1][0]:
            continue
        while len(chain) > 1:
            (ax, az), (bx, bz), (cx, cz) = chain[-2], chain[-1], point
            turn = (bx - ax) * (cz - bz) - (bz - az) * (cx - bx)
            if turn / (math.hypot(bx - ax, bz - az) * math.hypot(cx - bx, cz - bz)) > STRAIGHT_RAD:
                break
            chain.pop()
        chain.append(point)
    return np.array(chain)


def feet(vertices_m: Array, tolerance_m: float) -> Array:
    """Vertices (k, 3) within `tolerance_m` of the lowest that a flat support can touch, sorted by azimuth about the
    origin.

    They are the corners of the footprint polygon and, for a base that is not flat, those on its lower hull.
    """
    from scipy.spatial import ConvexHull

    low = vertices_m[vertices_m[:, 2] <= vertices_m[:, 2].min() + tolerance_m]
    outline = footprint(vertices_m, tolerance_m)
    if np.ptp(low[:, 2]) > 1e-9:
        lid = np.array([[x, y, outline[:, 2].max() + 1.0] for x, y in outline[:, :2]])
        hull = ConvexHull(np.vstack([low, lid]))
        facing_down = hull.equations[:, 2] < -1e-9
        touched = np.unique(hull.simplices[facing_down])
        outline = np.unique(np.vstack([outline, low[touched[touched < len(low)]]]), axis=0)
    return np.array(outline[np.argsort(np.arctan2(outline[:, 1], outline[:, 0]), kind="stable")])


def sides(polygon_m: Array) -> tuple[Array, Array]:
    """Lengths (k,) of a counter-clockwise convex polygon's sides (k, 2 or 3) and the azimuths (k,), degrees, that they face."""
    side = np.roll(polygon_m[:, :2], -1, axis=0) - polygon_m[:, :2]
    return np.linalg.norm(side, axis=1), np.rad2deg(np.arctan2(-side[:, 0], side[:, 1])) % 360.0


def outward_sides(polygon_m: Array) -> tuple[Array, Array]:
    """Outward normals (k, 2) of the sides and their distances (k,) from the origin, negative where it lies outside."""
    azimuth = np.deg2rad(sides(polygon_m)[1])
    outward = np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    return outward, np.asarray((outward * polygon_m[:, :2]).sum(axis=1))


def margin_m(polygon_m: Array) -> float:
    """Distance from the origin to the nearest side of a counter-clockwise convex polygon (k, 2 or 3); negative outside."""
    return float(outward_sides(polygon_m)[1].min())


def corner_m(polygon_m: Array, azimuth_deg: ArrayLike) -> Array:
    """Distance (n,) from the centroid's vertical to the polygon's support line across each azimuth: the planar corner
    distance."""
    azimuth = np.deg2rad(np.atleast_1d(np.asarray(azimuth_deg, dtype=np.float64)))
    return np.asarray((polygon_m[:, :2] @ np.vstack([np.cos(azimuth), np.sin(azimuth)])).max(axis=0))


def reach_m(polygon_m: Array, azimuth_deg: ArrayLike) -> Array:
    """Distance (n,) from the origin to the polygon's outline along each azimuth: where a level push lifts the body off.

    It is less than `corner_m` wherever the outline is met obliquely: there the body begins to turn about a side that a planar
    model at that azimuth does not have.
    """
    outward, distance = outward_sides(polygon_m)
    azimuth = np.deg2rad(np.atleast_1d(np.asarray(azimuth_deg, dtype=np.float64)))
    towards = outward @ np.vstack([np.cos(azimuth), np.sin(azimuth)])
    with np.errstate(divide="ignore"):
        return np.asarray(np.where(towards > 1e-12, distance[:, None] / towards, np.inf).min(axis=0))


def slenderness_rose_rad(polygon_m: Array, centroid_height_m: float, azimuth_deg: ArrayLike) -> Array:
    """Angle α (n,) = atan(b/h) by which the body must turn towards each azimuth before it falls by itself.

    The body turns about the side of the polygon that its support line touches, whose distance is b (docs/model.md, section 1);
    the height of that vertex above the base plane is left out (it is at most the contact tolerance).
    """
    return np.arctan2(corner_m(polygon_m, azimuth_deg), centroid_height_m)


def weakest_azimuth_deg(polygon_m: Array) -> float:
    """Direction across the side of the polygon nearest the centroid's vertical: where the least slenderness lies."""
    return float(sides(polygon_m)[1][int(np.argmin(outward_sides(polygon_m)[1]))])
