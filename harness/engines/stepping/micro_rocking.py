"""Micro-rocking: half-cycles of a few steps are followed in parts of each, so that none ends in the step in which it returns."""

from __future__ import annotations

from harness.engines.stepping.contact_gaps import ContactGaps
from harness.engines.stepping.contact_time import ContactTimeEstimate
from harness.engines.stepping.step_state import HalfCycle, StepState


def after_impact(state: StepState, gaps: ContactGaps) -> HalfCycle | None:
    """The half-cycle that an impact begins; None where it is sure to be long, or the foot that rises did not stand."""
    stepper, step_s, events = state.stepper, state.step_s, state.events
    heights = gaps.heights(state.row, stepper.table_place[2], stepper.table_rate[2])
    foot = min(range(len(heights)), key=lambda index: heights[index][1])
    gap, closing = heights[foot]
    # Thrown up at v against an acceleration a it is back after 2 v/a; the bound of a gives the shortest time.
    soonest_s = -2.0 * closing / float(gaps.bounds[foot])
    if abs(gap) > gaps.near_m or closing >= 0.0 or soonest_s > events.short_steps * step_s:
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
