"""What can be left out while nothing moves: records are looked through, not integrated."""

from __future__ import annotations

from typing import Final

from analytic.kernel.compiler import jit
from analytic.kernel.forcing import break_at, is_jump, is_over, sampled_at
from analytic.kernel.joint_state import corner
from analytic.kernel.layout import (
    ALONG_X,
    ALONG_Z,
    AMPLITUDE,
    BASE_MASS,
    DURATION,
    FACET,
    GRAVITY,
    GRID,
    GRID_STEP,
    HAS_BASE,
    HISTORY,
    KIND,
    LOADED,
    MASS,
    MU_STATIC,
    NONE,
    PEAK_SLIP,
    QUIET_SAMPLES,
    S_OM,
    S_TH,
    S_U,
    S_V,
    SAMPLED,
    SAMPLES,
    SCALE,
    SEG,
    SKIPPED_S,
    TIMES,
    WANT_VALIDITY,
    T,
    Task,
)
from analytic.kernel.memory import peek
from analytic.kernel.track import sample
from analytic.kernel.validity import note_rest

CLEAR: Final = 1e-9
"""Relative distance to a limit below which nothing is skipped."""


@jit
def stays(task: Task, ax: float, gz: float, swing: float) -> bool:
    """Whether a statue at rest on a stuck support stays so, clear of every limit, under |a_x − ax| ≤ swing and g_e ≥ gz."""
    if gz <= 0.0:
        return False
    for side in (1, -1):
        x, z, _ = corner(task, task.q[FACET], side)
        if -side * (gz * x - ax * z) - swing * z <= CLEAR * (abs(gz * x) + abs(ax * z)):
            return False
    if task.p[HAS_BASE] > 0.0:
        total = task.p[MASS] + task.p[BASE_MASS]
        if total * (task.p[MU_STATIC] * gz - abs(ax) - swing) <= CLEAR * total * (gz + abs(ax)):
            return False
    return True


@jit
def hold(task: Task, until: float) -> None:
    """Move the clock to until, the state unchanged, and fill the output samples passed."""
    s, q = task.s, task.q
    dt = task.p[GRID_STEP]
    if dt > 0.0:
        while q[GRID] < task.length[HISTORY] and q[GRID] * dt < until:
            sample(task, q[GRID], q[GRID] * dt, s[S_TH], s[S_OM], s[S_U], s[S_V])
            q[GRID] += 1
    task.r[PEAK_SLIP] = max(task.r[PEAK_SLIP], abs(s[S_U]))
    task.r[SKIPPED_S] += until - s[T]
    s[T] = until
    q[LOADED] = 0


@jit
def _left(task: Task, axis: int, time: float, own: bool) -> float:
    """The acceleration just before time, which is the motion's own next break if own."""
    seg = task.q[SEG + axis]
    if own and 1 <= seg < task.length[TIMES + axis]:
        return float(task.f[axis, SCALE] * peek(task.address[SAMPLES + axis], seg))
    return sampled_at(task, axis, time)


@jit
def _look_through(task: Task) -> None:
    """Pass every sample up to which the statue certainly stays at rest."""
    q, p = task.q, task.p
    g = p[GRAVITY]
    while True:
        bx, bz = break_at(task, ALONG_X), break_at(task, ALONG_Z)
        until = min(bx, bz, p[DURATION])
        ax, az = _left(task, ALONG_X, until, bx == until), _left(task, ALONG_Z, until, bz == until)
        if not stays(task, ax, g + az, 0.0):
            return
        if until >= p[DURATION]:
            hold(task, p[DURATION])
            return
        q[SEG + ALONG_X] += 1 if bx == until else 0
        q[SEG + ALONG_Z] += 1 if bz == until else 0
        jump = (bx == until and is_jump(task, ALONG_X)) or (bz == until and is_jump(task, ALONG_Z))
        after_x, after_z = sampled_at(task, ALONG_X, until), sampled_at(task, ALONG_Z, until)
        if jump and not stays(task, after_x, g + after_z, 0.0):
            q[SEG + ALONG_X] -= 1 if bx == until else 0
            q[SEG + ALONG_Z] -= 1 if bz == until else 0
            return
        hold(task, until)
        task.c[QUIET_SAMPLES] += 1
        if p[WANT_VALIDITY] > 0.0:
            note_rest(task, until, ax, g + az)
            note_rest(task, until, after_x, g + after_z)


@jit
def quiet(task: Task) -> None:
    """Skip what is left of a rest in which no limit can be reached (docs/model.md, section 2)."""
    p = task.p
    over_x, over_z = is_over(task, ALONG_X), is_over(task, ALONG_Z)
    if over_x and over_z:
        hold(task, p[DURATION])
        return
    kind_x, kind_z = int(task.f[ALONG_X, KIND]), int(task.f[ALONG_Z, KIND])
    if (over_x or kind_x == SAMPLED) and (over_z or kind_z == SAMPLED):
        _look_through(task)
        return
    swing_x = 0.0 if kind_x == NONE else abs(task.f[ALONG_X, AMPLITUDE])
    swing_z = 0.0 if kind_z == NONE else abs(task.f[ALONG_Z, AMPLITUDE])
    if p[WANT_VALIDITY] == 0.0 and stays(task, 0.0, p[GRAVITY] - swing_z, swing_x):
        hold(task, p[DURATION])
