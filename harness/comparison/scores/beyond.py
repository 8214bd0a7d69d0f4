"""Two histories beyond the horizon, where no instant of one can be asked of the other: their distributions."""

from __future__ import annotations

from typing import Final

import numpy as np

from harness.comparison.scores.events import Excursions
from harness.comparison.statistics import distributions
from harness.model.history import Array
from harness.model.history_pair import Pair
from harness.records.scores import AfterHorizon, Apart, PeaksApart

LEAST_VALUES: Final = 8
"""Fewer values than this have no distribution worth a probability: a quartile would rest on two values."""
RESAMPLES: Final = 200
"""Resamples for the interval and for what chance alone gives: the 95 % quantile then rests on 10 of them."""
INSTANTS: Final = 1001
"""Equally spaced instants that stand for the rotation's distribution: a thousandth in probability."""


def after_horizon(excursions: tuple[Excursions, Excursions], both: Pair, until_s: float) -> AfterHorizon | None:
    """Distributions of the excursions' peaks and of the rotation after `until_s`; None when it is not passed.

    `peaks` holds the distances of the peaks' distributions, with their interval and what chance alone would give from 8
    excursions on (as if excursions did not depend on each other); `rotation` those of |θ| over time.
    """
    if until_s >= both.end_s:
        return None
    begin_s = max(until_s, both.start_s)
    peaks = [np.abs(each.peak_rad[each.uplift_s > begin_s]) for each in excursions]
    rotation = _rotation(both, begin_s)
    largest = [
        max(float(theta.max()), float(peak.max(initial=0.0))) for theta, peak in zip(rotation, peaks, strict=True)
    ]
    return AfterHorizon(
        from_s=begin_s,
        until_s=both.end_s,
        largest_a_rad=largest[0],
        largest_b_rad=largest[1],
        last_difference_rad=float(both.theta_a_rad[-1] - both.theta_b_rad[-1]),
        last_slip_difference_m=float(both.slip_a_m[-1] - both.slip_b_m[-1]),
        rotation=Apart(distributions.area_metric(*rotation), distributions.ks_distance(*rotation)),
        excursions_a=peaks[0].size,
        excursions_b=peaks[1].size,
        peaks=_peaks(*peaks),
    )


def _rotation(both: Pair, begin_s: float) -> tuple[Array, Array]:
    """|θ| of each at equally spaced instants, so that every one stands for the same time."""
    t_s = np.linspace(begin_s, both.end_s, INSTANTS)
    a, b = (np.abs(np.interp(t_s, both.t_s, theta)) for theta in (both.theta_a_rad, both.theta_b_rad))
    return a, b


def _peaks(a: Array, b: Array) -> PeaksApart | None:
    if min(a.size, b.size) >= LEAST_VALUES:
        scores = distributions.compare_distributions(a, b, resamples=RESAMPLES)
        return PeaksApart(
            area_rad=scores.area.value,
            area_interval_rad=scores.area,
            area_by_chance_rad=scores.area_null,
            ks=scores.ks,
            ks_p=scores.ks_p,
        )
    if min(a.size, b.size) == 0:
        return None
    return PeaksApart(area_rad=distributions.area_metric(a, b), ks=distributions.ks_distance(a, b))
