"""Samples as a page carries them: fewer for the screen with every peak kept, packed as differences of multiples of a step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reports.charts import Json

Array = NDArray[np.float64]

DISPLAYED_SAMPLES: Final = 12_000
"""Most samples of one curve on a page: a 10 s history at 1 ms stays whole, and four curves stay under 0.5 MB."""

LEVELS: Final = 2**18
"""Steps over an array's range: a value on a page is at most a 500 000th of the range beside the record's."""
ON_CLOCK: Final = 1e-3
"""Samples this near to multiples of their spacing, as a share of it, are taken as such: times cost nothing then."""


def shown_samples(values: Array, most: int = DISPLAYED_SAMPLES) -> NDArray[np.intp]:
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


def shown_together(curves: Sequence[Array], most: int = DISPLAYED_SAMPLES) -> NDArray[np.intp]:
    """Indices of the samples to draw of curves over one axis: at most so many of each, its extremes among them."""
    return np.unique(np.concatenate([shown_samples(each, most) for each in curves]))


def packed_array(values: ArrayLike, levels: int = LEVELS) -> Json:
    """Finite values (n,) or, flattened, (n, k) as `{step, order, deltas}`: `deltas` summed `order` times, times `step`.

    Whole numbers, and times on a clock, come back as they are.
    """
    array = np.asarray(values).ravel()
    step = 1.0 if array.dtype.kind in "iu" else _step(array.astype(np.float64), levels)
    steps = np.round(array / step).astype(np.int64)
    first = np.diff(steps, prepend=0)
    second = np.diff(first, prepend=0)
    order, deltas = min((1, first), (2, second), key=lambda choice: int(np.abs(choice[1]).sum()))
    return {"step": step, "order": order, "deltas": deltas.tolist()}


def _step(array: Any, levels: int) -> float:
    """The spacing of samples on a clock, for others the range over `levels`."""
    apart = np.diff(array)
    spacing = float(np.median(apart)) if len(apart) else 0.0
    # Beside a value that dwarfs it a spacing counts nothing: whole numbers end at 2^53.
    if 0.0 < np.abs(array).max(initial=0.0) < 2.0**53 * spacing:
        # A clock's spacing has few digits; a median of differences carries their rounding.
        spacing = float(f"{spacing:.9g}")
        if np.abs(array / spacing - np.round(array / spacing)).max() < ON_CLOCK:
            return spacing
    if len(array) < 2 or np.ptp(array) == 0.0:
        return _alone(array)
    # Values that differ by their rounding alone: a finer step than that has no whole number of steps.
    return max(float(np.ptp(array)) / levels, float(np.spacing(np.abs(array).max())))


def _alone(array: Any) -> float:
    """A step of which one value, or the same again and again, is a multiple."""
    return float(abs(array[0])) if len(array) and array[0] else 1.0


def numbers(values: Any) -> Any:
    """The values of a trace: packed arrays unpacked (n,), lists as they are."""
    if not isinstance(values, Mapping):
        return values
    steps = np.asarray(values["deltas"], dtype=np.int64)
    for _ in range(values["order"]):
        steps = np.cumsum(steps)
    return steps * values["step"]
