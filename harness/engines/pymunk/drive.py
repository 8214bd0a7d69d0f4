"""One run in progress: its clocks, its sliding state, and an engine step of any length with the coefficient that it needs.

Chipmunk moves bodies with the velocities of the step before and then changes these, so its positions lag its velocities by
half a step: both are second-order accurate when they are read so. The engine's step size never changes (it would corrupt its
warm start): a shorter advance is made by placing the bodies back along their velocities first.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from harness.engines.contact import frame
from harness.engines.contact.coulomb import SLIP_ONSET
from harness.engines.contact.friction import FloorFriction, floor_friction
from harness.engines.event_stepping.interventions import Ledger
from harness.engines.pymunk import native, writing
from harness.engines.pymunk.settings import MunkSettings
from harness.engines.pymunk.world import World
from harness.engines.pymunk.writing import BodyWriter
from harness.model.scene import Scene

Array = NDArray[np.float64]
Pair = tuple[float, float]


@dataclass(eq=False)
class RunState:
    """State of one run in progress: clocks of velocities (`t_s`) and of positions (`place_s`), friction state, records.

    All steps from `whole_from` on were whole. A recorded state's velocities are those of its `times_s`, its positions earlier by
    its `lags_s`.
    """

    scene: Scene
    settings: MunkSettings
    world: World
    friction: FloorFriction
    t_s: float = 0.0
    place_s: float = 0.0
    stuck: bool = True
    rate_before_m_s: float = math.nan
    spin_before_rad_s: float = math.nan
    whole_from: int = 0
    times_s: list[float] = field(default_factory=list)
    lags_s: list[float] = field(default_factory=list)
    states: list[Array] = field(default_factory=list)
    work: dict[str, int] = field(
        default_factory=lambda: {
            "engine_steps": 0,
            "impacts_split": 0,
            "halts_split": 0,
            "uplifts_met": 0,
        }
    )

    ledger: Ledger = field(default_factory=Ledger)

    @cached_property
    def writers(self) -> tuple[BodyWriter, ...]:
        """What writes to the statue, and to the pedestal if there is one."""
        bodies = zip(self.world.movers, (self.world.statue, self.world.pedestal), strict=False)
        g = self.scene.gravity_m_s2
        return tuple(BodyWriter(raw, own.mass, own.moment, g, self.ledger) for raw, own in bodies if own is not None)

    @property
    def masses_kg(self) -> tuple[float, ...]:
        """Masses of the moving bodies."""
        pedestal = self.scene.pedestal
        statue = self.scene.statue.mass_kg
        return (statue,) if pedestal is None else (statue, pedestal.mass_kg)

    @property
    def aligned(self) -> bool:
        """Whether impacts are met inside steps; a prescribed ratio is imposed on a flat base only."""
        return self.settings.align and (self.world.flat_base or self.scene.contact.restitution is None)

    @property
    def moving(self) -> bool:
        """Whether the table moves, instead of the frame."""
        return self.scene.table == "moving"


def start(scene: Scene, settings: MunkSettings, world: World, t_s: float) -> RunState:
    """A run about to begin at `t_s`, everything still at its initial state."""
    drive = RunState(scene, settings, world, floor_friction(scene, settings.dt_s), t_s, t_s - 0.5 * settings.dt_s)
    if t_s > 0.0:
        record(drive, 0.0)
    record(drive, t_s)
    return drive


def record(drive: RunState, t_s: float, lag_s: float | None = None) -> None:
    """Append the present state as that of `t_s`, its positions half a step (or `lag_s`) earlier."""
    recorder = drive.world.recorder
    native.each_body(native.space_of(drive.world.space), recorder.each, recorder.target)
    drive.times_s.append(t_s)
    drive.lags_s.append(0.5 * drive.settings.dt_s if lag_s is None else lag_s)


def advance(drive: RunState, move_s: float, kick_s: float, *, hard: bool = False) -> None:
    """One engine step that moves positions by `move_s` and velocities by `kick_s`; `hard` with an impact's iterations."""
    space, dt = native.space_of(drive.world.space), drive.settings.dt_s
    # Chipmunk always moves places by a whole step: what this one must not move is taken back before it.
    back = move_s - dt
    for writer in drive.writers:
        writer.shift(back)
    native.set_iterations(space, drive.settings.impact_iterations if hard else drive.settings.iterations)
    end_s = drive.t_s + kick_s
    gravity = (0.0, 0.0)
    if drive.moving:
        gravity = (0.0, -drive.scene.gravity_m_s2 * kick_s / dt)
        _place_table(drive, end_s, drive.place_s + move_s)
    elif kick_s > 0.0:
        along, _, down = frame.mean_gravity(drive.scene, drive.t_s, end_s)
        gravity = (along * kick_s / dt, down * kick_s / dt)
    native.set_gravity(space, gravity)
    drive.t_s = end_s
    drive.place_s += move_s
    step_with_friction(drive, gravity)
    native.set_iterations(space, drive.settings.iterations)


def _place_table(drive: RunState, velocity_s: float, place_s: float) -> None:
    """Give the table its exact velocity, and the place from which the step's own move takes it where it should be."""
    velocity = frame.table_velocity(drive.scene, np.array([velocity_s]))[0]
    place = frame.table_displacement(drive.scene, np.array([place_s]))[0]
    dt, floor = drive.settings.dt_s, native.body_of(drive.world.floor)
    begin = (float(place[0] - velocity[0] * dt), float(place[2] - velocity[2] * dt))
    writing.move_table(floor, begin, (float(velocity[0]), float(velocity[2])))


