"""The table's motion step by step: the same for every contact engine."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import Excitation, ZeroExcitation
from harness.model.scene import Scene

Array = NDArray[np.float64]


def step_count(duration_s: float, dt_s: float) -> int:
    """Number of steps that reach `duration_s` (the last one may pass it by less than a step)."""
    # A duration that is a whole number of steps but for rounding takes no step more.
    return max(1, math.ceil(duration_s / dt_s * (1.0 - 1e-12)))


def apparent_gravity(scene: Scene, edges_s: Array) -> Array:
    """Gravity in the floor's accelerating frame, (−a_x, −a_y, −g − a_z), shape (n − 1, 3), m/s².

    Each row is the exact mean over its step [edges_s[i], edges_s[i+1]] (from the motion's velocity), so that a step's impulse
    is exact also where the acceleration jumps inside it.
    """
    base_excitation = scene.base_excitation
    means = [_mean_accel(item, edges_s) for item in (base_excitation.x, base_excitation.y, base_excitation.z)]
    gravity = -np.column_stack(means)
    gravity[:, 2] -= scene.gravity_m_s2
    return gravity


def greatest_pull_m_s2(scene: Scene) -> float:
    """A bound on what weight and table together can do, m/s²."""
    base_excitation = scene.base_excitation
    return scene.gravity_m_s2 + base_excitation.x.peak_m_s2 + base_excitation.y.peak_m_s2 + base_excitation.z.peak_m_s2


def _mean_accel(item: Excitation, edges_s: Array) -> Array:
    if isinstance(item, ZeroExcitation):
        return np.zeros(edges_s.size - 1)
    velocity = np.asarray(item.velocity_m_s(edges_s), dtype=np.float64)
    mean: Array = np.diff(velocity) / np.diff(edges_s)
    return mean


def table_displacement(scene: Scene, t_s: Array) -> Array:
    """Displacement of a moving table (x, y, z) at the given times, shape (n, 3), m; zero before t = 0."""
    base_excitation = scene.base_excitation
    later = np.maximum(t_s, 0.0)
    return np.column_stack(
        [np.asarray(item.displacement_m(later)) for item in (base_excitation.x, base_excitation.y, base_excitation.z)]
    )


def table_velocity(scene: Scene, t_s: Array) -> Array:
    """Velocity of a moving table (x, y, z) at the given times, shape (n, 3), m/s; zero before t = 0."""
    base_excitation = scene.base_excitation
    later = np.maximum(t_s, 0.0)
    return np.column_stack(
        [np.asarray(item.velocity_m_s(later)) for item in (base_excitation.x, base_excitation.y, base_excitation.z)]
    )
