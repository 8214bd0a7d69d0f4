"""Taylor coefficients of the motion in each joint state (docs/model.md, section 2), order by order, and which state is chosen.

About the vertex (x, z) of the base the centroid stands at X = −x cos θ + (h − z) sin θ, Z = x sin θ + (h − z) cos θ from the
pivot, so that X' = Zθ̇ and Z' = −Xθ̇: no sine or cosine is needed beyond a step's first instant. The statue obeys

    J θ̈ = m (g_e X − A Z)

throughout; A = a_x while the pedestal is stuck. While it slides, with σ = sgn u̇, κ = σμ_k and P = Z − κ'X,

    A = −κ g_e − m/M d(Pθ̇)/dt,

where κ' = κ when the friction follows the true normal force and 0 when it follows M g_e. Of the new term of A only P₀θ̈ is not yet
known when that of θ̈ is sought: it makes J into J − m²/M Z₀P₀, the determinant of the sliding system.
"""

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit, load_double, set_term, term
from analytic.kernel.forcing import coefficients
from analytic.kernel.polynomial import leading, sine_cosine
from analytic.kernel.records import FRICTION_PARADOX, INVERSE, LIFT_OFF, MOVING, UNDECIDED, Floats, Series, Task

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


# The joint state {rest, rocking right, left} × {stuck, sliding +, −} after a jump or an event (docs/model.md, section 2).
#
# Only what is at rest is free. A joint state is feasible when its own accelerations keep its signs; where an acceleration
# or a limit is zero at the instant itself, its first derivative that is not decides.


WEIGHTLESS: Final = 1e-9
"""Share of gravity below which nothing is held down: both uplift conditions are then met at once."""
LOW_ORDER: Final = 6
"""Order to which a candidate's accelerations are compared with zero: a state all of whose first derivatives vanish is taken
for rest."""
UNSURE: Final = -1
"""All terms so far are zero."""


@inlined
def start_series(task: Task) -> None:
    """Write the first terms of the motion, and the floor's accelerations unless they stand there."""
    series, state, params = task.series, task.state, task.params
    series.theta[0], series.theta_rate[0] = state.theta_rad, state.theta_rate_rad_s
    series.slip[0], series.slip_rate[0] = state.slip_m, state.slip_rate_m_s
    if not state.floor_loaded:
        task.motion_x.degree = coefficients(task.motion_x, series.floor_accel, state.time_s, params.order)
        task.motion_z.degree = coefficients(task.motion_z, series.gravity, state.time_s, params.order)
        series.gravity[0] += params.gravity_m_s2
        state.floor_loaded = True
        if math.isnan(series.floor_accel[0] + series.gravity[0]):  # a kind of motion without a formula
            state.outcome = UNDECIDED
            task.counts.given_up = 1


@inlined
def corner(task: Task, facet: int, side: int) -> tuple[float, float, float]:
    """X and Z of the facet's corner on that side, resting on the facet, and the statue's inertia about it."""
    x, z = vertex(task, facet + 1 if side > 0 else facet)
    angle = load_double(task.base.facets, facet)
    j = task.params.inertia_kg_m2 + task.params.mass_kg * (x * x + z * z)
    if angle == 0.0:
        return -x, z, j
    sine, cosine = math.sin(angle), math.cos(angle)
    return z * sine - x * cosine, x * sine + z * cosine, j


@inlined
def lift_margin(task: Task, side: int, n: int) -> float:
    """Write the coefficients 0..n of g_e b − A h, which keeps the resting statue down on that side, as the event function;
    return the scale of its terms."""
    x, z, _ = corner(task, task.state.facet, side)
    series = task.series
    for k in range(n + 1):
        set_term(series.event, k, -side * (term(series.gravity, k) * x - term(series.support_accel, k) * z))
    return float(abs(series.gravity[0] * x) + abs(series.support_accel[0] * z))


@inlined
def stick_margin(task: Task, side: int, n: int) -> float:
    """Write the coefficients 0..n of μ_s N ± F, which falls to zero as the pedestal starts to that side, as the event function;
    return the scale of its terms."""
    series, params = task.series, task.params
    total = params.mass_kg + params.pedestal_mass_kg
    if params.dynamic_normal:
        normal, factor = series.floor_normal, params.floor_static
    else:
        normal, factor = series.gravity, params.floor_static * total
    for k in range(n + 1):
        set_term(series.event, k, factor * term(normal, k) + side * term(series.floor_force, k))
    return float(total * (abs(series.gravity[0]) + abs(series.floor_accel[0])))


@inlined
def theta_rate_zeros(task: Task, n: int) -> int:
    """Leading coefficients of θ̇ that are rounding only."""
    series, time_s = task.series, task.params.time_scale_s
    scale = time_s * (abs(series.gravity[0]) + abs(series.support_accel[0])) / task.params.centroid_height_m
    return leading(series.theta_rate, n, scale, time_s)


