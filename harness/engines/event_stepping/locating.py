"""Events located inside a step, for any engine whose places and velocities keep clocks of their own.

A contact engine changes velocities by its contacts as they are at one instant, and moves places by velocities. Read as a
leapfrog both are of second order: a change of velocities lies evenly about that instant, a move evenly about that of the
velocities. An event inside a step breaks this. So velocities are brought to the event's instant with the contacts as they are
half the way there, places go on to the event by these velocities, an impact takes no time, and one more part leads to a whole
step.

Micro-rocking: a statue that rises under a floor that shakes at a high frequency often rocks first by 1e-5 rad in half-cycles of
some milliseconds. It is next to nothing, but its next rise begins with it. Half-cycles of a few steps are followed in parts of
their own length, until one is long enough for whole steps or too short for these to tell.
"""

from __future__ import annotations

import math
from typing import Protocol

from harness.engines.event_stepping.settings import EVENTS

Pair = tuple[float, float]


class LocatedBodies(Protocol):
    """What an engine offers: its bodies between whole steps. Times in s, lengths in m.

    `place_s` and `velocity_s` are the clocks; at whole steps velocities are `lag_s` (half a step, or minus that) ahead of places,
    the later clock at the step's number times `step_s`. `last_step` is the run's last number.
    """

    step_s: float
    lag_s: float
    last_step: int

    @property
    def place_s(self) -> float:
        """Time of the places."""

    @property
    def velocity_s(self) -> float:
        """Time of the velocities."""

    def advance(self, move_s: float, kick_s: float, *, hard: bool = False) -> None:
        """Move places by `move_s`, and velocities by `kick_s` with the contacts there; `hard`: all of them begin anew."""

    def coast(self, seconds: float) -> None:
        """Move places alone."""

    def turn_on(self, instant_s: float) -> None:
        """Give the statue the velocity that it has at an instant, as it turns on its standing vertex."""

    def impact(self, move_s: float, vertex: int) -> None:
        """Move places to a vertex's contact, and let all that touches there meet at once; both clocks then stand at that time."""

    def gap(self, vertex: int) -> Pair:
        """Height of a vertex over where its support is felt, and its rate, at the velocities' time.

        Velocities that change evenly take places, moved by them alone, to where they are then.
        """

    def felt_m(self) -> float:
        """How far above that height a vertex is already in contact."""

    def rising(self) -> tuple[int, float] | None:
        """The vertex that an impact let rise, and a bound on the acceleration that takes it back; None where none rises."""

    def lift(self, height_m: float | None) -> None:
        """Be ready for a half-cycle that lifts its vertex by no more than this; None: for whole steps again."""

    def settle(self) -> None:
        """Lay the statue on the facet on which its half-cycles die out."""

    def record(self) -> None:
        """Keep a sample of the velocities' time."""

    def reached(self, number: int) -> None:
        """Keep a sample of a whole step, from which whole steps go on."""


def meet_impacts(bodies: LocatedBodies, vertex: int, ahead_s: float) -> int:
    """Pass the impact of a vertex that comes down `ahead_s` after the places' time, and the short half-cycles that follow; the
    number of the whole step that was reached.
    """
    due: tuple[int, float] | None = (vertex, ahead_s)
    while due is not None and _impact(bodies, *due):
        due = _half_cycle(bodies)
    bodies.lift(None)
    return to_whole_step(bodies)


def meet_stick_onset(bodies: LocatedBodies, instant_s: float, *, hard: bool) -> int:
    """Bring velocities to the instant at which the pedestal sticks; the number of the whole step that was reached."""
    _bring(bodies, instant_s, hard=hard)
    bodies.record()
    return to_whole_step(bodies)


def to_whole_step(bodies: LocatedBodies) -> int:
    """One part that ends at a whole step, whose number is returned."""
    early_s, late_s = min(bodies.lag_s, 0.0), max(bodies.lag_s, 0.0)
    number = math.ceil((bodies.velocity_s - early_s) / bodies.step_s + EVENTS.least_tail)
    number = min(number, bodies.last_step)
    end_s = number * bodies.step_s
    if end_s + early_s > bodies.velocity_s:
        _bring(bodies, end_s + early_s)
    # At a whole step velocities are the tangents of the earlier clock's time.
    bodies.turn_on(end_s + early_s - late_s)
    bodies.coast(end_s - late_s - bodies.place_s)
    bodies.reached(number)
    return number


