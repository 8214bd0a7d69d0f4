"""Closed-form answers: free rocking, rectangular pulses, Newmark sliding, similarity, a cylinder rolling on its rim.

They are exact for what each one states, and are what the event-driven model is held against. One-sine and one-cosine
pulses on the linearised block are in `analytic.pulse_response`.

A block 0.2 m wide and 1 m high: its first impact after a start at half its balance angle, what the impact keeps, and how far
a block slides under one rectangular pulse of 0.3 g and 0.4 s at a friction of 0.15:

>>> import math
>>> alpha, radius = math.atan2(0.1, 0.5), math.hypot(0.1, 0.5)
>>> p = frequency_parameter_rad_s(1.0, radius, radius**2 / 3.0)
>>> print(f"{quarter_period_s(0.5 * alpha, alpha, p):.5f} s")
0.34709 s
>>> print(f"{rectangle_ratio(alpha):.4f}")
0.9423
>>> print(f"{1e3 * rectangular_pulse_slip_m(0.3 * 9.81, 0.4, 0.15):.1f} mm")
235.4 mm
"""

import math
from dataclasses import dataclass
from typing import final

from analytic.block import GRAVITY_M_S2, positive, require

# --- free rocking ---------------------------------------------------------------------------------------------------


def frequency_parameter_rad_s(
    mass_kg: float, radius_m: float, inertia_kg_m2: float, gravity_m_s2: float = GRAVITY_M_S2
) -> float:
    """p = √(m g R / J), J about the pivot = inertia_kg_m2 + m R² (Housner 1963, eq. 3)."""
    positive(mass_kg=mass_kg, radius_m=radius_m, inertia_kg_m2=inertia_kg_m2, gravity_m_s2=gravity_m_s2)
    return math.sqrt(mass_kg * gravity_m_s2 * radius_m / (inertia_kg_m2 + mass_kg * radius_m**2))


def quarter_period_s(theta0_rad: float, alpha_rad: float, p_rad_s: float) -> float:
    """Time from rest at θ₀ to the impact of any block, θ̈ = −p² sin(α − θ), without linearisation.

    The energy integral ∫dθ / √(2p²[cos(α−θ) − cos(α−θ₀)]) is an elliptic integral of the first kind, taken here in Carlson's
    form from the unstable side, so that nothing cancels as θ₀ → α.
    """
    from scipy.special import elliprf

    positive(theta0_rad=theta0_rad, alpha_rad=alpha_rad, p_rad_s=p_rad_s)
    require(
        theta0_rad < alpha_rad < 0.5 * math.pi,
        "wanted 0 < theta0_rad < alpha_rad < π/2, got {!r} and {!r}; beyond α the block falls outwards",
        theta0_rad,
        alpha_rad,
    )
    complement = math.sin(0.5 * (alpha_rad - theta0_rad))
    amplitude = math.atan2(
        math.sqrt(math.sin(0.5 * theta0_rad) * math.sin(alpha_rad - 0.5 * theta0_rad)),
        math.cos(0.5 * alpha_rad) * complement,
    )
    cos2, sin2 = math.cos(amplitude) ** 2, math.sin(amplitude) ** 2
    return float(math.sin(amplitude) * elliprf(cos2, cos2 + complement**2 * sin2, 1.0)) / p_rad_s


def housner_ratio(mass_kg: float, inertia_kg_m2: float, height_m: float, b_old_m: float, b_new_m: float) -> float:
    """θ̇⁺/θ̇⁻ by angular momentum about the new corner, support held: (J_G + m(h² − b_o b_n)) / (J_G + m(h² + b_n²)).

    For unequal corners it differs in the two directions; at or below 0 the block does not rock on.
    """
    positive(mass_kg=mass_kg, inertia_kg_m2=inertia_kg_m2, height_m=height_m, b_old_m=b_old_m, b_new_m=b_new_m)
    crossed = inertia_kg_m2 + mass_kg * (height_m**2 - b_old_m * b_new_m)
    return crossed / (inertia_kg_m2 + mass_kg * (height_m**2 + b_new_m**2))


