"""The loops: whole steps, shorter ones around events, when to stop; and the plain one of unmodified engines."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.engines.base import MOVING_TABLE, refuse
from harness.engines.stepping.step_state import Backend, ContactGaps, ContactTimeEstimate, HalfCycle, Stepper, StepState
from harness.engines.stepping.support import followed, stuck_below_m_s, wall_touch
from harness.engines.stepping.trajectory import (
    ALONE,
    SAME_INSTANT,
    Row,
    Schedule,
    StepLog,
    Vector,
    advanced,
    axis_of,
    base_velocity,
    fallen,
    greatest_pull_m_s2,
    matrices,
    trajectory,
)
from harness.model import Array, Scene
from harness.statics.plan import LimitsOfRest

# The model's impact map on both bodies, to be imposed in a contact engine (docs/model.md, sections 3 and 4).

IMPOSED_LABEL: Final = "impact law imposed"
"""Label of a run whose impacts are the model's: it tests the motion between impacts, not the impact."""


def imposed_rates(
    scene: Scene, *, old_side: int, theta_rate_rad_s: float, slip_rate_m_s: float, stuck: bool
) -> tuple[float, float]:
    """Rate of rotation, rad/s, and of the pedestal's slip, m/s, after an impact of the scene's prescribed ratio.

    The statue rocked about the corner `old_side` (+1 right, −1 left); without a pedestal the support is held. `stuck` is the
    pedestal's state before the impact (docs/model.md, section 3).
    """
    statue, pedestal, contact = scene.statue, scene.pedestal, scene.contact
    after = (contact.restitution or 0.0) * theta_rate_rad_s
    if pedestal is None or scene.form.pedestal_at_impact == "unchanged":
        return after, slip_rate_m_s
    total = statue.mass_kg + pedestal.mass_kg
    given = statue.mass_kg * statue.centroid_height_m * (theta_rate_rad_s - after)
    old, new = statue.corner_m(old_side), statue.corner_m(-old_side)
    speed = new * abs(after) + old * abs(theta_rate_rad_s)
    limit, slides = contact.floor_kinetic, contact.floor_kinetic
    if stuck:
        limit, slides = contact.floor_static, contact.at_impact
    # The friction impulse that holds the pedestal must be within the limit; else it slides on to where that does not hold it.
    needed = total * slip_rate_m_s + given
    if abs(needed) <= limit * (statue.mass_kg * speed):
        return after, 0.0
    return after, slip_rate_m_s + (given - math.copysign(slides * statue.mass_kg * speed, needed)) / total


# What a run in progress is looked at for, and what ends it. While the statue rests on its base and the motion cannot move it,
# nothing is integrated.

STILL_M_S: Final = 1e-5
"""Velocity, m/s and rad/s, below which everything counts as still."""
LEAN_RAD: Final = 1e-6
"""A statue at rest leans less than this from its pose at rest: measured, 1e-8 to 1e-7 rad on 16 vertices under a record."""
LEAST_STEPS: Final = 8
"""A shorter spell is not worth its look."""
SETTLE_STEPS: Final = 4
"""Whole steps made before the first instant at which anything can move: what gives way then is foreseen from three."""


@dataclass(eq=False)
class RestSpells:
    """Asked with a run in progress. `axes` (3, 3) are the statue's principal axes as columns, `axis` the vertical one in its
    principal frame, `rest` that axis in the world at rest. The statue is at rest when it is so at two looks, one after the other:
    where it only turns back, it moves in the next step.
    """

    limits: LimitsOfRest
    axes: Array
    axis: Vector
    rest: Vector
    still_at: int = -1
    look_from: int = 0

    def steps(self, state: StepState) -> int:
        """Whole steps from now on in which nothing can move; 0 where something moves, or soon may."""
        row, number = state.row, state.number
        if abs(row[11]) > STILL_M_S or number < self.look_from or not state.even:
            return 0
        velocities = row[7:13] + row[20:26]
        zx, zy, _ = axis_of(row, self.axis)
        if max(map(abs, velocities)) > STILL_M_S or math.hypot(zx - self.rest[0], zy - self.rest[1]) > LEAN_RAD:
            self.still_at = -1
            return 0
        if self.still_at < 0:
            self.still_at = number
            return 0
        self.still_at = -1
        # The sides over which the base may tip are where the statue has turned about the vertical.
        turn = matrices(np.array([row[3:7]]))[0] @ self.axes.T
        until_s = self.limits.until_s(state.t_s, math.atan2(turn[1, 0], turn[0, 0]))
        steps = int(until_s / state.step_s) - number - SETTLE_STEPS
        self.look_from = number + max(steps, 1)
        return steps if steps >= LEAST_STEPS else 0


