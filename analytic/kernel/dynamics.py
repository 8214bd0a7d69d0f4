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

from analytic.kernel.compiler import inlined
from analytic.kernel.elementary import sine_cosine
from analytic.kernel.layout import (
    ABS,
    AX,
    BASE_MASS,
    BASE_X,
    BASE_Z,
    CENTROID,
    COSINE_OF,
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
    SINE_OF,
    SLIDE,
    SLIP,
    TH,
    TIME_SCALE,
    TOLERANCE,
    TURNED,
    Floats,
    Task,
)
from analytic.kernel.memory import peek, set_term, term

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
        s = task.s
        if theta != s[TURNED]:
            s[TURNED] = theta
            s[SINE_OF], s[COSINE_OF] = sine_cosine(theta)
        task.w[PX, 0] = z * s[SINE_OF] - x * s[COSINE_OF]
        task.w[PZ, 0] = x * s[SINE_OF] + z * s[COSINE_OF]
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
def _older(w: Floats, row: int, i: int, deg_z: int, moment: float) -> tuple[float, float, float]:
    """What term i + 1 of Xθ̇ and of Zθ̇ and term i of g_e X − A Z, A being in the row, owe to coefficients older than the newest of
    θ̇ and A; moment: what the last owes to the first term of g_e."""
    sx, sz, sx1, sz1, moment1, k = 0.0, 0.0, 0.0, 0.0, 0.0, 2
    if i > 0 and i % 2 == 0:  # pairs of terms are left
        omega, depth, k = term(w, OM, i - 1), term(w, PZ, 2), 3
        sx, sz = term(w, PX, 2) * omega, depth * omega
        moment -= term(w, row, i - 2) * depth
    while k < i:
        omega, depth = term(w, OM, i + 1 - k), term(w, PZ, k)
        omega1, depth1 = term(w, OM, i - k), term(w, PZ, k + 1)
        sx, sx1 = sx + term(w, PX, k) * omega, sx1 + term(w, PX, k + 1) * omega1
        sz, sz1 = sz + depth * omega, sz1 + depth1 * omega1
        moment, moment1 = moment - term(w, row, i - k) * depth, moment1 - term(w, row, i - k - 1) * depth1
        k += 2
    sx, sz, moment = sx + sx1, sz + sz1, moment + moment1
    for k in range(1, min(i, deg_z) + 1):
        moment += term(w, GE, k) * term(w, PX, i - k)
    return sx, sz, moment


@inlined
def _pushed(x: float, z: float, pull: float, weight: float) -> float:
    """What a term of the floor's acceleration gives directly: the sum may be small for a term while its next one is not."""
    return abs(pull * z) + abs(weight * x)


@inlined
def rock_stuck(task: Task, n: int, j: float, h: float, tol: float) -> tuple[int, float]:
    """Rocking on a support that is stuck, A being the floor's own a_x, and its forces V, N and F; j: inertia about the pivot.

    Returns the order reached, n or less where the step needs less, and the step. X and Z are written to one order more.
    """
    w, p, deg_z = task.w, task.p, task.q[DEGREE + 1]
    m, base, per_j = p[MASS], p[BASE_MASS], p[MASS] / j
    x, z, om, first = w[PX, 0], w[PZ, 0], w[OM, 0], w[OM, 0]
    px1, pz1 = z * om, -(x * om)
    px, next_px, next_pz = x, px1, pz1
    w[DET, 0], w[PX, 1], w[PZ, 1], w[ABS, 0] = j, px1, pz1, w[AX, 0]
    power, small, order = 1.0, 0, 1.0
    for i in range(n):
        inverse = INVERSE[i + 1]
        sx, sz, moment = _older(w, AX, i, deg_z, term(w, GE, 0) * px)
        pull, weight = term(w, AX, i), term(w, GE, i)
        if i > 0:
            moment -= pz1 * term(w, AX, i - 1)
            sx += px1 * om
            sz += pz1 * om
        px = next_px
        set_term(w, TH, i + 1, om * inverse)
        om = per_j * (moment - z * pull) * inverse
        xw, zw = x * om + (sx + px * first), z * om + (sz + next_pz * first)
        next_px, next_pz = zw * INVERSE[i + 2], -(xw * INVERSE[i + 2])
        set_term(w, OM, i + 1, om)
        set_term(w, PX, i + 2, next_px)
        set_term(w, PZ, i + 2, next_pz)
        v = m * (weight - order * xw)
        set_term(w, PIVOT_V, i, v)
        set_term(w, NORMAL, i, v + base * weight)
        set_term(w, FLOOR, i, m * (pull + order * zw) + base * pull)
        if i == 0 and tol > 0.0:
            h = _aim(task, h)
        power *= h
        order += 1.0
        if i < 2:  # no step ends there
            continue
        small = (small + 1) * int(max(abs(om), per_j * _pushed(x, z, pull, weight) * inverse) * power <= tol)
        if small >= 2 and i >= 3:
            return i + 1, h
    return n, h


