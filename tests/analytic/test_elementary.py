"""Sine, cosine and the coarse root of the compiled code."""

import math

import mpmath
import numpy as np
import pytest

from analytic.kernel.compiler import jit
from analytic.kernel.polynomial import FAR, coarse_root, sine_cosine
from tests.budgets_analytic import COARSE_ROOT, SINE_RELATIVE


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
