"""Fewer samples for the screen with every peak kept."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DISPLAYED_SAMPLES: Final = 12_000
"""Most samples of one curve on a page: a 10 s history at 1 ms stays whole, and four curves stay under 0.5 MB."""

STRAIGHT_PX: Final = 0.05
"""A point this near to the line between its neighbours is left out of a still curve."""
STRAIGHTENINGS: Final = 6


def kept_samples(values: Array, most: int = DISPLAYED_SAMPLES) -> NDArray[np.intp]:
    """Indices of the samples to draw, increasing: all, or first, least, largest and last of every bin.

    At most `most` (≥ 8) are kept; the extremes of `values` and both its ends are always among them.
    """
    count = len(values)
    if count <= most:
        return np.arange(count)
    edges = np.linspace(0, count, most // 4 + 1).astype(np.intp)
    starts, ends = edges[:-1], edges[1:]
    chosen = [starts, ends - 1]
    width = int((ends - starts).max())
    padded = starts[:, None] + np.minimum(np.arange(width), (ends - starts)[:, None] - 1)
    block = values[padded]
    chosen += [starts + np.argmin(block, axis=1), starts + np.argmax(block, axis=1)]
    return np.unique(np.concatenate(chosen))


def thinned_px(points_px: Array, most: int) -> Array:
    """Of the points (n, 2) of a still curve at most so many, and few that lie on the line between their neighbours.

    Each straightening may move the curve by `STRAIGHT_PX`.
    """
    points = points_px[kept_samples(points_px[:, 1], most)]
    for _ in range(STRAIGHTENINGS):
        before, middle, after = points[:-2:2], points[1:-1:2], points[2::2]
        along, aside = after - before, middle - before
        length2 = np.einsum("ij,ij->i", along, along)
        share = np.clip(np.einsum("ij,ij->i", along, aside) / np.where(length2 > 0.0, length2, 1.0), 0.0, 1.0)
        off = np.hypot(*(aside - share[:, None] * along).T)
        points = np.delete(points, 1 + 2 * np.flatnonzero(off < STRAIGHT_PX), axis=0)
    return points
