"""Taylor coefficients of the motion in each joint state (docs/model.md, section 2), order by order.

About the vertex (x, z) of the base the centroid stands at X = −x cos θ + (h − z) sin θ, Z = x sin θ + (h − z) cos θ from the
pivot, so that X' = Zθ̇ and Z' = −Xθ̇: no sine or cosine is needed beyond a step's first instant. The statue obeys

    J θ̈ = m (g_e X − A Z)

throughout; A = a_x while the pedestal is stuck. While it slides, with σ = sgn u̇, κ = σμ_k and P = Z − κ'X,

    A = −κ g_e − m/M d(Pθ̇)/dt,

where κ' = κ when the friction follows the true normal force and 0 when it follows M g_e. Of the new term of A only P₀θ̈ is not yet
known when that of θ̈ is sought: it makes J into J − m²/M Z₀P₀, the determinant of the sliding system.
"""

from __future__ import annotations

import math
from typing import Final

from analytic._jit import inlined
from analytic.borrowed import peek
from analytic.layout import (
    ABS,
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
    WANT_VALIDITY,
    XW,
    ZW,
    Floats,
    Task,
)

AIM: Final = 1.25
"""Steps towards an event end beyond its first guess by this factor, so that the event lies inside."""


@inlined
def vertex(task: Task, k: int) -> tuple[float, float]:
    """Where vertex k stands: x from below the centroid, and the centroid's height above it, m."""
    return peek(task.address[BASE_X], k), task.p[CENTROID] - peek(task.address[BASE_Z], k)


@inlined
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


@inlined
def _fall(gap: float, speed: float, pull: float) -> float:
    """When gap + speed t + pull t²/2, a gap from 0 on, closes; infinite if it does not."""
    left = speed * speed - 2.0 * pull * gap
    if left < 0.0 or (speed >= 0.0 and pull >= 0.0):
        return math.inf
    root = math.sqrt(left)
    time = (speed + root) / -pull if speed >= 0.0 else 2.0 * gap / (root - speed)
    return time if time > 0.0 else math.inf


@inlined
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


@inlined
def _aim_at_halt(task: Task, h: float) -> float:
    """The step, at most h, that ends a little after the halt foreseen from the first terms."""
    rate, accel = task.w[RATE, 0], task.w[RATE, 1]
    return min(h, AIM * abs(rate / accel)) if rate * accel < 0.0 else h


@inlined
def rock(task: Task, slide: int, n: int, j: float, h: float, tol: float) -> tuple[int, float]:
    """Rocking on a support that is stuck or slides; j: inertia about the pivot. Returns the order reached, n or less where the
    step needs less, and the step."""
    w, p, deg_z = task.w, task.p, task.q[DEGREE + 1]
    m, kappa = p[MASS], slide * p[MU_KINETIC]
    ratio = m / (m + p[BASE_MASS]) if slide != 0 else 0.0
    deg_a = n if slide != 0 else task.q[DEGREE]
    kappa_n = kappa * p[DYNAMIC]
    x, z = w[PX, 0], w[PZ, 0]
    lever = z - kappa_n * x
    w[DET, 0] = j - m * ratio * z * lever
    per_det, power, small = m / w[DET, 0], 1.0, 0
    w[XW, 0], w[ZW, 0] = x * w[OM, 0], z * w[OM, 0]
    for i in range(n):
        inverse = INVERSE[i + 1]
        w[TH, i + 1], w[SLIP, i + 1] = w[OM, i] * inverse, w[RATE, i] * inverse
        w[PX, i + 1], w[PZ, i + 1] = w[ZW, i] * inverse, -(w[XW, i] * inverse)
        sx, sz, moment = 0.0, 0.0, 0.0
        for k in range(1, i + 2):
            sx += w[PX, k] * w[OM, i + 1 - k]
            sz += w[PZ, k] * w[OM, i + 1 - k]
        for k in range(min(i, deg_z) + 1):
            moment += w[GE, k] * w[PX, i - k]
        for k in range(max(1, i - deg_a), i + 1):
            moment -= w[ABS, i - k] * w[PZ, k]
        drawn = ratio * (i + 1) * (sz - kappa_n * sx)
        held = w[AX, i] if slide == 0 else -(kappa * w[GE, i])
        acc = per_det * (moment - z * (held - drawn))
        w[ABS, i] = held - (drawn + ratio * lever * acc)
        w[OM, i + 1], w[RATE, i + 1] = acc * inverse, (w[ABS, i] - w[AX, i]) * inverse
        w[XW, i + 1], w[ZW, i + 1] = x * w[OM, i + 1] + sx, z * w[OM, i + 1] + sz
        if i == 0 and tol > 0.0:
            h = _aim_at_halt(task, _aim(task, h))
        power *= h
        # what the floor gives directly may be small for a term while its next one is not
        pushed = per_det * (abs(w[AX, i] * z) + abs(w[GE, i] * x)) * inverse
        largest = max(abs(w[OM, i + 1]), pushed, abs(w[RATE, i + 1]) / p[CENTROID])
        small = small + 1 if largest * power <= tol else 0
        if small >= 2 and i >= 3:
            n = i + 1
            break
    w[ABS, n] = w[AX, n] if slide == 0 else 0.0
    return n, h


@inlined
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


@inlined
def expand(task: Task, pivot: int, slide: int, n: int, h: float) -> tuple[int, float]:
    """Taylor coefficients of the motion and the forces in one joint state from the first column of the workspace.

    AX and GE must be loaded. Returns the order reached (forces: one less) and the step, h or less, that was aimed at an event.
    """
    p, w = task.p, task.w
    tol = p[TOLERANCE] / p[TIME_SCALE] if h < math.inf else 0.0
    if pivot < 0:
        at_rest(w, n, slide, slide * p[MU_KINETIC])
    else:
        n, h = rock(task, slide, n, place(task, w[TH, 0], pivot), h, tol)
    _forces(task, n, p[MASS], slide == 0 or p[WANT_VALIDITY] > 0.0)
    return n, h


@inlined
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
