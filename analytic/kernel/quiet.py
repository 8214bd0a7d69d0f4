"""What can be left out while nothing moves: records are looked through, not integrated."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.codes import NONE, SAMPLED
from analytic.kernel.compiler import jit
from analytic.kernel.forcing import is_jump, is_over, next_break_s, sampled_at
from analytic.kernel.joint_state import corner
from analytic.kernel.memory import load_double
from analytic.kernel.records import Motion, Task
from analytic.kernel.track import sample_state
from analytic.kernel.validity import note_rest

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
    state, output, dt = task.state, task.output, task.params.output_step_s
    if dt > 0.0:
        while output.next_sample < output.n_samples and output.next_sample * dt < until:
            sample_state(task, output.next_sample * dt)
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
            note_rest(task, until, ax, g + az)
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
    bound_x = 0.0 if x.params.kind == NONE else abs(x.params.amplitude_m_s2)
    bound_z = 0.0 if z.params.kind == NONE else abs(z.params.amplitude_m_s2)
    if not params.keep_validity and stays(task, 0.0, params.gravity_m_s2 - bound_z, bound_x):
        hold(task, params.duration_s)
