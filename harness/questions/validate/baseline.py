"""What needs no model: a bare PGV threshold and probability, and the fragility contour in PGA against PGV/PGA."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import NormalDist
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from harness.comparison.statistics import fragility
from harness.model.history import Array
from harness.questions.validate.motions import Intensity
from harness.records.validation import ContourLine, ContourRecord

RIDGE: Final = 1e-6
"""Weight of the ridge that keeps the contour's Newton steps finite where the classes are separated: one case in a million."""
CURVE_POINTS: Final = 60
"""Points of every curve that a page draws."""


def best_threshold(intensity: ArrayLike, fell: ArrayLike) -> float:
    """The threshold t with the most cases right under "falls when intensity ≥ t"; the lowest where several are as good.

    Raises `ValueError` for an empty set.
    """
    x, y = np.asarray(intensity, dtype=np.float64), np.asarray(fell, dtype=np.bool_)
    if x.size == 0:
        raise ValueError("at least one case is wanted")
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    # With the threshold before case k, those below stand rightly and those from k on fall rightly.
    right = np.concatenate(([0], np.cumsum(~y))) + (y.sum() - np.concatenate(([0], np.cumsum(y))))
    # Equal intensities cannot be parted.
    right[1:-1][x[1:] == x[:-1]] = -1
    k = int(np.argmax(right))
    if k == 0:
        return float(x[0])
    return float(np.nextafter(x[-1], math.inf)) if k == x.size else float(0.5 * (x[k - 1] + x[k]))


def chances(intensity: ArrayLike, fell: ArrayLike, asked: ArrayLike) -> Array:
    """P(overturned) at the `asked` intensities by the lognormal curve fitted to the cases (`statistics.fragility`).

    Where no rising curve fits (one outcome only, or no order in the intensity) it is the share of the cases that fell, after
    Laplace (fell + 1)/(cases + 2); a motion of no intensity overturns nothing.
    """
    x, y, at = (np.asarray(values, dtype=np.float64) for values in (intensity, fell, asked))
    shaken = x > 0.0
    p = np.full(at.shape, (y.sum() + 1.0) / (y.size + 2.0))
    if shaken.any():
        curve = fragility.fit(x[shaken], y[shaken])
        if curve.median is not None:
            p[at > 0.0] = curve.probability(at[at > 0.0])
    p[at <= 0.0] = 0.0
    return p


def contour(intensities: Sequence[Intensity], fell: Sequence[bool]) -> ContourRecord | None:
    """P(overturned) = Φ(c₀ + c₁ ln PGA + c₂ ln(PGV/PGA)), PGA in g and PGV/PGA in s, by maximum likelihood.

    `separated`: a line parts the cases that fell from those that stood; the likelihood then has no maximum, and the
    coefficients (from a ridge that keeps them finite) tell the line, not the spread. After Purvance, Anooshehpoor and Brune
    (Earthquake Engineering and Structural Dynamics 37, 2008). None where only one outcome occurs, or PGA does not raise the
    probability.
    """
    y = np.asarray(fell, dtype=np.float64)
    if y.size < 3 or y.sum() in (0, y.size):
        return None
    ratios = np.array([each.ratio_s for each in intensities])
    logs = np.log(np.column_stack(([each.pga_g for each in intensities], ratios)))
    middle = logs.mean(axis=0)
    design = np.column_stack((np.ones(y.size), logs - middle))
    beta, _ = fragility.probit(design, y, RIDGE)
    c1, c2 = float(beta[1]), float(beta[2])
    if c1 <= 0.0:
        return None
    coefficients = float(beta[0] - beta[1:] @ middle), c1, c2
    separated = bool(np.all((design @ beta > 0.0) == (y > 0.5)))
    asked = np.geomspace(ratios.min(), ratios.max(), CURVE_POINTS)
    line = ContourLine(asked.tolist(), contour_pga_g(coefficients, asked).tolist())
    return ContourRecord(y.size, int(y.sum()), coefficients, separated, line)


def contour_pga_g(coefficients: tuple[float, float, float], ratio_s: ArrayLike, probability: float = 0.5) -> Array:
    """PGA in g at which that probability is reached, for each PGV/PGA in s."""
    c0, c1, c2 = coefficients
    return np.asarray(np.exp((NormalDist().inv_cdf(probability) - c0 - c2 * np.log(ratio_s)) / c1))
