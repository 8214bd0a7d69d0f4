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

from analytic.kernel.compiler import inlined, load_double, set_term, term
from analytic.kernel.polynomial import sine_cosine
from analytic.kernel.records import INVERSE, Floats, Series, Task

AIM: Final = 1.25
"""Steps towards an event end beyond its first guess by this factor, so that the event lies inside: the guess is that of a
constant acceleration."""


@inlined
def vertex(task: Task, k: int) -> tuple[float, float]:
    """Where vertex k stands: x from below the centroid, and the centroid's height above it, m."""
    return load_double(task.base.x, k), task.params.centroid_height_m - load_double(task.base.z, k)


@inlined
def place(task: Task, theta: float, pivot: int) -> float:
    """Write X and Z of the pivot at rotation theta; return the statue's inertia about it, kg m²."""
    x, z = vertex(task, pivot)
    if theta == 0.0:
        task.series.pivot_x[0], task.series.pivot_z[0] = -x, z
    else:
        state = task.state
        if theta != state.angle_rad:
            state.angle_rad = theta
            state.sine, state.cosine = sine_cosine(theta)
        task.series.pivot_x[0] = z * state.sine - x * state.cosine
        task.series.pivot_z[0] = x * state.sine + z * state.cosine
    return float(task.params.inertia_kg_m2 + task.params.mass_kg * (x * x + z * z))


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
    series, pivot = task.series, task.state.pivot
    if pivot > 0:
        gap = series.theta[0] - load_double(task.base.facets, pivot - 1)
        h = min(h, AIM * _fall(gap, series.theta_rate[0], series.theta_rate[1]))
    if pivot < task.base.n_facets:
        gap = load_double(task.base.facets, pivot) - series.theta[0]
        h = min(h, AIM * _fall(gap, -series.theta_rate[0], -series.theta_rate[1]))
    return h


@inlined
def _aim_at_stick(task: Task, h: float) -> float:
    """The step, at most h, that ends a little after the stick onset foreseen from the first terms."""
    rate, accel = task.series.slip_rate[0], task.series.slip_rate[1]
    return min(h, AIM * abs(rate / accel)) if rate * accel < 0.0 else h


@inlined
def _older(series: Series, accel: Floats, i: int, deg_z: int, moment: float) -> tuple[float, float, float]:
    """What term i + 1 of Xθ̇ and of Zθ̇ and term i of g_e X − A Z, A being accel, owe to coefficients older than the newest of
    θ̇ and A; moment: what the last owes to the first term of g_e."""
    sx, sz, sx1, sz1, moment1, k = 0.0, 0.0, 0.0, 0.0, 0.0, 2
    if i > 0 and i % 2 == 0:  # pairs of terms are left
        omega, depth, k = term(series.theta_rate, i - 1), term(series.pivot_z, 2), 3
        sx, sz = term(series.pivot_x, 2) * omega, depth * omega
        moment -= term(accel, i - 2) * depth
    while k < i:
        omega, depth = term(series.theta_rate, i + 1 - k), term(series.pivot_z, k)
        omega1, depth1 = term(series.theta_rate, i - k), term(series.pivot_z, k + 1)
        sx, sx1 = sx + term(series.pivot_x, k) * omega, sx1 + term(series.pivot_x, k + 1) * omega1
        sz, sz1 = sz + depth * omega, sz1 + depth1 * omega1
        moment, moment1 = moment - term(accel, i - k) * depth, moment1 - term(accel, i - k - 1) * depth1
        k += 2
    sx, sz, moment = sx + sx1, sz + sz1, moment + moment1
    for k in range(1, min(i, deg_z) + 1):
        moment += term(series.gravity, k) * term(series.pivot_x, i - k)
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
    series, params, deg_z = task.series, task.params, task.motion_z.degree
    m, base, per_j = params.mass_kg, params.pedestal_mass_kg, params.mass_kg / j
    x, z, om = series.pivot_x[0], series.pivot_z[0], series.theta_rate[0]
    first = om
    px1, pz1 = z * om, -(x * om)
    px, next_px, next_pz = x, px1, pz1
    series.determinant, series.support_accel[0] = j, series.floor_accel[0]
    series.pivot_x[1], series.pivot_z[1] = px1, pz1
    power, small, order = 1.0, 0, 1.0
    for i in range(n):
        inverse = INVERSE[i + 1]
        sx, sz, moment = _older(series, series.floor_accel, i, deg_z, term(series.gravity, 0) * px)
        pull, weight = term(series.floor_accel, i), term(series.gravity, i)
        if i > 0:
            moment -= pz1 * term(series.floor_accel, i - 1)
            sx += px1 * om
            sz += pz1 * om
        px = next_px
        set_term(series.theta, i + 1, om * inverse)
        om = per_j * (moment - z * pull) * inverse
        xw, zw = x * om + (sx + px * first), z * om + (sz + next_pz * first)
        next_px, next_pz = zw * INVERSE[i + 2], -(xw * INVERSE[i + 2])
        set_term(series.theta_rate, i + 1, om)
        set_term(series.pivot_x, i + 2, next_px)
        set_term(series.pivot_z, i + 2, next_pz)
        v = m * (weight - order * xw)
        set_term(series.pivot_normal, i, v)
        set_term(series.floor_normal, i, v + base * weight)
        set_term(series.floor_force, i, m * (pull + order * zw) + base * pull)
        if i == 0 and tol > 0.0:
            h = _aim(task, h)
        power *= h
        order += 1.0
        if i < 2:  # no step ends there
            continue
        # two terms in a row below the tolerance end the series: one alone may be zero by symmetry
        small = (small + 1) * int(max(abs(om), per_j * _pushed(x, z, pull, weight) * inverse) * power <= tol)
        if small >= 2 and i >= 3:
            return i + 1, h
    return n, h


