"""Taylor coefficients of the motion in each joint state (docs/model.md, section 2), order by order.

About the vertex (x, z) of the base the centroid stands at X = −x cos θ + (h − z) sin θ, Z = x sin θ + (h − z) cos θ from the
pivot, so that X' = Zθ̇ and Z' = −Xθ̇: no sine or cosine is needed beyond a step's first instant. With σ = sgn u̇ and
κ = σμ_k, sliding gives

    [J − m²/M Z P] θ̈ = m g_e (X + κZ) − m²/M Z Q θ̇²,   P = Z − κ'X,  Q = X + κ'Z,
    A = −κ g_e − m/M d(Pθ̇)/dt,

where κ' = κ when the friction follows the true normal force and 0 when it follows M g_e; sticking gives A = a_x and
J θ̈ = m (g_e X − A Z).
"""

from __future__ import annotations

import math
from typing import Final

from analytic._jit import jit
from analytic.borrowed import peek
from analytic.layout import (
    ABS,
    ACC,
    AX,
    BASE_MASS,
    BASE_X,
    BASE_Z,
    CENTROID,
    DEGREE,
    DET,
    DYNAMIC,
    FACET_RAD,
    FLOOR,
    GE,
    INERTIA,
    INVERSE,
    MASS,
    MU_KINETIC,
    NORMAL,
    OM,
    PIVOT,
    PIVOT_H,
    PIVOT_V,
    PX,
    PZ,
    RATE,
    SLIP,
    TH,
    TIME_SCALE,
    TOLERANCE,
    W2,
    WANT_VALIDITY,
    XW,
    ZW,
    ZX,
    ZZ,
    Floats,
    Task,
)

AIM: Final = 1.25
"""Steps towards an event end beyond its first guess by this factor, so that the event lies inside."""


@jit
def vertex(task: Task, k: int) -> tuple[float, float]:
    """Where vertex k stands: x from below the centroid, and the centroid's height above it, m."""
    return peek(task.address[BASE_X], k), task.p[CENTROID] - peek(task.address[BASE_Z], k)


@jit
def place(task: Task, theta: float, pivot: int) -> float:
    """Write X and Z of the pivot at rotation theta into the workspace; return the statue's inertia about it, kg m²."""
    x, z = vertex(task, pivot)
    if theta == 0.0:
        task.w[PX, 0], task.w[PZ, 0] = -x, z
    else:
        sine, cosine = math.sin(theta), math.cos(theta)
        task.w[PX, 0] = z * sine - x * cosine
        task.w[PZ, 0] = x * sine + z * cosine
    return float(task.p[INERTIA] + task.p[MASS] * (x * x + z * z))


@jit
def _advance(w: Floats, i: int, sx: float, sz: float, acc: float) -> None:
    """Coefficient i + 1 of θ̇, θ, X and Z from coefficient i of θ̈, Xθ̇ and Zθ̇."""
    w[XW, i], w[ZW, i] = sx, sz
    inverse = INVERSE[i + 1]
    w[OM, i + 1] = acc * inverse
    w[TH, i + 1] = w[OM, i] * inverse
    w[PX, i + 1] = sz * inverse
    w[PZ, i + 1] = -(sx * inverse)


@jit
def _fall(gap: float, speed: float, pull: float) -> float:
    """When gap + speed t + pull t²/2, a gap from 0 on, closes; infinite if it does not."""
    left = speed * speed - 2.0 * pull * gap
    if left < 0.0 or (speed >= 0.0 and pull >= 0.0):
        return math.inf
    root = math.sqrt(left)
    time = (speed + root) / -pull if speed >= 0.0 else 2.0 * gap / (root - speed)
    return time if time > 0.0 else math.inf


