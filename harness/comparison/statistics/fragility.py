"""Fragility curves: the probability of overturning against the intensity of the motion, lognormal, by maximum likelihood."""

import math
from dataclasses import dataclass
from statistics import NormalDist
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from harness.model.history import Array
from harness.records.scores import CONFIDENCE
from harness.records.validation import FragilityCurve

STEPS: Final = 60
"""Newton steps allowed; probit likelihoods are concave and take some 6 to 10 from the start used, separated ones the most."""
CONVERGED: Final = 1e-10
"""Newton stops when no coefficient moves by more than this of the largest, or of one; the next step would be rounding."""


@dataclass(frozen=True, eq=False)
class Fragility:
    """P(overturned | x) = Φ(ln(x/median)/dispersion), with the covariance of (intercept, slope) of its linear predictor.

    `separated`: every case that fell was stronger than every one that stood, so that no likelihood has a maximum; `median` is
    then halfway (in the logarithm) between the two that bound it, dispersion 0 and the covariance None. With one class only
    the median is None and nothing can be said beyond `fell` of `cases`.
    """

    cases: int
    fell: int
    median: float | None
    dispersion: float | None
    separated: bool
    bounds: tuple[float, float] | None
    covariance: Array | None

    def probability(self, intensity: ArrayLike) -> Array:
        """P at intensities > 0; NaN where nothing can be said."""
        x = np.asarray(intensity, dtype=np.float64)
        if self.median is None:
            return np.full(x.shape, np.nan)
        if not self.dispersion:
            return np.where(x < self.median, 0.0, 1.0)
        return _phi(np.log(x / self.median) / self.dispersion)

    def band(self, intensity: ArrayLike, confidence: float = CONFIDENCE) -> tuple[Array, Array]:
        """Pointwise confidence band of P from the Fisher information; 0…1 inside the gap where the classes are separated."""
        x = np.asarray(intensity, dtype=np.float64)
        if self.median is None:
            return np.zeros(x.shape), np.ones(x.shape)
        if self.covariance is None or not self.dispersion:
            low, high = self.bounds or (self.median, self.median)
            return np.where(x < high, 0.0, 1.0), np.where(x <= low, 0.0, 1.0)
        design = np.stack((np.ones_like(x), np.log(x)), axis=-1)
        spread = np.sqrt(np.einsum("...i,ij,...j->...", design, self.covariance, design))
        middle = np.log(x / self.median) / self.dispersion
        z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
        return _phi(middle - z * spread), _phi(middle + z * spread)

    def curve(self, intensity: ArrayLike) -> FragilityCurve:
        """The record, with the curve and its band at intensities."""
        low, high = self.band(intensity)
        probability = [None if math.isnan(p) else p for p in self.probability(intensity).tolist()]
        return FragilityCurve(
            cases=self.cases,
            fell=self.fell,
            median=self.median,
            dispersion=self.dispersion,
            separated=self.separated,
            bounds=self.bounds,
            intensity=np.asarray(intensity).tolist(),
            probability=probability,
            low=low.tolist(),
            high=high.tolist(),
        )


def fit(intensity: ArrayLike, fell: ArrayLike) -> Fragility:
    """Fit a lognormal fragility curve to cases of one intensity and one outcome each (shape (n,)).

    Maximum likelihood of the Bernoulli outcomes (Baker, Earthquake Spectra 31, 2015), by Newton on the probit's concave
    likelihood. Raises `ValueError` for intensities that are not positive and finite, or no case.
    """
    x, y = np.asarray(intensity, dtype=np.float64).ravel(), np.asarray(fell, dtype=np.float64).ravel()
    if x.size == 0 or x.size != y.size or not np.all(np.isfinite(x) & (x > 0.0)):
        raise ValueError(f"positive intensities, one for each outcome, wanted; got {x.size} for {y.size} outcomes")
    total = int(y.sum())
    if total in (0, x.size):
        return Fragility(x.size, total, None, None, False, None, None)
    low, high = float(x[y == 0].max()), float(x[y == 1].min())
    if low <= high:
        return Fragility(x.size, total, math.sqrt(low * high), 0.0, True, (low, high), None)
    logs = np.log(x)
    centre = float(logs.mean())
    beta, information = probit(np.column_stack((np.ones_like(logs), logs - centre)), y)
    back = np.array([[1.0, -centre], [0.0, 1.0]])
    intercept, slope = (back @ beta).tolist()
    if slope <= 0.0:
        # Stronger motions overturn less often here: no fragility curve rises through these cases.
        return Fragility(x.size, total, None, None, False, None, None)
    return Fragility(
        x.size,
        total,
        math.exp(-intercept / slope),
        1.0 / slope,
        False,
        None,
        back @ np.linalg.inv(information) @ back.T,
    )


def probit(design: Array, y: Array, ridge: float = 0.0) -> tuple[Array, Array]:
    """Coefficients (k,) of greatest likelihood of P = Φ(design β), design (n, k) with its constant first, and the information
    (k, k) there; by damped Newton steps. A `ridge` on the coefficients keeps them finite where a line parts the outcomes."""
    beta = np.zeros(design.shape[1])
    beta[0] = NormalDist().inv_cdf(float(y.mean()))
    information = np.eye(beta.size)

    def value(at: Array) -> float:
        return _probit_terms(design @ at, y)[2] - 0.5 * ridge * float(at @ at)

    for _ in range(STEPS):
        gradient, weight, _ = _probit_terms(design @ beta, y)
        information = design.T @ (weight[:, None] * design) + ridge * np.eye(beta.size)
        step = np.linalg.solve(information, design.T @ gradient - ridge * beta)
        while value(beta + step) < value(beta) - 1e-12 * y.size:
            step = 0.5 * step
        beta = beta + step
        if np.max(np.abs(step)) < CONVERGED * max(1.0, float(np.max(np.abs(beta)))):
            break
    return beta, information


def _probit_terms(eta: Array, y: Array) -> tuple[Array, Array, float]:
    """First derivative of each case's log-likelihood under P = Φ(η), minus the second, and the sum of all."""
    from scipy.special import log_ndtr

    sign = 2.0 * y - 1.0
    signed = sign * eta
    logs = log_ndtr(signed)
    mills = np.exp(-0.5 * signed**2 - 0.5 * math.log(2.0 * math.pi) - logs)
    return sign * mills, mills * (mills + signed), float(np.sum(logs))


def _phi(x: Array) -> Array:
    from scipy.special import ndtr

    values: Array = ndtr(x)
    return values
