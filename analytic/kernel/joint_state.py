"""The joint state {rest, rocking right, left} × {stuck, sliding +, −} after a jump or an event (docs/model.md, section 2).

Only what is at rest is free. A joint state is feasible when its own accelerations keep its signs; where an acceleration
or a limit is zero at the instant itself, its first derivative that is not decides.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.dynamics import expand, vertex
from analytic.kernel.forcing import coefficients
from analytic.kernel.layout import (
    ABS,
    ALONG_X,
    ALONG_Z,
    AX,
    BASE_MASS,
    CENTROID,
    DEGREE,
    DET,
    DYNAMIC,
    EVENT,
    FACET,
    FACET_RAD,
    FLOOR,
    FRESH,
    GE,
    GRAVITY,
    HAS_BASE,
    INERTIA,
    LIFT_OFF,
    LOADED,
    MASS,
    MU_STATIC,
    NORMAL,
    OM,
    PARADOX,
    PIVOT,
    PIVOT_V,
    PX,
    RATE,
    S_OM,
    S_TH,
    S_U,
    S_V,
    SLIDE,
    SLIP,
    TABLE,
    TH,
    TIME_SCALE,
    Task,
)
from analytic.kernel.memory import peek, set_term, term
from analytic.kernel.polynomial import leading

WEIGHTLESS: Final = 1e-9
"""Share of gravity below which nothing is held down: both uplift conditions are then met at once."""
LOW_ORDER: Final = 6
"""Order to which a candidate's accelerations are compared with zero."""
UNSURE: Final = -1
"""All terms so far are zero."""


@inlined
def load(task: Task) -> None:
    """Fill the first column of the workspace, and the floor's accelerations unless they stand there."""
    w, s, q = task.w, task.s, task.q
    w[TH, 0], w[OM, 0], w[SLIP, 0], w[RATE, 0] = s[S_TH], s[S_OM], s[S_U], s[S_V]
    if q[LOADED] == 0:
        q[DEGREE] = coefficients(task, ALONG_X, AX)
        q[DEGREE + 1] = coefficients(task, ALONG_Z, GE)
        w[GE, 0] += task.p[GRAVITY]
        q[LOADED] = 1


@inlined
def corner(task: Task, facet: int, side: int) -> tuple[float, float, float]:
    """X and Z of the facet's corner on that side, resting on the facet, and the statue's inertia about it."""
    k = facet + 1 if side > 0 else facet
    x, z = vertex(task, k)
    angle = peek(task.address[FACET_RAD], facet)
    j = task.p[INERTIA] + task.p[MASS] * (x * x + z * z)
    if angle == 0.0:
        return -x, z, j
    sine, cosine = math.sin(angle), math.cos(angle)
    return z * sine - x * cosine, x * sine + z * cosine, j


@inlined
def lift_margin(task: Task, side: int, n: int) -> float:
    """Write the coefficients 0..n of the moment that keeps the resting statue down on that side; return their scale."""
    x, z, _ = corner(task, task.q[FACET], side)
    w = task.w
    for k in range(n + 1):
        set_term(w, EVENT, k, -side * (term(w, GE, k) * x - term(w, ABS, k) * z))
    return float(abs(w[GE, 0] * x) + abs(w[ABS, 0] * z))


@inlined
def stick_margin(task: Task, side: int, n: int) -> float:
    """Write the coefficients 0..n of μ_s N ± F, which falls to zero as the pedestal starts to that side; return their scale."""
    w, p = task.w, task.p
    total = p[MASS] + p[BASE_MASS]
    row, factor = (NORMAL, p[MU_STATIC]) if p[DYNAMIC] > 0.0 else (GE, p[MU_STATIC] * total)
    for k in range(n + 1):
        set_term(w, EVENT, k, factor * term(w, row, k) + side * term(w, FLOOR, k))
    return float(total * (abs(w[GE, 0]) + abs(w[AX, 0])))


@inlined
def omega_zeros(task: Task, n: int) -> int:
    """Leading coefficients of θ̇ that are rounding only."""
    scale = task.p[TIME_SCALE] * (abs(task.w[GE, 0]) + abs(task.w[ABS, 0])) / task.p[CENTROID]
    return leading(task.w, OM, n, scale, task.p[TIME_SCALE])


@inlined
def rate_zeros(task: Task, n: int) -> int:
    """Leading coefficients of u̇ that are rounding only."""
    scale = task.p[TIME_SCALE] * (abs(task.w[GE, 0]) + abs(task.w[AX, 0]))
    return leading(task.w, RATE, n, scale, task.p[TIME_SCALE])


