"""Unmodified pymunk acts with the static coefficient as an impact breaks the pedestal loose."""

from __future__ import annotations

from tests.measures.static_impacts import measured


def test_the_plain_engine_is_the_model_with_the_static_coefficient() -> None:
    coarse, fine = (measured(0.429, 3.0, step_s, 0.8) for step_s in (4e-4, 1e-4))
    assert fine.static_rad < 0.1 * fine.kinetic_rad
    # What is left falls with its step; the difference from the other model does not.
    assert fine.static_rad < 0.7 * coarse.static_rad
    assert fine.kinetic_rad > 0.5 * coarse.kinetic_rad
