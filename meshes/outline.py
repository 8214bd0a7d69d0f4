"""The outline of a base from a noisy rim: straight sides fitted where the rim is straight to within its own noise.

The widest of many noisy points lies some standard deviations outside the true edge; a footprint made of such points would be too
large on every side. Fitted sides are not.
"""

import numpy as np
from numpy.typing import NDArray

from meshes.mesh import Array

Indices = NDArray[np.int64]

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
    lags = {1, *(2**k for k in range(1, 8) if 2**k <= longest)}
    return max(_noise_at(rim, lag) for lag in lags)


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
