"""Impacts that come by turns, ever smaller, are dropped at every local error; a slow slide turns and stops: the run goes on."""

from typing import Final

import numpy as np
import pytest

import analytic
from analytic import spatial
from analytic.block import GRAVITY_M_S2 as GRAVITY
from tests import budgets_spatial as budget
from tests.analytic.spatial.test_variety import drawn

FRICTION: Final = 0.4
BODY: Final = spatial.Body.block(400.0, 0.35, 0.45, 1.1)
LONG_S: Final = 2.0
COARSE: Final = 1e-7
"""Local error of a run for its outcome: the finest ones of these scenes take up to a million steps."""
SCENES: Final = (
    (2.0, 1.0 / 0.6, 0.9158),
    (2.0, 1.0 / 0.7, 0.9158),
    (2.0, 1.1, 1.2),
    (2.0, 1.7, 1.1053),
    (1.25, 1.0 / 0.7, 0.8211),
    (1.25, 1.3, 0.9632),
    (1.25, 1.1, 1.1526),
    (1.25, 1.7, 0.9158),
    (1.0, 1.1, 0.7737),
    (1.5, 1.0 / 0.7, 0.7737),
    (1.5, 1.3, 1.1526),
    (1.5, 1.1, 0.7737),
)
"""Frequencies of one sine along x and y, Hz, and their factor. Each once ended as a paradox at one local error or another."""

LOCAL_ERRORS = (1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)


def between_two_feet() -> spatial.Problem:
    """A block that slides on one foot while the other strikes, slips and sticks again: at the end one sticks and one slides."""
    body = spatial.Body(
        400.0,
        np.diag([73.92, 72.0, 8.74666667]),
        [(-0.15, -0.2, -0.7), (0.17, -0.2, -0.7), (0.17, 0.2, -0.7), (-0.15, 0.2, -0.7)],
    )
    x = analytic.Pulse("one_sine", 3.662226580835672, 0.7)
    y = analytic.Pulse("one_sine", 3.3731034297170663, 0.9, 0.2)
    return spatial.Problem(body, 2.0, 0.35375692298739403, None, x, y, gravity_m_s2=GRAVITY)


@pytest.mark.parametrize("tolerance", LOCAL_ERRORS)
def test_a_foot_that_slips_at_each_smaller_impact_comes_to_stick(tolerance: float) -> None:
    """Dropping rebounds alone, the impact's own slip was kept: stick, fall of rounding, impact, slip, every 0.13 µs."""
    run = spatial.solve(between_two_feet(), tolerance=tolerance)
    assert not run.gave_up
    assert run.outcome is spatial.Outcome.OVERTURNED
    assert run.work.steps + run.work.rejected < budget.SEQUENCE_STEPS


@pytest.mark.parametrize("seed", [945, 1467, 2267])
def test_a_dropped_rebound_pushes_no_other_vertex_down(seed: int) -> None:
    """Coarse runs let a vertex be pushed down by what was slower than their slowest sliding: it struck again every 10 ns."""
    run = spatial.solve(drawn(seed), tolerance=1e-7, dt_out_s=None)
    assert not run.gave_up
    assert run.work.steps + run.work.rejected < budget.SEQUENCE_STEPS


def test_a_vertex_that_slides_about_another_stops_where_it_would_turn_round() -> None:
    """Taken for a turn of its direction, its friction went on as before and drove it: steps of 1 µs without end."""
    rng = np.random.default_rng(3846)
    body = spatial.Body.block(400.0, rng.uniform(0.2, 0.5), rng.uniform(0.25, 0.6), rng.uniform(0.7, 1.6))
    x, y = (analytic.Pulse("one_sine", rng.uniform(0.15, 0.6) * GRAVITY, rng.uniform(0.4, 1.2)) for _ in range(2))
    run = spatial.solve(
        spatial.Problem(body, 3.0, rng.uniform(0.1, 1.0), None, x, y, gravity_m_s2=GRAVITY),
        tolerance=1e-7,
        dt_out_s=None,
    )
    assert not run.gave_up
    assert run.work.steps + run.work.rejected < budget.SEQUENCE_STEPS


def problem(x_hz: float, y_hz: float, factor: float) -> spatial.Problem:
    """One sine of 0.4 g along x and one of 0.35 g along y, both times the factor."""
    x, y = (
        analytic.Pulse("one_sine", amplitude * factor * GRAVITY, 1.0 / hz)
        for amplitude, hz in ((0.4, x_hz), (0.35, y_hz))
    )
    return spatial.Problem(BODY, LONG_S, FRICTION, None, x, y, gravity_m_s2=GRAVITY)


@pytest.mark.parametrize("scene", SCENES)
def test_a_mode_is_possible_all_the_time(scene: tuple[float, float, float]) -> None:
    """At a coefficient of 0.4 these bodies are far from Painlevé's paradox: a run must reach its end, and there rest."""
    run = spatial.solve(problem(*scene), tolerance=COARSE, dt_out_s=None)
    assert run.outcome is spatial.Outcome.STANDS
    assert run.intervals[-1].mode is spatial.Mode.REST
    assert not run.gave_up


def test_a_run_is_given_up_after_the_steps_that_it_may_take() -> None:
    run = spatial.solve(between_two_feet(), most_steps=300, dt_out_s=None)
    assert run.gave_up
    assert run.work.steps + run.work.rejected == pytest.approx(300, abs=1)
    assert run.end_s < 2.0
    certified = spatial.certify(between_two_feet(), most_steps=300)
    assert not certified.complete
