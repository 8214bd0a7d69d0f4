"""Landing on a facet: the impact, and the end of a sequence of ever smaller ones."""

from __future__ import annotations

from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.impact import both_corners, impact, kinetic
from analytic.kernel.joint_state import corner, load
from analytic.kernel.layout import (
    AX,
    BASE_MASS,
    ENERGY_GAINED,
    ENERGY_LOST,
    FACET,
    FACET_RAD,
    GE,
    GRAVITY,
    HAS_BASE,
    IMPACT,
    IMPACTS,
    INERTIA,
    MASS,
    MOMENTUM,
    MU_KINETIC,
    MU_STATIC,
    PIVOT,
    RATIO,
    REST_ANGLE,
    S_OM,
    S_TH,
    S_V,
    SLIDE,
    TIME_SCALE,
    WANT_VALIDITY,
    ZENO,
    Task,
)
from analytic.kernel.memory import peek
from analytic.kernel.track import settle
from analytic.kernel.validity import note_impact

Lever = tuple[int, float, float]
"""Side of a corner, X of the centroid from it, and the statue's inertia about it."""
STILL: Final = 1e-15
"""Statue and pedestal stand when their velocities are this share of gravity times the statue's time constant: what follows would
come within what the clock resolves."""


@inlined
def _drops(task: Task, omega: float, rate: float, z: float, own: Lever, other: Lever) -> bool:
    """Whether the rebound that starts at omega is too low to matter, by the smaller of the moments that hold the statue down."""
    load(task)
    gravity, accel = task.w[GE, 0], task.w[AX, 0]
    if task.p[HAS_BASE] > 0.0 and rate != 0.0:
        accel = -(task.p[MU_KINETIC] * gravity) if rate > 0.0 else task.p[MU_KINETIC] * gravity
    lift = 0.5 * omega * omega
    for side, x, j in (own, other):
        hold = -side * task.p[MASS] * (gravity * x - accel * z)
        if hold <= 0.0 or lift * j >= task.p[REST_ANGLE] * hold:
            return False
    return True


@jit
def land(task: Task, facet: int, residual: float) -> None:
    """Apply the impact on the facet (docs/model.md, section 3), or rest when the rebound is too small to matter."""
    p, s, q, r, c = task.p, task.s, task.q, task.r, task.c
    m, total = p[MASS], p[MASS] + p[BASE_MASS]
    old_side = 1 if q[PIVOT] == facet + 1 else -1
    xo, z, jo = corner(task, facet, old_side)
    xn, _, jn = corner(task, facet, -old_side)
    omega, rate, stuck = s[S_OM], s[S_V], q[SLIDE] == 0
    mu = p[MU_STATIC] if stuck else p[MU_KINETIC]
    after, moved, normal = impact(
        m,
        p[BASE_MASS],
        p[INERTIA],
        xn,
        xo,
        z,
        omega,
        rate,
        p[RATIO],
        p[MOMENTUM] > 0.0,
        mu,
        p[MU_KINETIC],
        p[HAS_BASE] > 0.0,
    )
    s[S_TH], q[FACET] = peek(task.address[FACET_RAD], facet), facet
    # Noted as they are: what is dropped below is a sequence of such impacts, no single one that stops the statue at once.
    pushed, pressed, moved_by = m * ((moved - rate) + z * (after - omega)), normal, moved - rate
    if after != 0.0 and _drops(task, after, moved, z, (old_side, xo, jo), (-old_side, xn, jn)):
        c[ZENO] += 1
        after, moved = 0.0, rate
        # a stuck pedestal stays stuck: the push of a dropped rebound would start a slip as small, that ends in another impact
        if p[HAS_BASE] > 0.0 and p[MOMENTUM] > 0.0 and not stuck:
            after, moved, _ = both_corners(m, total, xo, z, omega, rate, mu, p[MU_KINETIC])
    if max(abs(after) * z, abs(moved)) <= STILL * p[GRAVITY] * p[TIME_SCALE]:
        after, moved = 0.0, 0.0  # where each halt lifts the statue, whose landing pushes the pedestal again, for ever
    s[S_OM], s[S_V] = after, moved
    c[IMPACTS] += 1
    change = kinetic(m, total, jn, z, after, moved) - kinetic(m, total, jo, z, omega, rate)
    r[ENERGY_GAINED] += max(change, 0.0)
    r[ENERGY_LOST] += max(-change, 0.0)
    new = facet if old_side > 0 else facet + 1
    if p[WANT_VALIDITY] > 0.0:
        note_impact(task, new, pushed, pressed, moved_by)
    q[PIVOT] = new if after != 0.0 else -1
    q[SLIDE] = 0
    settle(task, IMPACT, omega, rate, after == 0.0, change, residual)
