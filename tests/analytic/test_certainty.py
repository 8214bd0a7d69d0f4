"""A run's stated uncertainty holds, and it says when it is not to be trusted."""

import numpy as np
import pytest

from analytic import Block, Harmonic, Pedestal, Pulse, Rest, SampledAcceleration, certify, simulate
from tests import budgets_reference as budget
from tests.analytic import reference_lagrange
from tests.analytic.paestum import FREE, GRAVITY, PEDESTAL, STATUE
from tests.analytic.reference_case import random_case
from tests.analytic.reference_kernel import certified

END_S, GRID_S = 2.0, 0.02
ON_PEDESTAL = {"pedestal": PEDESTAL, "floor_static": 0.20, "floor_kinetic": 0.15, "gravity_m_s2": GRAVITY}


def test_free_rocking_is_sure_to_the_end() -> None:
    found = certify(FREE, Rest(), theta0_rad=0.05, duration_s=3.0)
    assert found.reliable_until_s == 3.0
    assert found.uncertainty_rad < 1e-11
    assert found.outcome_is_sure


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), [(0.334, 3.0), (0.429, 4.5), (0.429, 6.0)])
def test_the_stated_uncertainty_covers_the_error(amplitude_g: float, frequency_hz: float) -> None:
    motion = Harmonic(amplitude_g * GRAVITY, frequency_hz)
    stated = certify(STATUE, motion, accuracy_rad=1e-4, base_accuracy_rad=1e-7, duration_s=10.0, **ON_PEDESTAL)
    exact = simulate(STATUE, motion, accuracy_rad=1e-15, duration_s=10.0, **ON_PEDESTAL)  # type: ignore[arg-type]
    n = int(np.searchsorted(stated.solution.t_s, stated.reliable_until_s))
    n = min(n, exact.t_s.size - 1, stated.solution.t_s.size - 1)
    error = float(np.abs(stated.solution.theta_rad[:n] - exact.theta_rad[:n]).max())
    assert n > 1000
    assert error <= stated.uncertainty_rad
    assert stated.uncertainty_rad <= 1e-4
    slip = float(np.abs(stated.solution.slip_m[:n] - exact.slip_m[:n]).max())
    assert 0.0 < slip <= stated.slip_uncertainty_m <= 1e-4 * STATUE.centroid_height_m


@pytest.mark.parametrize("seed", budget.CERTIFIED_SEEDS)
def test_no_less_is_stated_than_rounding_makes(seed: int) -> None:
    """Against an independent solver at its finest: all runs of the certificate share the rounding of what they are given."""
    case = random_case(seed)
    stated = certified(case, END_S, GRID_S)
    exact = reference_lagrange.solve(case, END_S, GRID_S, rtol=budget.FINEST_RTOL).samples
    run = stated.solution
    n = min(int(np.searchsorted(run.t_s, stated.reliable_until_s, side="right")), len(exact), run.t_s.size) - 1
    assert n > 5
    assert np.abs(run.theta_rad[:n] - exact[:n, 1]).max() <= stated.uncertainty_rad
    assert np.abs(run.slip_m[:n] - exact[:n, 3]).max() <= stated.slip_uncertainty_m
    assert stated.uncertainty_rad <= budget.CERTIFIED_RAD


def test_no_less_is_stated_than_the_rebounds_that_all_runs_drop() -> None:
    found = certify(FREE, Rest(), theta0_rad=1e-9, duration_s=1.0, base_accuracy_rad=1e-6, accuracy_rad=1e-4)
    assert found.solution.counts.dropped_rebounds > 0
    assert found.uncertainty_rad >= 1e-8, "a hundredth of the aimed error is dropped; the runs do not differ"


def test_a_chaotic_run_says_until_when_it_holds() -> None:
    found = certify(
        STATUE,
        Harmonic(0.429 * GRAVITY, 6.0),
        accuracy_rad=1e-9,
        base_accuracy_rad=1e-8,
        duration_s=10.0,
        **ON_PEDESTAL,
    )
    assert 0.0 < found.reliable_until_s < 10.0


