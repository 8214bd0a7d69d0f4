"""What the model reaches beyond the paper's cases, by three solvers: walls, no return, thrown starts, endings, ties, bases."""

from dataclasses import replace

import numpy as np
import pytest

from analytic import Block
from tests import budgets_reference as budget
from tests.analytic import reference_kernel, reference_lagrange, reference_newton
from tests.analytic.reference_case import (
    GRAVITY,
    PEDESTAL_SIZE_M,
    Case,
    Motion,
    Path,
    full_period,
    harmonic,
    rectangle,
    rest,
)
from tests.analytic.reference_cases import paper_case

END_S, GRID_S = 1.5, 0.02
BULGING = ((-0.15, 0.012), (-0.06, 0.0), (0.06, 0.0), (0.15, 0.012))
UNEVEN = ((-0.12, 0.02), (-0.05, 0.0), (0.07, 0.0), (0.15, 0.012), (0.18, 0.03))
KEELED = ((-0.15, 0.02), (0.0, 0.0), (0.15, 0.012))
LEVEL = ((-0.12, 0.0), (0.02, 0.0), (0.15, 0.02))


def paths(case: Case, end: float = END_S) -> list[Path]:
    """The compiled model's path and those of the two references."""
    return [
        reference_kernel.solve(case, end, GRID_S),
        reference_lagrange.solve(case, end, GRID_S),
        reference_newton.solve(case, end, GRID_S, step=1e-3),
    ]


def assert_one_story(found: list[Path]) -> None:
    """The same samples, ending, impacts, ties and, where it overturns, time of no return."""
    kernel, *references = found
    for path in references:
        assert path.outcome == kernel.outcome
        assert len(path.samples) == len(kernel.samples)
        gap = np.max(np.abs(path.samples - kernel.samples), axis=0)
        assert gap[0] <= budget.EVENT_TIME_S
        assert gap[1] <= budget.KERNEL_RAD, f"rotation differs by {gap[1]:.2e} rad"
        assert gap[3] <= budget.KERNEL_M, f"slip differs by {gap[3]:.2e} m"
        assert path.ties == kernel.ties
        if kernel.outcome.startswith("overturned"):
            assert path.times("balance")[-1:] == pytest.approx(kernel.times("balance"), abs=budget.EVENT_TIME_S)


def statue(profile: tuple[tuple[float, float], ...], **changes: object) -> Case:
    """A statue of 100 kg on a base of many vertices."""
    return Case(100.0, 0.6, 0.1, 0.1, 14.0, profile=profile, **changes)  # type: ignore[arg-type]


THROWN = {
    "on the floor": paper_case(0.0, 1.0, pedestal=False, form="consistent"),
    "on the pedestal": paper_case(0.334, 3.0, pedestal=True, form="consistent"),
    "paper's form": paper_case(0.334, 3.0, pedestal=True, form="paper"),
}


@pytest.mark.parametrize("rate0", [0.25, -0.6])
@pytest.mark.parametrize("name", THROWN)
def test_a_start_with_a_velocity(name: str, rate0: float) -> None:
    found = paths(replace(THROWN[name], rate0=rate0))
    assert_one_story(found)
    assert found[0].samples[0, 2] == rate0
    assert found[0].times("impact")


@pytest.mark.parametrize("pedestal", [True, False])
@pytest.mark.parametrize(("side", "distance_m"), [(1, 0.09), (1, 0.40), (-1, 0.09)])
def test_a_wall_ends_the_run_where_statue_or_pedestal_touches_it(pedestal: bool, side: int, distance_m: float) -> None:
    case = paper_case(0.429, 2.0, pedestal=pedestal, form="consistent")
    case = replace(case, wall=(side, distance_m, 1.46), rate0=min(0.5 * side, 0.0))
    found = paths(case, 2.0)
    assert_one_story(found)
    assert found[0].outcome == "touches_wall"
    end = found[0].samples[-1]
    assert abs(case.before_wall(1 if end[1] > 0.0 else -1, end[1], end[3])) < budget.KERNEL_RAD


@pytest.mark.parametrize(("touches", "distance_m", "rate0"), [("top", 0.15, -1.0), ("pedestal", 0.12, 0.2)])
def test_slip_counts_against_the_wall(touches: str, distance_m: float, rate0: float) -> None:
    # A friction of 0.03: the pedestal slides for most of the time, and carries the statue towards the wall.
    smooth = replace(paper_case(0.429, 2.0, pedestal=True, form="consistent", mu_static=0.03), mu_kinetic=0.03)
    case = replace(smooth, wall=(-1, distance_m, 1.46), rate0=rate0)
    found = paths(case, 2.0)
    assert_one_story(found)
    _, theta, _, slip, _ = found[0].samples[-1]
    edge = 0.5 * PEDESTAL_SIZE_M[0] - 0.5 * (case.b_left + case.b_right)  # the pedestal's, beside the base
    assert found[0].outcome == "touches_wall"
    assert (abs(distance_m - edge + slip) < budget.KERNEL_M) == (touches == "pedestal")
    assert slip < 0.0
    assert 1.46 * abs(theta) < 0.8 * distance_m, "it would not have touched without the slip"


