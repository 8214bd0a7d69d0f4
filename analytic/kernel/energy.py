"""The outcome from energy alone once the motion has ended (docs/model.md, section 7).

With the floor at rest and the pedestal stuck, E = ½ J θ̇² + m g Z is constant between impacts, and each impact gives the next
rate: no step is needed to know which barrier is passed. Wherever a bound below cannot be shown, the run is integrated instead.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel import codes
from analytic.kernel.compiler import jit
from analytic.kernel.dynamics import place, vertex
from analytic.kernel.impact import impact
from analytic.kernel.joint_state import corner
from analytic.kernel.memory import load_double
from analytic.kernel.records import Task
from analytic.kernel.track import note_peak
from analytic.kernel.validity import leave

UNKNOWN: Final = 0
"""Energy alone does not decide here."""
EXHAUSTED: Final = -1
"""Nor after all the impacts that are followed."""
NEAR_TIE: Final = 1e-9
"""Relative distance of the energy to a barrier below which the run is integrated on: far above the rounding of E, far below any
scatter of a real statue's numbers."""
SPENT: Final = 1e-14
"""Kinetic energy in m g R below which a statue over its base stands: it lifts the centroid by less than 1e-14 R."""
MAX_IMPACTS: Final = 2000
"""Impacts followed: a statue that keeps 0.992 of its rate at each has spent its energy by then."""
NEXT_IMPACTS: Final = 32
"""Impacts that are integrated before so many are followed again: a round stone loses little on each of its small facets."""


@jit
def _sticks(task: Task, j: float, energy: float, reach: float, lowest: float, radius: float) -> bool:
    """Whether contact, and the pedestal's friction, certainly hold on an arc with |X| ≤ reach and Z ≥ lowest."""
    params = task.params
    m, g = params.mass_kg, params.gravity_m_s2
    turn2 = max(2.0 * (energy - m * g * lowest) / j, 0.0)  # largest θ̇² on the arc
    # V = m (g + Z''), Z'' = −X θ̈ − Z θ̇² and θ̈ = m g X/J: least where |X| is largest and the turn fastest
    v = m * (g - m * g * reach * reach / j - radius * turn2)
    if v <= 0.0:
        return False
    if not params.has_pedestal:
        return True
    normal = v + params.pedestal_mass_kg * g if params.dynamic_normal else (m + params.pedestal_mass_kg) * g
    # F = m X'' = m X (m g Z/J − θ̇²): a difference, at most m |X| times the larger of its terms
    return bool(m * reach * max(m * g * radius / j, turn2) <= params.floor_static * normal)


@jit
def _wall_ahead(task: Task, pivot: int, side: int, theta: float) -> float:
    """Rotation to that side, from theta on, at which the statue touches the wall as it turns about a vertex of its base on a
    pedestal that stays; infinite if it does not."""
    params, base = task.params, task.base
    if params.wall_side != side:
        return math.inf
    x, z = load_double(base.x, pivot), load_double(base.z, pivot)
    room, first = params.wall_m - side * (load_double(base.stands, pivot) + task.state.slip_m), math.inf
    for i in range(base.n_outline):
        dx, dz = side * (load_double(base.outline_x, i) - x), load_double(base.outline_z, i) - z
        radius = math.sqrt(dx * dx + dz * dz)
        if radius > abs(room):  # else it passes below the wall's face
            turn = math.atan2(dz, dx) - math.acos(room / radius)
            if turn >= side * theta:
                first = min(first, turn)
    return first


@jit
def _note_ahead(task: Task, side: int, lean: float) -> None:
    """A lean to that side that will be reached, from now on: when it will be is not computed."""
    params = task.params
    note_peak(task, side * lean, task.state.time_s)
    if params.keep_validity and lean > (params.base_right_rad if side > 0 else params.base_left_rad):
        leave(task, task.state.time_s, codes.BY_LEAN)


@jit
def _ahead(task: Task, pivot: int, side: int, theta: float, energy: float) -> tuple[int, float]:
    """Outcome of moving to a side where no facet lies ahead, UNKNOWN with angle 0 to turn back, 1 to integrate."""
    params = task.params
    x, z = vertex(task, pivot)
    weight = params.mass_kg * params.gravity_m_s2 * math.sqrt(x * x + z * z)
    balance, wall = side * math.atan2(x, z), _wall_ahead(task, pivot, side, theta)
    # the barrier: the centroid above its corner, or where the wall stops it before
    top = weight if wall >= balance else weight * math.cos(wall - balance)
    if side * theta < min(balance, wall):
        margin = energy / top - 1.0
        task.results.outcome_margin = min(task.results.outcome_margin, abs(margin))
        if abs(margin) < NEAR_TIE:
            return UNKNOWN, 1.0
        if margin < 0.0:
            _note_ahead(task, side, balance - math.acos(max(energy / weight, -1.0)))
            return UNKNOWN, 0.0
    if wall < params.overturn_rad:
        _note_ahead(task, side, wall)
        return codes.TOUCHES_WALL, 0.0
    _note_ahead(task, side, params.overturn_rad)
    return (codes.OVERTURNED_RIGHT if side > 0 else codes.OVERTURNED_LEFT), 0.0