WALL_STEPS: Final = 256
"""Steps between two looks whether a wall was reached: a look costs what ten steps do."""
ACROSS: Final = 0.5
"""Share of the balance angle across the plane within which the statue is not on its way to a fall there, which would come
first."""


@dataclass(eq=False)
class WallWatch:
    """Whether the run has come to its end at a wall; `axes` and `step_s` as `trajectory` takes them."""

    scene: Scene
    axes: Array | None
    step_s: float
    seen: int = 0
    touched: bool = False

    def ends(self, record: StepLog) -> bool:
        """Whether something touched the wall since the last look or before, and the statue does not fall across the plane."""
        path = trajectory(self.scene, record.tail(max(self.seen - 2, 0)), self.axes, self.step_s)
        self.seen = len(record.t_s)
        self.touched = self.touched or wall_touch(self.scene, path) is not None
        across, statue = path.extra.get("out_of_plane_rad"), self.scene.statue
        most_rad = ACROSS * math.atan2(0.5 * statue.depth_m, statue.centroid_height_m)
        return self.touched and (across is None or abs(float(across[-1])) < most_rad)


UPRIGHT: Final[Vector] = (0.0, 0.0, 1.0)
LOOK_STEPS: Final = 64
"""Steps between two questions whether the run may end: a statue that has fallen stays down."""


@dataclass(frozen=True, eq=False)
class Watch:
    """What a loop looks at: the statue's `axis` in its principal frame and in the world at `rest`, when and what to end.

    `quiet_from` is the number of the step from which the table is still (None: the run is not ended at rest). `leave` is asked
    now and then whether the statue may touch what this world leaves out, `stop`, with time and rotation, whether the run may end,
    `wall` whether one was reached. `gaps` finds impacts; None leaves them to whole steps, as they are while `edges` says that the
    pedestal's edges may be met. `spells` finds times of rest; `ends_fallen` ends a run whose statue has overturned.
    """

    axis: Vector = UPRIGHT
    rest: Vector = UPRIGHT
    quiet_from: int | None = None
    leave: Callable[[Row], bool] | None = None
    stop: Callable[[float, float], bool] | None = None
    gaps: ContactGaps | None = None
    spells: RestSpells | None = None
    edges: Callable[[Row], bool] | None = None
    wall: WallWatch | None = None
    # Engines that do not say otherwise end there: what has fallen does not stand up again.
    ends_fallen: bool = True


# Micro-rocking: half-cycles of a few steps are followed in parts of each, so that none ends in the step in which it returns.


def after_impact(state: StepState, gaps: ContactGaps) -> HalfCycle | None:
    """The half-cycle that an impact begins; None where it is sure to be long, or the foot that rises did not stand."""
    stepper, step_s, events = state.stepper, state.step_s, state.events
    heights = gaps.heights(state.row, stepper.table_place[2], stepper.table_rate[2])
    # Of the vertices that a lean brings down later the higher ones rise faster, and none of them stood.
    standing = [index for index, (gap, _) in enumerate(heights) if abs(gap) <= gaps.near_m]
    foot = min(standing, key=lambda index: heights[index][1], default=-1)
    if foot < 0 or heights[foot][1] >= 0.0:
        return None
    # Thrown up at v against an acceleration a it is back after 2 v/a; the bound of a gives the shortest time.
    soonest_s = -2.0 * heights[foot][1] / gaps.bound[foot]
    if soonest_s > events.short_steps * step_s:
        return None
    return HalfCycle(
        ContactTimeEstimate(state, gaps, foot),
        state.t_s,
        min(max(soonest_s, events.least_first * step_s), events.most_first * step_s),
    )