@pytest.mark.parametrize("acts", [0.15, 0.17, 0.20])
def test_a_coefficient_of_its_own_at_the_impact_that_breaks_the_pedestal_loose(acts: float) -> None:
    case = replace(paper_case(0.429, 3.0, pedestal=True, form="consistent"), mu_impact=acts)
    found = paths(case, 0.9)
    assert_one_story(found)
    usual = reference_kernel.solve(replace(case, mu_impact=None), 0.9, GRID_S)
    apart = np.max(np.abs(found[0].samples - usual.samples))
    assert apart == 0.0 if acts == case.mu_kinetic else apart > 1e-3


@pytest.mark.parametrize("ratio", [0.0, 1.0])
def test_impacts_that_keep_nothing_and_everything(ratio: float) -> None:
    for pedestal in (True, False):
        case = replace(paper_case(0.429, 3.0, pedestal=pedestal, form="consistent"), ratio=ratio)
        assert_one_story(paths(case, 0.8))


@pytest.mark.parametrize("pedestal", [True, False])
def test_no_return_is_the_last_outward_crossing_before_the_fall(pedestal: bool) -> None:
    found = paths(paper_case(0.429, 1.5, pedestal=pedestal, form="consistent"), 2.5)
    assert_one_story(found)
    assert found[0].times("balance")
    assert found[0].outcome == "overturned_right"


@pytest.mark.parametrize("side", [1, -1])
def test_friction_leaves_no_solution_under_a_slender_heavy_statue(side: int) -> None:
    """docs/model.md, section 5: landing while a light pedestal is about to slide the other way."""
    left, right = (0.064, 0.206)[::side]
    motion = harmonic(side * 48.6, 1.187, 0.991)
    case = Case(500.0, 1.0, left, right, 1.86, 1.573, 0.935, 0.84, accel_x=motion, theta0=side * 0.07)
    found = paths(case, 0.5)
    assert_one_story(found)
    assert found[0].outcome == "friction_paradox"
    assert found[0].times("impact")


def test_where_two_states_are_possible_the_stuck_one_is_taken_by_all() -> None:
    step = Motion(((0.0, 9.0, lambda t: -0.3 * GRAVITY),), ("rectangular", (-0.3 * GRAVITY, 9.0)))
    found = paths(replace(paper_case(0.3, 1.0, pedestal=True, form="consistent"), accel_x=step), 0.4)
    assert_one_story(found)
    assert found[0].ties >= 1


@pytest.mark.parametrize("lift_g", [0.5, 1.1])
def test_vertical_motion_up_to_flight(lift_g: float) -> None:
    case = replace(
        paper_case(0.334, 2.0, pedestal=True, form="consistent"),
        accel_z=full_period(lift_g * GRAVITY, 0.5, "one_cosine"),
    )
    found = paths(case, 1.0)
    assert_one_story(found)
    assert (found[0].outcome == "lift_off") == (lift_g > 1.0)


@pytest.mark.parametrize("profile", [BULGING, UNEVEN, KEELED, LEVEL])
@pytest.mark.parametrize("pedestal_kg", [None, 60.0])
def test_bases_of_many_vertices(profile: tuple[tuple[float, float], ...], pedestal_kg: float | None) -> None:
    case = statue(
        profile, pedestal_kg=pedestal_kg, mu_static=0.3, mu_kinetic=0.25, accel_x=harmonic(4.0, 2.0), theta0=0.1
    )
    found = paths(case, 1.0)
    assert_one_story(found)
    levels = {round(float(facet.tilt), 9) for facet in case.facets()}
    assert len(found[0].times("impact")) >= 2
    assert len(levels) == len(profile) - 1


@pytest.mark.parametrize(("profile", "facet"), [(KEELED, 0), (KEELED, 1), (BULGING, 1)])
def test_a_base_of_many_vertices_leaves_the_facet_it_rests_on(
    profile: tuple[tuple[float, float], ...], facet: int
) -> None:
    tilt = statue(profile).facets()[facet].tilt
    assert Block(100.0, 0.6, 14.0, profile).arrays[2][facet] == tilt
    still = paths(statue(profile, theta0=tilt, accel_x=rest()), 0.2)
    assert_one_story(still)
    assert set(still[0].samples[:, 1]) == {tilt}
    found = paths(statue(profile, theta0=tilt, accel_x=rectangle(-4.5, 0.3)), 2.5)
    assert_one_story(found)
    assert np.ptp(found[0].samples[:, 1]) > 0.05


@pytest.mark.parametrize("motion", [rest(), harmonic(4.0, 2.0)])
def test_a_base_of_many_vertices_overturns_over_its_outer_one(motion: Motion) -> None:
    found = paths(statue(UNEVEN, accel_x=motion, theta0=0.2, rate0=1.6), 1.5)
    assert_one_story(found)
    assert found[0].outcome == "overturned_right"
