"""Whether a scene is its own mirror image across the rocking plane."""

from __future__ import annotations

from typing import Final

import numpy as np

from harness.model.history import Array
from harness.model.scene import Scene

SAME: Final = 1e-9
"""Lengths (m) and shares of the inertia that differ by no more are equal: rounding of the numbers given."""


def asymmetry(scene: Scene) -> str | None:
    """What keeps a scene from being its own mirror image: `plane`, `inertia` or `base`; None when it is one."""
    if not scene.planar:
        return "plane"
    tensor, feet = scene.statue.inertia_tensor_kg_m2, scene.statue.footprint_m
    if max(abs(float(tensor[0, 1])), abs(float(tensor[1, 2]))) > SAME * float(np.trace(tensor)):
        return "inertia"
    if np.max(np.abs(_sorted(feet) - _sorted(feet * np.array([1.0, -1.0, 1.0])))) > SAME:
        return "base"
    return None


def _sorted(points_m: Array) -> Array:
    """Points (k, 3) in an order that rounding does not change."""
    return points_m[np.lexsort(np.round(points_m / SAME).T)]