@inlined
def rock_sliding(task: Task, slide: int, n: int, j: float, h: float, tol: float) -> tuple[int, float]:
    """Rocking on a sliding support, and its forces V and N; arguments and answer as of `rock_stuck`."""
    series, params, deg_z = task.series, task.params, task.motion_z.degree
    m, base, kappa = params.mass_kg, params.pedestal_mass_kg, slide * params.floor_kinetic
    ratio = m / (m + base)
    kappa_n, per_length = (kappa if params.dynamic_normal else 0.0), 1.0 / params.centroid_height_m
    x, z, om, rate = series.pivot_x[0], series.pivot_z[0], series.theta_rate[0], series.slip_rate[0]
    first = om
    lever = z - kappa_n * x
    series.determinant = j - m * ratio * z * lever
    per_det, power, small, order = m / series.determinant, 1.0, 0, 1.0
    px1, pz1, a, lean = z * om, -(x * om), 0.0, x + kappa_n * z
    px, next_px, next_pz = x, px1, pz1
    series.pivot_x[1], series.pivot_z[1] = px1, pz1
    drawing, drawn_by_acc = per_det * z * ratio, ratio * lever
    turn = lean * om
    # what θ̈'s next term owes to (X + κ'Z)θ̇ and A of the order before, and to its θ̇
    by_turn, by_accel, by_rate = drawing * first, -(per_det * pz1), -(drawing * turn)
    for i in range(n):
        inverse = INVERSE[i + 1]
        sx, sz, moment = _older(series, series.support_accel, i, deg_z, term(series.gravity, 0) * px)
        pull, weight = term(series.floor_accel, i), term(series.gravity, i)
        held = -(kappa * weight)
        known = per_det * (moment - z * held) + drawing * order * (sz - kappa_n * sx)
        # what the order before has just given (θ̇, A and, through them, the next X and Z) comes in on the shortest way
        if i > 0:
            known += order * by_rate * om + by_accel * a
            sx += px1 * om
            sz += pz1 * om
        px = next_px
        acc = known - by_turn * turn
        set_term(series.theta, i + 1, om * inverse)
        set_term(series.slip, i + 1, rate * inverse)
        sx += px * first
        sz += next_pz * first
        a = held - ratio * order * (sz - kappa_n * sx) - drawn_by_acc * acc
        om, rate = acc * inverse, (a - pull) * inverse
        xw, zw, turn = x * om + sx, z * om + sz, lean * om + (sx + kappa_n * sz)
        set_term(series.support_accel, i, a)
        set_term(series.theta_rate, i + 1, om)
        set_term(series.slip_rate, i + 1, rate)
        next_px, next_pz = zw * INVERSE[i + 2], -(xw * INVERSE[i + 2])
        set_term(series.pivot_x, i + 2, next_px)
        set_term(series.pivot_z, i + 2, next_pz)
        v = m * (weight - order * xw)
        set_term(series.pivot_normal, i, v)
        set_term(series.floor_normal, i, v + base * weight)
        if i == 0 and tol > 0.0:
            h = _aim_at_stick(task, _aim(task, h))
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
    series, m = task.series, task.params.mass_kg
    for k in range(n + 1):
        if task.state.slide == 0:
            series.support_accel[k] = series.floor_accel[k]
        series.pivot_force[k] = m * (series.support_accel[k] + (k + 1) * (k + 2) * series.pivot_x[k + 2])


@inlined
def at_rest(series: Series, n: int, slide: int, kappa: float) -> None:
    """The statue standing on its support, which is stuck (slide 0) or slides with A = −κ g_e."""
    for k in range(n + 1):
        if k > 0:
            series.theta[k], series.slip[k] = 0.0, 0.0
        series.theta_rate[k] = 0.0
        if slide == 0:
            series.slip_rate[k], series.support_accel[k] = 0.0, series.floor_accel[k]
        else:
            series.support_accel[k] = -(kappa * series.gravity[k])
            if k > 0:
                series.slip_rate[k] = -(kappa * series.gravity[k - 1] + series.floor_accel[k - 1]) / k
                series.slip[k] = series.slip_rate[k - 1] / k


@inlined
def expand(task: Task, pivot: int, slide: int, n: int, h: float) -> tuple[int, float]:
    """Taylor coefficients of the motion and the forces in one joint state from their first terms, a_x and g_e.

    Returns the order reached (forces: one less) and the step, h or less, that was aimed at an event.
    """
    params, series = task.params, task.series
    tol = params.tolerance_rad / params.time_scale_s if h < math.inf else 0.0
    if pivot < 0:
        at_rest(series, n, slide, slide * params.floor_kinetic)
        total = params.mass_kg + params.pedestal_mass_kg
        for i in range(n):
            set_term(series.pivot_normal, i, params.mass_kg * term(series.gravity, i))
            set_term(series.floor_normal, i, total * term(series.gravity, i))
            set_term(series.floor_force, i, total * term(series.support_accel, i))
    elif slide == 0:
        n, h = rock_stuck(task, n, place(task, series.theta[0], pivot), h, tol)
    else:
        n, h = rock_sliding(task, slide, n, place(task, series.theta[0], pivot), h, tol)
    return n, h