@inlined
def rock_sliding(task: Task, slide: int, n: int, j: float, h: float, tol: float) -> tuple[int, float]:
    """Rocking on a sliding support, and its forces V and N; arguments and answer as of `rock_stuck`."""
    w, p, deg_z = task.w, task.p, task.q[DEGREE + 1]
    m, base, kappa = p[MASS], p[BASE_MASS], slide * p[MU_KINETIC]
    ratio = m / (m + base)
    kappa_n, per_length = kappa * p[DYNAMIC], 1.0 / p[CENTROID]
    x, z, om, first, rate = w[PX, 0], w[PZ, 0], w[OM, 0], w[OM, 0], w[RATE, 0]
    lever = z - kappa_n * x
    w[DET, 0] = j - m * ratio * z * lever
    per_det, power, small, order = m / w[DET, 0], 1.0, 0, 1.0
    px1, pz1, a, lean = z * om, -(x * om), 0.0, x + kappa_n * z
    px, next_px, next_pz = x, px1, pz1
    w[PX, 1], w[PZ, 1] = px1, pz1
    drawing, drawn_by_acc = per_det * z * ratio, ratio * lever
    turn = lean * om
    # what θ̈'s next term owes to (X + κ'Z)θ̇ and A of the order before, and to its θ̇
    by_turn, by_accel, by_rate = drawing * first, -(per_det * pz1), -(drawing * turn)
    for i in range(n):
        inverse = INVERSE[i + 1]
        sx, sz, moment = _older(w, ABS, i, deg_z, term(w, GE, 0) * px)
        pull, weight = term(w, AX, i), term(w, GE, i)
        held = -(kappa * weight)
        known = per_det * (moment - z * held) + drawing * order * (sz - kappa_n * sx)
        # what the order before has just given (θ̇, A and, through them, the next X and Z) comes in on the shortest way
        if i > 0:
            known += order * by_rate * om + by_accel * a
            sx += px1 * om
            sz += pz1 * om
        px = next_px
        acc = known - by_turn * turn
        set_term(w, TH, i + 1, om * inverse)
        set_term(w, SLIP, i + 1, rate * inverse)
        sx += px * first
        sz += next_pz * first
        a = held - ratio * order * (sz - kappa_n * sx) - drawn_by_acc * acc
        om, rate = acc * inverse, (a - pull) * inverse
        xw, zw, turn = x * om + sx, z * om + sz, lean * om + (sx + kappa_n * sz)
        set_term(w, ABS, i, a)
        set_term(w, OM, i + 1, om)
        set_term(w, RATE, i + 1, rate)
        next_px, next_pz = zw * INVERSE[i + 2], -(xw * INVERSE[i + 2])
        set_term(w, PX, i + 2, next_px)
        set_term(w, PZ, i + 2, next_pz)
        v = m * (weight - order * xw)
        set_term(w, PIVOT_V, i, v)
        set_term(w, NORMAL, i, v + base * weight)
        if i == 0 and tol > 0.0:
            h = _aim_at_halt(task, _aim(task, h))
        power *= h
        order += 1.0
        if i < 2:  # no step ends there
            continue
        largest = max(abs(om), per_det * _pushed(x, z, pull, weight) * inverse, abs(rate) * per_length)
        small = (small + 1) * int(largest * power <= tol)
        if small >= 2 and i >= 3:
            return i + 1, h
    return n, h


@inlined
def complete(task: Task, n: int) -> None:
    """Write what only the model's limits need of a rocking step: terms 0..n of H = m (A + X''), and of A while the support is
    stuck."""
    w, m = task.w, task.p[MASS]
    for k in range(n + 1):
        if task.q[SLIDE] == 0:
            w[ABS, k] = w[AX, k]
        w[PIVOT_H, k] = m * (w[ABS, k] + (k + 1) * (k + 2) * w[PX, k + 2])


@inlined
def at_rest(w: Floats, n: int, slide: int, kappa: float) -> None:
    """The statue standing on its support, which is stuck (slide 0) or slides with A = −κ g_e."""
    for k in range(n + 1):
        if k > 0:
            w[TH, k], w[SLIP, k] = 0.0, 0.0
        w[OM, k] = 0.0
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
        total = p[MASS] + p[BASE_MASS]
        for i in range(n):
            set_term(w, PIVOT_V, i, p[MASS] * term(w, GE, i))
            set_term(w, NORMAL, i, total * term(w, GE, i))
            set_term(w, FLOOR, i, total * term(w, ABS, i))
    elif slide == 0:
        n, h = rock_stuck(task, n, place(task, w[TH, 0], pivot), h, tol)
    else:
        n, h = rock_sliding(task, slide, n, place(task, w[TH, 0], pivot), h, tol)
    return n, h
