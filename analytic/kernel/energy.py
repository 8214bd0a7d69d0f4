"""What is not integrated: a quiet start and rest; the outcome from energy alone once the motion has ended (docs/model.md,
section 7).

With the floor at rest and the pedestal stuck, E = ½ J θ̇² + m g Z is constant between impacts, and each impact gives the next
rate: no step is needed to know which barrier is passed. Wherever a bound below cannot be shown, the run is integrated instead.
"""

import math
from typing import Final

from analytic.kernel.compiler import jit, load_double
from analytic.kernel.dynamics import corner, place, vertex
from analytic.kernel.forcing import is_jump, is_over, next_break_s, sampled_at
from analytic.kernel.impact import impact
from analytic.kernel.records import (
    BY_LEAN,
    OVERTURNED_LEFT,
    OVERTURNED_RIGHT,
    SAMPLED,
    STANDS,
    TOUCHES_WALL,
    Motion,
    Task,
)
from analytic.kernel.track import leave, note_peak, note_rest, sample_state

# What can be left out while nothing moves: records are looked through, not integrated.


CLEAR: Final = 1e-9
"""Relative distance to a limit below which nothing is skipped: far above the rounding of the moments compared, so that what
is skipped is at rest for the integrator too."""
WEAKER: Final = 1e-6
"""Relative distance to the nearest limit below which a sample is weak: far above `CLEAR`."""


@jit
def stays(task: Task, ax: float, gz: float, variation: float) -> bool:
    """Whether a statue at rest on a stuck support stays so, clear of every limit, under |a_x − ax| ≤ variation and g_e ≥ gz."""
    if gz <= 0.0:
        return False
    for side in (1, -1):  # uplift: A h > g_e b, by the moments about either corner
        x, z, _ = corner(task, task.state.facet, side)
        if -side * (gz * x - ax * z) - variation * z <= CLEAR * (abs(gz * x) + abs(ax * z)):
            return False
    if task.params.has_pedestal:  # slip: |F| = μ_s N with F = M a_x, N = M g_e
        total = task.params.mass_kg + task.params.pedestal_mass_kg
        if total * (task.params.floor_static * gz - abs(ax) - variation) <= CLEAR * total * (gz + abs(ax)):
            return False
    return True


@jit
def hold(task: Task, until: float) -> None:
    """Move the clock to until, the state unchanged, and fill the output samples passed."""
    state, counts, dt = task.state, task.counts, task.params.output_step_s
    if dt > 0.0:
        while counts.samples < task.output.n_samples and counts.samples * dt < until:
            sample_state(task, counts.samples * dt)
    task.results.peak_slip_m = max(task.results.peak_slip_m, abs(state.slip_m))
    task.results.skipped_s += until - state.time_s
    state.time_s = until
    state.floor_loaded = False


@jit
def _before(motion: Motion, time: float, own: bool) -> float:
    """The acceleration just before time, which is the motion's own next break if own."""
    params, passed = motion.params, motion.breaks_passed
    if own and 1 <= passed < params.n_samples:
        return params.scale * load_double(params.samples, passed)
    return sampled_at(motion, time)


@jit
def _pass_weak(task: Task) -> None:
    """Pass the samples inside a record that are weaker than any limit, at once where nobody hears of them."""
    params, state, x = task.params, task.state, task.motion_x
    if params.output_step_s > 0.0 or params.keep_validity or x.params.kind != SAMPLED or not is_over(task.motion_z):
        return
    g = params.gravity_m_s2
    weak = (1.0 - WEAKER) * params.floor_static * g if params.has_pedestal else math.inf
    for side in (1, -1):
        along, up, _ = corner(task, state.facet, side)
        weak = min(weak, (1.0 - WEAKER) * abs(g * along / up))
    if not (stays(task, weak, g, 0.0) and stays(task, -weak, g, 0.0)):
        return
    passed, begun = x.breaks_passed, x.breaks_passed
    while (
        1 <= passed < x.params.n_samples - 1
        and load_double(x.params.times, passed) < params.duration_s
        and abs(x.params.scale * load_double(x.params.samples, passed)) <= weak
    ):
        passed += 1
    if passed > begun:
        x.breaks_passed = passed
        task.counts.quiet_samples += passed - begun
        hold(task, load_double(x.params.times, passed - 1))


