"""The impact at a change of pivot (docs/model.md, section 3), for corners of any height.

All impulses act at the new corner, so the statue keeps its angular momentum about it (or the prescribed ratio replaces that law);
the whole keeps its horizontal momentum but for the floor's friction, and X of either corner has its own sign.
"""

from __future__ import annotations

from analytic.kernel.compiler import jit
from analytic.kernel.records import Params


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
    for i in range(2):
        sign = first if i == 0 else -first
        after, moved = _slid(m, total, jn, jc, xn, xo, z, omega, rate, ratio, sign * mu_k)
        if moved * sign > 0.0 and after * omega >= 0.0:
            return after, moved, m * (xo * omega - xn * after)
    return both_corners(m, total, xo, z, omega, rate, mu, mu_k)


@jit
def kinetic_energy(m: float, total: float, j: float, z: float, omega: float, rate: float) -> float:
    """Kinetic energy in the floor's frame, J: j about the pivot, z the centroid's height above it."""
    return 0.5 * total * rate * rate + m * z * omega * rate + 0.5 * j * omega * omega
