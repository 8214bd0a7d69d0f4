"""Many problems run in two sweeps say, to the last bit, what `certify` says of each."""

from dataclasses import astuple

import numpy as np

from analytic import Block, CommonKeywords, Form, Harmonic, Pedestal, SampledAcceleration, ZeroExcitation, certify
from analytic.problem import Problem
from analytic.sweep import Motions, body_of, certify_rows
from harness.engines.analytic import findings_of

ACCURACY_RAD = 1e-6
CASES = 60


def drawn(stream: np.random.Generator, k: int) -> tuple[Block, Motions, CommonKeywords]:
    """Blocks with and without a pedestal under formulas and records, in both forms of the model."""
    block = Block.two_corners(
        mass_kg=stream.uniform(100.0, 900.0),
        centroid_height_m=stream.uniform(0.4, 1.2),
        inertia_kg_m2=stream.uniform(50.0, 200.0),
        corner_left_m=stream.uniform(0.05, 0.4),
        corner_right_m=stream.uniform(0.05, 0.4),
    )
    noise = SampledAcceleration(np.arange(300) * 0.01, 3.0 * stream.normal(size=300))
    x = Harmonic(stream.uniform(0.5, 6.0), stream.uniform(0.5, 5.0)) if k % 2 else noise
    z = Harmonic(stream.uniform(0.5, 2.0), stream.uniform(0.5, 5.0)) if k % 5 == 0 else ZeroExcitation()
    keywords: CommonKeywords = {
        "duration_s": stream.uniform(3.0, 8.0),
        "form": Form.paper(0.9) if k % 7 == 0 else Form(),
        "gravity_m_s2": stream.uniform(9.0, 10.0),
        "statue_friction": 0.5,
    }
    if k % 3:
        pedestal = Pedestal(stream.uniform(50.0, 400.0), 1.2, 0.3)
        keywords |= {"pedestal": pedestal, "floor_static": 0.2, "floor_kinetic": 0.15}
    return block, (x, z), keywords


def test_rows_are_certified_as_single_runs() -> None:
    stream = np.random.default_rng(23)
    cases = [drawn(stream, k) for k in range(CASES)]
    still = ZeroExcitation()
    bodies = [body_of(Problem(block, still, still, **keywords), ACCURACY_RAD) for block, _, keywords in cases]
    rows = certify_rows(bodies, np.arange(CASES), [motions for _, motions, _ in cases], ACCURACY_RAD)
    warned = 0
    for k, (block, motions, keywords) in enumerate(cases):
        given: CommonKeywords = {**keywords, "dt_s": None, "skip_energy": False}
        single = certify(block, *motions, accuracy_rad=ACCURACY_RAD, base_accuracy_rad=ACCURACY_RAD, **given)
        row = rows.certified(k)
        stated = rows.uncertainty_rad[k], rows.slip_uncertainty_m[k], rows.reliable_until_s[k]
        assert stated == (single.uncertainty_rad, single.slip_uncertainty_m, single.reliable_until_s)
        assert row.outcomes == single.outcomes
        known = findings_of(single)
        assert findings_of(row) == known
        assert bool(rows.doubtful[k]) or not known
        for name in (
            "outcome",
            "end_s",
            "peak_signed_rad",
            "peak_slip_m",
            "final_slip_m",
            "overturn_time_s",
            "counts",
        ):
            assert getattr(row.solution, name) == getattr(single.solution, name), name
        np.testing.assert_array_equal(astuple(row.solution.results), astuple(single.solution.results))
        assert row.solution.validity is not None
        assert single.solution.validity is not None
        assert astuple(row.solution.validity) == astuple(single.solution.validity)
        warned += bool(known)
    assert 0 < warned < CASES, "both kinds are among them"