def test_doubts_and_limits_are_told() -> None:
    jump = certify(STATUE, Pulse("rectangular", -0.3 * GRAVITY, 0.5), duration_s=2.0, **ON_PEDESTAL)
    assert jump.solution.counts.ties > 0
    rough = certify(STATUE, Harmonic(0.334 * GRAVITY, 3.0), duration_s=2.0, statue_friction=0.1, **ON_PEDESTAL)
    assert rough.solution.validity.left_domain_s is not None
    assert rough.solution.validity.left_domain_by == "statue_slides"
    narrow = certify(
        STATUE,
        Harmonic(0.334 * GRAVITY, 3.0),
        duration_s=2.0,
        **(ON_PEDESTAL | {"pedestal": Pedestal(250.0, 0.3, 0.5)}),
    )
    assert narrow.solution.validity.left_domain_by == "pedestal_tips"


def test_the_domain_is_left_where_a_limit_is_passed_not_where_a_step_is_looked_at() -> None:
    """A pivot that gives way before the statue falls: told up to 0.02 s late, spatial's slip began while the model still held."""
    squat, pulse = Block.rectangle(width_m=0.62, height_m=2.4), Pulse("one_sine", 3.5, 1.0, 0.2)
    left = [
        simulate(squat, pulse, duration_s=3.0, statue_friction=0.5, accuracy_rad=accuracy_rad).validity
        for accuracy_rad in (1e-6, 1e-9)
    ]
    assert left[0].left_domain_by == left[1].left_domain_by == "statue_slides"
    assert left[0].left_domain_s == pytest.approx(left[1].left_domain_s, abs=budget.LEFT_DOMAIN_S)


def test_a_pedestal_that_tips_under_a_statue_at_rest_does_so_between_two_samples() -> None:
    """Samples at rest are looked through, not integrated: the limit passed between two was told at the second, 20 ms late."""
    block, pedestal = Block.rectangle(width_m=0.6, height_m=1.0, mass_kg=500.0), Pedestal(250.0, 0.62, 0.5)
    m, both = block.mass_kg, block.mass_kg + pedestal.mass_kg
    limit = GRAVITY * 0.31 * both / (m * (0.5 + 0.5) + pedestal.mass_kg * 0.25)
    ramp = SampledAcceleration([0.0, 0.05, 0.1], [0.0, 1.2 * limit, 0.0])
    found = simulate(
        block, ramp, duration_s=0.2, pedestal=pedestal, floor_static=0.9, floor_kinetic=0.9, gravity_m_s2=GRAVITY
    ).validity
    assert found.left_domain_by == "pedestal_tips"
    assert found.left_domain_s == pytest.approx(0.05 / 1.2, abs=budget.LEFT_DOMAIN_S)


def test_paestum_landing_left_needs_the_printed_friction() -> None:
    """0.341 with the pedestal held (docs/model.md, section 5)."""
    run = simulate(STATUE, Rest(), theta0_rad=0.05, duration_s=1.0, gravity_m_s2=GRAVITY)
    first = run.impacts[0]
    assert first.pivot == 0
    z, omega, after = 0.774, first.theta_rate_before_rad_s, first.theta_rate_after_rad_s
    needed = abs(z * (after - omega)) / (0.3585 * abs(after) + 0.0682 * abs(omega))
    assert round(needed, 3) == 0.341
    assert run.validity.pivot_friction_needed_at_impact >= needed * (1.0 - 1e-12)