def follow(state: StepState, gaps: ContactGaps, half_cycle: HalfCycle) -> bool:
    """Make the next part of a half-cycle, or its impact where that is due within it; False: it is no short one."""
    step_s, back_s, events = state.step_s, 0.0, state.events
    if half_cycle.parts > 0:
        back_s = half_cycle.contact_time()
        if not half_cycle.known:
            whole_s = state.t_s - half_cycle.start_s + back_s
            if not events.least_steps * step_s <= whole_s <= events.short_steps * step_s:
                return False
            half_cycle.part_s, half_cycle.known = whole_s / events.parts, True
        if half_cycle.parts > events.most_parts:
            return False
    end_s = state.t_s + min(half_cycle.part_s, step_s)
    whole = end_s > state.next_s - events.tail_parts * half_cycle.part_s
    end_s = state.next_s if whole else end_s
    if half_cycle.parts > 0 and back_s <= events.close_parts * (end_s - state.t_s):
        _locate_impact(state, gaps, half_cycle.contact_time)
        return True
    half_cycle.parts += 1
    if whole:
        state.to_next()
    else:
        state.to(end_s, max(0.5 * (state.t_s + end_s), state.kick_s))
    return True


# An event inside a step, met at its instant: velocities are brought there by the engine, places by their velocities.


def locate_event(
    state: StepState,
    gaps: ContactGaps,
    until: Callable[[], float],
    act: Callable[[], None],
    speeds: Callable[[], tuple[float, float]] | None = None,
) -> None:
    """Go to the instant at which `until`, the time, s, to the event, is zero, and `act` there.

    `speeds` gives the time at the present velocities, s, and what these grow to over them up to the event; without it they are
    taken not to change. Where the event comes later than it seemed the step is taken to its end instead.
    """
    step_s, floor, events = state.step_s, state.stepper, state.events
    contact_s = until()
    for _ in range(events.most_approaches):
        # A gap is closed at the speed that closes it within the step, whatever its length: before short steps there must be none.
        state.lower(gaps.drift_m(state.row, floor.table_place[2]))
        if contact_s <= events.far * step_s:
            break
        end = min(state.t_s + events.approach * contact_s, state.next_s - events.aside * step_s)
        if end < state.t_s + events.shortest * step_s:
            break
        state.to(end, max(0.5 * (state.t_s + end), state.kick_s))
        contact_s = until()
    if state.t_s + contact_s > state.next_s:
        if state.schedule.jump_after_s(state.kick_s) > state.next_s:
            state.to_next()
        return
    room, there_s = max(contact_s, events.room * step_s), state.t_s + contact_s
    plain, grown = (contact_s, 1.0) if speeds is None else speeds()
    # Back to where the velocities of the instant, not the present ones, take it down in that time: short of it they are stopped.
    back = room * grown - plain
    if back != 0.0:
        state.drift(-back)
    forward, state.t_s, instant = contact_s + back - events.short * room, there_s - room, max(there_s, state.kick_s)
    state.kick(events.short * room, instant)
    feet = gaps.standing(state.row, floor.table_place[2], floor.table_rate[2])
    if feet:
        # The velocities stand square to the arm of the standing foot at the places before that step: both turn on together.
        before, there = state.row, advanced(state.row, room)
        state.turn(room, gaps.foot_m(feet, before))
        at_contact = [(*there[:7], *row[7:13], *there[13:]) for row in (before, state.row)]
        owed, left = gaps.foot_speeds_m_s(feet, before, at_contact, floor.table_place[2], floor.table_rate[2])
        floor.writer.ledger["turn_on"].compare(owed, left, events.still * gaps.least_m_s)
    contact_s = until()
    if abs(contact_s) > room:
        # What came down no longer does.
        state.drift(forward)
        state.t_s = instant
        state.jump_velocity(state.row)
        return
    state.drift(contact_s)
    state.lower(gaps.drift_m(state.row, floor.table_place[2], within_s=events.together * step_s))
    act()


# The model's impact in place of the engine's own, for a scene that prescribes a ratio.