@jit
def _aim(task: Task, h: float) -> float:
    """The step, at most h, that ends a little after the landing foreseen from the first terms."""
    w, pivot = task.w, task.q[PIVOT]
    if pivot > 0:
        gap = w[TH, 0] - peek(task.address[FACET_RAD], pivot - 1)
        h = min(h, AIM * _fall(gap, w[OM, 0], w[OM, 1]))
    if pivot < task.length[FACET_RAD]:
        gap = peek(task.address[FACET_RAD], pivot) - w[TH, 0]
        h = min(h, AIM * _fall(gap, -w[OM, 0], -w[OM, 1]))
    return h


@jit
def _last_products(w: Floats, n: int) -> None:
    sx, sz = 0.0, 0.0
    for k in range(n + 1):
        sx += w[PX, k] * w[OM, n - k]
        sz += w[PZ, k] * w[OM, n - k]
    w[XW, n], w[ZW, n] = sx, sz


@jit
def rock_stuck(task: Task, n: int, m_over_j: float, h: float, tol: float) -> tuple[int, float]:
    """Rocking on a support that follows the floor; returns the order reached, n or less, and the step, h or less."""
    w, deg_x, deg_z = task.w, task.q[DEGREE], task.q[DEGREE + 1]
    power, small = 1.0, 0
    for i in range(n):
        sx, sz, moment = 0.0, 0.0, 0.0
        for k in range(i + 1):
            sx += w[PX, k] * w[OM, i - k]
            sz += w[PZ, k] * w[OM, i - k]
        for k in range(min(i, deg_z) + 1):
            moment += w[GE, k] * w[PX, i - k]
        for k in range(min(i, deg_x) + 1):
            moment -= w[AX, k] * w[PZ, i - k]
        _advance(w, i, sx, sz, m_over_j * moment)
        if i == 0 and tol > 0.0:
            h = _aim(task, h)
        power *= h
        pushed = m_over_j * (abs(w[AX, i] * w[PZ, 0]) + abs(w[GE, i] * w[PX, 0])) * INVERSE[i + 1]
        small = small + 1 if max(abs(w[OM, i + 1]), pushed) * power <= tol else 0
        if small >= 2 and i >= 3:
            n = i + 1
            break
    _last_products(w, n)
    for k in range(n + 1):
        w[RATE, k] = 0.0
        w[ABS, k] = w[AX, k]
        if k > 0:
            w[SLIP, k] = 0.0
    return n, h


@jit
def rock_slide(
    task: Task, n: int, m: float, m_total: float, j: float, kappa: float, kappa_n: float, h: float, tol: float
) -> tuple[int, float]:
    """Rocking on a sliding pedestal; returns as ``rock_stuck``."""
    w, deg_z, length_m = task.w, task.q[DEGREE + 1], task.p[CENTROID]
    ratio = m / m_total
    power, small, per_det = 1.0, 0, 0.0
    for i in range(n):
        sx, sz, so, szx, szz = 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(i + 1):
            sx += w[PX, k] * w[OM, i - k]
            sz += w[PZ, k] * w[OM, i - k]
            so += w[OM, k] * w[OM, i - k]
            szx += w[PZ, k] * w[PX, i - k]
            szz += w[PZ, k] * w[PZ, i - k]
        w[W2, i], w[ZX, i], w[ZZ, i] = so, szx, szz
        w[DET, i] = -(m * ratio) * (szz - kappa_n * szx)
        if i == 0:
            w[DET, 0] += j
            per_det = 1.0 / w[DET, 0]
        centrifugal = 0.0
        implicit = 0.0
        for k in range(i + 1):
            centrifugal += (w[ZX, k] + kappa_n * w[ZZ, k]) * w[W2, i - k]
        for k in range(1, i + 1):
            implicit += w[DET, k] * w[ACC, i - k]
        weight = 0.0
        for k in range(min(i, deg_z) + 1):
            weight += w[GE, k] * (w[PX, i - k] + kappa * w[PZ, i - k])
        w[ACC, i] = (m * weight - (m * ratio) * centrifugal - implicit) * per_det
        _slide_coefficient(w, i, ratio, kappa, kappa_n, sx, sz)
        _advance(w, i, sx, sz, w[ACC, i])
        if i == 1 and tol > 0.0:
            h = _aim(task, h)
            halting = w[RATE, 0] * w[RATE, 1] < 0.0
            h = min(h, AIM * abs(w[RATE, 0] / w[RATE, 1])) if halting else h
            power = h
        # θ̇ does not feel the floor while the pedestal slides; u̇ does, and may need more terms
        settled = abs(w[RATE, i]) * power <= tol * length_m
        power *= h
        small = small + 1 if settled and abs(w[OM, i + 1]) * power <= tol else 0
        if small >= 2 and i >= 4:
            n = i + 1
            break
    _last_products(w, n)
    _slide_coefficient(w, n, ratio, kappa, kappa_n, w[XW, n], w[ZW, n])
    for i in range(n):
        w[ABS, i] = -(kappa * w[GE, i]) - ratio * (i + 1) * (w[ZW, i + 1] - kappa_n * w[XW, i + 1])
    return n, h