def rectangle_ratio(alpha_rad: float) -> float:
    """Housner's ratio of a homogeneous rectangle, 1 − 1.5 sin²α (Housner 1963, eq. 8, as a ratio of rates)."""
    positive(alpha_rad=alpha_rad)
    return 1.0 - 1.5 * math.sin(alpha_rad) ** 2


# --- pulses ---------------------------------------------------------------------------------------------------------


def rectangular_pulse_threshold(p_t_d: float) -> float:
    """Least a/(g α) that overturns a slender block in a rectangular pulse of length t_d: 1/(1 − exp(−p t_d)).

    At the pulse's end the linearised block must be on its unstable manifold, θ + θ̇/p = α.
    """
    positive(p_t_d=p_t_d)
    return -1.0 / math.expm1(-p_t_d)


# --- sliding without rocking ------------------------------------------------------------------------------------------


def rectangular_pulse_slip_m(
    accel_m_s2: float, duration_s: float, friction: float, gravity_m_s2: float = GRAVITY_M_S2
) -> float:
    """Total slip of a rigid block under one rectangular pulse: ½ (A − μg) t_d² A/(μg), 0 if A ≤ μg (Newmark 1965)."""
    positive(accel_m_s2=accel_m_s2, duration_s=duration_s, friction=friction, gravity_m_s2=gravity_m_s2)
    limit = friction * gravity_m_s2
    return 0.5 * max(accel_m_s2 - limit, 0.0) * duration_s**2 * accel_m_s2 / limit


@final
@dataclass(frozen=True)
class HarmonicSlip:
    """One excursion of slip under a = A sin 2πft: its start and stop (s) and its length (m, against the floor's motion)."""

    start_s: float
    stop_s: float
    slip_m: float


def harmonic_first_slip(
    accel_m_s2: float, frequency_hz: float, static: float, kinetic: float, gravity_m_s2: float = GRAVITY_M_S2
) -> HarmonicSlip | None:
    """The first excursion of a block that starts from rest, None if A ≤ μ_s g; it starts at ωt = asin(μ_s g/A).

    It stops where the velocity lost to friction equals that of the floor, (A/ω)(cos ωt₁ − cos ωt₂) = μ_k g (t₂ − t₁)
    (Newmark 1965 for a sine; the only number found by iteration is t₂).
    """
    from scipy.optimize import brentq

    positive(
        accel_m_s2=accel_m_s2, frequency_hz=frequency_hz, static=static, kinetic=kinetic, gravity_m_s2=gravity_m_s2
    )
    require(kinetic <= static, "wanted kinetic ≤ static friction, got {!r} above {!r}", kinetic, static)
    if accel_m_s2 <= static * gravity_m_s2:
        return None
    omega, limit = 2.0 * math.pi * frequency_hz, kinetic * gravity_m_s2
    start = math.asin(static * gravity_m_s2 / accel_m_s2) / omega

    def lag(t: float) -> float:
        return accel_m_s2 / omega * (math.cos(omega * start) - math.cos(omega * t)) - limit * (t - start)

    fastest = (math.pi - math.asin(limit / accel_m_s2)) / omega
    stop = float(brentq(lag, fastest, start + 2.0 * math.pi / omega, xtol=1e-15, rtol=1e-15))
    carried = math.cos(omega * start) * (stop - start) - (math.sin(omega * stop) - math.sin(omega * start)) / omega
    return HarmonicSlip(start, stop, accel_m_s2 / omega * carried - 0.5 * limit * (stop - start) ** 2)