def test_rocking_that_dies_out_needs_no_more_friction_than_its_impacts() -> None:
    """Chattering that is ended is not one impact that stops the statue at once."""
    block = Block.rectangle(width_m=0.2, height_m=1.0)
    early = simulate(block, Rest(), theta0_rad=0.05, duration_s=1.0, gravity_m_s2=GRAVITY)
    whole = simulate(block, Rest(), theta0_rad=0.05, duration_s=20.0, gravity_m_s2=GRAVITY)
    assert early.counts.dropped_rebounds == 0
    assert whole.counts.dropped_rebounds == 1
    assert whole.validity.left_domain_s is None
    needed = early.validity.pivot_friction_needed_at_impact
    assert whole.validity.pivot_friction_needed_at_impact == pytest.approx(needed, rel=1e-9)


def test_tipping_margin_at_rest_is_the_statics_of_two_bodies() -> None:
    a_x, offset = 0.5, 0.02
    pedestal = Pedestal(250.0, 0.60, 0.20, offset)
    run = simulate(
        STATUE,
        Pulse("rectangular", a_x, 1.0),
        pedestal=pedestal,
        floor_static=0.20,
        floor_kinetic=0.15,
        duration_s=0.9,
        gravity_m_s2=GRAVITY,
    )
    assert run.peak_theta_rad == 0.0
    total = 957.0
    centre = 0.5 * (0.0682 - 0.3585) + offset
    weight = -707.0 * centre * GRAVITY
    inertia = (707.0 * (0.20 + 0.774) + 250.0 * 0.10) * a_x
    expected = 0.30 - abs(weight - inertia) / (total * GRAVITY)
    assert run.validity.pedestal_tipping_margin_m == pytest.approx(expected, rel=1e-12)


def test_without_a_history_one_further_run_is_the_check_and_the_numbers_are_the_same() -> None:
    motion = Harmonic(0.429 * GRAVITY, 4.5)
    options = {"accuracy_rad": 1e-6, "base_accuracy_rad": 1e-6, "duration_s": 3.0, **ON_PEDESTAL}
    whole = certify(STATUE, motion, skip_energy=False, **options)  # type: ignore[arg-type]
    short = certify(STATUE, motion, dt_s=None, skip_energy=False, **options)  # type: ignore[arg-type]
    assert short.solution.events == ()
    assert short.outcome_is_sure == whole.outcome_is_sure
    for name in ("outcome", "end_s", "peak_theta_rad", "peak_time_s", "peak_slip_m", "final_slip_m", "validity"):
        assert getattr(short.solution, name) == getattr(whole.solution, name), name
    assert short.solution.counts.impacts == len(whole.solution.impacts)
    exact = simulate(STATUE, motion, accuracy_rad=1e-15, duration_s=3.0, dt_s=None, **ON_PEDESTAL)  # type: ignore[arg-type]
    assert abs(short.solution.peak_theta_rad - exact.peak_theta_rad) <= short.uncertainty_rad


def test_a_peak_that_runs_share_before_their_paths_part_holds_up_to_itself_only() -> None:
    motion = Harmonic(3.402692436584214, 4.799942511102415)
    scene = ON_PEDESTAL | {"duration_s": 6.342315367369476, "dt_s": None}
    found = certify(STATUE, motion, accuracy_rad=1e-6, base_accuracy_rad=1e-6, **scene)
    exact = simulate(STATUE, motion, accuracy_rad=1e-13, **scene)  # type: ignore[arg-type]
    missed = exact.peak_theta_rad - found.solution.peak_theta_rad
    assert missed > 100.0 * found.uncertainty_rad, "the runs agree on a peak that is not the largest"
    assert found.reliable_until_s < exact.peak_time_s
    assert found.reliable_until_s == pytest.approx(found.solution.peak_time_s, abs=1e-5)


def test_an_outcome_whose_runs_keep_to_one_path_is_sure_to_the_end() -> None:
    scene = ON_PEDESTAL | {"duration_s": 2.0, "dt_s": None}
    found = certify(STATUE, Harmonic(0.334 * GRAVITY, 3.0), **scene)
    assert found.solution.energy_lost_j > 0.0
    assert found.reliable_until_s == found.solution.end_s
