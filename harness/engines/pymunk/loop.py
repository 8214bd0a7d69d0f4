"""A whole run: blocks of plain steps, each left when a step must be split."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.contact import frame
from harness.engines.pymunk import drive as driving
from harness.engines.pymunk import events, native, uplift, writing
from harness.engines.pymunk import micro_rocking as rattle
from harness.engines.pymunk.drive import RunState
from harness.engines.pymunk.settings import MunkSettings
from harness.engines.pymunk.standing import FAR, SupportVertex
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
IMPACT, HALT, RATTLE, END = 1, 2, 3, 0
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


def run(drive: RunState, standing: SupportVertex, grid: Grid, first: int, want: RunOptions) -> bool:
    """Compute from step `first` to the end; returns whether the run was ended early at rest."""
    total, k = len(grid.gravity), first
    quiet_after = drive.scene.base_excitation.end_s if want.allows("quiet_end") else math.inf
    still_blocks, look = 0, min(k + BLOCK_STEPS, total)
    drive.whole_from, split_from = first, first + LEAST_BETWEEN
    drive.spin_before_rad_s = native.get_spin(standing.statue)
    while k < total:
        k, event, share = _plain_steps(drive, standing, grid, k, look, split_from)
        if event == IMPACT:
            end = min(k + EVENT_STEPS, total)
            events.split_impact(drive, standing, standing.facet, float(grid.edges_s[end]))
            k, drive.rate_before_m_s, drive.whole_from, split_from = end, math.nan, end, end + LEAST_BETWEEN
        elif event == RATTLE:
            k = rattle.rattle(drive, standing, standing.facet, grid.edges_s)
            drive.rate_before_m_s, drive.whole_from, split_from = math.nan, k, k + LEAST_BETWEEN
        elif event == HALT:
            events.split_halt(drive, standing, share, float(grid.edges_s[k + 1]))
            # An impact may follow at once: a halt does not change how the statue turns.
            k, drive.rate_before_m_s, drive.whole_from = k + 1, math.nan, k + 1
        if event != END:
            # What an event changed the spin by says nothing of the steps after it.
            drive.spin_before_rad_s = native.get_spin(standing.statue)
        if k >= look:
            look = min(k + BLOCK_STEPS, total)
            drive.states.append(drive.world.recorder.take())
            if (
                want.allows("stop_at_overturn")
                and abs(native.get_angle(native.body_of(drive.world.statue))) > OVERTURN_RAD
            ):
                return False
            if want.stop is not None and want.stop(drive.t_s, -native.get_angle(native.body_of(drive.world.statue))):
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
    drive: RunState, standing: SupportVertex, grid: Grid, k: int, stop: int, first_split: int
) -> tuple[int, int, float]:
    """Whole steps from k until one must be split (for an impact from step `first_split` on), or `stop`.

    Returns the next step, what it holds (END: nothing) and, at a halt, the share of the step at which it comes.
    """
    world, friction, settings = drive.world, drive.friction, drive.settings
    space, recorder, floor = native.space_of(world.space), world.recorder, native.body_of(world.floor)
    step, set_gravity, each, last = native.step, native.set_gravity, native.each_body, recorder.last
    record_with, record_to, hold = recorder.each, recorder.target, standing.hold
    dt, gravity, moving, rest = settings.dt_s, grid.gravity, drive.moving, friction.stuck_below_m_s
    last_split = len(gravity) - EVENT_STEPS
    switches, creep = friction.switches, CREEP_SHARE * rest
    aligned, on_pedestal = drive.aligned, world.pedestal is not None
    halts = settings.align and on_pedestal and rest > 0.0
    many, few, using = settings.iterations, settings.turning_iterations, settings.iterations
    lags = (0.5 * dt, 0.5 * dt)
    least_spin = standing.swings_rad_s if aligned else math.inf
    own, under = world.statue_slice, world.pedestal_slice
    begin, event, share, spin, row, risen = k, END, 0.0, drive.spin_before_rad_s, last(), standing.risen
    state, below = row[own], row[under] if on_pedestal else None
    rate, before, top, standing.asked = driving.slip_rate(drive), drive.rate_before_m_s, None, -2
    while k < stop:
        spin_before, spin = spin, state[5]
        wanted = many
        if -least_spin <= spin <= least_spin:
            risen = False
        else:
            if not risen:
                risen = uplift.follow(drive, standing, k - drive.whole_from)
                state = native.state_of(standing.statue)
                spin = state[5]
            found = standing.coming(state, below, spin_before)
            if found == FAR:
                wanted = few if standing.held(k, state, gravity[k - 1]) else many
            elif found >= 0 and first_split <= k <= last_split and standing.stands_on(found + (spin < 0.0)):
                short, standing.facet = rattle.is_short(drive, standing, found, float(grid.edges_s[k])), found
                if short is not None:
                    event = RATTLE if short else IMPACT
                    break
        # At the present deceleration the pedestal comes to rest within the step (never true after an event: before is NaN).
        if (
            halts
            and (rest < rate < before - rate or before - rate < rate < -rest)
            and driving.slid(drive, gravity[k - 1], standing.owed_m_s)
        ):
            event, share = HALT, rate / (before - rate)
            break
        if wanted != using:
            native.set_iterations(space, wanted)
            using = wanted
        set_gravity(space, gravity[k])
        if aligned:
            if moving and not on_pedestal:
                top = grid.table_place[k][1] + dt * grid.table_velocity[k][1]
            hold(state, below, dt, lags, top, slow=k % SLOW_EVERY == 0)
        if moving:
            writing.move_table(floor, grid.table_place[k], grid.table_velocity[k])
        step(space, dt)
        each(space, record_with, record_to)
        row = last()
        if on_pedestal:
            before, rate = rate, row[world.pedestal_column + 3] - (grid.table_velocity[k][0] if moving else 0.0)
            if switches and (abs(rate) > creep if drive.stuck else abs(rate) <= rest or rate * before < 0.0):
                recorder.drop()
                rate, using = _switch(drive, standing, grid, k, rate), many
                each(space, record_with, record_to)
                row = last()
            below = row[under]
        state = row[own]
        k += 1
    native.set_iterations(space, many)
    drive.rate_before_m_s, drive.spin_before_rad_s, standing.risen = before, spin, risen
    drive.times_s.extend(grid.edges_s[begin + 1 : k + 1].tolist())
    drive.lags_s.extend([0.5 * dt] * (k - begin))
    drive.work["engine_steps"] += k - begin
    drive.t_s = float(grid.edges_s[k])
    drive.place_s = drive.t_s - 0.5 * dt
    return k, event, share


def _switch(drive: RunState, standing: SupportVertex, grid: Grid, k: int, rate: float) -> float:
    """Let the floor's coefficient follow the state after step k; returns the pedestal's rate.

    A step that seems to have broken loose is computed again: with many iterations first, because a solver's remainder is no
    slip, then with the kinetic coefficient, or the mean of both where the two whole steps before it say when it gave way.
    """
    if not drive.stuck:
        driving.set_stuck(drive, stuck=True)
        return rate
    owed = standing.owed_m_s
    before = driving.less(driving.recorded_velocities(drive), owed)
    if not driving.broke_loose(drive, before, grid.gravity[k]):
        return rate
    space, many = native.space_of(drive.world.space), drive.settings.impact_iterations
    lags_s = (0.5 * drive.settings.dt_s, 0.5 * drive.settings.dt_s)
    share = driving.release_share(drive, grid.gravity[k - 2 : k]) if k >= drive.whole_from + 2 else 0.0
    for stuck in (True, False):
        driving.restore_recorded(drive)
        if owed != (0.0, 0.0):
            standing.hold(native.state_of(standing.statue), standing.below(), drive.settings.dt_s, lags_s)
        if drive.moving:
            writing.place_table(native.body_of(drive.world.floor), grid.table_place[k])
        driving.set_stuck(drive, stuck=stuck, static_share=share)
        native.set_iterations(space, many)
        native.step(space, drive.settings.dt_s)
        native.set_iterations(space, drive.settings.iterations)
        drive.ledger.of(driving.RELEASE).steps_again += 1
        if stuck and not driving.broke_loose(drive, before, grid.gravity[k]):
            return driving.slip_rate(drive)
    # The steps that follow slide throughout.
    driving.set_stuck(drive, stuck=False)
    return driving.slip_rate(drive)