@inlined
def slip_rate_zeros(task: Task, pivot: int, n: int) -> int:
    """Leading coefficients of u̇ that are rounding only.

    Where the statue rocks, the force that sticking lacks moves the pedestal j/det times as fast as where it rests: by less than
    the bound here. So what is rounding as a margin is rounding as a rate too; else sticking fails by its next term and sliding by
    its first, and no candidate is left (both coefficients the same, onsets found to 1e-6 rad: in two of five runs of 10 s).
    """
    series, params, time_s = task.series, task.params, task.params.time_scale_s
    wider = 2.0
    if pivot >= 0:
        pull = params.mass_kg * params.mass_kg / (params.mass_kg + params.pedestal_mass_kg)
        x, z, kappa = series.pivot_x[0], series.pivot_z[0], params.floor_kinetic
        wider += pull * (x * x + z * z) * math.sqrt(1.0 + kappa * kappa) / series.determinant
    scale = time_s * (abs(series.gravity[0]) + abs(series.floor_accel[0]))
    return leading(series.slip_rate, n, wider * scale, time_s)


@inlined
def falling(task: Task) -> bool:
    """Whether the statue leans beyond its balance point and moves away: losing its corner then ends no run."""
    pivot, series = task.state.pivot, task.series
    right = pivot == task.base.n_facets and series.pivot_x[0] > 0.0 and series.theta_rate[0] > 0.0
    return right or (pivot == 0 and series.pivot_x[0] < 0.0 and series.theta_rate[0] < 0.0)


@inlined
def _holds(task: Task, scale: float, n: int) -> int:
    """1 if the margin that is the event function is positive or zero for ever, 0 if not, UNSURE if that takes more than n
    terms."""
    lead = leading(task.series.event, n, scale, task.params.time_scale_s)
    if lead > n:
        return 1 if n == LOW_ORDER - 1 else UNSURE
    return 1 if task.series.event[lead] > 0.0 else 0


@inlined
def _moves(rate: Floats, lead: int, n: int, sign: int) -> int:
    """1 if the rate grows to that side, 0 if not, UNSURE if that takes more than n terms."""
    if lead > n:
        return 0 if n == LOW_ORDER else UNSURE
    return 1 if rate[lead] * sign >= 0.0 else 0


@inlined
def _keeps_signs(task: Task, pivot: int, slide: int, rock_free: bool, slide_free: bool, n: int) -> int:
    """1 if the accelerations of the expanded joint state keep its signs, 0 if not, UNSURE if that takes more than n terms."""
    series, verdict = task.series, 1
    if rock_free and pivot >= 0:
        verdict = _moves(series.theta_rate, theta_rate_zeros(task, n), n, 1 if pivot > task.state.facet else -1)
    if verdict == 1 and slide_free and slide != 0:
        verdict = _moves(series.slip_rate, slip_rate_zeros(task, pivot, n), n, slide)
    for side in (1, -1):
        if verdict == 1 and rock_free and pivot < 0:
            verdict = _holds(task, lift_margin(task, side, n - 1), n - 1)
        if verdict == 1 and slide_free and slide == 0:
            verdict = _holds(task, stick_margin(task, side, n - 1), n - 1)
    return verdict


@jit
def _feasible(task: Task, pivot: int, slide: int, rock_free: bool, slide_free: bool) -> int:
    """1 feasible, 0 not, or the ending that the state would be; more terms only where the first are zero."""
    series, params = task.series, task.params
    for n in (1, 2, LOW_ORDER):
        start_series(task)
        expand(task, pivot, slide, n, math.inf)
        if pivot >= 0 and slide != 0 and series.determinant <= 0.0:
            return FRICTION_PARADOX
        weightless = series.gravity[0] <= WEIGHTLESS * params.gravity_m_s2
        floats = params.has_pedestal and series.floor_normal[0] <= 0.0
        if weightless or floats or (series.pivot_normal[0] <= 0.0 and (rock_free or not falling(task))):
            return LIFT_OFF
        verdict = _keeps_signs(task, pivot, slide, rock_free, slide_free, n)
        if verdict != UNSURE:
            return verdict
    return 1


@jit
def choose(task: Task, rock_free: bool) -> tuple[int, int]:
    """Choose the joint state, the stuck one if several are feasible (but see `Form.choice`); return how many were (1 if no events
    are kept), and 0 or the run's ending."""
    state = task.state
    slide_free = task.params.has_pedestal and state.slip_rate_m_s == 0.0
    start_series(task)
    against = -1 if task.series.floor_accel[0] > 0.0 else 1
    feasible, ending, moving = 0, 0, task.params.choice == MOVING
    pivot_chosen, slide_chosen = state.pivot, state.slide
    # Rest, then the vertex on the side to which the floor's inertia tips the statue, then the other; stuck, then the side to
    # which the floor leaves the pedestal behind, then the other.
    tipped = state.facet + 1 if against > 0 else state.facet
    for i in range(3 if slide_free else 1):
        slide = (0, against, -against)[i] if slide_free else state.slide
        for j in range(3 if rock_free else 1):
            pivot = (-1, tipped, 2 * state.facet + 1 - tipped)[j] if rock_free else state.pivot
            verdict = _feasible(task, pivot, slide, rock_free, slide_free)
            if verdict == 1:
                feasible += 1
                if feasible == 1 or moving:
                    pivot_chosen, slide_chosen = pivot, slide
                if task.output.n_events == 0 and not moving:  # nobody asks how many others there are
                    state.pivot, state.slide, state.fresh = pivot, slide, True
                    return feasible, 0
            elif verdict != 0:
                ending = max(ending, verdict)
    if feasible == 0:
        return 0, ending if ending != 0 else FRICTION_PARADOX
    state.pivot, state.slide, state.fresh = pivot_chosen, slide_chosen, True
    return feasible, 0