@jit
def _leaves(task: Task, until: float, accel: float, gravity: float) -> bool:
    """Whether the domain is left on the way to a sample, which is then not passed at once: a step finds the instant."""
    inside = math.isnan(task.results.left_domain_s)
    note_rest(task, until, accel, gravity)
    if inside and not math.isnan(task.results.left_domain_s):
        task.results.left_domain_s, task.results.left_domain_by = math.nan, 0
        return True
    return False


@jit
def _look_through(task: Task) -> None:
    """Pass every sample up to which the statue certainly stays at rest: between two of them the acceleration is a straight line,
    so that what holds at its ends holds between them."""
    params, x, z = task.params, task.motion_x, task.motion_z
    g = params.gravity_m_s2
    while True:
        break_x, break_z = next_break_s(x), next_break_s(z)
        until = min(break_x, break_z, params.duration_s)
        ax, az = _before(x, until, break_x == until), _before(z, until, break_z == until)
        if not stays(task, ax, g + az, 0.0):
            return
        if until >= params.duration_s:
            hold(task, params.duration_s)
            return
        if params.keep_validity and _leaves(task, until, ax, g + az):
            return
        passed_x, passed_z = x.breaks_passed, z.breaks_passed
        x.breaks_passed += 1 if break_x == until else 0
        z.breaks_passed += 1 if break_z == until else 0
        jump = (break_x == until and is_jump(x)) or (break_z == until and is_jump(z))
        after_x, after_z = sampled_at(x, until), sampled_at(z, until)
        if jump and not stays(task, after_x, g + after_z, 0.0):
            x.breaks_passed, z.breaks_passed = passed_x, passed_z
            return
        hold(task, until)
        task.counts.quiet_samples += 1
        if params.keep_validity:
            note_rest(task, until, after_x, g + after_z)
        _pass_weak(task)


@jit
def skip_quiet(task: Task) -> None:
    """Skip what is left of a rest in which no limit can be reached (docs/model.md, section 2)."""
    params, x, z = task.params, task.motion_x, task.motion_z
    if is_over(x) and is_over(z):
        hold(task, params.duration_s)
        return
    if (is_over(x) or x.params.kind == SAMPLED) and (is_over(z) or z.params.kind == SAMPLED):
        _look_through(task)
        return
    # a formula is bounded by its amplitude: enough where the run needs no extremes of the forces on the way
    most_x, most_z = abs(x.params.amplitude_m_s2), abs(z.params.amplitude_m_s2)
    if not params.keep_validity and stays(task, 0.0, params.gravity_m_s2 - most_z, most_x):
        hold(task, params.duration_s)


UNKNOWN: Final = 0
"""Energy alone does not decide here."""
EXHAUSTED: Final = -1
"""Nor after all the impacts that are followed."""
NEAR_TIE: Final = 1e-9
"""Relative distance of the energy to a barrier below which the run is integrated on: far above the rounding of E, far below any
scatter of a real statue's numbers."""
SPENT: Final = 1e-14
"""Kinetic energy in m g R below which a statue over its base stands: it lifts the centroid by less than 1e-14 R."""
MAX_IMPACTS: Final = 2000
"""Impacts followed: a statue that keeps 0.992 of its rate at each has spent its energy by then."""
NEXT_IMPACTS: Final = 32
"""Impacts that are integrated before so many are followed again: a round stone loses little on each of its small facets."""


@jit
def _sticks(task: Task, j: float, energy: float, reach: float, lowest: float, radius: float) -> bool:
    """Whether contact, and the pedestal's friction, certainly hold on an arc with |X| ≤ reach and Z ≥ lowest."""
    params = task.params
    m, g = params.mass_kg, params.gravity_m_s2
    turn2 = max(2.0 * (energy - m * g * lowest) / j, 0.0)  # largest θ̇² on the arc
    # V = m (g + Z''), Z'' = −X θ̈ − Z θ̇² and θ̈ = m g X/J: least where |X| is largest and the turn fastest
    v = m * (g - m * g * reach * reach / j - radius * turn2)
    if v <= 0.0:
        return False
    if not params.has_pedestal:
        return True
    normal = v + params.pedestal_mass_kg * g if params.dynamic_normal else (m + params.pedestal_mass_kg) * g
    # F = m X'' = m X (m g Z/J − θ̇²): a difference, at most m |X| times the larger of its terms
    return bool(m * reach * max(m * g * radius / j, turn2) <= params.floor_static * normal)


