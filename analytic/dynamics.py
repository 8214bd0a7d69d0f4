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

from analytic._jit import jit
from analytic.layout import (
    ABS,
    ACC,
    AX,
    BASE_MASS,
    CENTROID,
    DET,
    DYNAMIC,
    FLOOR,
    GE,
    INERTIA,
    INVERSE,
    MASS,
    MU_KINETIC,
    NORMAL,
    OM,
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
    XW,
    ZW,
    ZX,
    ZZ,
    Floats,
    Task,
)


@jit
def place(task: Task, theta: float, pivot: int) -> float:
    """Write X and Z of the pivot at rotation theta into the workspace; return the statue's inertia about it, kg m²."""
    x, z = task.x[pivot], task.p[CENTROID] - task.z[pivot]
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
def _last_products(w: Floats, n: int) -> None:
    sx, sz = 0.0, 0.0
    for k in range(n + 1):
        sx += w[PX, k] * w[OM, n - k]
        sz += w[PZ, k] * w[OM, n - k]
    w[XW, n], w[ZW, n] = sx, sz


@jit
def rock_stuck(w: Floats, n: int, m_over_j: float, deg_x: int, deg_z: int, h: float, tol: float) -> int:
    """Rocking on a support that follows the floor; returns the order reached, n or less where h needs less."""
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
        power *= h
        small = small + 1 if abs(w[OM, i + 1]) * power <= tol else 0
        if small >= 2 and i >= 3 + max(deg_x, deg_z):
            n = i + 1
            break
    _last_products(w, n)
    for k in range(n + 1):
        w[RATE, k] = 0.0
        w[ABS, k] = w[AX, k]
        if k > 0:
            w[SLIP, k] = 0.0
    return n


@jit
def rock_slide(
    w: Floats,
    n: int,
    m: float,
    m_total: float,
    j: float,
    kappa: float,
    kappa_n: float,
    deg_z: int,
    h: float,
    tol: float,
    length_m: float,
) -> int:
    """Rocking on a sliding pedestal; returns the order reached, n or less where h needs less."""
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
        # θ̇ does not feel the floor while the pedestal slides; u̇ does, and may need more terms
        settled = abs(w[RATE, i]) * power <= tol * length_m
        power *= h
        small = small + 1 if settled and abs(w[OM, i + 1]) * power <= tol else 0
        if small >= 2 and i >= 5:
            n = i + 1
            break
    _last_products(w, n)
    _slide_coefficient(w, n, ratio, kappa, kappa_n, w[XW, n], w[ZW, n])
    for i in range(n):
        w[ABS, i] = -(kappa * w[GE, i]) - ratio * (i + 1) * (w[ZW, i + 1] - kappa_n * w[XW, i + 1])
    return n


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
def expand(task: Task, pivot: int, slide: int, n: int, deg_x: int, deg_z: int, h: float) -> int:
    """Taylor coefficients of the motion and the forces in one joint state from the first column of the workspace.

    AX and GE must be filled to order n with their degrees deg_x, deg_z. Returns the order reached (forces: one less).
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
            n = rock_stuck(w, n, m / j, deg_x, deg_z, h, tol)
        else:
            kappa_n = kappa * p[DYNAMIC]
            n = rock_slide(w, n, m, m_total, j, kappa, kappa_n, deg_z, h, tol, p[CENTROID])
    _forces(w, n, m, p[BASE_MASS])
    return n


@jit
def _forces(w: Floats, n: int, m: float, base: float) -> None:
    """H, V at the pivot and F, N at the floor to order n − 1."""
    for i in range(n):
        w[PIVOT_V, i] = m * (w[GE, i] - (i + 1) * w[XW, i + 1])
        w[PIVOT_H, i] = m * (w[ABS, i] + (i + 1) * w[ZW, i + 1])
        w[NORMAL, i] = w[PIVOT_V, i] + base * w[GE, i]
        w[FLOOR, i] = w[PIVOT_H, i] + base * w[ABS, i]
