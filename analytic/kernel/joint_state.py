"""The joint state {rest, rocking right, left} × {stuck, sliding +, −} after a jump or an event (docs/model.md, section 2).

Only what is at rest is free. A joint state is feasible when its own accelerations keep its signs; where an acceleration
or a limit is zero at the instant itself, its first derivative that is not decides.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.codes import FRICTION_PARADOX, LIFT_OFF, MOVING, UNDECIDED
from analytic.kernel.compiler import inlined, jit, load_double, set_term, term
from analytic.kernel.dynamics import expand, vertex
from analytic.kernel.forcing import coefficients
from analytic.kernel.polynomial import leading
from analytic.kernel.records import Floats, Task

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
        if weightless or (params.has_pedestal and series.floor_normal[0] <= 0.0):
            return LIFT_OFF
        if series.pivot_normal[0] <= 0.0 and (rock_free or not falling(task)):
            return LIFT_OFF
        verdict = _keeps_signs(task, pivot, slide, rock_free, slide_free, n)
        if verdict != UNSURE:
            return verdict
    return 1


@inlined
def _slide_candidate(i: int, against: int) -> int:
    """The i-th slide to try: stuck, then the side to which the floor leaves the pedestal behind, then the other."""
    if i == 0:
        return 0
    return against if i == 1 else -against


@inlined
def _pivot_candidate(i: int, against: int, facet: int) -> int:
    """The i-th pivot to try: rest, then the vertex on the side to which the floor's inertia tips the statue, then the other."""
    if i == 0:
        return -1
    return facet + 1 if (against > 0) == (i == 1) else facet


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
    for i in range(3 if slide_free else 1):
        slide = _slide_candidate(i, against) if slide_free else state.slide
        for j in range(3 if rock_free else 1):
            pivot = _pivot_candidate(j, against, state.facet) if rock_free else state.pivot
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
