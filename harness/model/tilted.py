"""A pedestal that tips: where its centroid and its top come to lie, whose slip is that of the edge on which it stands."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from harness.model.history import Array


class Sides(Protocol):
    """Width and height of a pedestal."""

    @property
    def width_m(self) -> float: ...
    @property
    def height_m(self) -> float: ...


def centroid_shift_m(pedestal: Sides, tilt_rad: Array) -> Array:
    """How far the centroid moves along the floor while the pedestal tips about an edge that stands, of the tilts' shape:
    (h/2) sin φ + sgn φ (w/2) (1 − cos φ).
    """
    aside = 0.5 * pedestal.width_m * np.sign(tilt_rad) * (1.0 - np.cos(tilt_rad))
    return np.asarray(0.5 * pedestal.height_m * np.sin(tilt_rad) + aside)


def support_m(pedestal: Sides | None, slip_m: Array, extra: Mapping[str, Array]) -> Array:
    """Displacement (n,) of what the statue stands on, from a history's columns: of the middle of its pedestal's top."""
    tilt_rad = extra.get("pedestal_tilt_rad")
    if pedestal is None or tilt_rad is None:
        return slip_m
    return np.asarray(slip_m + centroid_shift_m(pedestal, tilt_rad) + 0.5 * pedestal.height_m * np.sin(tilt_rad))