@jit
def _landing(task: Task, pivot: int, facet: int, speed: float) -> tuple[int, float, bool]:
    """Pivot and θ̇ after landing on the facet with θ̇ = speed, and whether the pedestal stayed where it was."""
    params = task.params
    side = 1 if pivot == facet + 1 else -1
    xo, z, _ = corner(task, facet, side)
    xn, _, _ = corner(task, facet, -side)
    after, moved, _ = impact(params, xn, xo, z, speed, 0.0, params.floor_static, params.floor_kinetic)
    return (facet if side > 0 else facet + 1), after, moved == 0.0


@jit
def _follow(task: Task) -> int:
    """Outcome of the free rocking from the present state, UNKNOWN where energy alone does not decide."""
    params, series = task.params, task.series
    m, g, last = params.mass_kg, params.gravity_m_s2, task.base.n_facets
    theta, omega, pivot = task.state.theta_rad, task.state.theta_rate_rad_s, task.state.pivot
    for _ in range(MAX_IMPACTS):
        j = place(task, theta, pivot)
        energy = 0.5 * j * omega * omega + m * g * series.pivot_z[0]
        side = 1 if (omega > 0.0 or (omega == 0.0 and series.pivot_x[0] > 0.0)) else -1
        x, z = vertex(task, pivot)
        radius = math.sqrt(x * x + z * z)
        outer = pivot == last if side > 0 else pivot == 0
        if outer:
            reach, lowest = (
                max(abs(series.pivot_x[0]), params.floor_static * params.has_pedestal * radius),
                series.pivot_z[0],
            )
            if series.pivot_x[0] * side <= 0.0 and not _sticks(task, j, energy, reach, lowest, radius):
                return UNKNOWN
            outcome, doubt = _ahead(task, pivot, side, theta, energy)
            if outcome != UNKNOWN or doubt > 0.0:
                return outcome
            side = -side
        facet = pivot if side > 0 else pivot - 1
        x, z, _ = corner(task, facet, 1 if pivot == facet + 1 else -1)
        if not _sticks(task, j, energy, max(abs(x), abs(series.pivot_x[0])), min(z, series.pivot_z[0]), radius):
            return UNKNOWN
        wall = _wall_ahead(task, pivot, side, theta)
        if x * series.pivot_x[0] >= 0.0 and z > series.pivot_z[0]:  # it rises towards a facet that it may not reach
            margin = energy / (m * g * z) - 1.0
            if abs(margin) < NEAR_TIE:
                return UNKNOWN
            if margin < 0.0:
                xv, zv = vertex(task, pivot)
                turned = side * math.atan2(xv, zv) - math.acos(energy / (m * g * radius))
                _note_ahead(task, side, min(turned, wall))
                if wall < turned:
                    return codes.TOUCHES_WALL
                omega = -omega  # it turns back, and comes by here the other way
                continue
        if x * series.pivot_x[0] < 0.0:  # the centroid must pass over the corner first
            margin = energy / (m * g * radius) - 1.0
            task.results.outcome_margin = min(task.results.outcome_margin, abs(margin))
            if abs(margin) < NEAR_TIE:
                return UNKNOWN
            if margin < 0.0:
                beyond = pivot == last if side < 0 else pivot == 0
                return _ahead(task, pivot, -side, theta, energy)[0] if beyond else UNKNOWN
        if wall < side * load_double(task.base.facets, facet):
            _note_ahead(task, side, wall)
            return codes.TOUCHES_WALL
        speed = side * math.sqrt(max(2.0 * (energy - m * g * z) / j, 0.0))
        pivot, omega, held = _landing(task, pivot, facet, speed)
        if not held:
            return UNKNOWN
        theta = load_double(task.base.facets, facet)
        xr, _, _ = corner(task, facet, 1)
        xl, _, _ = corner(task, facet, -1)
        if xr < 0.0 < xl and 0.5 * j * omega * omega <= SPENT * m * g * radius:
            return codes.STANDS
    return EXHAUSTED


@jit
def decide(task: Task) -> bool:
    """Set the outcome from the energy if it follows from it; both motions must be over."""
    state = task.state
    if state.slide != 0 or task.counts.impacts < state.followed:
        return False
    outcome = codes.STANDS if state.pivot < 0 else _follow(task)
    if outcome == EXHAUSTED:
        state.followed = task.counts.impacts + NEXT_IMPACTS
    if outcome in (EXHAUSTED, UNKNOWN):
        return False
    state.outcome = outcome
    task.counts.energy_endings += 1
    return True