@jit
def _wall_ahead(task: Task, pivot: int, side: int, theta: float) -> float:
    """Rotation to that side, from theta on, at which the statue touches the wall as it turns about a vertex of its base on a
    pedestal that stays; infinite if it does not."""
    params, base = task.params, task.base
    if params.wall_side != side:
        return math.inf
    x, z = load_double(base.x, pivot), load_double(base.z, pivot)
    room, first = params.wall_m - side * (load_double(base.stands, pivot) + task.state.slip_m), math.inf
    for i in range(base.n_outline):
        dx, dz = side * (load_double(base.outline_x, i) - x), load_double(base.outline_z, i) - z
        radius = math.sqrt(dx * dx + dz * dz)
        if radius > abs(room):  # else it passes below the wall's face
            turn = math.atan2(dz, dx) - math.acos(room / radius)
            if turn >= side * theta:
                first = min(first, turn)
    return first


@jit
def _note_ahead(task: Task, side: int, lean: float) -> None:
    """A lean to that side that will be reached, from now on: when it will be is not computed."""
    params = task.params
    note_peak(task, side * lean, task.state.time_s)
    if params.keep_validity and lean > (params.base_right_rad if side > 0 else params.base_left_rad):
        leave(task, task.state.time_s, BY_LEAN)


@jit
def _ahead(task: Task, pivot: int, side: int, theta: float, energy: float) -> tuple[int, float]:
    """Outcome of moving to a side where no facet lies ahead, UNKNOWN with angle 0 to turn back, 1 to integrate."""
    params = task.params
    x, z = vertex(task, pivot)
    weight = params.mass_kg * params.gravity_m_s2 * math.sqrt(x * x + z * z)
    balance, wall = side * math.atan2(x, z), _wall_ahead(task, pivot, side, theta)
    # the barrier: the centroid above its corner, or where the wall stops it before
    top = weight if wall >= balance else weight * math.cos(wall - balance)
    if side * theta < min(balance, wall):
        margin = energy / top - 1.0
        task.results.outcome_margin = min(task.results.outcome_margin, abs(margin))
        if abs(margin) < NEAR_TIE:
            return UNKNOWN, 1.0
        if margin < 0.0:
            _note_ahead(task, side, balance - math.acos(max(energy / weight, -1.0)))
            return UNKNOWN, 0.0
    if wall < params.overturn_rad:
        _note_ahead(task, side, wall)
        return TOUCHES_WALL, 0.0
    _note_ahead(task, side, params.overturn_rad)
    return (OVERTURNED_RIGHT if side > 0 else OVERTURNED_LEFT), 0.0


@jit
def _landing(task: Task, pivot: int, facet: int, speed: float) -> tuple[int, float, bool]:
    """Pivot and θ̇ after landing on the facet with θ̇ = speed, and whether the pedestal stayed where it was."""
    params = task.params
    side = 1 if pivot == facet + 1 else -1
    xo, z, _ = corner(task, facet, side)
    xn, _, _ = corner(task, facet, -side)
    after, moved, _ = impact(params, xn, xo, z, speed, 0.0, params.floor_static, params.floor_kinetic)
    return (facet if side > 0 else facet + 1), after, moved == 0.0


