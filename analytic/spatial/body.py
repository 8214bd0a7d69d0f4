"""A rigid body on the vertices of its base."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import positive
from analytic.errors import AnalyticInputError
from analytic.spatial.kernel.records import MAX_VERTICES

Floats = NDArray[np.float64]
SYMMETRIC: Final = 1e-9
"""Relative difference up to which an inertia tensor's halves are taken for rounded."""


@final
@dataclass(frozen=True, eq=False)
class Body:
    """Mass, kg, inertia tensor about the centroid (3, 3), kg m², and vertices (n, 3) from the centroid, m, body's frame.

    The frame's z is the body's axis, up as it stands. The vertices are those that may touch the floor: the corners of the base,
    or of the whole convex hull of a body that is thrown, in any order, n ≥ 3; they need not be level. Raises
    AnalyticInputError for what is no such body.
    """

    mass_kg: float
    inertia_kg_m2: Floats
    vertices_m: Floats

    def __init__(self, mass_kg: float, inertia_kg_m2: ArrayLike, vertices_m: ArrayLike) -> None:
        """Check and copy the numbers."""
        positive(mass_kg=mass_kg)
        inertia, vertices = (np.array(each, dtype=np.float64) for each in (inertia_kg_m2, vertices_m))
        if inertia.shape != (3, 3) or not np.isfinite(inertia).all():
            raise AnalyticInputError(f"inertia_kg_m2: a finite (3, 3) tensor is wanted, {inertia.shape} came.")
        if not np.allclose(inertia, inertia.T, rtol=0.0, atol=SYMMETRIC * np.abs(inertia).max()):
            raise AnalyticInputError("inertia_kg_m2: a symmetric tensor is wanted.")
        inertia = 0.5 * (inertia + inertia.T)
        moments = np.linalg.eigvalsh(inertia)
        if moments[0] <= 0.0 or moments[2] > (1.0 + SYMMETRIC) * (moments[0] + moments[1]):
            raise AnalyticInputError(
                f"inertia_kg_m2: positive principal moments, none above the others' sum, are wanted, {moments} came."
            )
        if vertices.ndim == 2 and vertices.shape[0] > MAX_VERTICES:
            raise AnalyticInputError(
                f"vertices_m: at most {MAX_VERTICES} vertices are wanted, {vertices.shape[0]} came: leave out the flattest."
            )
        if vertices.ndim != 2 or vertices.shape[0] < 3 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
            raise AnalyticInputError(f"vertices_m: at least three finite (x, y, z) are wanted, {vertices.shape} came.")
        for name, value in (("mass_kg", float(mass_kg)), ("inertia_kg_m2", inertia), ("vertices_m", vertices)):
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
            object.__setattr__(self, name, value)

    @classmethod
    def block(cls, mass_kg: float, width_m: float, depth_m: float, height_m: float) -> Self:
        """A homogeneous block: width along x, depth along y, height along z."""
        positive(width_m=width_m, depth_m=depth_m, height_m=height_m)
        x, y, z = width_m**2, depth_m**2, height_m**2
        inertia = np.diag([y + z, x + z, x + y]) * mass_kg / 12.0
        corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        vertices = [(0.5 * width_m * i, 0.5 * depth_m * j, -0.5 * height_m) for i, j in corners]
        return cls(mass_kg, inertia, vertices)

    @cached_property
    def inverse_about(self) -> Floats:
        """Inverse of the inertia about each vertex (n, 3, 3)."""
        r = self.vertices_m
        steiner = np.einsum("ij,ij->i", r, r)[:, None, None] * np.eye(3) - r[:, :, None] * r[:, None, :]
        return np.linalg.inv(self.inertia_kg_m2 + self.mass_kg * steiner)

    @property
    def radius_m(self) -> float:
        """Distance of the farthest vertex from the centroid, m."""
        return float(np.linalg.norm(self.vertices_m, axis=1).max())