def impose(stepper: Stepper, scene: Scene, row: Row, lean_rad: float) -> Row:
    """Put both bodies upright with the velocities after the model's impact; `lean_rad` is what little is left to fall."""
    # It came down from the side against which it turns, whether or not the last digits of the lean have passed zero.
    statue, side = scene.statue, 1 if row[11] < 0.0 else -1
    table_x, table_y, _ = stepper.table_rate
    slip = row[20] - table_x if len(row) > ALONE else 0.0
    rate, slip = imposed_rates(scene, old_side=side, theta_rate_rad_s=row[11], slip_rate_m_s=slip, stuck=stepper.stuck)
    base = slip + table_x
    # The old corner stays where it stands; the centroid comes to lie over the base again.
    old, new = side * statue.corner_m(side), -side * statue.corner_m(-side)
    shift = old * math.cos(lean_rad) - statue.centroid_height_m * math.sin(lean_rad) - old
    top, below = 0.0, row[ALONE:]
    if scene.pedestal is not None:
        top = row[15] + 0.5 * scene.pedestal.height_m
        stepper.set_sliding(slip != 0.0)
        below = (*row[13:20], base, table_y, 0.0, 0.0, 0.0, 0.0)
    height = top - stepper.backend.depth_m + statue.centroid_height_m
    velocity = (base + rate * statue.centroid_height_m, table_y, rate * new)
    turn = advanced((*row[:10], 0.0, -1.0, 0.0), lean_rad)[3:7]
    upright = (row[0] + shift, row[1], height, *turn, *velocity, 0.0, rate, 0.0)
    stepper.writer.write("imposed_impact", row, upright + below)
    return stepper.backend.read()


RESTING_FREE: Final = 4
"""Steps taken at once at rest: an uplift and its return inside them are below a step's own error."""
MOST_FREE: Final = 16
"""Steps taken at once at most: so often are overturning, rest and the pedestal's edge looked at."""
BESIDE_FREE: Final = 2
"""Steps taken at once where the pedestal's edges may be met: a foot that slides over one stands beside it for no longer."""
LEANING: Final = 0.2
"""An axis whose vertical component is larger is far from overturned."""
STILL_LEAN_RAD: Final = 1e-4
"""A statue at rest on its base leans less than this from its pose at rest."""
STILL_CHECK: Final = 64
STILL_CHECKS: Final = 16
"""A run may end when everything was still at this many checks in a row, `STILL_CHECK` steps apart."""


def integrate(scene: Scene, schedule: Schedule, watch: Watch, state: StepState) -> StepLog:
    """Run `state` to the schedule's end, an overturn, rest, or where it is to leave this world."""
    pull = greatest_pull_m_s2(scene)
    kinetic = scene.contact.floor_kinetic * scene.gravity_m_s2
    still, record = StillWatch(watch.rest, watch.quiet_from), state.record
    falls = watch.ends_fallen and scene.initial.pose is None
    state.settle()
    look, leave_look, wall_look, beside = state.number, state.number, state.number, False
    while state.number < schedule.count:
        row, jump_s = state.row, schedule.jump_after_s(state.kick_s)
        zx, zy, zz = axis_of(row, watch.axis)
        if zz < LEANING and falls and fallen(zx, zy, zz):
            break
        if state.on_grid:
            if watch.leave is not None and state.number >= leave_look:
                if watch.leave(row):
                    break
                beside = watch.edges is not None and watch.edges(row)
                leave_look = state.number + (BESIDE_FREE if beside else MOST_FREE)
            if watch.stop is not None and state.number >= look:
                look = state.number + LOOK_STEPS
                if watch.stop(state.t_s, math.atan2(zx, zz)):
                    break
            if watch.wall is not None and state.number >= wall_look:
                wall_look = state.number + WALL_STEPS
                if watch.wall.ends(record):
                    break
            if still.lasts(state.number, row, zx, zy):
                record.rested = True
                break
            if watch.spells is not None and not beside and (steps := watch.spells.steps(state)) > 0:
                state.rest(min(steps, schedule.count - state.number))
                continue
        free = MOST_FREE
        due = jump_s <= state.next_s + SAME_INSTANT * state.step_s
        if watch.gaps is not None and (beside or tips(row, state.step_s, state.stepper.tipped_rad)):
            free = BESIDE_FREE if beside else MOST_FREE
            # Nothing is located: the engine is plain, and no half-cycle is followed.
            state.half_cycle = None
        elif watch.gaps is not None and state.velocity_jumps < state.events.most_jumps:
            free = _touched(state, scene, watch.gaps, watch, jump_s if due else math.inf)
            if free == 0:
                continue
            if len(row) > ALONE and len(record.t_s) > 1:
                free = min(free, _stick_onset(state, pull, kinetic, jump_s))
                if free == 0:
                    continue
        if due:
            state.meet_jump(jump_s)
        elif state.even:
            free = free if jump_s == math.inf else min(free, int((jump_s - state.t_s) / state.step_s + SAME_INSTANT))
            begin = state.number - schedule.first
            state.whole_steps(schedule.coarse[begin : begin + free])
        else:
            state.to_next()
    state.stepper.balance.check()
    return record


