"""A symmetric block shaken along x is the planar model's, on twenty scenes."""

import math

import numpy as np
import pytest

import analytic
from analytic import spatial
from analytic.block import GRAVITY_M_S2 as GRAVITY
from tests.budgets_spatial import AUDIT, IMPULSE, PLANAR_RAD


def scene(k: int) -> tuple[tuple[float, float, float, float], analytic.Excitation, analytic.Excitation | None]:
    """Mass, width, depth, height; motion along x and z."""
    rng = np.random.default_rng(100 + k)
    width, depth, mass = rng.uniform(0.2, 0.6), rng.uniform(0.2, 0.8), rng.uniform(50.0, 900.0)
    height = width * rng.uniform(2.0, 5.0)
    amplitude, frequency = GRAVITY * width / height * rng.uniform(1.05, 2.0), rng.uniform(1.0, 4.0)
    motions = (
        analytic.Harmonic(amplitude, frequency),
        analytic.Pulse("one_sine", 1.5 * amplitude, 1.0 / frequency, 0.1),
        analytic.SampledAcceleration(np.arange(40) * 0.05, amplitude * rng.normal(size=40)),
        analytic.Harmonic(amplitude, frequency, 0.3, 0.5),
        analytic.Pulse("ricker", 2.0 * amplitude, 3.0 / frequency, 0.05),
    )
    vertical = analytic.Harmonic(3.0, 1.3 * frequency) if k % 3 == 0 else None
    return (mass, width, depth, height), motions[k % 5], vertical


@pytest.mark.parametrize("k", range(20))
def test_it_rocks_as_in_the_plane(k: int) -> None:
    (mass, width, depth, height), along, vertical = scene(k)
    flat = analytic.Block.rectangle(width_m=width, height_m=height, mass_kg=mass)
    planar = analytic.simulate(flat, along, vertical, duration_s=2.0, dt_s=0.01)
    body = spatial.Body.block(mass, width, depth, height)
    run = spatial.simulate(body, along, None, vertical, duration_s=2.0, friction_static=math.inf, dt_out_s=0.01)
    # The planar outcome may follow from the energy that is left at the end; this model says only what has happened by then.
    fell = planar.overturn_time_s is not None and planar.overturn_time_s <= planar.t_s[-1]
    assert fell == (run.outcome is spatial.Outcome.OVERTURNED)
    theta = 2.0 * np.arctan2(run.quaternion_wxyz[:, 2], run.quaternion_wxyz[:, 0])
    size = min(theta.size, planar.theta_rad.size) - 1
    assert size >= 50
    np.testing.assert_allclose(theta[:size], planar.theta_rad[:size], atol=PLANAR_RAD)
    assert np.abs(planar.theta_rad).max() > 1e-3
    assert run.energy_residual < AUDIT
    assert run.momentum_residual < AUDIT
    assert np.abs(run.position_m[:, 1]).max() < IMPULSE
