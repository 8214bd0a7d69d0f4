"""Balances on bodies and starts of every kind: slender and squat, three to twelve vertices, tilted, spinning, unsymmetric."""

import math
from typing import Final

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import analytic
from analytic import spatial
from analytic.block import GRAVITY_M_S2 as GRAVITY
from analytic.spatial import solver
from tests import budgets_spatial as budget

DURATION_S: Final = 1.5
SEEDS: Final = (0, 1, 2, 3, 4, 5, 6, 8, 9, 11, 12, 14, 15, 17, 18, 21)


def drawn_body(rng: np.random.Generator, vertices: int) -> spatial.Body:
    """A body with products of inertia on a convex polygon that need not be level or have its centroid in the middle."""
    slender = rng.uniform(2.0, 8.0)
    angles = (
        np.sort(rng.uniform(0.0, 2.0 * math.pi / vertices, vertices)) + np.arange(vertices) * 2.0 * math.pi / vertices
    )
    reach = rng.uniform(0.15, 0.3)
    base = reach * np.column_stack([np.cos(angles), rng.uniform(0.7, 1.3) * np.sin(angles)])
    base -= base.mean(axis=0) + 0.1 * reach * rng.uniform(-1.0, 1.0, 2)
    height = slender * reach
    points = rng.normal(size=(40, 3)) * [0.5 * reach, 0.6 * reach, 0.4 * height]
    arms = points - points.mean(axis=0)
    mass = rng.uniform(20.0, 900.0)
    inertia = mass / len(arms) * (np.sum(arms**2) * np.eye(3) - arms.T @ arms)
    return spatial.Body(mass, inertia, np.column_stack([base, np.full(vertices, -0.5 * height)]))


def drawn(seed: int) -> spatial.Problem:
    """A body under one sine in each direction, that begins tilted and spinning in two of three."""
    rng = np.random.default_rng(1000 + seed)
    body = drawn_body(rng, 3 + seed % 10)
    mu = (0.05, 0.15, 0.3, 0.5, 0.75, 1.0)[seed % 6]
    least = min(mu, float(np.min(np.hypot(*body.vertices_m[:, :2].T))) / -float(body.vertices_m[0, 2]))
    x, y = (
        analytic.Pulse("one_sine", rng.uniform(0.8, 2.5) * least * GRAVITY, rng.uniform(0.3, 0.9)) for _ in range(2)
    )
    z = analytic.Harmonic(rng.uniform(0.0, 0.3) * GRAVITY, rng.uniform(1.0, 4.0))
    start = {}
    if seed % 3:
        towards, tilt = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(0.0, 0.3) * least
        half = math.sin(0.5 * tilt)
        start = {
            "quaternion_wxyz": (math.cos(0.5 * tilt), half * math.cos(towards), half * math.sin(towards), 0.0),
            "angular_velocity_rad_s": (0.0, 0.0, rng.uniform(-1.0, 1.0)),
        }
    return spatial.Problem(body, DURATION_S, mu, (1.0, 0.8)[seed % 2] * mu, x, y, z, gravity_m_s2=GRAVITY, **start)


@pytest.mark.parametrize("seed", SEEDS)
def test_balances_hold_for_every_kind_of_body(seed: int) -> None:
    given = drawn(seed)
    assert len(ConvexHull(given.body.vertices_m[:, :2]).vertices) == len(given.body.vertices_m)
    run = spatial.solve(given, dt_out_s=0.01)
    assert run.outcome is not spatial.Outcome.FRICTION_PARADOX
    assert not run.gave_up
    assert run.energy_residual < budget.AUDIT
    assert run.momentum_residual < budget.AUDIT
    assert run.cone_residual < budget.IMPULSE
    assert run.gap_m.min() > -budget.IMPULSE
    assert all(event.energy_lost_j >= -budget.IMPULSE * given.body.mass_kg for event in run.impacts)


@pytest.mark.parametrize("vertices", [16, 200])
def test_a_base_of_many_vertices_rolls_over_them(vertices: int) -> None:
    """A leaning drum rolls round its rim from vertex to vertex: only those at the floor enter the equations."""
    angles = (np.arange(vertices) + 0.5) * 2.0 * math.pi / vertices
    rim = np.column_stack([0.25 * np.cos(angles), 0.25 * np.sin(angles), np.full(vertices, -0.4)])
    body = spatial.Body(200.0, np.diag([14.0, 14.0, 6.0]), rim)
    half = 0.1
    run = spatial.simulate(
        body,
        duration_s=0.4,
        friction_static=0.8,
        quaternion_wxyz=(math.cos(half), 0.0, math.sin(half), 0.0),
        angular_velocity_rad_s=(0.3, 0.0, 0.0),
        gravity_m_s2=GRAVITY,
        dt_out_s=0.01,
    )
    assert run.impacts
    assert run.outcome is not spatial.Outcome.FRICTION_PARADOX
    assert not run.gave_up
    assert run.energy_residual < budget.AUDIT
    assert run.momentum_residual < budget.AUDIT
    assert run.gap_m.min() > -budget.IMPULSE


@pytest.mark.parametrize("seed", [214, 222, 352, 366, 425, 663, 871, 1153, 1447, 1455])
def test_what_friction_held_begins_to_slide_in_a_direction(seed: int) -> None:
    """At the limit of friction the equations have two solutions side by side, or one that no start led to: none was found."""
    rng = np.random.default_rng(seed)
    body = drawn_body(rng, 15)
    least = float(np.min(np.hypot(*body.vertices_m[:, :2].T))) / -float(body.vertices_m[0, 2])
    x, y = (analytic.Harmonic(rng.uniform(1.0, 2.0) * least * 9.81, rng.uniform(2.0, 6.0)) for _ in range(2))
    shaken = spatial.Problem(body, 0.1, rng.uniform(0.6, 1.0), None, x, y, gravity_m_s2=9.81)
    run = spatial.solve(shaken, tolerance=1e-10, dt_out_s=0.01)
    assert run.outcome is not spatial.Outcome.FRICTION_PARADOX
    assert run.energy_residual < budget.AUDIT
    assert run.gap_m.min() > -budget.IMPULSE


def test_a_run_with_more_events_than_rows_is_repeated_with_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = spatial.solve(drawn(4), dt_out_s=0.01)
    runs: list[int] = []
    monkeypatch.setattr(solver, "run_all", lambda *told, run=solver.run_all: (runs.append(1), run(*told)))
    assert spatial.solve(drawn(4), dt_out_s=0.01).events
    assert len(runs) == 1
    monkeypatch.setattr(solver, "ROWS", 2)
    again = spatial.solve(drawn(4), dt_out_s=0.01)
    assert len(runs) == 3
    assert [event.time_s for event in again.events] == [event.time_s for event in whole.events]
    assert len(again.events) > solver.ROWS


def test_counting_what_else_was_possible_changes_nothing() -> None:
    """Of a base of eight vertices, at whose choices another motion was possible thrice."""
    counted, plain = (spatial.solve(drawn(25), dt_out_s=0.01, ties=ties) for ties in (True, False))
    assert counted.ambiguous_states > plain.ambiguous_states == 0
    assert plain.position_m.tobytes() == counted.position_m.tobytes()
    assert [event.time_s for event in plain.events] == [event.time_s for event in counted.events]
