"""A whole run: blocks of plain steps, each left when a step must be split."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.contact import frame
from harness.engines.contact.coulomb import SLIP_ONSET
from harness.engines.pymunk import drive as driving
from harness.engines.pymunk import events, micro_rocking, native, uplift, writing
from harness.engines.pymunk.drive import RunState
from harness.engines.pymunk.settings import MunkSettings
from harness.engines.pymunk.support_vertex import FAR, SupportVertex
from harness.model.options import RunOptions
from harness.model.scene import OVERTURN_RAD, Scene

Array = NDArray[np.float64]
Pair = tuple[float, float]

BLOCK_STEPS: Final = 512
"""Whole steps between two looks at whether the run can end."""
CREEP_SHARE: Final = 2e-2
"""Share of the velocity of rest above which a stuck pedestal is asked whether its friction is at the limit."""
STILL_BLOCKS: Final = 2
STILL_RAD_S: Final = 1e-5
STILL_M_S: Final = 1e-5
"""Rates below these in two blocks running, with the floor still, are rest."""
TREMBLE_RAD_S2: Final = 1e-2
"""Rate, over the step, at which a statue at rest may tremble in its depth of contact: measured 3e-5 rad/s at 4 ms."""
IMPACT, STICK_ONSET, MICRO_ROCKING, END = 1, 2, 3, 0
EVENT_STEPS: Final = 3
"""Whole steps that a split impact takes the place of."""
SLOW_EVERY: Final = 16
"""Steps after which a slow or resting statue is held to its depth of contact."""
LEAST_BETWEEN: Final = 2
"""Whole steps since an event that tell how the statue moves on."""


@dataclass(frozen=True, eq=False)
class Grid:
    """The run's whole steps: `edges_s` (n + 1,), gravity of each, and for a moving table its velocity and place."""

    edges_s: Array
    gravity: Sequence[Pair]
    table_velocity: Sequence[Pair]
    table_place: Sequence[Pair]


def grid_of(scene: Scene, dt_s: float) -> Grid:
    """Everything that the table does, computed before the loop."""
    edges: Array = np.arange(frame.step_count(scene.duration_s, dt_s) + 1, dtype=np.float64) * dt_s
    if scene.table == "frame":
        return Grid(edges, _pairs(frame.apparent_gravity(scene, edges)), (), ())
    still = [(0.0, -scene.gravity_m_s2)] * (edges.size - 1)
    velocity = frame.table_velocity(scene, edges[1:])
    place = frame.table_displacement(scene, edges[1:] - 0.5 * dt_s) - velocity * dt_s
    return Grid(edges, still, _pairs(velocity), _pairs(place))


def _pairs(rows: Array) -> list[Pair]:
    return list(zip(rows[:, 0].tolist(), rows[:, 2].tolist(), strict=True))


def run(drive: RunState, support: SupportVertex, grid: Grid, first: int, options: RunOptions) -> bool:
    """Compute from step `first` to the end; returns whether the run was ended early at rest."""
    total, k = len(grid.gravity), first
    quiet_after = drive.scene.base_excitation.end_s if options.allows("quiet_end") else math.inf
    still_blocks, look = 0, min(k + BLOCK_STEPS, total)
    drive.whole_from, split_from = first, first + LEAST_BETWEEN
    drive.spin_before_rad_s = native.get_spin(support.statue)
    while k < total:
        k, event, share = _plain_steps(drive, support, grid, k, look, split_from)
        if event == IMPACT:
            end = min(k + EVENT_STEPS, total)
            events.split_impact(drive, support, support.facet, float(grid.edges_s[end]))
            k, drive.rate_before_m_s, drive.whole_from, split_from = end, math.nan, end, end + LEAST_BETWEEN
        elif event == MICRO_ROCKING:
            k = micro_rocking.pass_micro_rocking(drive, support, support.facet, grid.edges_s)
            drive.rate_before_m_s, drive.whole_from, split_from = math.nan, k, k + LEAST_BETWEEN
        elif event == STICK_ONSET:
            events.split_stick_onset(drive, support, share, float(grid.edges_s[k + 1]))
            # An impact may follow at once: a stick onset does not change how the statue turns.
            k, drive.rate_before_m_s, drive.whole_from = k + 1, math.nan, k + 1
        if event != END:
            # What an event changed the spin by says nothing of the steps after it.
            drive.spin_before_rad_s = native.get_spin(support.statue)
        if k >= look:
            look = min(k + BLOCK_STEPS, total)
            drive.states.append(drive.world.recorder.take())
            if (
                options.allows("stop_at_overturn")
                and abs(native.get_angle(native.body_of(drive.world.statue))) > OVERTURN_RAD
            ):
                return False
            if options.stop is not None and options.stop(
                drive.t_s, -native.get_angle(native.body_of(drive.world.statue))
            ):
                return False
            still_blocks = still_blocks + 1 if drive.t_s > quiet_after and _still(drive) else 0
            if still_blocks >= STILL_BLOCKS:
                return k < total
    drive.states.append(drive.world.recorder.take())
    return False


