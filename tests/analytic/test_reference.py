"""Two solvers that share only the statement of the problem follow the same path, through impacts, slips and jumps."""

from dataclasses import replace

import numpy as np
import pytest

from tests import budgets_reference as budget
from tests.analytic import reference_lagrange, reference_newton
from tests.analytic.reference_case import Case, Motion, Path
from tests.analytic.reference_cases import FORMS, paper_case, random_case

END_S, GRID_S = 2.0, 0.02
FINE_STEP_S = 5e-4  # a slip shorter than the step of reference B can go unseen between its ends
RANDOM_SEEDS = (3, 17, 24, 41, 74, 113, 179)


def assert_same_path(a: Path, b: Path) -> None:
    """Same outcome, same events at the same times, same samples."""
    assert a.outcome == b.outcome
    shared = min(len(a.samples), len(b.samples))
    assert abs(len(a.samples) - len(b.samples)) <= 1
    gap = np.max(np.abs(a.samples[:shared] - b.samples[:shared]), axis=0)
    assert gap[1] <= budget.REFERENCES_RAD, f"rotation differs by {gap[1]:.2e} rad"
    assert gap[3] <= budget.REFERENCES_M, f"slip differs by {gap[3]:.2e} m"
    for name in ("impact", "halt", "slip_forward", "slip_backward"):
        assert len(a.times(name)) == len(b.times(name)), name
        np.testing.assert_allclose(a.times(name), b.times(name), rtol=0.0, atol=budget.EVENT_TIME_S, err_msg=name)


def both(case: Case, step: float = reference_newton.STEP_S) -> tuple[Path, Path]:
    """Reference A's and reference B's path."""
    return reference_lagrange.solve(case, END_S, GRID_S), reference_newton.solve(case, END_S, GRID_S, step=step)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), [(0.334, 3.0), (0.429, 2.0), (0.429, 6.0)])
def test_references_agree_with_pedestal(amplitude_g: float, frequency_hz: float, form: str) -> None:
    a, b = both(paper_case(amplitude_g, frequency_hz, pedestal=True, form=form))
    assert a.times("impact"), "the case must rock"
    assert a.times("halt"), "the case must slide"
    assert_same_path(a, b)


@pytest.mark.parametrize("form", ["consistent", "paper"])
@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), [(0.429, 1.5), (0.429, 2.0), (0.334, 6.0)])
def test_references_agree_on_the_floor(amplitude_g: float, frequency_hz: float, form: str) -> None:
    assert_same_path(*both(paper_case(amplitude_g, frequency_hz, pedestal=False, form=form)))


def test_references_agree_with_equal_frictions() -> None:
    assert_same_path(*both(paper_case(0.429, 4.5, pedestal=True, form="consistent", mu_static=0.15)))


@pytest.mark.parametrize("seed", RANDOM_SEEDS)
def test_references_agree_on_random_cases(seed: int) -> None:
    assert_same_path(*both(random_case(seed), FINE_STEP_S))


@pytest.mark.parametrize("parameter", ["inertia", "h", "b_right", "mu_kinetic", "pedestal_kg"])
def test_comparison_sees_a_change_of_one_in_a_million(parameter: str) -> None:
    case = paper_case(0.429, 3.0, pedestal=True, form="consistent")
    a = reference_lagrange.solve(case, END_S, GRID_S)
    other = replace(case, **{parameter: getattr(case, parameter) * (1.0 + budget.SEEN_RELATIVE)})
    with pytest.raises(AssertionError, match="rotation differs"):
        assert_same_path(a, reference_newton.solve(other, END_S, GRID_S))


def test_a_mirrored_case_gives_the_mirrored_path() -> None:
    case = random_case(24)
    mirrored = replace(
        case,
        b_left=case.b_right,
        b_right=case.b_left,
        theta0=-case.theta0,
        accel_x=Motion(tuple((a, b, lambda t, f=f: -f(t)) for a, b, f in case.accel_x.segments)),
    )
    a, b = (reference_lagrange.solve(c, END_S, GRID_S).samples for c in (case, mirrored))
    assert np.max(np.abs(a[:, 1:] + b[:, 1:])) <= budget.REFERENCES_RAD


def test_a_step_with_two_possible_states_is_met_as_a_tie() -> None:
    """Paestum under a step of −0.3 g: it can rock with the pedestal stuck or slide; the stuck state is taken."""
    case = replace(
        paper_case(0.3, 1.0, pedestal=True, form="consistent"), accel_x=Motion(((0.0, 9.0, lambda t: -0.3 * 9.81),))
    )
    path = reference_lagrange.solve(case, 0.05, 0.01)
    assert path.ties == 1
    assert path.samples[-1, 1] > 0.0
    assert path.samples[-1, 3] == 0.0
