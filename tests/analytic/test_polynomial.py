"""The first root of a step's polynomial, against numpy's roots, near tangents and from a zero start."""

import numpy as np
import pytest

from analytic.kernel.polynomial import NO_ROOT, TANGENT_LEVEL, first_root, leading
from tests.budgets_analytic import ROOT_REL


def row(coefficients: list[float] | np.ndarray) -> np.ndarray:
    """The coefficients, and the room for one more that a search may fill up with a zero."""
    return np.array([*coefficients, np.nan], dtype=np.float64)


@pytest.mark.parametrize("seed", range(200))
def test_first_root_is_the_first(seed: int) -> None:
    rng = np.random.default_rng(seed)
    degree = int(rng.integers(1, 14))
    c = rng.normal(size=degree + 1) * rng.uniform(0.2, 1.5) ** np.arange(degree + 1)
    c[0] = abs(c[0])
    roots = np.roots(c[::-1])
    real = np.sort(roots[np.abs(roots.imag) < 1e-9].real)
    real = real[(real > 0.0) & (real <= 1.0)]
    found, _, _ = first_root(row(c), 0, degree, 1.0)
    if real.size == 0:
        assert found == NO_ROOT
    else:
        assert found == pytest.approx(real[0], rel=ROOT_REL)


def test_two_close_roots_are_not_stepped_over() -> None:
    gap = 1e-5
    inside = np.polynomial.polynomial.polyfromroots([0.5 - gap, 0.5 + gap])
    found, _, _ = first_root(row(inside), 0, 2, 1.0)
    assert found == pytest.approx(0.5 - gap, rel=ROOT_REL)


def test_a_near_touch_is_no_root_but_is_told() -> None:
    touching = np.polynomial.polynomial.polyfromroots([0.3, 0.3])
    touching[0] += 1e-12
    found, level, _ = first_root(row(touching), 0, 2, 1.0)
    assert found == NO_ROOT
    assert level >= TANGENT_LEVEL


def test_a_start_on_the_surface_does_not_fire_again() -> None:
    leaving = row([0.0, 1.0, -2.0])
    assert first_root(leaving, 1, 2, 1.0)[0] == pytest.approx(0.5, rel=ROOT_REL)
    entering = row([0.0, -1.0, 2.0])
    assert first_root(entering, 1, 2, 1.0)[0] == 0.0


def test_leading_tells_rounding_from_a_term() -> None:
    assert leading(row([1e-14, 1e-13, 0.5]), 2, 1.0, 1.0) == 2
    assert leading(row([1e-14, 1e-13, 0.0]), 2, 1.0, 1.0) == 3
    assert leading(row([1e-3, 0.0, 0.5]), 2, 1.0, 1.0) == 0
