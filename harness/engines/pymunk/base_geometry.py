"""The base as pymunk's contact sees it: its vertices, how fast it can fall, and what turning about a vertex owes a velocity."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.model.scene import Scene
from meshes.footprint import lower_chain

Array = NDArray[np.float64]
Pair = tuple[float, float]

STEEPEST_RAD: Final = 1.0
"""Facets of the silhouette that are steeper belong to its flanks: a statue that lies on them has fallen."""


def base_vertices(scene: Scene) -> Array:
    """Vertices (k, 2) of the silhouette that a level support can touch while the statue stands, from right to left, m from the
    centroid.
    """
    chain = lower_chain(scene.statue.section_m)
    steps = np.diff(chain, axis=0)
    base = np.flatnonzero(np.abs(np.arctan2(steps[:, 1], steps[:, 0])) < STEEPEST_RAD)
    facets = chain[base[0] : base[-1] + 2]
    from_centroid: Array = facets[::-1] - np.array([0.0, scene.statue.centroid_height_m])
    return from_centroid


def fall_rad_s2(scene: Scene) -> float:
    """Greatest acceleration of a statue that stands on one corner of its base, under its weight."""
    statue = scene.statue
    # The lever of the weight about a corner is longest upright: a lean onto that corner shortens it.
    arms = ((statue.corner_m(side), scene.pivot_inertia_kg_m2[side]) for side in (-1, 1))
    return max(statue.mass_kg * scene.gravity_m_s2 * arm / inertia for arm, inertia in arms)


def velocity_owed(spin: float, gained: float, turn: float, lags_s: Pair, arm_x: float, arm_z: float) -> Pair:
    """What to take from the centroid's velocity before a turn so that support and spin have their own at its end, m/s.

    `spin`, rad/s, and what it `gained` in the last whole step; `turn`, rad; `arm` from the centroid to the vertex, m.

    A velocity is the tangent of the circle where its contact was solved, a lag behind its instant: it lacks lag ω² arm. A
    pedestal that slides shares that momentum, and it and the spin are off by it at first order. What the lack changes by in
    a turn, with arm' for ω × arm over ω, is ω² ((lag₁ − lag₀) arm + lag₀ turn arm') + 2 ω Δω lag₁ arm. Its part across the
    arm is also what the spin would lose: a solution keeps of a velocity only what lies along the new tangent.
    """
    lag_s, after_s = lags_s
    along = spin * (spin * (after_s - lag_s) + 2.0 * gained * after_s)
    across = spin * spin * lag_s * turn
    return along * arm_x - across * arm_z, along * arm_z + across * arm_x