@inlined
def falling(task: Task) -> bool:
    """Whether the statue leans beyond its balance point and moves away: losing its corner then ends no run."""
    pivot, w = task.q[PIVOT], task.w
    right = pivot == task.length[FACET_RAD] and w[PX, 0] > 0.0 and w[OM, 0] > 0.0
    return bool(right or (pivot == 0 and w[PX, 0] < 0.0 and w[OM, 0] < 0.0))


@inlined
def _holds(task: Task, scale: float, n: int) -> int:
    """1 if the margin in the EVENT row is positive or zero for ever, 0 if not, UNSURE if that takes more than n terms."""
    lead = leading(task.w, EVENT, n, scale, task.p[TIME_SCALE])
    if lead > n:
        return 1 if n == LOW_ORDER - 1 else UNSURE
    return 1 if task.w[EVENT, lead] > 0.0 else 0


@inlined
def _moves(task: Task, row: int, lead: int, n: int, sign: int) -> int:
    """1 if the rate in the row grows to that side, 0 if not, UNSURE if that takes more than n terms."""
    if lead > n:
        return 0 if n == LOW_ORDER else UNSURE
    return 1 if task.w[row, lead] * sign >= 0.0 else 0


@inlined
def _keeps(task: Task, pivot: int, slide: int, rock_free: bool, slide_free: bool, n: int) -> int:
    """1 if the accelerations of the expanded joint state keep its signs, 0 if not, UNSURE if that takes more than n terms."""
    if rock_free and pivot >= 0:
        kept = _moves(task, OM, omega_zeros(task, n), n, 1 if pivot > task.q[FACET] else -1)
        if kept != 1:
            return kept
    if slide_free and slide != 0:
        kept = _moves(task, RATE, rate_zeros(task, n), n, slide)
        if kept != 1:
            return kept
    for side in (1, -1):
        if rock_free and pivot < 0:
            kept = _holds(task, lift_margin(task, side, n - 1), n - 1)
            if kept != 1:
                return kept
        if slide_free and slide == 0:
            kept = _holds(task, stick_margin(task, side, n - 1), n - 1)
            if kept != 1:
                return kept
    return 1


@jit
def _feasible(task: Task, pivot: int, slide: int, rock_free: bool, slide_free: bool) -> int:
    """1 feasible, 0 not, or the ending that the state would be (LIFT_OFF, PARADOX); more terms only where the first are zero."""
    w = task.w
    for n in (1, 2, LOW_ORDER):
        load(task)
        expand(task, pivot, slide, n, math.inf)
        if pivot >= 0 and slide != 0 and w[DET, 0] <= 0.0:
            return PARADOX
        if w[GE, 0] <= WEIGHTLESS * task.p[GRAVITY] or (task.p[HAS_BASE] > 0.0 and w[NORMAL, 0] <= 0.0):
            return LIFT_OFF
        if w[PIVOT_V, 0] <= 0.0 and (rock_free or not falling(task)):
            return LIFT_OFF
        kept = _keeps(task, pivot, slide, rock_free, slide_free, n)
        if kept != UNSURE:
            return kept
    return 1


@jit
def choose(task: Task, rock_free: bool) -> tuple[int, int]:
    """Choose the joint state, the stuck one if several are feasible; return how many were (1 if no events are kept), and
    0 or the run's ending."""
    q = task.q
    slide_free = task.p[HAS_BASE] > 0.0 and task.s[S_V] == 0.0
    load(task)
    lead = -1 if task.w[AX, 0] > 0.0 else 1
    found, ending = 0, 0
    pivot_found, slide_found = q[PIVOT], q[SLIDE]
    for i in range(3 if slide_free else 1):
        slide = q[SLIDE] if not slide_free else (0 if i == 0 else (lead if i == 1 else -lead))
        for j in range(3 if rock_free else 1):
            pivot = q[PIVOT]
            if rock_free:
                pivot = -1
                if j > 0:
                    pivot = q[FACET] + 1 if (lead > 0) == (j == 1) else q[FACET]
            verdict = _feasible(task, pivot, slide, rock_free, slide_free)
            if verdict == 1:
                found += 1
                if found == 1:
                    pivot_found, slide_found = pivot, slide
                if task.length[TABLE] == 0:
                    q[PIVOT], q[SLIDE], q[FRESH] = pivot, slide, 1
                    return found, 0
            elif verdict != 0:
                ending = max(ending, verdict)
    if found == 0:
        return 0, ending if ending != 0 else PARADOX
    q[PIVOT], q[SLIDE], q[FRESH] = pivot_found, slide_found, 1
    return found, 0
