"""Closed forms against published numbers, against quadrature, and against a reference solver that knows none of them."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from analytic import AnalyticInputError
from analytic import closed_form as cf
from tests import budgets_reference as budget
from tests.analytic import reference_kernel, reference_lagrange
from tests.analytic.reference_case import GRAVITY, Case, full_period, harmonic, rectangle


def assert_printed(value: float, printed: str) -> None:
    """Meets a printed number to its last digit."""
    unit = 10.0 ** -len(printed.partition(".")[2])
    assert abs(value - float(printed)) <= budget.PRINTED_DIGITS * unit, f"{value!r} is not {printed}"


def rectangular_block(b: float, h: float, **changes: object) -> Case:
    """A homogeneous rectangle of half width b and half height h on the floor, 1 kg."""
    return Case(1.0, h, b, b, (b * b + h * h) / 3.0, **changes)  # type: ignore[arg-type]


def sliding_block(mu: float, **changes: object) -> Case:
    """A block too squat to rock on a pedestal that slides."""
    return Case(1.0, 0.1, 2.0, 2.0, 1.0, pedestal_kg=1.0, mu_static=mu, mu_kinetic=mu, **changes)  # type: ignore[arg-type]


def quarter_period_linear_s(theta0_rad: float, alpha_rad: float, p_rad_s: float) -> float:
    """Time from rest at θ₀ to the impact, slender block: (1/p) acosh(1/(1 − θ₀/α)) (Housner 1963, eq. 5)."""
    return math.acosh(1.0 / (1.0 - theta0_rad / alpha_rad)) / p_rad_s


def first_impact_rate_rad_s(theta0_rad: float, alpha_rad: float, p_rad_s: float) -> float:
    """|θ̇| just before the impact that follows rest at θ₀: p √(2[cos(α−θ₀) − cos α]), by energy."""
    return 2.0 * p_rad_s * math.sqrt(math.sin(0.5 * theta0_rad) * math.sin(alpha_rad - 0.5 * theta0_rad))


def peak_after_impact_rad(rate_rad_s: float, alpha_rad: float, p_rad_s: float) -> float:
    """|θ| reached after leaving the support at |θ̇|: cos(α − θ) = cos α + θ̇²/2p²; inf if it goes past α (overturns)."""
    level = math.cos(alpha_rad) + 0.5 * (rate_rad_s / p_rad_s) ** 2
    return math.inf if level >= 1.0 else alpha_rad - math.acos(level)


B, H = 0.1, 0.5
ALPHA, RADIUS, INERTIA = math.atan2(B, H), math.hypot(B, H), (B * B + H * H) / 3.0
P = cf.frequency_parameter_rad_s(1.0, RADIUS, INERTIA)


def test_free_rocking_published_numbers() -> None:
    rate = first_impact_rate_rad_s(0.5 * ALPHA, ALPHA, P)
    ratio = cf.housner_ratio(1.0, INERTIA, H, B, B)
    assert_printed(cf.quarter_period_s(0.5 * ALPHA, ALPHA, P), "0.34709")
    assert_printed(rate, "0.64805")
    assert_printed(ratio, "0.9423")
    assert_printed(peak_after_impact_rad(ratio * rate, ALPHA, P) / ALPHA, "0.4222")
    assert ratio == pytest.approx(cf.rectangle_ratio(ALPHA), rel=1e-15)


def test_free_rocking_of_the_reference_solver() -> None:
    path = reference_lagrange.solve(rectangular_block(B, H, theta0=0.5 * ALPHA), 1.0, 1e-3)
    rate = first_impact_rate_rad_s(0.5 * ALPHA, ALPHA, P)
    assert path.times("impact")[0] == pytest.approx(
        cf.quarter_period_s(0.5 * ALPHA, ALPHA, P), abs=budget.REFERENCES_RAD
    )
    before = path.samples[path.samples[:, 0] < path.times("impact")[0]][-1]
    rounding = P * P * ALPHA * 1e-3  # the last sample is up to 1 ms before the impact
    assert abs(before[2]) == pytest.approx(rate, abs=rounding)
    peak = peak_after_impact_rad(cf.rectangle_ratio(ALPHA) * rate, ALPHA, P)
    assert np.max(-path.samples[:, 1]) == pytest.approx(peak, abs=0.5 * P * P * ALPHA * (0.5e-3) ** 2)


@pytest.mark.parametrize("fraction", [0.01, 0.5, 0.9, 0.999])
@pytest.mark.parametrize("alpha", [0.01, 0.2, 1.2])
def test_quarter_period_is_the_quadrature_of_the_energy_integral(fraction: float, alpha: float) -> None:
    theta0 = fraction * alpha
    start = alpha - theta0

    def integrand(x: float) -> float:  # θ = θ₀ − x² removes the end's singularity
        if x == 0.0:
            return math.sqrt(2.0 / math.sin(start))
        return x / math.sqrt(math.sin(start + 0.5 * x * x) * math.sin(0.5 * x * x))

    knee = [math.sqrt(start)] if start < theta0 else None
    time, _ = quad(integrand, 0.0, math.sqrt(theta0), epsabs=0.0, epsrel=1e-13, limit=200, points=knee)
    assert cf.quarter_period_s(theta0, alpha, 1.0) == pytest.approx(time, rel=budget.QUADRATURE_RELATIVE)


def test_slender_limit_is_the_linearised_quarter_period() -> None:
    gaps = [
        abs(cf.quarter_period_s(0.6 * a, a, 1.0) / quarter_period_linear_s(0.6 * a, a, 1.0) - 1.0)
        for a in (0.2, 0.1, 0.05)
    ]
    assert gaps[0] > 5e-4, "the two forms must differ for a stocky block"
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.05)
    assert gaps[1] / gaps[2] == pytest.approx(4.0, rel=0.05)


def test_a_block_that_leaves_faster_than_its_barrier_does_not_peak() -> None:
    barrier = P * math.sqrt(2.0 * (1.0 - math.cos(ALPHA)))
    assert peak_after_impact_rad(barrier * (1.0 + 1e-12), ALPHA, P) == math.inf
    assert peak_after_impact_rad(barrier * (1.0 - 1e-6), ALPHA, P) < ALPHA


def test_housner_ratio_differs_between_the_corners() -> None:
    landing_left = cf.housner_ratio(707.0, 152.4, 0.774, 0.0682, 0.3585)
    landing_right = cf.housner_ratio(707.0, 152.4, 0.774, 0.3585, 0.0682)
    model = reference_lagrange.Lagrange(Case(707.0, 0.774, 0.3585, 0.0682, 152.4))
    assert landing_left == pytest.approx(-model.impact(1, np.array([0.0, -1.0, 0.0, 0.0]), True)[0], rel=1e-14)
    assert landing_right == pytest.approx(model.impact(-1, np.array([0.0, 1.0, 0.0, 0.0]), True)[0], rel=1e-14)
    assert landing_right - landing_left > 0.1


@pytest.mark.parametrize(("p_t_d", "printed"), [(0.5, "2.5415"), (1.0, "1.5820"), (2.0, "1.1565")])
def test_rectangular_pulse_threshold(p_t_d: float, printed: str) -> None:
    threshold = cf.rectangular_pulse_threshold(p_t_d)
    assert_printed(threshold, printed)
    alpha = 1e-3
    block = {"b": math.sin(alpha), "h": math.cos(alpha)}  # R = 1
    p = math.sqrt(0.75 * GRAVITY)
    for solver in (reference_lagrange, reference_kernel):
        outcomes = []
        for sign in (-1.0, 1.0):
            amplitude = threshold * (1.0 + sign * budget.SLENDER_RELATIVE) * GRAVITY * alpha
            case = rectangular_block(**block, accel_x=rectangle(-amplitude, p_t_d / p), overturn=10.0 * alpha)
            outcomes.append(solver.solve(case, 25.0 / p, 0.1).outcome)
        assert outcomes == ["ran", "overturned_right"]


@pytest.mark.parametrize(
    ("radius", "outcome", "peak"),
    [
        (0.25, "overturned_left", None),
        (0.5, "overturned_left", None),
        (1.0, "ran", "0.7257"),
        (2.0, "ran", "0.2773"),
        (4.0, "ran", "0.1296"),
    ],
)
def test_five_sizes_under_one_sine_pulse(radius: float, outcome: str, peak: str | None) -> None:
    alpha, g = 0.2, 9.80665
    case = rectangular_block(
        radius * math.sin(alpha),
        radius * math.cos(alpha),
        accel_x=full_period(2.0 * g * math.tan(alpha), 0.5),
        ratio=cf.rectangle_ratio(alpha),
        gravity=g,
        overturn=1.2,  # six times α; a falling block may lose contact before 1.5 rad
    )
    path = reference_lagrange.solve(case, 4.0, 2e-4)
    assert path.outcome.startswith(outcome[:9]) if peak is None else path.outcome == outcome
    if peak is not None:
        assert_printed(float(np.max(np.abs(path.samples[:, 1]))) / alpha, peak)


def test_newmark_rectangular_pulse() -> None:
    case = sliding_block(0.15, accel_x=rectangle(3.0, 0.4))
    path = reference_lagrange.solve(case, 2.0, 0.1)
    assert path.samples[-1, 4] == 0.0
    assert -path.samples[-1, 3] == pytest.approx(cf.rectangular_pulse_slip_m(3.0, 0.4, 0.15), abs=budget.REFERENCES_M)
    assert cf.rectangular_pulse_slip_m(1.4, 0.4, 0.15) == 0.0


def test_newmark_first_excursion_of_a_harmonic_motion() -> None:
    slip = cf.harmonic_first_slip(3.0, 2.0, 0.25, 0.15)
    case = Case(1.0, 0.1, 2.0, 2.0, 1.0, 1.0, 0.25, 0.15, accel_x=harmonic(3.0, 2.0))
    path = reference_lagrange.solve(case, slip.stop_s + 1e-3, 1e-3)
    assert path.times("slip_backward")[0] == pytest.approx(slip.start_s, abs=budget.EVENT_TIME_S)
    assert path.times("halt")[0] == pytest.approx(slip.stop_s, abs=budget.EVENT_TIME_S)
    still = path.samples[path.samples[:, 0] <= slip.stop_s][-1]
    assert -still[3] == pytest.approx(slip.slip_m, abs=0.5 * 10.0 * 1e-6)  # ≤ 1 ms before the stop at ≤ 10 m/s²
    assert cf.harmonic_first_slip(2.4, 2.0, 0.25, 0.15) is None


def test_steady_sliding_under_a_harmonic_motion() -> None:
    amplitude, frequency, mu = 6.0, 2.0, 0.15
    path = reference_lagrange.solve(sliding_block(mu, accel_x=harmonic(amplitude, frequency)), 8.0, 1e-3)
    last = path.samples[path.samples[:, 0] >= 7.0][:, 3]
    grid = 0.5 * (amplitude + mu * GRAVITY) * (0.5e-3) ** 2 * 2.0
    wanted = cf.harmonic_steady_slip_range_m(amplitude, frequency, mu)
    assert np.ptp(last) == pytest.approx(wanted, rel=budget.STEADY_SLIP_RELATIVE, abs=grid)
    with pytest.raises(AnalyticInputError, match="sticks"):
        cf.harmonic_steady_slip_range_m(2.0, frequency, mu)


def test_similar_problems_have_similar_paths() -> None:
    factor = 2.5
    s = cf.similarity(factor)
    small = rectangular_block(0.1, 0.5, accel_x=harmonic(3.5, 2.0))
    large = Case(
        s.mass,
        0.5 * s.length,
        0.1 * s.length,
        0.1 * s.length,
        small.inertia * s.inertia,
        accel_x=harmonic(3.5 * s.acceleration, 2.0 * s.frequency),
    )
    a = reference_lagrange.solve(small, 1.5, 0.05).samples
    b = reference_lagrange.solve(large, 1.5 * s.time, 0.05 * s.time).samples
    assert np.max(np.abs(a[:, 1])) > 0.01
    assert np.max(np.abs(a[:, 1] - b[:, 1])) <= budget.KERNEL_RAD
    assert np.max(np.abs(a[:, 2] * s.rate - b[:, 2])) <= 10.0 * budget.KERNEL_RAD  # rates are about ten times rotations


@pytest.mark.parametrize(("half_height", "path"), [(1e-9, 0.0), (0.3, 0.0), (0.3, 0.05), (0.05, 0.2)])
def test_rolling_cylinder_satisfies_the_balance_of_angular_momentum(half_height: float, path: float) -> None:
    """Angular momentum of the turning body, by finite differences in the fixed frame, against the contact force's moment."""
    a, h, tilt, g = 0.1, half_height, 0.2, 9.81
    roll = cf.rolling_cylinder(a, h, tilt, path_radius_m=path)
    inertia = np.diag([(3 * a * a + 4 * h * h) / 12.0] * 2 + [0.5 * a * a])
    omega = roll.precession_rad_s

    def about(axis: int, angle: float) -> np.ndarray:
        i, j = (axis + 1) % 3, (axis + 2) % 3
        matrix = np.eye(3)
        matrix[i, i] = matrix[j, j] = math.cos(angle)
        matrix[j, i], matrix[i, j] = math.sin(angle), -math.sin(angle)
        return matrix

    def body(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Orientation, centroid and contact point relative to the centroid; the axis leans towards −y at t = 0."""
        frame = about(2, omega * t) @ about(0, tilt)
        centre = about(2, omega * t) @ np.array([0.0, -path, roll.centre_height_m])
        return frame @ about(2, roll.spin_rad_s * t), centre, frame @ np.array([0.0, -a, -h])

    def angular_velocity(t: float, d: float) -> np.ndarray:
        skew = (body(t + d)[0] - body(t - d)[0]) / (2 * d) @ body(t)[0].T
        return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])

    def momentum(t: float, d: float) -> np.ndarray:
        turn = body(t)[0]
        return turn @ inertia @ turn.T @ angular_velocity(t, d)

    d = 2.0 * math.pi / omega * 1e-4
    acceleration = (body(d)[1] - 2.0 * body(0.0)[1] + body(-d)[1]) / (d * d)
    force = acceleration + np.array([0.0, 0.0, g])
    lever = body(0.0)[2]
    torque = np.cross(lever, force)
    rate = (momentum(d, d) - momentum(-d, d)) / (2 * d)
    np.testing.assert_allclose(rate, torque, rtol=0.0, atol=budget.DIFFERENCE_RELATIVE * g * a)
    contact = (body(d)[1] - body(-d)[1]) / (2 * d) + np.cross(angular_velocity(0.0, d), lever)
    np.testing.assert_allclose(contact, 0.0, atol=budget.DIFFERENCE_RELATIVE * omega * a)
    assert body(0.0)[1][2] + lever[2] == pytest.approx(0.0, abs=1e-15)


def test_a_thin_disk_wobbles_as_a_coin() -> None:
    roll = cf.rolling_cylinder(0.3, 1e-12, 0.2)
    assert roll.precession_rad_s**2 == pytest.approx(4.0 * 9.81 / (0.3 * math.sin(0.2)), rel=1e-10)
    assert roll.friction_needed == 0.0


@pytest.mark.parametrize(
    "call",
    [
        lambda: cf.quarter_period_s(0.2, 0.1, 1.0),
        lambda: cf.quarter_period_s(-0.1, 0.2, 1.0),
        lambda: cf.frequency_parameter_rad_s(1.0, math.nan, 1.0),
        lambda: cf.rectangular_pulse_threshold(0.0),
        lambda: cf.harmonic_first_slip(1.0, 1.0, 0.1, 0.2),
        lambda: cf.rolling_cylinder(0.1, 0.3, 0.4),
    ],
)
def test_impossible_numbers_are_refused_with_a_sentence(call: object) -> None:
    with pytest.raises(AnalyticInputError, match="wanted"):
        call()  # type: ignore[operator]
