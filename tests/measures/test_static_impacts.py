"""Unmodified engines act with the static coefficient as an impact breaks the pedestal loose."""

import pytest

from tests.engines_for_tests import ready
from tests.measures.static_impacts import apart_rad


@pytest.mark.parametrize(("name", "finer_s"), [("pymunk:plain", 1e-4), ("pybullet:plain", 2e-4)])
def test_a_plain_engine_is_the_model_with_the_static_coefficient(name: str, finer_s: float) -> None:
    ready(name)
    coarse, fine = (apart_rad(name, 0.429, 3.0, step_s, 0.8) for step_s in (4e-4, finer_s))
    assert fine["static"] < 0.1 * fine["kinetic"]
    # What is left falls with its step; the difference from the other model does not.
    assert fine["static"] < 0.7 * coarse["static"]
    assert fine["kinetic"] > 0.5 * coarse["kinetic"]