def tips(row: Row, step_s: float, tipped_rad: float) -> bool:
    """Whether the pedestal tips: its impacts on the floor are not located, and those of the statue are none on a held support."""
    if len(row) == ALONE:
        return False
    a, b, c, d = row[16:20]
    tilt = math.hypot(2.0 * (a * c + b * d), 2.0 * (b * c - a * d))
    return tilt + step_s * math.hypot(row[23], row[24]) > tipped_rad


def _touched(state: StepState, scene: Scene, gaps: ContactGaps, watch: Watch, jump_s: float) -> int:
    """Number of whole steps in which no foot can come down; 0 when one was about to and its impact has been passed.

    What comes after `jump_s`, the instant in the next step at which the floor's acceleration jumps, is not looked at before that.
    """
    stepper, step_s = state.stepper, state.step_s
    if jump_s == math.inf and state.half_cycle is not None:
        if follow(state, gaps, state.half_cycle):
            return 0
        state.half_cycle = None
    contact_s, soonest, foot = gaps(state.row, stepper.table_place[2], stepper.table_rate[2])
    if scene.contact.restitution is not None:
        return _imposed(state, scene, gaps, watch, soonest, jump_s)
    # Its velocity is of half a step ago: it may come sooner than at that.
    if contact_s == math.inf or state.t_s + min(contact_s, soonest) > state.next_s:
        if stepper.backend.near is False:
            return MOST_FREE
        return _free(state, soonest / step_s)
    contact_time = ContactTimeEstimate(state, gaps, foot)
    located_s = contact_time()
    if state.t_s + located_s > jump_s or min(contact_s, located_s) > state.events.later * (state.next_s - state.t_s):
        return 1
    _locate_impact(state, gaps, contact_time)
    return 0


def _locate_impact(state: StepState, gaps: ContactGaps, contact_time: ContactTimeEstimate) -> None:
    """A foot that comes down, and the half-cycle that begins with its impact."""
    locate_event(state, gaps, contact_time, state.impact, contact_time.speeds)
    if state.velocity_jumped:
        state.half_cycle = after_impact(state, gaps)


def _imposed(state: StepState, scene: Scene, gaps: ContactGaps, watch: Watch, soonest: float, jump_s: float) -> int:
    """The same where impacts are prescribed: one is imposed when the statue passes upright."""
    step_s = state.step_s
    # Right after an impact the statue is upright, to the last digit or not.
    contact_s = math.inf if state.velocity_jumped else _upright(state, gaps, watch)
    sure = min(soonest, contact_s)
    if contact_s == math.inf or state.t_s + sure > state.next_s or state.t_s + contact_s > jump_s:
        return _free(state, sure / step_s)

    def pass_upright() -> None:
        lean = axis_of(state.row, watch.axis)[0] - watch.rest[0]
        state.jump_velocity(impose(state.stepper, scene, state.row, lean))

    locate_event(state, gaps, lambda: _upright(state, gaps, watch), pass_upright)
    return 0


def _upright(state: StepState, gaps: ContactGaps, watch: Watch) -> float:
    """Time, s, until the statue passes upright; infinite when it does not come down."""
    lean, rate = axis_of(state.row, watch.axis)[0] - watch.rest[0], state.row[11]
    return -lean / rate if lean * rate < 0.0 and abs(rate) > gaps.slow_rad_s else math.inf


def _stick_onset(state: StepState, pull: float, kinetic: float, jump_s: float) -> int:
    """Number of whole steps in which the pedestal cannot stick; 0 when it was about to, before the floor's acceleration jumps,
    and its stick onset has been met.

    `pull` bounds its deceleration, `kinetic` is kinetic friction's, m/s².
    """
    stepper, row, record, step_s = state.stepper, state.row, state.record, state.step_s
    least_m_s2 = state.events.least_share * kinetic
    before = record.flat[-2 * len(row) + 20 : -2 * len(row) + 22]
    vx, vy = row[20] - stepper.table_rate[0], row[21] - stepper.table_rate[1]
    speed = math.hypot(vx, vy)
    unseen = MOST_FREE if stepper.backend.near is False else 0
    if speed <= least_m_s2 * step_s:
        return unseen or RESTING_FREE
    last_s = record.kick_s[-1] - record.kick_s[-2]
    if last_s <= 0.0 or not state.smooth:
        return 1
    ax = (vx - before[0] + stepper.table_before[0]) / last_s
    ay = (vy - before[1] + stepper.table_before[1]) / last_s
    slowing = -(vx * ax + vy * ay) / speed
    # Kinetic friction stops nothing that goes past rest: what turns aside slides on, unless less than it is needed.
    if slowing > least_m_s2 and not stepper.passes_rest((vx, vy), (ax * last_s, ay * last_s)):
        stick_onset_s = state.kick_s + speed / slowing
        if stick_onset_s <= min(0.5 * (state.t_s + state.next_s), jump_s):
            state.bring(stick_onset_s)
            return 0
    return unseen or _free(state, speed / (pull * step_s))


