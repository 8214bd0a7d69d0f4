"""The many feet of a scan are asked as arrays, few as plain numbers: both answer alike."""

import math

import numpy as np
import pytest

from harness.engines.stepping.step_state import MANY, ContactGaps
from tests.scenes_for_tests import paestum

COUNT = 2 * MANY + 2


def row(lean_rad: float, rate_rad_s: float, height_m: float) -> tuple[float, ...]:
    """A statue alone that leans to the right, its centroid as high as that."""
    half = 0.5 * lean_rad
    return (0.0, 0.0, height_m, 0.0, math.sin(half), 0.0, math.cos(half), 0.0, 0.0, -0.1, 0.0, rate_rad_s, 0.0)


@pytest.mark.parametrize(("lean_rad", "rate_rad_s"), [(0.05, -0.4), (-0.03, 0.2), (0.2, 0.0), (1e-4, -1.0)])
def test_many_feet_are_asked_as_few_are(lean_rad: float, rate_rad_s: float) -> None:
    scene = paestum(0.3, 2.0)
    height_m = scene.statue.centroid_height_m
    around = np.linspace(0.0, math.tau, COUNT, endpoint=False)
    feet_m = np.column_stack([0.2 * np.cos(around), 0.3 * np.sin(around), np.full(COUNT, -height_m)])
    many, few = (ContactGaps(scene, feet_m, None, 1e-3) for _ in range(2))
    assert not many.few
    few.few = True
    at = row(lean_rad, rate_rad_s, height_m + 0.2 * abs(math.sin(lean_rad)) + 0.01)
    assert many(at, 0.0, 0.0) == pytest.approx(few(at, 0.0, 0.0), rel=1e-9)
    assert np.allclose(many.heights(at, 0.0, 0.0), few.heights(at, 0.0, 0.0), atol=1e-12)
