"""The compiled model against reference A: the paper's cases, random ones, and every known answer."""

import math

import numpy as np
import pytest

from analytic import closed_form as cf
from analytic.pulse_response import overturning_ranges, pulse_response
from tests import budgets_reference as budget
from tests.analytic import reference_kernel, reference_lagrange, reference_newton
from tests.analytic.reference_case import GRAVITY, Case, Path, full_period, harmonic, rectangle
from tests.analytic.reference_cases import AMPLITUDES_G, FORMS, FREQUENCIES_HZ, paper_case, random_case
from tests.analytic.test_closed_form import ALPHA, P, assert_printed, rectangular_block, sliding_block

END_S, GRID_S = 2.0, 0.02
RANDOM_SEEDS = tuple(range(300, 318))
DWINDLING_SEEDS = (15, 19, 126, 229)
"""Chattering on a pedestal whose momentum the form does not keep: dropping their last rebounds at
1e-14 rad of height cost up to 2.7e-7 rad."""
ENDING_SEEDS = {12: "overturned_right", 135: "overturned_left", 156: "lift_off", 211: "lift_off", 250: "lift_off"}
"""Runs that meet a break (12) or slip (135) while they lose their corner in the fall, press no more on the floor in the fall
(156, 211), and once never ended (250)."""


SOLVERS = (reference_kernel.solve, reference_lagrange.solve, reference_newton.solve)


def gaps(a: Path, b: Path) -> tuple[float, float]:
    """Largest differences of rotation (rad) and slip (m) over the samples both have."""
    shared = min(len(a.samples), len(b.samples))
    assert abs(len(a.samples) - len(b.samples)) <= 1, f"{a.outcome}, {b.outcome}"
    gap = np.max(np.abs(a.samples[:shared] - b.samples[:shared]), axis=0)
    return float(gap[1]), float(gap[3])


def assert_kernel_follows(case: Case) -> None:
    """Within what is claimed, over the first 2 s."""
    reference = reference_lagrange.solve(case, END_S, GRID_S)
    kernel = reference_kernel.solve(case, END_S, GRID_S, skip_start=False, skip_rest=False)
    rotation, slip = gaps(reference, kernel)
    assert rotation <= budget.KERNEL_RAD, f"rotation differs by {rotation:.2e} rad"
    assert slip <= budget.KERNEL_M, f"slip differs by {slip:.2e} m"


@pytest.mark.parametrize("form", ["consistent", "paper"])
@pytest.mark.parametrize("mu_static", [0.20, 0.15, None])
@pytest.mark.parametrize("frequency_hz", FREQUENCIES_HZ)
@pytest.mark.parametrize("amplitude_g", AMPLITUDES_G)
def test_paper_cases(amplitude_g: float, frequency_hz: float, mu_static: float | None, form: str) -> None:
    """Every case of the paper; None: without pedestal."""
    friction = {"mu_static": mu_static} if mu_static is not None else {}
    assert_kernel_follows(paper_case(amplitude_g, frequency_hz, pedestal=mu_static is not None, form=form, **friction))


@pytest.mark.parametrize("form", FORMS[2:])
@pytest.mark.parametrize("mu_static", [0.20, 0.15])
def test_mixed_forms(mu_static: float, form: str) -> None:
    """0.429 g at 4.5 Hz: its dwindling impacts with a static normal force once cost the model 8e-8 rad."""
    assert_kernel_follows(paper_case(0.429, 4.5, pedestal=True, form=form, mu_static=mu_static))


@pytest.mark.parametrize("seed", ENDING_SEEDS)
def test_how_a_run_ends_while_contact_is_lost(seed: int) -> None:
    """docs/model.md, section 5: a corner lost in the fall ends nothing, a pedestal that no longer presses ends the run."""
    paths = [solve(random_case(seed), END_S, GRID_S) for solve in SOLVERS]
    assert [path.outcome for path in paths] == [ENDING_SEEDS[seed]] * len(paths)
    ends = [path.samples[-1, 0] for path in paths]
    np.testing.assert_allclose(ends, ends[0], rtol=0.0, atol=budget.EVENT_TIME_S)


