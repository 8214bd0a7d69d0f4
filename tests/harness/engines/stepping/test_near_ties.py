"""A force that holds the pedestal just below its limit holds it, as in the model: an engine's own feet give way before that."""

from dataclasses import replace

import pytest

from harness import Scene, compare, load_scene, simulate
from harness.records.scores import ROBUST
from tests.engines_for_tests import ready
from tests.scenes_for_tests import SCENES, paestum

SHIPPED = [(0.356, 4.0), (0.367072, 2.5), (0.367102, 2.5)]
"""Amplitudes, g, at which the model's force at 5.38 Hz comes to 0.998 to 0.99999 of static friction's, and how long to run, s."""
BLOCK = [0.337537, 0.356409, 0.356437]
"""The same at 4 Hz for the block of the same numbers, which stays in its plane in space too."""


def assert_agrees(name: str, on: Scene) -> None:
    found, exact = simulate(on, name), simulate(on, "analytic")
    scores = compare(exact, found)
    assert scores.verdict not in ROBUST
    assert scores.evidence.largest_reliable_difference_rad <= 1e-3, "it was 0.006 to 0.013 rad"


@pytest.mark.parametrize(("amplitude_g", "duration_s"), SHIPPED)
def test_pymunk_sticks_where_the_model_does(amplitude_g: float, duration_s: float) -> None:
    ready("pymunk")
    shaking = [f"motion.x.amplitude_g={amplitude_g}", "motion.x.frequency_hz=5.38", f"duration_s={duration_s}"]
    assert_agrees("pymunk", load_scene(SCENES / "paestum_pedestal.toml", shaking))


@pytest.mark.parametrize("amplitude_g", BLOCK)
def test_pybullet_sticks_where_the_model_does(amplitude_g: float) -> None:
    ready("pybullet")
    assert_agrees("pybullet", replace(paestum(amplitude_g, 4.0, mu=(0.20, 0.15)), duration_s=2.0))
