"""Closed surfaces from rings and tubes: what a generated body is made of."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from meshes.repair import Part

Array = NDArray[np.float64]


def loft(rings: Array) -> Part:
    """Closed surface through rings (k, n, 3), each counter-clockwise seen from its far end, with a fan over either
    end."""
    count, around, _ = rings.shape
    vertices = np.vstack([rings.reshape(-1, 3), rings[0].mean(axis=0), rings[-1].mean(axis=0)])
    here = np.arange(count * around).reshape(count, around)
    beside = np.roll(here, -1, axis=1)
    a, b, c, d = here[:-1].ravel(), beside[:-1].ravel(), beside[1:].ravel(), here[1:].ravel()
    foot, head = count * around, count * around + 1
    fans = [
        np.column_stack([np.full(around, foot), beside[0], here[0]]),
        np.column_stack([np.full(around, head), here[-1], beside[-1]]),
    ]
    return vertices, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d]), *fans])


def tube(
    knots: Array,
    around: int,
    folds: Callable[[Array, Array], Array] | None = None,
    upright: tuple[float, float, float] = (0.31, 0.2, 1.0),
) -> Part:
    """Closed tube along knots (k, 5) of x, y, z, radius across and radius towards `upright`.

    `folds(t, angle)` widens it, t from 0 to 1 along it; `upright` must not be parallel to it anywhere.
    """
    path, radii = knots[:, :3], knots[:, 3:]
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1)[:, None]
    aside = np.cross(along, np.array(upright))
    aside /= np.linalg.norm(aside, axis=1)[:, None]
    other = np.cross(along, aside)
    turn = 2.0 * np.pi * np.arange(around) / around
    t = np.linspace(0.0, 1.0, len(path))[:, None]
    grow = 1.0 + (folds(t, turn[None, :]) if folds else 0.0) * np.ones((len(path), around))
    rings = (
        path[:, None, :]
        + (grow * radii[:, :1] * np.cos(turn))[..., None] * aside[:, None, :]
        + (grow * radii[:, 1:] * np.sin(turn))[..., None] * other[:, None, :]
    )
    return loft(rings)


def smooth_curve(knots: Array, count: int) -> Array:
    """Monotone cubic curve through the knots (k, d), at `count` evenly spaced parameters."""
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(np.linspace(0.0, 1.0, len(knots)), knots)(np.linspace(0.0, 1.0, count)))
