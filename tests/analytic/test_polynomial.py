"""The first root of a step's polynomial against numpy's roots; sine, cosine and the coarse root of the compiled code."""

import math

import mpmath
import numpy as np
import pytest

from analytic.kernel.compiler import jit
from analytic.kernel.polynomial import FAR, NO_ROOT, TANGENT_LEVEL, coarse_root, first_root, leading, sine_cosine
from tests.budgets_analytic import COARSE_ROOT, ROOT_REL, SINE_RELATIVE


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


@jit
def both(angle: float) -> tuple[float, float]:
    return sine_cosine(angle)


@jit
def root(x: float, inverse: float) -> float:
    return coarse_root(x, inverse)


RANDOM = np.random.default_rng(7)
QUARTERS = np.arange(1, 300) * (0.5 * math.pi)
ANGLES = {
    "tilts": RANDOM.uniform(-1.6, 1.6, 1000),
    "phases": RANDOM.uniform(-800.0, 800.0, 1000),
    "far phases": RANDOM.uniform(-FAR, FAR, 500),
    "small": 10.0 ** RANDOM.uniform(-300.0, 0.0, 300),
    "about quarter turns": np.concatenate([QUARTERS, np.nextafter(QUARTERS, 0.0), -QUARTERS]),
}


@pytest.mark.parametrize("name", ANGLES)
def test_sine_and_cosine_are_right_to_the_last_places_everywhere(name: str) -> None:
    with mpmath.workprec(160):
        for angle in ANGLES[name].tolist():
            found, exact = both(angle), (mpmath.sin(mpmath.mpf(angle)), mpmath.cos(mpmath.mpf(angle)))
            off = [abs(f - e) / abs(e) for f, e in zip(found, exact, strict=True)]
            assert max(off) <= SINE_RELATIVE, f"{angle!r}: {found}"


@pytest.mark.parametrize("name", ANGLES)
def test_the_angle_of_the_other_sign_gives_the_same_bits(name: str) -> None:
    for angle in ANGLES[name].tolist():
        sine, cosine = both(angle)
        assert both(-angle) == (-sine, cosine)


def test_beyond_the_far_angle_and_beyond_numbers_the_library_answers() -> None:
    for angle in (2.0 * FAR, -1e15):
        assert both(angle) == (math.sin(angle), math.cos(angle))
    assert all(math.isnan(value) for value in both(math.nan))


def test_the_coarse_root_is_as_coarse_as_it_says_at_every_order() -> None:
    for order in range(2, 27):
        for x in (10.0 ** RANDOM.uniform(-300.0, 300.0, 300)).tolist():
            assert root(x, 1.0 / order) == pytest.approx(x ** (1.0 / order), rel=COARSE_ROOT)