@jit
def _slide_coefficient(w: Floats, i: int, ratio: float, kappa: float, kappa_n: float, sx: float, sz: float) -> None:
    """Coefficient i of the sliding velocity: v' = −κ g_e − a_x − m/M (Pθ̇)'."""
    if i > 0:
        w[RATE, i] = -(kappa * w[GE, i - 1] + w[AX, i - 1]) * INVERSE[i] - ratio * (sz - kappa_n * sx)
        w[SLIP, i] = w[RATE, i - 1] * INVERSE[i]


@jit
def at_rest(w: Floats, n: int, slide: int, kappa: float) -> None:
    """The statue standing on its support, which is stuck (slide 0) or slides with A = −κ g_e."""
    for k in range(n + 1):
        if k > 0:
            w[TH, k], w[SLIP, k] = 0.0, 0.0
        w[OM, k], w[XW, k], w[ZW, k] = 0.0, 0.0, 0.0
        if slide == 0:
            w[RATE, k], w[ABS, k] = 0.0, w[AX, k]
        else:
            w[ABS, k] = -(kappa * w[GE, k])
            if k > 0:
                w[RATE, k] = -(kappa * w[GE, k - 1] + w[AX, k - 1]) / k
                w[SLIP, k] = w[RATE, k - 1] / k


@jit
def expand(task: Task, pivot: int, slide: int, n: int, h: float) -> tuple[int, float]:
    """Taylor coefficients of the motion and the forces in one joint state from the first column of the workspace.

    AX and GE must be loaded. Returns the order reached (forces: one less) and the step, h or less, that was aimed at an event.
    """
    p, w = task.p, task.w
    m, m_total = p[MASS], p[MASS] + p[BASE_MASS]
    kappa = slide * p[MU_KINETIC]
    tol = p[TOLERANCE] / p[TIME_SCALE] if h < math.inf else 0.0
    if pivot < 0:
        at_rest(w, n, slide, kappa)
    else:
        j = place(task, w[TH, 0], pivot)
        if slide == 0:
            n, h = rock_stuck(task, n, m / j, h, tol)
        else:
            n, h = rock_slide(task, n, m, m_total, j, kappa, kappa * p[DYNAMIC], h, tol)
    _forces(task, n, m, slide == 0 or p[WANT_VALIDITY] > 0.0)
    return n, h


@jit
def _forces(task: Task, n: int, m: float, all_of_them: bool) -> None:
    """V at the pivot and N at the floor to order n − 1; H and F too where they are wanted."""
    w, base = task.w, task.p[BASE_MASS]
    for i in range(n):
        w[PIVOT_V, i] = m * (w[GE, i] - (i + 1) * w[XW, i + 1])
        w[NORMAL, i] = w[PIVOT_V, i] + base * w[GE, i]
    if all_of_them:
        for i in range(n):
            w[PIVOT_H, i] = m * (w[ABS, i] + (i + 1) * w[ZW, i + 1])
            w[FLOOR, i] = w[PIVOT_H, i] + base * w[ABS, i]