def _still(drive: RunState) -> bool:
    body = native.body_of(drive.world.statue)
    upright = abs(native.get_angle(body)) <= resolution_rad(drive.scene, drive.settings)
    still_rad_s = max(STILL_RAD_S, TREMBLE_RAD_S2 * drive.settings.dt_s)
    return upright and abs(native.get_spin(body)) < still_rad_s and abs(driving.slip_rate(drive)) < STILL_M_S


def resolution_rad(scene: Scene, settings: MunkSettings) -> float:
    """Rotation that the contact's slop can leave at rest."""
    return 2.0 * settings.slop_m / (scene.statue.corner_left_m + scene.statue.corner_right_m)


def _plain_steps(
    drive: RunState, support: SupportVertex, grid: Grid, k: int, stop: int, first_split: int
) -> tuple[int, int, float]:
    """Whole steps from k until one must be split (for an impact from step `first_split` on), or `stop`.

    Returns the next step, what it holds (END: nothing) and, at a stick onset, the share of the step at which it comes.
    """
    world, friction, settings = drive.world, drive.friction, drive.settings
    space, recorder, whole_step = native.space_of(world.space), world.recorder, _whole_step(drive, support, grid)
    gravity, moving, rest = grid.gravity, drive.moving, friction.stuck_below_m_s
    last_split, on_pedestal = len(gravity) - EVENT_STEPS, world.pedestal is not None
    switches, creep, support.asked = friction.switches, CREEP_SHARE * rest, -2
    locates_stick_onset = settings.align and on_pedestal and rest > 0.0
    many, few, using = settings.iterations, settings.turning_iterations, settings.iterations
    own, under, least_spin = world.statue_slice, world.pedestal_slice, _least_spin_rad_s(drive, support)
    begin, event, share, spin, row, risen = k, END, 0.0, drive.spin_before_rad_s, recorder.last(), support.risen
    state, below = row[own], row[under] if on_pedestal else None
    rate, before = driving.slip_rate(drive), drive.rate_before_m_s
    while k < stop:
        spin_before, spin, wanted = spin, state[5], many
        if -least_spin <= spin <= least_spin:
            risen = False
        else:
            if not risen:
                risen = uplift.follow(drive, support, k - drive.whole_from)
                state = native.state_of(support.statue)
                spin = state[5]
            facet = support.next_facet(state, below, spin_before)
            if facet == FAR:
                wanted = few if support.held(k, state, gravity[k - 1]) else many
            elif facet >= 0 and first_split <= k <= last_split:
                event = _impact_on(drive, support, facet, spin, float(grid.edges_s[k]))
                if event != END:
                    break
        # At the present deceleration the pedestal comes to rest within the step (never true after an event: before is NaN).
        if (
            locates_stick_onset
            and (rest < rate < before - rate or before - rate < rate < -rest)
            and driving.slid(drive, gravity[k - 1], support.owed_m_s)
        ):
            event, share = STICK_ONSET, rate / (before - rate)
            break
        if wanted != using:
            native.set_iterations(space, wanted)
            using = wanted
        row = whole_step(k, state, below)
        if on_pedestal:
            before, rate = rate, row[world.pedestal_column + 3] - (grid.table_velocity[k][0] if moving else 0.0)
            if switches and (abs(rate) > creep if drive.stuck else abs(rate) <= rest or rate * before < 0.0):
                recorder.drop()
                rate, using = _switch(drive, support, grid, k, rate), many
                native.each_body(space, recorder.each, recorder.target)
                row = recorder.last()
            below = row[under]
        state = row[own]
        k += 1
    native.set_iterations(space, many)
    drive.rate_before_m_s, drive.spin_before_rad_s, support.risen = before, spin, risen
    _note_steps(drive, grid, begin, k)
    return k, event, share


