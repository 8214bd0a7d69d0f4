"""The numbers by which events are located: shares of a step, of a rate or of a length, none with a unit but the angles.

Where no other reason stands beside one it was chosen by trial on the paper's cases, and no result hangs on it: a fifth more or
less moves none by its stated uncertainty (tests/harness/engines/stepping/test_constants.py).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from harness.engines.stepping.step_log import STANDS_RAD


@dataclass(frozen=True, kw_only=True)
class EventSettings:
    """What decides where a step is parted, in the order in which a run asks for it."""

    # Which step holds an event.
    ahead: float = 1.5
    """Steps between the last look at an event and the step in which it may fall."""
    later: float = 2.0
    """A foot that comes down no sooner than in so many of what is left of a step, at its present speed and as that grows, does
    not come down in it: of 290 impacts of a scan that rocks over 16 vertices one did, and of 2 200 steps without one 2 180 need
    no look."""
    most_jumps: int = 8
    """Events met within one step at most: what touches again and again comes to rest in a whole one."""
    tipped_rad: float = STANDS_RAD
    """A pedestal that leans more than this by the end of a step tips (the solver iterations leave up to 1e-6 rad in one that
    stands, in a whole scene 8e-6 at 1 ms; events located in a tipping of 1e-4 rad still shift it), or more than"""
    tipped: float = 0.2
    """this share of g over half its height, an acceleration of a body that tips freely, times the square of the step: of so much
    the solver iterations of longer steps leave a part."""

    # Which foot comes down.
    least_rate: float = 8e-4
    """The highest rate about the other end of the base at which a foot may close and stand all the same, of √(g/h), h the height
    of the centroid:"""
    held: float = 0.02
    """this share of the statue's own rate, as the solver iterations leave as much where friction changes, but not less than"""
    least_at_rest: float = 1.4e-4
    """this share of √(g/h), which they leave in a statue at rest on a pedestal that tips, or"""
    least_gained: float = 0.016
    """this share of g/h times the step: an impact at a lower rate begins a half-cycle of a fraction of a step."""
    drift: float = 4.0
    """A foot that falls faster than this many times its drift in a step comes down; a slower one stands."""
    near: float = 6.5e-6
    """A foot nearer than this share of h stands: the circle on which it turns takes it so far off its support within a step. In
    slow turning it takes it less far, but"""
    rest: float = 1.3e-7
    """this share of h the solver iterations may leave one that rests."""
    late: float = 0.05
    """A foot that came down longer ago than this, in steps, has met its support: deeper it was missed for a step."""
    least_turning: float = 0.25
    """A foot that closes at less than this share of the base's width times the rate of turning comes down from another cause (a
    contact lost for a step): its speed says nothing of how the statue turns, and is taken as it is."""

    # How an event is met.
    far: float = 0.06
    """An event further ahead than this, in steps, is approached by steps with the velocity of their middle."""
    approach: float = 0.85
    """Share of the time to the event that such a step takes."""
    most_approaches: int = 3
    aside: float = 0.1
    """Share of a step that an approach leaves before the step's end, where what is approached may come later."""
    room: float = 0.03
    """Time, in steps, that the places are left before the contact while the velocities are brought to its instant."""
    short: float = 0.9
    """Share of that time that the engine's step takes: a contact within a step is felt before it is reached."""
    together: float = 0.05
    """Feet that come down within this share of a step meet their support at once, as those of one edge do: an impact's length."""
    shortest: float = 2e-3
    """Share of a step below which none is taken."""
    still: float = 5e-3
    """Share of the least speed of a foot that comes down which a correction may leave in one that stands: a sound run, ended at
    its first event, left 4e-7 m/s of 5e-8 (scene 786044 of `space_scene`)."""
    least_rest: float = 0.04
    """A rest of a step shorter than this goes with the part before it."""

    # Micro-rocking.
    short_steps: float = 8.0
    """A half-cycle expected to be shorter than so many steps is followed in parts of its own."""
    least_steps: float = 0.25
    """One shorter than this is left to whole steps, in which it dies out."""
    parts: float = 5.0
    """Parts of a half-cycle as it is expected from its first one."""
    most_parts: int = 40
    """Parts after which a half-cycle that does not return is left to whole steps."""
    least_first: float = 0.02
    most_first: float = 0.5
    """Shares of a step between which the first part lies: the forces of a half-cycle are known only after it."""
    close_parts: float = 1.2
    """A foot that returns within so many times the coming part is met."""
    tail_parts: float = 0.4
    """A rest of a whole step shorter than so many parts goes with the part before it."""

    # Stick onset and slip onset of the pedestal.
    least_share: float = 0.02
    """Share of kinetic friction's deceleration below which a change of the pedestal's velocity is the solver's remainder."""
    past_rest: float = 0.1
    """A pedestal whose velocity, going on in a straight line, passes rest by more than this share of what kinetic friction takes
    in a step does not come to rest."""
    sticks_below: float = 0.3
    """Share of a step's loss of velocity that may be left of it when the pedestal counts as stuck."""
    unsolved: float = 2e-3
    """Share of its limit that friction at it may lack: the solver's iterations end before the last digits."""
    whole: float = 0.5
    """Share of a step from which on a step tells the force that holds the pedestal."""

    def stretched(self, share: float) -> EventSettings:
        """The same, with all that is done around an event so many times as long: of what the layer errs by that is another."""
        return (
            self
            if share == 1.0
            else replace(
                self,
                approach=1.0 - share * (1.0 - self.approach),
                aside=share * self.aside,
                room=share * self.room,
                together=share * self.together,
                least_rest=share * self.least_rest,
                parts=self.parts / share,
            )
        )


EVENTS: Final = EventSettings()
