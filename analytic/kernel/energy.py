"""The outcome from energy alone once the motion has ended (docs/model.md, section 7)."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import jit
from analytic.kernel.dynamics import place, vertex
from analytic.kernel.impact import impact
from analytic.kernel.joint_state import corner
from analytic.kernel.layout import (
    BASE_MASS,
    BY_ENERGY,
    DYNAMIC,
    FACET_RAD,
    GRAVITY,
    HAS_BASE,
    INERTIA,
    MASS,
    MOMENTUM,
    MU_KINETIC,
    MU_STATIC,
    OUTCOME,
    OUTCOME_MARGIN,
    OVERTURN,
    OVERTURNED_LEFT,
    OVERTURNED_RIGHT,
    PEAK,
    PEAK_TIME,
    PIVOT,
    PX,
    PZ,
    RATIO,
    S_OM,
    S_TH,
    SLIDE,
    STANDS,
    TOUCHES_WALL,
    WALL_ROTATION,
    WALL_SIDE,
    T,
    Task,
)
from analytic.kernel.memory import peek

UNKNOWN: Final = 0
"""Energy alone does not decide here."""
NEAR_TIE: Final = 1e-9
"""Relative distance of the energy to a barrier below which the run is integrated on."""
SPENT: Final = 1e-14
"""Kinetic energy in m g R below which a statue over its base stands."""
MAX_IMPACTS: Final = 2000


@jit
def _sticks(task: Task, j: float, energy: float, reach: float, lowest: float, radius: float) -> bool:
    """Whether contact, and the pedestal's friction, certainly hold on an arc with |X| ≤ reach and Z ≥ lowest."""
    p = task.p
    m, g = p[MASS], p[GRAVITY]
    turn2 = max(2.0 * (energy - m * g * lowest) / j, 0.0)
    v = m * (g - m * g * reach * reach / j - radius * turn2)
    if v <= 0.0:
        return False
    if p[HAS_BASE] == 0.0:
        return True
    normal = v + p[BASE_MASS] * g if p[DYNAMIC] > 0.0 else (m + p[BASE_MASS]) * g
    return bool(m * reach * max(m * g * radius / j, turn2) <= p[MU_STATIC] * normal)


@jit
def _reach(task: Task, theta: float) -> None:
    """Note a rotation that will be reached, at a time after this one that is not computed."""
    if abs(theta) > abs(task.r[PEAK]):
        task.r[PEAK], task.r[PEAK_TIME] = theta, task.s[T]


@jit
def _ahead(task: Task, pivot: int, side: int, theta: float, energy: float) -> tuple[int, float]:
    """Outcome of moving to a side where no facet lies ahead, UNKNOWN with angle 0 to turn back, 1 to integrate."""
    p = task.p
    x, z = vertex(task, pivot)
    weight = p[MASS] * p[GRAVITY] * math.sqrt(x * x + z * z)
    balance, wall = side * math.atan2(x, z), (p[WALL_ROTATION] if p[WALL_SIDE] == side else math.inf)
    top = weight if wall >= balance else weight * math.cos(wall - balance)
    if side * theta < min(balance, wall):
        margin = energy / top - 1.0
        task.r[OUTCOME_MARGIN] = min(task.r[OUTCOME_MARGIN], abs(margin))
        if abs(margin) < NEAR_TIE:
            return UNKNOWN, 1.0
        if margin < 0.0:
            _reach(task, side * (balance - math.acos(max(energy / weight, -1.0))))
            return UNKNOWN, 0.0
    if wall < p[OVERTURN]:
        _reach(task, side * wall)
        return TOUCHES_WALL, 0.0
    _reach(task, side * p[OVERTURN])
    return (OVERTURNED_RIGHT if side > 0 else OVERTURNED_LEFT), 0.0


@jit
def _landing(task: Task, pivot: int, facet: int, speed: float) -> tuple[int, float, bool]:
    """Pivot and θ̇ after landing on the facet with θ̇ = speed, and whether the pedestal stayed where it was."""
    p = task.p
    side = 1 if pivot == facet + 1 else -1
    xo, z, _ = corner(task, facet, side)
    xn, _, _ = corner(task, facet, -side)
    after, moved, _ = impact(
        p[MASS],
        p[BASE_MASS],
        p[INERTIA],
        xn,
        xo,
        z,
        speed,
        0.0,
        p[RATIO],
        p[MOMENTUM] > 0.0,
        p[MU_STATIC],
        p[MU_KINETIC],
        p[HAS_BASE] > 0.0,
    )
    return (facet if side > 0 else facet + 1), after, moved == 0.0


@jit
def _follow(task: Task) -> int:
    """Outcome of the free rocking from the present state, UNKNOWN where energy alone does not decide."""
    p, w = task.p, task.w
    m, g, last = p[MASS], p[GRAVITY], task.length[FACET_RAD]
    theta, omega, pivot = task.s[S_TH], task.s[S_OM], task.q[PIVOT]
    for _ in range(MAX_IMPACTS):
        j = place(task, theta, pivot)
        energy = 0.5 * j * omega * omega + m * g * w[PZ, 0]
        side = 1 if (omega > 0.0 or (omega == 0.0 and w[PX, 0] > 0.0)) else -1
        x, z = vertex(task, pivot)
        radius = math.sqrt(x * x + z * z)
        outer = pivot == last if side > 0 else pivot == 0
        if outer:
            reach, lowest = max(abs(w[PX, 0]), p[MU_STATIC] * p[HAS_BASE] * radius), w[PZ, 0]
            if w[PX, 0] * side <= 0.0 and not _sticks(task, j, energy, reach, lowest, radius):
                return UNKNOWN
            outcome, doubt = _ahead(task, pivot, side, theta, energy)
            if outcome != UNKNOWN or doubt > 0.0:
                return outcome
            side = -side
        facet = pivot if side > 0 else pivot - 1
        if facet < 0 or facet >= last:
            return UNKNOWN
        x, z, _ = corner(task, facet, 1 if pivot == facet + 1 else -1)
        if x * w[PX, 0] < 0.0 or not _sticks(task, j, energy, max(abs(x), abs(w[PX, 0])), min(z, w[PZ, 0]), radius):
            return UNKNOWN
        speed = side * math.sqrt(max(2.0 * (energy - m * g * z) / j, 0.0))
        pivot, omega, held = _landing(task, pivot, facet, speed)
        if not held:
            return UNKNOWN
        theta = peek(task.address[FACET_RAD], facet)
        xr, _, _ = corner(task, facet, 1)
        xl, _, _ = corner(task, facet, -1)
        if xr < 0.0 < xl and 0.5 * j * omega * omega <= SPENT * m * g * radius:
            return STANDS
    return UNKNOWN


@jit
def decide(task: Task) -> bool:
    """Set the outcome from the energy if it follows from it; both motions must be over."""
    q = task.q
    if q[SLIDE] != 0:
        return False
    outcome = STANDS if q[PIVOT] < 0 else _follow(task)
    if outcome == UNKNOWN:
        return False
    q[OUTCOME] = outcome
    task.c[BY_ENERGY] += 1
    return True
