"""The impact at a change of pivot (docs/model.md, section 3), for corners of any height, and landing on a facet.

All impulses act at the new corner, so the statue keeps its angular momentum about it (or the prescribed ratio replaces that law);
the whole keeps its horizontal momentum but for the floor's friction, and X of either corner has its own sign.
"""

from typing import Final

from analytic.kernel.compiler import inlined, jit, load_double
from analytic.kernel.dynamics import corner, start_series
from analytic.kernel.records import IMPACT, Params, Task
from analytic.kernel.track import change_state, note_impact


@jit
def _slid(
    m: float,
    total: float,
    jn: float,
    jc: float,
    xn: float,
    xo: float,
    z: float,
    omega: float,
    rate: float,
    ratio: float,
    k: float,
) -> tuple[float, float]:
    """θ̇⁺ and u̇⁺ when the floor gives P_f = −k P_n, k = σμ_k."""
    # horizontal balance with P_f = −k P_n: M (u̇⁺ − u̇⁻) = m (z − k xo) θ̇⁻ − m (z − k xn) θ̇⁺
    lever_new, lever_old = m * (z - k * xn), m * (z - k * xo)
    if ratio >= 0.0:
        after = ratio * omega
    else:  # the same put into J_n θ̇⁺ + m z u̇⁺ = J_c θ̇⁻ + m z u̇⁻
        pull = m * z / total
        after = omega * (jc - pull * lever_old) / (jn - pull * lever_new)
    return after, rate + (lever_old * omega - lever_new * after) / total


@jit
def both_corners(
    m: float, total: float, xo: float, z: float, omega: float, rate: float, mu: float, mu_k: float
) -> tuple[float, float, float]:
    """θ̇⁺ = 0: both corners hold; the pedestal stops if friction can stop it."""
    normal = abs(m * xo * omega)
    momentum = total * rate + m * z * omega
    if abs(momentum) <= mu * normal:
        return 0.0, 0.0, normal
    sign = 1.0 if momentum > 0.0 else -1.0
    after = momentum - sign * mu_k * normal
    return 0.0, (after / total if after * sign > 0.0 else 0.0), normal


@jit
def impact(
    params: Params, xn: float, xo: float, z: float, omega: float, rate: float, mu: float, mu_k: float
) -> tuple[float, float, float]:
    """θ̇⁺ in rad/s, u̇⁺ in m/s and the vertical impulse P_n in N s at a change of pivot.

    xn, xo: horizontal distance from the new and the old corner to the centroid, m; z: its height above both, m; omega, rate:
    θ̇⁻ and u̇⁻; mu: μ_s if the pedestal was stuck, μ_k if it was sliding.
    """
    m, ratio = params.mass_kg, params.restitution
    jg = params.inertia_kg_m2
    jn, jc = jg + m * (z * z + xn * xn), jg + m * (z * z + xn * xo)
    total = m + params.pedestal_mass_kg
    if not params.has_pedestal or not params.momentum_at_impact:
        after = ratio * omega if ratio >= 0.0 else omega * (jc / jn)
        if after * omega < 0.0:
            after = 0.0
        return after, rate, m * (xo * omega - xn * after)
    # first as if friction stopped the pedestal, u̇⁺ = 0: it does where |P_f| ≤ μ P_n suffices
    held = ratio * omega if ratio >= 0.0 else (jc * omega + m * z * rate) / jn
    normal = m * (xo * omega - xn * held)
    floor = m * z * (held - omega) - total * rate
    turned = held * omega < 0.0
    if not turned and abs(floor) <= mu * normal:
        return held, 0.0, normal
    # a rate that would change its sign cannot: then both corners hold, θ̇⁺ = 0
    if turned and abs(total * rate + m * z * omega) <= mu * abs(m * xo * omega):
        return 0.0, 0.0, abs(m * xo * omega)
    # it slides on: to the side to which friction could not hold it, or to the other where that contradicts itself
    first = -1.0 if floor > 0.0 else 1.0
    for sign in (first, -first):
        after, moved = _slid(m, total, jn, jc, xn, xo, z, omega, rate, ratio, sign * mu_k)
        if moved * sign > 0.0 and after * omega >= 0.0:
            return after, moved, m * (xo * omega - xn * after)
    return both_corners(m, total, xo, z, omega, rate, mu, mu_k)


@jit
def kinetic_energy(m: float, total: float, j: float, z: float, omega: float, rate: float) -> float:
    """Kinetic energy in the floor's frame, J: j about the pivot, z the centroid's height above it."""
    return 0.5 * total * rate * rate + m * z * omega * rate + 0.5 * j * omega * omega


# Landing on a facet: the impact, and the end of chattering, a sequence of impacts of vanishing size.


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