def _free(state: StepState, steps: float) -> int:
    """Whole steps that may be taken at once where an event comes no sooner than in so many, or never."""
    return min(max(int(steps - state.events.ahead), 1), MOST_FREE) if steps < math.inf else RESTING_FREE


@dataclass(eq=False)
class StillWatch:
    """Counts the checks in a row at which nothing moved, from the step `next` on, from which the table is still (None: never);
    `rest` is the statue's axis at rest.
    """

    rest: Vector
    next: int | None
    count: int = 0

    def lasts(self, number: int, row: Row, zx: float, zy: float) -> bool:
        """Whether everything has been still long enough."""
        if self.next is None or number < self.next:
            return False
        self.next = number + STILL_CHECK
        moving = row[7:13] if len(row) == 13 else row[7:13] + row[20:26]
        upright = max(abs(zx - self.rest[0]), abs(zy - self.rest[1])) < STILL_LEAN_RAD
        self.count = self.count + 1 if upright and max(map(abs, moving)) < STILL_M_S else 0
        return self.count >= STILL_CHECKS


# Whole steps of an unmodified engine: nothing is located, none is solved again, and no body is written to.
# What a contact engine could compute only by writing to its bodies: unmodified engines refuse it.


def refuse_steering(scene: Scene, name: str) -> None:
    """Raise `EngineFailure`, in the name of the plain engine, for what can be had only by writing to bodies."""
    imposed = "a prescribed ratio at impact (contact.restitution; it would have to be imposed on the bodies)"
    asked = {
        # A body thrown in space bounces by the engine's own coefficient of restitution, without a write.
        imposed: scene.contact.restitution is not None and scene.initial.pose is None,
        MOVING_TABLE: scene.table == "moving",
    }
    refuse(name, asked, name.removesuffix(":plain"))


def plain_steps(backend: Backend, schedule: Schedule, watch: Watch) -> StepLog:
    """All steps of a schedule, or those up to a look at which `watch` ends the run: overturned, stopped, or to leave this world.

    Two coefficients of friction are the one thing that no engine knows: the floor's follows the pedestal's own velocity
    (`followed`).
    """
    step_s, contact = schedule.step_s, schedule.scene.contact
    rest_m_s = stuck_below_m_s(schedule.scene, step_s)
    row, acting, slips = backend.read(), contact.floor_static, (0.0, 0.0)
    pedestal = None if contact.floor_static == contact.floor_kinetic else schedule.scene.pedestal
    record = StepLog.begun(row, 0.0)
    for number, gravity in enumerate(schedule.coarse, 1):
        before, row = row, backend.advance(gravity)
        record.keep(number * step_s, (number - 0.5) * step_s, row)
        if pedestal is not None:
            # Asked after a step, for the next: in the one in which the pedestal breaks loose the static coefficient still acts.
            slipped, slips = slips, base_velocity(pedestal.half_m, before, row)
            wanted = followed(contact, rest_m_s, slipped, slips)
            if wanted != acting:
                backend.set_floor_friction(wanted)
                acting = wanted
        if number % LOOK_STEPS == 0:
            x, y, z = axis_of(row, watch.axis)
            lies = watch.ends_fallen and schedule.scene.initial.pose is None and fallen(x, y, z)
            stops = watch.stop is not None and watch.stop(number * step_s, math.atan2(x, z))
            if lies or stops or (watch.leave is not None and watch.leave(row)):
                break
        if watch.wall is not None and number % WALL_STEPS == 0 and watch.wall.ends(record):
            break
    return record