def slip_rate(drive: RunState) -> float:
    """Velocity of the pedestal over the floor."""
    pedestal = drive.world.pedestal
    if pedestal is None:
        return 0.0
    rate = float(native.get_velocity(native.body_of(pedestal)).x)
    return rate - float(native.get_velocity(native.body_of(drive.world.floor)).x) if drive.moving else rate


def step_with_friction(drive: RunState, gravity: Pair) -> None:
    """One engine step with the coefficient that the sliding state asks for (harness/engines/contact/friction.py)."""
    world, friction = drive.world, drive.friction
    space, dt = native.space_of(world.space), drive.settings.dt_s
    drive.work["engine_steps"] += 1
    if world.pedestal is None or not friction.switches:
        native.step(space, dt)
        return
    before = slip_rate(drive)
    saved = [native.state_of(body) for body in world.movers]
    floor = native.body_of(world.floor)
    floor_place = native.get_place(floor)
    native.step(space, dt)
    rate = slip_rate(drive)
    if not drive.stuck:
        if abs(rate) <= friction.stuck_below_m_s or rate * before < 0.0:
            set_stuck(drive, stuck=True)
        return
    if broke_loose(drive, [(state[3], state[4]) for state in saved], gravity):
        set_stuck(drive, stuck=False)
        for writer, state in zip(drive.writers, saved, strict=True):
            writer.restore(state)
        if drive.moving:
            writing.place_table(floor, (floor_place.x, floor_place.y))
        native.step(space, dt)
        drive.ledger.of(SLIP_ONSET).steps_again += 1


def broke_loose(drive: RunState, velocities: Sequence[Pair], gravity: Pair) -> bool:
    """Whether the floor's friction reached its static limit in the step just made from these `velocities` (statue, pedestal)."""
    after = [native.get_velocity(body) for body in drive.world.movers]
    return _at_limit(drive, velocities, [(item.x, item.y) for item in after], gravity, stuck=True)


def slip_onset_share(drive: RunState, gravity: Sequence[Pair]) -> float:
    """Share of the coming step after which static friction gives way, from the two whole steps before it under these gravities.

    The floor's friction over its limit is a straight line through the two; 0 where it does not grow, as after an event. Less
    than 0: in the half of the step before that its mean friction did not show.
    """
    rows = [recorded_velocities(drive, back) for back in (2, 1, 0)]
    used = []
    for before, after, pull in zip(rows[:2], rows[1:], gravity, strict=True):
        if not before:
            return 0.0
        friction, normal = _impulses(drive, before, after, pull)
        used.append(abs(friction) / (drive.friction.static * normal) if normal > 0.0 else 1.0)
    grown = used[1] - used[0]
    return min(max((1.0 - used[1]) / grown - 0.5, -0.5), 1.0) if grown > 0.0 else 0.0


def slid(drive: RunState, gravity: Pair, owed_m_s: Pair) -> bool:
    """Whether the pedestal slid in the step recorded last: its friction was at the limit. A solver's remainder is no slip.

    `owed_m_s`: what was taken from the statue's velocity before that step (`SupportVertex.hold`).
    """
    if drive.stuck and drive.friction.switches:
        return False
    before, after = less(recorded_velocities(drive, 1), owed_m_s), recorded_velocities(drive)
    return bool(before) and _at_limit(drive, before, after, gravity, stuck=drive.stuck)


def _at_limit(drive: RunState, before: Sequence[Pair], after: Sequence[Pair], gravity: Pair, *, stuck: bool) -> bool:
    """Whether the balance of momentum of both bodies over one step puts the floor's friction at its limit."""
    return drive.friction.at_limit(*_impulses(drive, before, after, gravity), stuck=stuck)


def _impulses(drive: RunState, before: Sequence[Pair], after: Sequence[Pair], gravity: Pair) -> Pair:
    """The floor's impulses of friction and of normal force over one step, N s, from the balance of momentum."""
    dt, friction, normal = drive.settings.dt_s, 0.0, 0.0
    for mass, (x0, z0), (x1, z1) in zip(drive.masses_kg, before, after, strict=True):
        friction += mass * (x1 - x0 - gravity[0] * dt)
        normal += mass * (z1 - z0 - gravity[1] * dt)
    return friction, normal


def recorded_velocities(drive: RunState, back: int = 0) -> list[Pair]:
    """Velocities of statue and pedestal in the state recorded last (`back` 1: before it), empty where there is none."""
    world = drive.world
    row = world.recorder.last(back)
    columns = (world.statue_column, world.pedestal_column)
    return [(row[column + 3], row[column + 4]) for column in columns] if row else []


def less(velocities: Sequence[Pair], owed_m_s: Pair) -> list[Pair]:
    """Velocities of statue and pedestal, the statue's less what was taken from it."""
    return [(x - owed_m_s[0], z - owed_m_s[1]) for x, z in velocities[:1]] + list(velocities[1:])


def set_stuck(drive: RunState, *, stuck: bool, static_share: float = 0.0) -> None:
    """Enter a sliding state: the floor's coefficient follows it, for a step stuck for a share of it the mean of both."""
    static, kinetic = drive.friction.static, drive.friction.kinetic
    coefficient = static if stuck else max(kinetic + static_share * (static - kinetic), 0.0)
    native.set_friction(native.shape_of(drive.world.floor_shape), coefficient)
    drive.stuck = stuck


def restore_recorded(drive: RunState) -> None:
    """Put the bodies back into the state recorded last."""
    world = drive.world
    row = world.recorder.last()
    for writer, column in zip(drive.writers, (world.statue_column, world.pedestal_column), strict=False):
        writer.restore(row[column : column + native.WIDTH])
