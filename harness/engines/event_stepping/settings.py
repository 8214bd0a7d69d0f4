"""Every number by which `locating` finds and meets events: dimensionless, each with its reason.

Each is changed by a fifth, up and down, in `tests/harness/engines/event_stepping/test_constants.py`: no result moves by its
error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class EventSettings:
    """Lengths of time are in steps, or in parts of a half-cycle, unless said otherwise."""

    least_tail: float = 0.5
    """A part that leads back to a whole step takes at least this; so none is longer than one step more."""
    approach: float = 0.8
    """Share of the time to an impact after which it is foreseen anew: that error falls with the square of what is left."""
    far: float = 0.5
    """... where it is further ahead than this: parts of a half-cycle end near enough."""
    clear: float = 4.0
    """... and where what is left is so many times the height at which contacts are felt: twice that at its middle."""
    short_steps: float = 8.0
    """A half-cycle that is expected to be shorter is followed in parts of its own: whole steps would end it in the one in which
    it returns, alike at every step."""
    least_steps: float = 0.25
    """A shorter one is left to whole steps, in which it dies out: its impacts are at 1e-3 rad/s or less."""
    parts: float = 5.0
    """Parts of a half-cycle: its return is foreseen from the acceleration in the last of them."""
    most_parts: float = 40.0
    """Parts after which a half-cycle that does not return is left to whole steps: eight times those expected."""
    least_first: float = 0.02
    most_first: float = 0.5
    """The first part, before a half-cycle's forces are known, lies between these: it is as long as the soonest return."""
    close_parts: float = 1.2
    """A vertex that returns within so much of the coming part is met: one part is what lies between two looks."""
    peak: float = 0.25
    """What a half-cycle lifts its vertex by, over the rate at its beginning times its duration: ¼ at a constant acceleration."""
    thin: float = 5e-3
    """Depth of contact in such a half-cycle over what it lifts its vertex by, where contacts have a depth."""


EVENTS: Final = EventSettings()
"""The settings of every run."""
