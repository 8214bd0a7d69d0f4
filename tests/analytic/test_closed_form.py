"""Closed forms against published numbers and against quadrature, and the model against them."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from analytic import AnalyticInputError, Rest, simulate
from analytic import closed_form as cf
from analytic.pulse_response import minimum_overturning_spectrum, overturning_ranges, pulse_response
from tests import budgets_reference as budget
from tests.analytic import reference_kernel
from tests.analytic.paestum import FREE
from tests.analytic.reference_case import GRAVITY, Case, Motion, full_period, harmonic, paper_case, rectangle

OMEGA_OVER_P, RATIO = 5.0, 0.9


def assert_printed(value: float, printed: str) -> None:
    """Meets a printed number to its last digit."""
    unit = 10.0 ** -len(printed.partition(".")[2])
    assert abs(value - float(printed)) <= budget.PRINTED_DIGITS * unit, f"{value!r} is not {printed}"


def sliding_block(mu: float, **changes: object) -> Case:
    """A block too squat to rock on a pedestal that slides."""
    return Case(1.0, 0.1, 2.0, 2.0, 1.0, pedestal_kg=1.0, mu_static=mu, mu_kinetic=mu, **changes)  # type: ignore[arg-type]


def slender_outcome(motion: Motion, ratio: float | None = None) -> str:
    """Outcome of a block of R = 1 m and α = 1e-3, far beyond which it has overturned."""
    b, h = math.sin(SLENDER_RAD), math.cos(SLENDER_RAD)
    case = Case(1.0, h, b, b, 1.0 / 3.0, ratio=ratio, accel_x=motion, overturn=20.0 * SLENDER_RAD)
    return reference_kernel.solve(case, 25.0 / SLENDER_P, 0.1).outcome


SLENDER_RAD, SLENDER_P = 1e-3, math.sqrt(0.75 * GRAVITY)


def test_free_rocking() -> None:
    alpha = FREE.alpha_rad(1)
    run = simulate(FREE, Rest(), theta0_rad=0.5 * alpha, duration_s=1.2, gravity_m_s2=GRAVITY)
    first, second = run.impacts[:2]
    quarter_s = cf.quarter_period_s(0.5 * alpha, alpha, FREE.p_rad_s(1, GRAVITY))
    assert_printed(quarter_s, "0.34709")
    assert first.time_s == pytest.approx(quarter_s, abs=1e-12)
    assert_printed(abs(first.theta_rate_before_rad_s), "0.64805")
    ratio = cf.housner_ratio(FREE.mass_kg, FREE.inertia_kg_m2, 0.5, 0.1, 0.1)
    assert_printed(ratio, "0.9423")
    assert [ratio, first.theta_rate_after_rad_s / first.theta_rate_before_rad_s] == pytest.approx(
        [cf.rectangle_ratio(alpha)] * 2, rel=1e-13
    )
    between = (run.t_s > first.time_s) & (run.t_s < second.time_s)
    assert_printed(float(np.abs(run.theta_rad[between]).max()) / alpha, "0.4222")


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


@pytest.mark.parametrize(("p_t_d", "printed"), [(0.5, "2.5415"), (1.0, "1.5820"), (2.0, "1.1565")])
def test_rectangular_pulse_threshold(p_t_d: float, printed: str) -> None:
    threshold = cf.rectangular_pulse_threshold(p_t_d)
    assert_printed(threshold, printed)
    outcomes = [
        slender_outcome(rectangle(-threshold * factor * GRAVITY * SLENDER_RAD, p_t_d / SLENDER_P))
        for factor in (1.0 - budget.SLENDER_RELATIVE, 1.0 + budget.SLENDER_RELATIVE)
    ]
    assert outcomes == ["ran", "overturned_right"]


def test_newmark_rectangular_pulse() -> None:
    path = reference_kernel.solve(sliding_block(0.15, accel_x=rectangle(3.0, 0.4)), 2.0, 0.1)
    assert path.samples[-1, 4] == 0.0
    assert -path.samples[-1, 3] == pytest.approx(cf.rectangular_pulse_slip_m(3.0, 0.4, 0.15), abs=budget.CLOSED_M)
    assert cf.rectangular_pulse_slip_m(1.4, 0.4, 0.15) == 0.0


def test_newmark_first_excursion_of_a_harmonic_motion() -> None:
    slip = cf.harmonic_first_slip(3.0, 2.0, 0.25, 0.15)
    case = Case(1.0, 0.1, 2.0, 2.0, 1.0, 1.0, 0.25, 0.15, accel_x=harmonic(3.0, 2.0))
    path = reference_kernel.solve(case, slip.stop_s, 1e-3)
    assert path.times("slip_backward")[0] == pytest.approx(slip.start_s, abs=1e-12)
    assert reference_kernel.solve(case, slip.stop_s + 1e-3, 1e-3).times("halt") == pytest.approx(
        [slip.stop_s], abs=1e-11
    )
    assert -path.samples[-1, 3] == pytest.approx(slip.slip_m, abs=budget.CLOSED_M)
    assert cf.harmonic_first_slip(2.4, 2.0, 0.25, 0.15) is None


def test_steady_sliding_under_a_harmonic_motion() -> None:
    amplitude, frequency, mu = 6.0, 2.0, 0.15
    path = reference_kernel.solve(sliding_block(mu, accel_x=harmonic(amplitude, frequency)), 8.0, 1e-3)
    last = path.samples[path.samples[:, 0] >= 7.0][:, 3]
    grid = 0.5 * (amplitude + mu * GRAVITY) * (0.5e-3) ** 2 * 2.0
    wanted = cf.harmonic_steady_slip_range_m(amplitude, frequency, mu)
    assert np.ptp(last) == pytest.approx(wanted, rel=budget.STEADY_SLIP_RELATIVE, abs=grid)
    with pytest.raises(AnalyticInputError, match="sticks"):
        cf.harmonic_steady_slip_range_m(2.0, frequency, mu)


def test_similar_problems_have_similar_paths() -> None:
    s = cf.similarity(7.3)
    small = paper_case(0.429, 3.0, pedestal=True, form="consistent")
    large = Case(
        small.m2 * s.mass,
        small.h * s.length,
        small.b_left * s.length,
        small.b_right * s.length,
        small.inertia * s.inertia,
        250.0 * s.mass,
        0.20,
        0.15,
        accel_x=harmonic(0.429 * GRAVITY * s.acceleration, 3.0 * s.frequency),
    )
    a = reference_kernel.solve(small, 2.0, 0.02).samples
    b = reference_kernel.solve(large, 2.0 * s.time, 0.02 * s.time).samples
    scaled = a * [s.time, 1.0, s.rate, s.length, s.length * s.rate]
    assert np.max(np.abs(a[:, 1])) > 0.01
    assert np.max(np.abs(scaled - b), axis=0) == pytest.approx([0.0] * 5, abs=10.0 * budget.KERNEL_RAD)


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


def test_published_thresholds_and_their_modes() -> None:
    first, second = overturning_ranges(OMEGA_OVER_P, RATIO)
    assert_printed(first[0], "3.0186")
    assert_printed(first[1], "6.3181")
    assert_printed(second[0], "7.1681")
    assert second[1] == math.inf
    assert (first[2], second[2]) == (1, 0), "first after one impact, then at once"


@pytest.mark.parametrize(("omega_over_p", "kind"), [(5.0, "one_sine"), (3.0, "one_cosine"), (1.5, "one_sine")])
def test_every_edge_is_an_edge_of_the_nonlinear_block(omega_over_p: float, kind: str) -> None:
    edges = [e for low, high, _ in overturning_ranges(omega_over_p, RATIO, kind) for e in (low, high) if e < math.inf]  # type: ignore[arg-type]
    assert len(edges) >= 3
    for edge in edges:
        for factor in (1.0 - 2.0 * budget.SLENDER_RELATIVE, 1.0 + 2.0 * budget.SLENDER_RELATIVE):
            linear = pulse_response(edge * factor, omega_over_p, RATIO, kind).overturned  # type: ignore[arg-type]
            side = {0: "ran", 1: "overturned_right", -1: "overturned_left"}[linear]
            amplitude = -edge * factor * GRAVITY * SLENDER_RAD
            pushed = full_period(amplitude, 2.0 * math.pi / (omega_over_p * SLENDER_P), kind)
            assert slender_outcome(pushed, RATIO) == side, (edge, factor)


def test_peak_of_a_block_that_stands() -> None:
    """Against a fine Runge-Kutta integration of the same linearised equation."""
    response = pulse_response(2.5, OMEGA_OVER_P, RATIO)
    assert response.overturned == 0
    x, v, s, t, peak, dt = 0.0, 0.0, 0, 0.0, 0.0, 2e-5

    def push(time: float) -> float:
        return 2.5 * math.sin(OMEGA_OVER_P * time) if time < 2.0 * math.pi / OMEGA_OVER_P else 0.0

    while t < 4.0:
        if s == 0:
            s = (push(t) > 1.0) - (push(t) < -1.0)
        else:
            k1 = x - s + push(t)
            k2 = x + 0.5 * dt * v - s + push(t + 0.5 * dt)
            x, v = x + dt * v + 0.5 * dt * dt * k1, v + dt * k2
            if s * x < 0.0:
                v, s, x = RATIO * v, -s, 0.0
        peak, t = max(peak, abs(x)), t + dt
    assert response.peak_over_alpha == pytest.approx(peak, abs=50.0 * dt)  # impacts are located to one step of dt


def test_spectrum_is_the_first_edge_and_grows_with_frequency() -> None:
    spectrum = minimum_overturning_spectrum([2.0, 5.0, 8.0], RATIO)
    assert spectrum[1] == pytest.approx(overturning_ranges(OMEGA_OVER_P, RATIO)[0][0], rel=1e-14)
    assert np.all(np.diff(spectrum) > 0.0)
    assert np.isnan(minimum_overturning_spectrum([12.0], RATIO)[0])


def test_a_weak_pulse_lifts_nothing() -> None:
    response = pulse_response(1.0, OMEGA_OVER_P, RATIO)
    assert (response.overturned, response.impacts, response.peak_over_alpha) == (0, 0, 0.0)


@pytest.mark.parametrize(
    "call",
    [
        lambda: cf.quarter_period_s(0.2, 0.1, 1.0),
        lambda: cf.quarter_period_s(-0.1, 0.2, 1.0),
        lambda: cf.frequency_parameter_rad_s(1.0, math.nan, 1.0),
        lambda: cf.rectangular_pulse_threshold(0.0),
        lambda: cf.harmonic_first_slip(1.0, 1.0, 0.1, 0.2),
        lambda: cf.rolling_cylinder(0.1, 0.3, 0.4),
        lambda: pulse_response(-1.0, 5.0, 0.9),
        lambda: pulse_response(1.0, 0.0, 0.9),
        lambda: pulse_response(1.0, 5.0, 1.1),
        lambda: pulse_response(math.nan, 5.0, 0.9),
    ],
)
def test_impossible_numbers_are_refused_with_a_sentence(call: object) -> None:
    with pytest.raises(AnalyticInputError, match="wanted"):
        call()  # type: ignore[operator]
