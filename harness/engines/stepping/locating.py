"""An event inside a step, met at its instant: velocities are brought there by the engine, places by their velocities."""

from __future__ import annotations

from collections.abc import Callable

from harness.engines.stepping.contact_gaps import ContactGaps
from harness.engines.stepping.rows import advanced
from harness.engines.stepping.step_state import StepState


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
