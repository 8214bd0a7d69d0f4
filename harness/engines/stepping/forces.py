"""Forces and energy of a trajectory, from the balance of momentum of each body in each step.

An engine that adds impulses to velocities obeys Δv = g Δt + impulse/m exactly, so these are the engine's own contact
impulses, read without asking it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.engines.stepping.columns import Trajectory
from harness.model.history import Array
from harness.model.scene import Pedestal, Scene

WINDOW: Final = 8
"""Steps over which impulses are summed before a ratio is formed: a solver's noise from step to step is not a force."""
LEAST_SHARE: Final = 0.02
"""A normal impulse below this share of the weight's is no contact to form a ratio with."""


@dataclass(frozen=True, eq=False)
class Impulses:
    """Cumulative impulses, N s, shape (n,), on the statue at its base and on the whole at the floor."""

    statue_x: Array
    statue_z: Array
    floor_x: Array
    floor_z: Array


def impulses(scene: Scene, trajectory: Trajectory) -> Impulses:
    """Cumulative contact impulses of a trajectory; without a pedestal both are the same."""
    t_s, rate = trajectory.t_s, trajectory.statue_rate_m_s
    gravity = trajectory.gravity_xz_m_s2 * (t_s[1:] - t_s[:-1])[:, None]
    statue = scene.statue.mass_kg * (rate[1:] - rate[:-1] - gravity)
    held = _summed(statue)
    rate_below = trajectory.pedestal_rate_m_s
    if scene.pedestal is None or rate_below is None:
        return Impulses(*held, *held)
    return Impulses(*held, *_summed(statue + scene.pedestal.mass_kg * (rate_below[1:] - rate_below[:-1] - gravity)))


def _summed(parts: Array) -> tuple[Array, Array]:
    total = np.zeros((2, parts.shape[0] + 1))
    np.cumsum(parts.T, axis=1, out=total[:, 1:])
    return total[0], total[1]


def mean_forces(t_s: Array, impulses_n_s: Sequence[Array], grid_s: Array) -> Array:
    """Mean force, N, for each row of impulses over the interval before each time of the grid (the first repeats the second)."""
    force: Array = np.zeros((len(impulses_n_s), grid_s.size))
    if grid_s.size > 1:
        for row, impulse in zip(force, impulses_n_s, strict=True):
            row[:] = np.interp(grid_s, t_s, impulse)
        force[:, 1:] -= force[:, :-1].copy()
        force[:, 1:] /= grid_s[1:] - grid_s[:-1]
        force[:, 0] = force[:, 1]
    return force


def force_limits(scene: Scene, trajectory: Trajectory, impulses: Impulses) -> dict[str, float]:
    """Greatest friction ratio needed at the statue's base, least normal forces there and at the floor."""
    width = min(WINDOW, trajectory.t_s.size - 1)
    if width < 1:
        return {}
    span = trajectory.t_s[width:] - trajectory.t_s[:-width]
    normal = (impulses.statue_z[width:] - impulses.statue_z[:-width]) / span
    shear = (impulses.statue_x[width:] - impulses.statue_x[:-width]) / span
    floor = (impulses.floor_z[width:] - impulses.floor_z[:-width]) / span
    if scene.pedestal is not None:
        # Along and across its top, where that is tilted.
        tilt = 0.5 * (trajectory.tilt_rad[width:] + trajectory.tilt_rad[:-width])
        cos, sin = np.cos(tilt), np.sin(tilt)
        shear, normal = shear * cos - normal * sin, shear * sin + normal * cos
    held = normal > LEAST_SHARE * scene.statue.mass_kg * scene.gravity_m_s2
    needed = float((np.abs(shear[held]) / normal[held]).max()) if held.any() else 0.0
    return {
        "statue_friction_needed": needed,
        "statue_normal_least_n": float(normal.min()),
        "floor_normal_least_n": float(floor.min()),
    }


def pedestal_inertia_kg_m2(pedestal: Pedestal) -> float:
    """Moment of inertia about its centroid, for a rotation in the rocking plane."""
    w, _, h = pedestal.half_m
    return pedestal.mass_kg * (w * w + h * h) / 3.0


def energy_j(scene: Scene, trajectory: Trajectory) -> Array:
    """Mechanical energy in the table's frame, J, shape (n,): kinetic and potential in gravity, zero as at rest upright."""
    statue, gravity = scene.statue, scene.gravity_m_s2
    rise = trajectory.statue_xz_m[:, 1] - trajectory.statue_xz_m[0, 1]
    total = 0.5 * statue.mass_kg * np.sum(trajectory.statue_rate_m_s**2, axis=1)
    total += 0.5 * statue.inertia_kg_m2 * trajectory.theta_rate_rad_s**2 + statue.mass_kg * gravity * rise
    if scene.pedestal is not None and trajectory.pedestal_xz_m is not None and trajectory.pedestal_rate_m_s is not None:
        lifted = trajectory.pedestal_xz_m[:, 1] - trajectory.pedestal_xz_m[0, 1]
        total += scene.pedestal.mass_kg * (0.5 * np.sum(trajectory.pedestal_rate_m_s**2, axis=1) + gravity * lifted)
        if trajectory.pedestal_spin_rad_s is not None:
            total += 0.5 * pedestal_inertia_kg_m2(scene.pedestal) * trajectory.pedestal_spin_rad_s**2
    return np.asarray(total)


def energy_lost_j(scene: Scene, trajectory: Trajectory, energy: Array) -> Array:
    """What the table's motion put in so far less the energy (`energy_j`), J, shape (n,): contacts may only make it grow."""
    given = np.zeros(trajectory.t_s.size)
    extra = trajectory.gravity_xz_m_s2 + np.array([0.0, scene.gravity_m_s2])
    step = trajectory.t_s[1:] - trajectory.t_s[:-1]
    bodies = [(scene.statue.mass_kg, trajectory.statue_rate_m_s)]
    if scene.pedestal is not None and trajectory.pedestal_rate_m_s is not None:
        bodies.append((scene.pedestal.mass_kg, trajectory.pedestal_rate_m_s))
    for mass, rate in bodies:
        # The work of a force that is constant in a step is exact with the mean of the velocities at its ends.
        power = mass * np.sum(extra * 0.5 * (rate[1:] + rate[:-1]), axis=1)
        given[1:] += np.cumsum(power * step)
    return np.asarray(given - energy)


def energy_gained_j(lost_j: Array) -> float:
    """Largest fall, J, of what is lost (`energy_lost_j`): energy from nowhere."""
    return float((np.maximum.accumulate(lost_j) - lost_j).max())


def lost_in_impacts_j(t_s: Array, lost_j: Array, impact_times_s: Sequence[float]) -> float:
    """What is lost, J, in the steps around the impacts: one before each to two after, as a solver's contact settles in two."""
    after = np.searchsorted(t_s, np.array(impact_times_s))
    last = t_s.size - 1
    return float(np.sum(lost_j[np.minimum(after + 2, last)] - lost_j[np.clip(after - 1, 0, last)]))