def harmonic_steady_slip_range_m(
    accel_m_s2: float, frequency_hz: float, kinetic: float, gravity_m_s2: float = GRAVITY_M_S2
) -> float:
    """Peak-to-peak slip of steady sliding without sticking: (2A/ω²) √(1 − (πη/2)²), η = μ_k g/A.

    Raises AnalyticInputError above η = 1/√(1 + π²/4) = 0.5370, where the block sticks twice a cycle (Den Hartog 1931).
    """
    positive(accel_m_s2=accel_m_s2, frequency_hz=frequency_hz, kinetic=kinetic, gravity_m_s2=gravity_m_s2)
    eta, bound = kinetic * gravity_m_s2 / accel_m_s2, 1.0 / math.hypot(1.0, 0.5 * math.pi)
    require(eta <= bound, "wanted μ_k g/A ≤ {:.4f}, got {:.4f}; the block sticks during each cycle", bound, eta)
    return 2.0 * accel_m_s2 / (2.0 * math.pi * frequency_hz) ** 2 * math.sqrt(1.0 - (0.5 * math.pi * eta) ** 2)


# --- similarity -------------------------------------------------------------------------------------------------------


@final
@dataclass(frozen=True)
class Similarity:
    """Factors between similar problems under one gravity: the larger's number = factor × the smaller's."""

    length: float
    time: float
    frequency: float
    rate: float
    velocity: float
    acceleration: float
    mass: float
    inertia: float


def similarity(length_factor: float) -> Similarity:
    """Scaling law of rocking and sliding under one gravity and density: lengths λ, times √λ, accelerations and angles 1.

    A statue λ times larger under the same accelerations stretched by √λ in time follows the same rotations.
    """
    positive(length_factor=length_factor)
    root = math.sqrt(length_factor)
    return Similarity(length_factor, root, 1.0 / root, 1.0 / root, root, 1.0, length_factor**3, length_factor**5)


# --- three dimensions --------------------------------------------------------------------------------------------------


@final
@dataclass(frozen=True)
class RollingCylinder:
    """Steady rolling on the rim: axis tilted by a constant angle, precessing about the vertical.

    `spin_rad_s` turns the body about its axis relative to the precessing frame; `axial_rad_s` is the body's whole angular
    velocity along its axis; `friction_needed` is the ratio of horizontal to vertical force at the contact.
    """

    precession_rad_s: float
    spin_rad_s: float
    axial_rad_s: float
    centre_height_m: float
    friction_needed: float


def rolling_cylinder(
    radius_m: float,
    half_height_m: float,
    tilt_rad: float,
    *,
    path_radius_m: float = 0.0,
    gravity_m_s2: float = GRAVITY_M_S2,
) -> RollingCylinder:
    """Precession of a homogeneous cylinder (a disk for a small height) rolling without slip on its rim.

    The centroid runs on a circle of path_radius_m (0: it stays where it is, the wobbling of a settling coin), positive with the
    centroid and the contact on the same side of the vertical axis of precession. From dL/dt = r × F with ω = Ω ẑ + ν ê₃:
    Ω² [I₁ sinβ cosβ − I₃ sinβ (h sinβ − ρ)/a + m ρ (h cosβ + a sinβ)] = m g (a cosβ − h sinβ).
    For h = ρ = 0 it is Ω² = 4g/(a sinβ).
    """
    positive(radius_m=radius_m, half_height_m=half_height_m, tilt_rad=tilt_rad, gravity_m_s2=gravity_m_s2)
    a, h, rho, g = radius_m, half_height_m, path_radius_m, gravity_m_s2
    sin, cos = math.sin(tilt_rad), math.cos(tilt_rad)
    transverse, axial = (3.0 * a * a + 4.0 * h * h) / 12.0, 0.5 * a * a  # per unit mass
    righting = g * (a * cos - h * sin)
    resisting = transverse * sin * cos - axial * sin * (h * sin - rho) / a + rho * (h * cos + a * sin)
    require(
        righting > 0.0 and resisting > 0.0,
        "no steady rolling: wanted tilt_rad below atan(a/h) = {:.4f}, got {!r}",
        math.atan2(a, h),
        tilt_rad,
    )
    precession = math.sqrt(righting / resisting)
    axial_rate = precession * (h * sin - rho) / a
    return RollingCylinder(
        precession,
        axial_rate - precession * cos,
        axial_rate,
        h * cos + a * sin,
        precession**2 * abs(rho) / g,
    )