def _least_spin_rad_s(drive: RunState, support: SupportVertex) -> float:
    """Rate of turning above which events are looked for; none where the run's steps are all whole."""
    return support.half_cycle_rad_s if drive.aligned else math.inf


def _whole_step(
    drive: RunState, support: SupportVertex, grid: Grid
) -> Callable[[int, Sequence[float], Sequence[float] | None], list[float]]:
    """What makes step k from the states of the statue and of what is below it, and returns the row that is recorded.

    Everything it takes is looked up here, once: a step is made millions of times.
    """
    world, recorder, dt, gravity, moving = (
        drive.world,
        drive.world.recorder,
        drive.settings.dt_s,
        grid.gravity,
        drive.moving,
    )
    space, floor = native.space_of(world.space), native.body_of(world.floor)
    step, set_gravity, each, last = native.step, native.set_gravity, native.each_body, recorder.last
    record_with, record_to, hold, aligned = recorder.each, recorder.target, support.hold, drive.aligned
    on_table, lags, place, velocity = (
        moving and world.pedestal is None,
        (0.5 * dt, 0.5 * dt),
        grid.table_place,
        grid.table_velocity,
    )

    def whole_step(k: int, state: Sequence[float], below: Sequence[float] | None) -> list[float]:
        set_gravity(space, gravity[k])
        if aligned:
            top = place[k][1] + dt * velocity[k][1] if on_table else None
            hold(state, below, dt, lags, top, slow=k % SLOW_EVERY == 0)
        if moving:
            writing.move_table(floor, place[k], velocity[k])
        step(space, dt)
        each(space, record_with, record_to)
        return last()

    return whole_step


def _impact_on(drive: RunState, support: SupportVertex, facet: int, spin: float, t_s: float) -> int:
    """What the step holds in which a facet comes: MICRO_ROCKING, IMPACT, or END where the engine is left to meet it."""
    if not support.stands_on(facet + (spin < 0.0)):
        return END
    short, support.facet = micro_rocking.is_short(drive, support, facet, t_s), facet
    return END if short is None else MICRO_ROCKING if short else IMPACT


def _note_steps(drive: RunState, grid: Grid, begin: int, end: int) -> None:
    """Times and counts of the whole steps from `begin` to `end`: places are half a step older than velocities."""
    dt = drive.settings.dt_s
    drive.times_s.extend(grid.edges_s[begin + 1 : end + 1].tolist())
    drive.lags_s.extend([0.5 * dt] * (end - begin))
    drive.work["engine_steps"] += end - begin
    drive.t_s = float(grid.edges_s[end])
    drive.place_s = drive.t_s - 0.5 * dt


def _switch(drive: RunState, support: SupportVertex, grid: Grid, k: int, rate: float) -> float:
    """Let the floor's coefficient follow the state after step k; returns the pedestal's rate.

    A step that seems to have broken loose is computed again: with many iterations first, because a solver's remainder is no
    slip, then with the kinetic coefficient, or the mean of both where the two whole steps before it say when it gave way.
    """
    if not drive.stuck:
        driving.set_stuck(drive, stuck=True)
        return rate
    owed = support.owed_m_s
    before = driving.less(driving.recorded_velocities(drive), owed)
    if not driving.broke_loose(drive, before, grid.gravity[k]):
        return rate
    space, many = native.space_of(drive.world.space), drive.settings.impact_iterations
    lags_s = (0.5 * drive.settings.dt_s, 0.5 * drive.settings.dt_s)
    share = driving.slip_onset_share(drive, grid.gravity[k - 2 : k]) if k >= drive.whole_from + 2 else 0.0
    for stuck in (True, False):
        driving.restore_recorded(drive)
        if owed != (0.0, 0.0):
            support.hold(native.state_of(support.statue), support.below(), drive.settings.dt_s, lags_s)
        if drive.moving:
            writing.place_table(native.body_of(drive.world.floor), grid.table_place[k])
        driving.set_stuck(drive, stuck=stuck, static_share=share)
        native.set_iterations(space, many)
        native.step(space, drive.settings.dt_s)
        native.set_iterations(space, drive.settings.iterations)
        drive.ledger.of(SLIP_ONSET).steps_again += 1
        if stuck and not driving.broke_loose(drive, before, grid.gravity[k]):
            return driving.slip_rate(drive)
    # The steps that follow slide throughout.
    driving.set_stuck(drive, stuck=False)
    return driving.slip_rate(drive)