@jit
def _follow(task: Task) -> tuple[int, bool]:
    """Outcome of the free rocking from the present state, UNKNOWN where energy alone does not decide; and whether it is a fall
    whose balance point is passed for good."""
    params, series = task.params, task.series
    m, g, last = params.mass_kg, params.gravity_m_s2, task.base.n_facets
    theta, omega, pivot = task.state.theta_rad, task.state.theta_rate_rad_s, task.state.pivot
    for number in range(MAX_IMPACTS):
        j = place(task, theta, pivot)
        energy = 0.5 * j * omega * omega + m * g * series.pivot_z[0]
        side = 1 if (omega > 0.0 or (omega == 0.0 and series.pivot_x[0] > 0.0)) else -1
        x, z = vertex(task, pivot)
        radius = math.sqrt(x * x + z * z)
        if pivot == (last if side > 0 else 0):
            reach, lowest = (
                max(abs(series.pivot_x[0]), params.floor_static * params.has_pedestal * radius),
                series.pivot_z[0],
            )
            past = series.pivot_x[0] * side > 0.0
            if not past and not _sticks(task, j, energy, reach, lowest, radius):
                return UNKNOWN, False
            outcome, doubt = _ahead(task, pivot, side, theta, energy)
            if outcome != UNKNOWN or doubt > 0.0:
                return outcome, past and number == 0
            side = -side
        facet = pivot if side > 0 else pivot - 1
        x, z, _ = corner(task, facet, 1 if pivot == facet + 1 else -1)
        if not _sticks(task, j, energy, max(abs(x), abs(series.pivot_x[0])), min(z, series.pivot_z[0]), radius):
            return UNKNOWN, False
        wall = _wall_ahead(task, pivot, side, theta)
        if x * series.pivot_x[0] >= 0.0 and z > series.pivot_z[0]:  # it rises towards a facet that it may not reach
            margin = energy / (m * g * z) - 1.0
            if abs(margin) < NEAR_TIE:
                return UNKNOWN, False
            if margin < 0.0:
                xv, zv = vertex(task, pivot)
                turned = side * math.atan2(xv, zv) - math.acos(energy / (m * g * radius))
                _note_ahead(task, side, min(turned, wall))
                if wall < turned:
                    return TOUCHES_WALL, False
                omega = -omega  # it turns back, and comes by here the other way
                continue
        if x * series.pivot_x[0] < 0.0:  # the centroid must pass over the corner first
            margin = energy / (m * g * radius) - 1.0
            task.results.outcome_margin = min(task.results.outcome_margin, abs(margin))
            if abs(margin) < NEAR_TIE:
                return UNKNOWN, False
            if margin < 0.0:
                beyond = pivot == (last if side < 0 else 0)
                return (_ahead(task, pivot, -side, theta, energy)[0] if beyond else UNKNOWN), number == 0
        if wall < side * load_double(task.base.facets, facet):
            _note_ahead(task, side, wall)
            return TOUCHES_WALL, False
        speed = side * math.sqrt(max(2.0 * (energy - m * g * z) / j, 0.0))
        pivot, omega, held = _landing(task, pivot, facet, speed)
        if not held:
            return UNKNOWN, False
        theta = load_double(task.base.facets, facet)
        xr, _, _ = corner(task, facet, 1)
        xl, _, _ = corner(task, facet, -1)
        if xr < 0.0 < xl and 0.5 * j * omega * omega <= SPENT * m * g * radius:
            return STANDS, False
    return EXHAUSTED, False


@jit
def decide(task: Task) -> bool:
    """Set the outcome from the energy if it follows from it; both motions must be over.

    A fall that has yet to pass its balance, and a wall, are told at the end of a run alone: until then their instants are found.
    """
    state, results = task.state, task.results
    if state.slide != 0 or task.counts.impacts < state.followed:
        return False
    peak_rad, peak_s, left_s, left_by = (
        results.peak_theta_rad,
        results.peak_time_s,
        results.left_domain_s,
        results.left_domain_by,
    )
    outcome, passed = (STANDS, False) if state.pivot < 0 else _follow(task)
    if outcome == EXHAUSTED:
        state.followed = task.counts.impacts + NEXT_IMPACTS
    if outcome in (EXHAUSTED, UNKNOWN) or not (passed or outcome == STANDS or state.time_s >= task.params.duration_s):
        # What lies ahead is met again.
        results.peak_theta_rad, results.peak_time_s = peak_rad, peak_s
        results.left_domain_s, results.left_domain_by = left_s, left_by
        return False
    if not passed:
        results.no_return_time_s = math.nan
    state.outcome = outcome
    task.counts.energy_endings += 1
    return True
