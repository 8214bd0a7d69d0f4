"""Scores of events: matched uplifts and impacts, what numerical errors change in them, excursions beyond the horizon."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness import statistics
from harness.history import Array
from harness.scores import energy, events
from harness.verdict import Side


def event_scores(a: events.Excursions, b: events.Excursions, inertia: energy.RockingInertia | None) -> dict[str, Any]:
    """Matched uplifts and impacts of two histories, and the energy that each matched impact takes."""
    rise_a, rise_b = a.from_rest, b.from_rest
    uplifts = events.match(
        a.uplift_s[rise_a], a.side[rise_a], a.length_s[rise_a], b.uplift_s[rise_b], b.side[rise_b], b.length_s[rise_b]
    )
    down_a, down_b = a.landed, b.landed
    times_a, times_b = a.impact_s[down_a], b.impact_s[down_b]
    # An impact is the same one when it is off by less than half the excursion that it ends.
    impacts = events.match(
        times_a, a.side[down_a], 0.5 * a.length_s[down_a], times_b, b.side[down_b], 0.5 * b.length_s[down_b]
    )
    index_a, index_b = np.flatnonzero(down_a)[impacts.index_a], np.flatnonzero(down_b)[impacts.index_b]
    share_a, share_b = energy.share_lost(a, inertia)[index_a], energy.share_lost(b, inertia)[index_b]
    return {
        "uplift_time_differences_s": _list(a.uplift_s[rise_a][uplifts.index_a] - b.uplift_s[rise_b][uplifts.index_b]),
        "uplifts_alone_a": uplifts.alone_a,
        "uplifts_alone_b": uplifts.alone_b,
        "impact_times_a_s": _list(times_a[impacts.index_a]),
        "impact_time_differences_s": _list(times_a[impacts.index_a] - times_b[impacts.index_b]),
        "impacts_alone_a": impacts.alone_a,
        "impacts_alone_b": impacts.alone_b,
        "impact_energy_share_lost_a": _list(share_a),
        "impact_energy_share_lost_b": _list(share_b),
        "impact_energy_lost_a_j": None if inertia is None else _list(energy.lost_j(a, inertia)[index_a]),
        "impact_energy_lost_b_j": None if inertia is None else _list(energy.lost_j(b, inertia)[index_b]),
    }


def after_horizon(
    found: tuple[events.Excursions, events.Excursions], until_s: float, end_s: float
) -> dict[str, Any] | None:
    """Distributions of the excursions' peaks after the horizon; None when the horizon is not passed."""
    if until_s >= end_s:
        return None
    peaks = [np.abs(each.peak_rad[each.uplift_s > until_s]) for each in found]
    record: dict[str, Any] = {"from_s": until_s, "excursions_a": peaks[0].size, "excursions_b": peaks[1].size}
    if all(each.size for each in peaks):
        record["peaks_area_metric_rad"] = statistics.area_metric(*peaks)
        record["peaks_ks"] = statistics.ks_distance(*peaks)
    return record


def numerical_uncertainty(
    sides: tuple[Side, Side], peak_b_rad: float, found: tuple[events.Excursions, events.Excursions], lever_m: float
) -> dict[str, Any]:
    """What the stated numerical errors can change in each score, while they hold; None where one is not stated.

    A rotation known to u moves a root mean square and a difference of peaks by at most u_a + u_b, an impact by u/|θ̇⁻|.
    """
    u_a, u_b = sides[0].uncertainty_rad, sides[1].uncertainty_rad
    joint = None if u_a is None or u_b is None else u_a + u_b
    rates = [np.abs(each.rate_before_rad_s[each.landed]) for each in found]
    slowest = [float(each.min()) if each.size else None for each in rates]
    times = [u / rate if u is not None and rate else None for u, rate in zip((u_a, u_b), slowest, strict=True)]
    return {
        "rms_theta_rad": joint,
        "largest_difference_rad": joint,
        "peak_theta_a_rad": u_a,
        "peak_theta_b_rad": u_b,
        "peak_ratio": joint / abs(peak_b_rad) if joint is not None and peak_b_rad else None,
        "rms_slip_m": None if joint is None else joint * lever_m,
        "impact_times_a_s": times[0],
        "impact_times_b_s": times[1],
    }


def _list(values: Array) -> tuple[float, ...]:
    return tuple(values.tolist())
