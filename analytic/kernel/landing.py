"""Landing on a facet: the impact, and the end of chattering, a sequence of impacts of vanishing size."""

from __future__ import annotations

from typing import Final

from analytic.kernel.codes import IMPACT
from analytic.kernel.compiler import inlined, jit
from analytic.kernel.impact import both_corners, impact, kinetic_energy
from analytic.kernel.joint_state import corner, start_series
from analytic.kernel.memory import load_double
from analytic.kernel.records import Task
from analytic.kernel.track import change_state
from analytic.kernel.validity import note_impact

Lever = tuple[int, float, float]
"""Side of a corner, X of the centroid from it, and the statue's inertia about it."""
STILL: Final = 1e-15
"""Statue and pedestal stand when their velocities are this share of gravity times the statue's time constant: what follows would
come within what the clock resolves."""


@inlined
def _drops(task: Task, omega: float, rate: float, z: float, own: Lever, other: Lever) -> bool:
    """Whether the rebound that starts at omega is too low to matter, by the smaller of the moments that hold the statue down."""
    start_series(task)
    gravity, accel = task.series.gravity[0], task.series.floor_accel[0]
    if task.params.has_pedestal and rate != 0.0:
        accel = -(task.params.floor_kinetic * gravity) if rate > 0.0 else task.params.floor_kinetic * gravity
    # J θ̇²/2 lifts the statue until the moment that holds it down, about m (g_e b − A h), has done as much work
    lift = 0.5 * omega * omega
    for side, x, j in (own, other):
        hold = -side * task.params.mass_kg * (gravity * x - accel * z)
        if hold <= 0.0 or lift * j >= task.params.rest_rad * hold:
            return False
    return True


@jit
def land(task: Task, facet: int, residual: float) -> None:
    """Apply the impact on the facet (docs/model.md, section 3), or rest when the rebound is too small to matter."""
    params, state, results, counts = task.params, task.state, task.results, task.counts
    m, total = params.mass_kg, params.mass_kg + params.pedestal_mass_kg
    old_side = 1 if state.pivot == facet + 1 else -1
    xo, z, jo = corner(task, facet, old_side)
    xn, _, jn = corner(task, facet, -old_side)
    omega, rate, stuck = state.theta_rate_rad_s, state.slip_rate_m_s, state.slide == 0
    mu = params.floor_static if stuck else params.floor_kinetic
    mu_k = params.floor_impact if stuck else params.floor_kinetic
    after, moved, normal = impact(params, xn, xo, z, omega, rate, mu, mu_k)
    state.theta_rad, state.facet = load_double(task.base.facets, facet), facet
    # Noted as they are: what is dropped below is a sequence of such impacts, no single one that stops the statue at once.
    pushed, pressed, moved_by = m * ((moved - rate) + z * (after - omega)), normal, moved - rate
    if after != 0.0 and _drops(task, after, moved, z, (old_side, xo, jo), (-old_side, xn, jn)):
        counts.dropped_rebounds += 1
        after, moved = 0.0, rate
        # a stuck pedestal stays stuck: the push of a dropped rebound would start a slip as small, that ends in another impact
        if params.has_pedestal and params.momentum_at_impact and not stuck:
            after, moved, _ = both_corners(m, total, xo, z, omega, rate, mu, mu_k)
    if max(abs(after) * z, abs(moved)) <= STILL * params.gravity_m_s2 * params.time_scale_s:
        # where each stick onset lifts the statue, whose landing pushes the pedestal again, for ever
        after, moved = 0.0, 0.0
    state.theta_rate_rad_s, state.slip_rate_m_s = after, moved
    counts.impacts += 1
    change = kinetic_energy(m, total, jn, z, after, moved) - kinetic_energy(m, total, jo, z, omega, rate)
    results.energy_gained_j += max(change, 0.0)
    results.energy_lost_j += max(-change, 0.0)
    new = facet if old_side > 0 else facet + 1
    if params.keep_validity:
        note_impact(task, new, pushed, pressed, moved_by)
    state.pivot = new if after != 0.0 else -1
    state.slide = 0
    change_state(task, IMPACT, omega, rate, after == 0.0, change, residual)
