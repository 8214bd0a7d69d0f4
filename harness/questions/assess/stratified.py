"""An engine's probability of overturning from few runs of its own: strata by what the analytic model says of each draw.

The model's answer to a draw costs nothing beside an engine's, and tells much of it. The draws are divided by the model's answer
into strata of known weight; the engine is run on some draws of each; P = Σ w_h p_h (Cochran, Sampling Techniques, ch. 5). The
estimate is unbiased whatever the model says: a wrong model costs runs, not truth. Runs go where w_h √(p_h (1 − p_h)) is largest
(Neyman).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from statistics import NormalDist
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.questions.assess.model_draws import ModelDraws
from harness.records.assess import Assessment

Ints = NDArray[np.int64]

SAFE_SHARE: Final = 0.6
"""Peak rotation of the model, over α, below which its statue is far from falling: a stratum of its own."""
PILOT: Final = 10
"""Runs of every stratum before any is judged."""
LEVEL: Final = 0.90
"""Level of every interval: what decides about a statue is asked to ± 0.05 at 90 %."""

Runs = Callable[[Sequence[int]], Sequence[bool | None]]
"""From numbers of draws to whether the engine's statue overturned in each; None where the run failed."""


def strata_of(model: ModelDraws) -> Ints:
    """Number of each draw's stratum, shape (n,): far from falling, near it (or not decided), overturned."""
    near = ~model.overturned & ((model.peak_share >= SAFE_SHARE) | ~model.decided)
    return np.where(model.overturned, 2, np.where(near, 1, 0))


def estimate(model: ModelDraws, run: Runs, *, half_width: float, most_runs: int, batch: int) -> Assessment:
    """Run the engine on draws until the interval's half width is reached, or `most_runs` are made."""
    strata = strata_of(model)
    queues = [np.flatnonzero(strata == h).tolist() for h in range(3)]
    weights = [len(queue) / strata.size for queue in queues]
    tally = _Tally(weights)
    tally.add(run, [(h, queues[h].pop(0)) for h in range(3) for _ in range(min(PILOT, len(queues[h])))])
    while tally.runs < most_runs and tally.half_width > half_width:
        picks: list[tuple[int, int]] = []
        pending = [0, 0, 0]
        for _ in range(min(batch, most_runs - tally.runs)):
            h = tally.neediest(pending, [bool(queue) for queue in queues])
            if h is None:
                break
            pending[h] += 1
            picks.append((h, queues[h].pop(0)))
        if not picks:
            break
        tally.add(run, picks)
    return tally.estimate(strata.size)


def jeffreys(fell: int, runs: int, level: float = LEVEL) -> tuple[float, float, float]:
    """The share that fell of so many runs (a half of none), and its interval at a level (Jeffreys)."""
    from scipy.special import betaincinv

    tail, missed = 0.5 - 0.5 * level, runs - fell
    low = float(betaincinv(fell + 0.5, missed + 0.5, tail)) if fell else 0.0
    high = float(betaincinv(fell + 0.5, missed + 0.5, 1.0 - tail)) if missed else 1.0
    return fell / runs if runs else 0.5, low, high


class _Tally:
    """Runs and falls of each stratum."""

    def __init__(self, weights: Sequence[float]) -> None:
        self.weights, self.runs, self.undecided = list(weights), 0, 0
        self.decided, self.fell = [0] * len(weights), [0] * len(weights)

    def add(self, run: Runs, picks: Sequence[tuple[int, int]]) -> None:
        """Run the engine on these draws and count."""
        for (h, _), fell in zip(picks, run([draw for _, draw in picks]), strict=True):
            self.runs += 1
            if fell is None:
                self.undecided += 1
            else:
                self.decided[h] += 1
                self.fell[h] += fell

    def neediest(self, pending: Sequence[int], left: Sequence[bool]) -> int | None:
        """The stratum in which one more run takes most off the variance; None where no draw is left."""
        gains = [
            w**2 * self._spread(h) / ((n := self.decided[h] + pending[h] + 1) * (n + 1)) if left[h] else -1.0
            for h, w in enumerate(self.weights)
        ]
        h = int(np.argmax(gains))
        return h if gains[h] > 0.0 else None

    def _spread(self, h: int) -> float:
        """p (1 − p) of a stratum, p drawn towards a half by two runs (Agresti and Coull): never nothing, however few the runs."""
        p = (self.fell[h] + 1.0) / (self.decided[h] + 2.0)
        return p * (1.0 - p)

    @property
    def half_width(self) -> float:
        """Half width at which runs end, of a normal interval: wider than the one told, so what fell so far moves the end less."""
        variance = sum(w**2 * self._spread(h) / max(self.decided[h], 1) for h, w in enumerate(self.weights) if w > 0.0)
        return NormalDist().inv_cdf(0.5 + 0.5 * LEVEL) * math.sqrt(variance)

    def _interval(self) -> tuple[float, float]:
        """The interval of Σ w p_h from those of each p_h (Jeffreys), their arms added as squares (Zou, Huang and Zhang 2009)."""
        weights = np.array(self.weights)
        share, low, high = np.array([jeffreys(*each) for each in zip(self.fell, self.decided, strict=True)]).T
        middle = float(weights @ share)
        below, above = (math.hypot(*(weights * arms)) for arms in (share - low, high - share))
        return max(middle - below, 0.0), min(middle + above, 1.0)

    def estimate(self, draws: int) -> Assessment:
        """The probability so far, of so many draws; no number where every run came to no end."""
        known = [(w, self.fell[h] / self.decided[h]) for h, w in enumerate(self.weights) if self.decided[h]]
        p = sum(w * share for w, share in known) / sum(w for w, _ in known) if known else math.nan
        low, high = self._interval() if known else (0.0, 1.0)
        undecided = self.undecided / self.runs
        low, high = low * (1.0 - undecided), high + undecided * (1.0 - high)
        return Assessment(p, min(low, p), max(high, p), LEVEL, draws, self.runs, undecided)