@pytest.mark.parametrize("seed", [*RANDOM_SEEDS, *DWINDLING_SEEDS])
def test_random_cases_with_vertical_motion_and_records(seed: int) -> None:
    assert_kernel_follows(random_case(seed))


@pytest.mark.parametrize("step_cap_s", [0.05, 0.01])
def test_short_steps_keep_the_sliding_velocity(step_cap_s: float) -> None:
    """A series cut by the rotation's terms alone lost 1e-6 m/s of the slip's rate when steps were short."""
    case = paper_case(0.429, 6.0, pedestal=True, form="consistent")
    a = reference_lagrange.solve(case, END_S, GRID_S)
    rotation, slip = gaps(a, reference_kernel.solve(case, END_S, GRID_S, step_cap_s=step_cap_s))
    assert rotation <= budget.REFERENCES_RAD
    assert slip <= budget.REFERENCES_M


def test_free_rocking() -> None:
    path = reference_kernel.solve(rectangular_block(0.1, 0.5, theta0=0.5 * ALPHA), 1.2, 1e-3)
    impact = path.times("impact")[0]
    assert impact == pytest.approx(cf.quarter_period_s(0.5 * ALPHA, ALPHA, P), abs=1e-12)
    assert_printed(impact, "0.34709")
    assert_printed(float(np.max(-path.samples[:, 1])) / ALPHA, "0.4222")


def test_one_sine_thresholds() -> None:
    """3.0186, 6.3181 and 7.1681 times gα for ω/p = 5 and r = 0.9, met by the nonlinear model at α = 1e-3."""
    alpha, p = 1e-3, math.sqrt(0.75 * GRAVITY)
    (first, safe, _), (again, _, _) = overturning_ranges(5.0, 0.9)
    for edge, printed in ((first, "3.0186"), (safe, "6.3181"), (again, "7.1681")):
        assert_printed(edge, printed)
        for factor in (1.0 - 2.0 * budget.SLENDER_RELATIVE, 1.0 + 2.0 * budget.SLENDER_RELATIVE):
            pulse = full_period(-edge * factor * GRAVITY * alpha, 2.0 * math.pi / (5.0 * p))
            case = rectangular_block(math.sin(alpha), math.cos(alpha), ratio=0.9, accel_x=pulse)
            side = {0: "ran", 1: "overturned_right", -1: "overturned_left"}[
                pulse_response(edge * factor, 5.0, 0.9).overturned
            ]
            assert reference_kernel.solve(case, 30.0 / p, 0.1).outcome == side, (edge, factor)


def test_newmark_sliding() -> None:
    path = reference_kernel.solve(sliding_block(0.15, accel_x=rectangle(3.0, 0.4)), 2.0, 0.1)
    assert -path.samples[-1, 3] == pytest.approx(cf.rectangular_pulse_slip_m(3.0, 0.4, 0.15), abs=budget.REFERENCES_M)
    slip = cf.harmonic_first_slip(3.0, 2.0, 0.15, 0.15)
    path = reference_kernel.solve(sliding_block(0.15, accel_x=harmonic(3.0, 2.0)), 0.5, 0.1)
    assert path.times("slip_backward")[0] == pytest.approx(slip.start_s, abs=1e-12)
    assert path.times("halt")[0] == pytest.approx(slip.stop_s, abs=1e-11)


def test_scaling_law() -> None:
    factor = 7.3
    s = cf.similarity(factor)
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
        accel_x=harmonic(0.429 * GRAVITY, 3.0 * s.frequency),
    )
    a = reference_kernel.solve(small, END_S, GRID_S).samples
    b = reference_kernel.solve(large, END_S * s.time, GRID_S * s.time).samples
    assert np.max(np.abs(a[:, 1] - b[:, 1])) <= budget.KERNEL_RAD
    assert np.max(np.abs(a[:, 3] * s.length - b[:, 3])) <= budget.KERNEL_M