def time_to_reach(distance: float, speed: float, gained: float) -> float:
    """Time, s, in which a distance is gone at a speed that grows by `gained` each second; infinite if never."""
    square = speed * speed + 2.0 * gained * distance
    # The sum of both speeds: no cancellation, and the first of two times where it is braked.
    both = speed + math.sqrt(square) if square >= 0.0 else 0.0
    return 2.0 * distance / both if both > 0.0 else math.inf


def time_to_contact(bodies: LocatedBodies, vertex: int, gained_m_s2: float) -> float:
    """Time, s, after the places' in which a vertex comes down that gathers so much speed."""
    gap, rising = bodies.gap(vertex)
    return bodies.velocity_s - bodies.place_s + time_to_reach(gap, -rising, gained_m_s2)


def _bring(bodies: LocatedBodies, instant_s: float, *, hard: bool = False) -> None:
    """Velocities to an instant, contacts as they are half the way there."""
    half_s = 0.5 * (bodies.velocity_s + instant_s)
    bodies.advance(half_s - bodies.place_s, instant_s - bodies.velocity_s, hard=hard)


def _impact(bodies: LocatedBodies, vertex: int, ahead_s: float) -> bool:
    """An impact `ahead_s` after the places' time; whether the vertex came down there."""
    contact_s, gained = ahead_s, 0.0
    left_s = bodies.place_s + ahead_s - bodies.velocity_s
    # The rest of the way must not end in a contact that is felt before it is reached.
    near_m = -bodies.gap(vertex)[1] * (1.0 - EVENTS.approach) * left_s
    far = left_s > EVENTS.far * bodies.step_s and near_m > EVENTS.clear * bodies.felt_m()
    # From far, most of the way first: what is left is foreseen from the acceleration there.
    for share in (EVENTS.approach, 1.0) if far else (1.0,):
        kick_s = share * (bodies.place_s + contact_s - bodies.velocity_s)
        if 0.0 < kick_s < math.inf:
            before_m_s = bodies.gap(vertex)[1]
            _bring(bodies, bodies.velocity_s + kick_s)
            gained = (before_m_s - bodies.gap(vertex)[1]) / kick_s
            contact_s = time_to_contact(bodies, vertex, gained)
    bodies.turn_on(bodies.velocity_s)
    bodies.record()
    if not -bodies.step_s < contact_s < bodies.step_s:
        return False
    bodies.impact(contact_s, vertex)
    bodies.record()
    return True


def _half_cycle(bodies: LocatedBodies) -> tuple[int, float] | None:
    """The half-cycle after an impact in parts, if it is short: the vertex that returns and when; None if it is no short one."""
    step_s, begin_s, rising = bodies.step_s, bodies.velocity_s, bodies.rising()
    if rising is None:
        return None
    vertex, most_m_s2 = rising
    rate_m_s = bodies.gap(vertex)[1]
    soonest_s = 2.0 * rate_m_s / most_m_s2
    if soonest_s > EVENTS.short_steps * step_s:
        return None
    part_s, known = min(max(soonest_s, EVENTS.least_first * step_s), EVENTS.most_first * step_s), False
    for _ in range(round(EVENTS.most_parts)):
        if bodies.velocity_s + part_s > (bodies.last_step - 1.0) * step_s:
            return None
        before_m_s = bodies.gap(vertex)[1]
        _bring(bodies, bodies.velocity_s + part_s)
        bodies.record()
        gained = min(max((before_m_s - bodies.gap(vertex)[1]) / part_s, -most_m_s2), most_m_s2)
        ahead_s = time_to_contact(bodies, vertex, gained)
        if not known:
            whole_s = bodies.place_s + ahead_s - begin_s
            if whole_s < EVENTS.least_steps * step_s:
                bodies.settle()
            if not EVENTS.least_steps * step_s <= whole_s <= EVENTS.short_steps * step_s:
                return None
            part_s, known = min(whole_s / EVENTS.parts, step_s), True
            bodies.lift(EVENTS.peak * rate_m_s * whole_s)
        if bodies.place_s + ahead_s - bodies.velocity_s <= EVENTS.close_parts * part_s:
            return vertex, ahead_s
    return None
