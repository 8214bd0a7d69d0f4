"""The loop: whole steps, shorter ones around events, when to stop."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from harness.engines.stepping.contact_gaps import ContactGaps
from harness.engines.stepping.frame import fallen, greatest_pull_m_s2
from harness.engines.stepping.impact import impact
from harness.engines.stepping.rows import ALONE, Row, advanced, axis_of, bodies
from harness.engines.stepping.schedule import SAME_INSTANT, Schedule
from harness.engines.stepping.step_log import StepLog
from harness.engines.stepping.step_state import ContactTime, HalfCycle, StepState
from harness.engines.stepping.stepper import Stepper
from harness.engines.stepping.watch import LOOK_STEPS, STILL_M_S, WALL_STEPS, Watch
from harness.model.scene import Scene

# When a foot comes down that gathers speed: velocities are older than places, and a short half-cycle's change
# much in that time.


class ContactTimeEstimate:
    """Called, tells the time, s, until a foot is down if its speed goes on changing as in the last step; infinite if never.

    Where velocities are not older than places, the foot comes with its present one.
    """

    def __init__(self, state: StepState, gaps: ContactGaps, foot: int) -> None:
        """Begin with what the last two samples show, unless an impact or a stick onset lies between them."""
        self.state, self.gaps, self.foot = state, gaps, foot
        self.gained_m_s2 = 0.0
        self.row, self.seen = state.row, self._height(state.row)
        self.kick_s, self.closing_m_s = state.kick_s, self.seen[1]
        kicks = state.record.kick_s
        if len(kicks) > 1 and kicks[-2] < kicks[-1] and state.smooth:
            self._gain(self._height(state.record.row(-2))[1], kicks[-2])

    def __call__(self) -> float:
        state = self.state
        gap, closing = self._look()
        if state.kick_s >= state.t_s:
            return gap / closing if closing > self.gaps.falling_m_s(state.row) else math.inf
        gained = self._gathers(closing)
        now = closing + gained * (state.t_s - state.kick_s)
        if gained <= 0.0:
            return gap / now if now > self.gaps.least_m_s else math.inf
        # The first t with gap = now t + gained t²/2.
        return (math.sqrt(now * now + 2.0 * gained * max(gap, 0.0)) - now) / gained

    def speeds(self) -> tuple[float, float]:
        """Time, s, until it would be down at its present speed, and that speed when it is down over the present one (≥ 1)."""
        gap, closing = self._look()
        contact_s = self()
        if contact_s == math.inf or closing <= self.gaps.least_m_s:
            return contact_s, 1.0
        then = closing + self._gathers(closing) * (self.state.t_s + contact_s - self.state.kick_s)
        return gap / closing, max(then / closing, 1.0)

    def _look(self) -> tuple[float, float]:
        if self.row is not self.state.row:
            self.row, self.seen = self.state.row, self._height(self.state.row)
        gap, closing = self.seen
        if self.state.kick_s > self.kick_s:
            before, self.closing_m_s = self.closing_m_s, closing
            before_s, self.kick_s = self.kick_s, self.state.kick_s
            self._gain(before, before_s)
        return gap, closing

    def _gain(self, before_m_s: float, before_s: float) -> None:
        most = float(self.gaps.bounds[self.foot])
        self.gained_m_s2 = min(max((self.closing_m_s - before_m_s) / (self.kick_s - before_s), -most), most)

    def _gathers(self, closing_m_s: float) -> float:
        row = self.state.row
        turning = self.gaps.base_m * math.hypot(row[10], row[11])
        return self.gained_m_s2 if abs(closing_m_s) >= self.state.events.least_turning * turning else 0.0

    def _height(self, row: Row) -> tuple[float, float]:
        stepper = self.state.stepper
        return self.gaps.height(self.foot, row, stepper.table_place[2], stepper.table_rate[2])


# Micro-rocking: half-cycles of a few steps are followed in parts of each, so that none ends in the step in
# which it returns.


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
    soonest_s = -2.0 * heights[foot][1] / float(gaps.bounds[foot])
    if soonest_s > events.short_steps * step_s:
        return None
    return HalfCycle(
        ContactTimeEstimate(state, gaps, foot),
        state.t_s,
        min(max(soonest_s, events.least_first * step_s), events.most_first * step_s),
    )


def follow(state: StepState, half_cycle: HalfCycle) -> bool | None:
    """Make the next part of a half-cycle. True, with none made, where its impact is due within it; None: it is no short one."""
    step_s, back_s, events = state.step_s, 0.0, state.events
    if half_cycle.parts > 0:
        back_s = half_cycle.contact_time()
        if not half_cycle.known:
            whole_s = state.t_s - half_cycle.start_s + back_s
            if not events.least_steps * step_s <= whole_s <= events.short_steps * step_s:
                return None
            half_cycle.part_s, half_cycle.known = whole_s / events.parts, True
        if half_cycle.parts > events.most_parts:
            return None
    end_s = state.t_s + min(half_cycle.part_s, step_s)
    whole = end_s > state.next_s - events.tail_parts * half_cycle.part_s
    end_s = state.next_s if whole else end_s
    if half_cycle.parts > 0 and back_s <= events.close_parts * (end_s - state.t_s):
        return True
    half_cycle.parts += 1
    if whole:
        state.to_next()
    else:
        state.to(end_s, max(0.5 * (state.t_s + end_s), state.kick_s))
    return False


# An event inside a step, met at its instant: velocities are brought there by the engine, places by their
# velocities.


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
        floor.writer.ledger.of("turn_on").compare(owed, left, events.still * gaps.least_m_s)
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
    was, statue, side = row, scene.statue, 1 if row[11] < 0.0 else -1
    body, pedestal = bodies(row)
    table_x, table_y = stepper.table_rate[0], stepper.table_rate[1]
    slip = 0.0 if pedestal is None else pedestal.velocity_m_s[0] - table_x
    jump = impact(scene, old_side=side, theta_rate_rad_s=row[11], slip_rate_m_s=slip, stuck=stepper.stuck)
    rate, base = jump.theta_rate_rad_s, jump.slip_rate_m_s + table_x
    # The old corner stays where it stands; the centroid comes to lie over the base again.
    old, new = side * statue.corner_m(side), -side * statue.corner_m(-side)
    shift = old * math.cos(lean_rad) - statue.centroid_height_m * math.sin(lean_rad) - old
    top = 0.0
    if pedestal is not None and scene.pedestal is not None:
        top = pedestal.place_m[2] + 0.5 * scene.pedestal.height_m
        stepper.set_sliding(jump.slip_rate_m_s != 0.0)
        row = (*row[:20], base, table_y, 0.0, 0.0, 0.0, 0.0)
    height = top - stepper.backend.depth_m + statue.centroid_height_m
    place = (body.place_m[0] + shift, body.place_m[1], height)
    velocity = (base + rate * statue.centroid_height_m, table_y, rate * new)
    upright = (*place, *_level(body.turn, lean_rad), *velocity, 0.0, rate, 0.0)
    stepper.writer.write("imposed_impact", was, upright + row[len(upright) :])
    return stepper.backend.read()


def _level(turn: tuple[float, float, float, float], lean_rad: float) -> tuple[float, float, float, float]:
    """A quaternion turned back by a lean about y."""
    x, y, z, w = turn
    s, c = math.sin(-0.5 * lean_rad), math.cos(-0.5 * lean_rad)
    return (c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y)


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
    still, record, falls = Still(watch), state.record, watch.ends_fallen and scene.initial.pose is None
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
            state.half_cycle, state.jumped_s = None, state.t_s
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
    if jump_s == math.inf and state.half_cycle is not None and _followed(state, gaps, state.half_cycle):
        return 0
    contact_s, soonest, foot = gaps(state.row, state.t_s, state.jumped_s, stepper.table_place[2], stepper.table_rate[2])
    if watch.impose:
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


def _locate_impact(state: StepState, gaps: ContactGaps, contact_time: ContactTime) -> None:
    """A foot that comes down, and the half-cycle that begins with its impact."""
    locate_event(state, gaps, contact_time, state.impact, contact_time.speeds)
    if state.velocity_jumped:
        state.half_cycle = after_impact(state, gaps)


def _followed(state: StepState, gaps: ContactGaps, half_cycle: HalfCycle) -> bool:
    """Whether a part of a short half-cycle, or its impact, was made; if not it is no short one any more."""
    due = follow(state, half_cycle)
    if due is None:
        state.half_cycle = None
    elif due:
        _locate_impact(state, gaps, half_cycle.contact_time)
    return due is not None


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


class Still:
    """Counts the checks in a row at which nothing moved, from the step on from which the table is still."""

    def __init__(self, watch: Watch) -> None:
        self.watch, self.next, self.count = watch, watch.quiet_from, 0

    def lasts(self, number: int, row: Row, zx: float, zy: float) -> bool:
        """Whether everything has been still long enough."""
        if self.next is None or number < self.next:
            return False
        self.next = number + STILL_CHECK
        rest = self.watch.rest
        moving = row[7:13] if len(row) == 13 else row[7:13] + row[20:26]
        upright = max(abs(zx - rest[0]), abs(zy - rest[1])) < STILL_LEAN_RAD
        self.count = self.count + 1 if upright and max(map(abs, moving)) < STILL_M_S else 0
        return self.count >= STILL_CHECKS
