"""What can be left out while nothing moves: records are looked through, not integrated."""

from __future__ import annotations

from typing import Final

from analytic._jit import jit
from analytic.forcing import break_at, is_jump, is_over, sampled_at
from analytic.layout import (
    AMPLITUDE,
    BASE_MASS,
    DURATION,
    FACET,
    GRAVITY,
    GRID,
    GRID_STEP,
    HAS_BASE,
    KIND,
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
    SCALE,
    SEG_X,
    SEG_Z,
    SKIPPED_S,
    WANT_VALIDITY,
    T,
    Task,
)
from analytic.states import corner
from analytic.validity import note_rest

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
        while q[GRID] < task.grid.shape[0] and q[GRID] * dt < until:
            task.grid[q[GRID], 0], task.grid[q[GRID], 1] = s[S_TH], s[S_OM]
            task.grid[q[GRID], 2], task.grid[q[GRID], 3] = s[S_U], s[S_V]
            q[GRID] += 1
    task.r[PEAK_SLIP] = max(task.r[PEAK_SLIP], abs(s[S_U]))
    task.r[SKIPPED_S] += until - s[T]
    s[T] = until


@jit
def _left(task: Task, along_x: bool, time: float, own: bool) -> float:
    """The acceleration just before time, which is the motion's own next break if own."""
    f, t = (task.fx, task.tx) if along_x else (task.fz, task.tz)
    a = task.sx if along_x else task.sz
    seg = task.q[SEG_X] if along_x else task.q[SEG_Z]
    if seg < 1 or seg >= t.size:
        return 0.0
    return float(f[SCALE] * a[seg]) if own else sampled_at(f, t, a, seg, time)


@jit
def _right(task: Task, along_x: bool, time: float) -> float:
    """The acceleration just after time, the motion's break there being passed."""
    f, t = (task.fx, task.tx) if along_x else (task.fz, task.tz)
    a = task.sx if along_x else task.sz
    return sampled_at(f, t, a, task.q[SEG_X] if along_x else task.q[SEG_Z], time)


@jit
def _look_through(task: Task) -> None:
    """Pass every sample up to which the statue certainly stays at rest."""
    q, p = task.q, task.p
    g = p[GRAVITY]
    while True:
        bx, bz = break_at(task.fx, task.tx, q[SEG_X]), break_at(task.fz, task.tz, q[SEG_Z])
        until = min(bx, bz, p[DURATION])
        ax, az = _left(task, True, until, bx == until), _left(task, False, until, bz == until)
        if not stays(task, ax, g + az, 0.0):
            return
        if until >= p[DURATION]:
            hold(task, p[DURATION])
            return
        q[SEG_X] += 1 if bx == until else 0
        q[SEG_Z] += 1 if bz == until else 0
        jump = (bx == until and is_jump(task.fx, task.tx, q[SEG_X])) or (
            bz == until and is_jump(task.fz, task.tz, q[SEG_Z])
        )
        after_x, after_z = _right(task, True, until), _right(task, False, until)
        if jump and not stays(task, after_x, g + after_z, 0.0):
            q[SEG_X] -= 1 if bx == until else 0
            q[SEG_Z] -= 1 if bz == until else 0
            return
        hold(task, until)
        task.c[QUIET_SAMPLES] += 1
        if p[WANT_VALIDITY] > 0.0:
            note_rest(task, until, ax, g + az)
            note_rest(task, until, after_x, g + after_z)


@jit
def quiet(task: Task) -> None:
    """Skip what is left of a rest in which no limit can be reached (docs/model.md, section 2)."""
    p, q = task.p, task.q
    over_x, over_z = is_over(task.fx, task.tx, q[SEG_X]), is_over(task.fz, task.tz, q[SEG_Z])
    if over_x and over_z:
        hold(task, p[DURATION])
        return
    kind_x, kind_z = int(task.fx[KIND]), int(task.fz[KIND])
    if (over_x or kind_x == SAMPLED) and (over_z or kind_z == SAMPLED):
        _look_through(task)
        return
    swing_x = 0.0 if kind_x == NONE else abs(task.fx[AMPLITUDE])
    swing_z = 0.0 if kind_z == NONE else abs(task.fz[AMPLITUDE])
    if p[WANT_VALIDITY] == 0.0 and stays(task, 0.0, p[GRAVITY] - swing_z, swing_x):
        hold(task, p[DURATION])
