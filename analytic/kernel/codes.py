"""Whole numbers that stand for kinds, outcomes and events in compiled code."""

from __future__ import annotations

from typing import Final

# Kinds of motion.
NONE: Final = 0
HARMONIC: Final = 1
RECTANGULAR: Final = 2
SINE: Final = 3
COSINE: Final = 4
RICKER: Final = 5
SAMPLED: Final = 6
PULSES: Final = {"rectangular": RECTANGULAR, "one_sine": SINE, "one_cosine": COSINE, "ricker": RICKER}

# Outcomes.
RUNNING: Final = 0
STANDS: Final = 1
OVERTURNED_LEFT: Final = 2
OVERTURNED_RIGHT: Final = 3
TOUCHES_WALL: Final = 4
LIFT_OFF: Final = 5
FRICTION_PARADOX: Final = 6
UNDECIDED: Final = 7

# Events.
NO_EVENT: Final = 0
UPLIFT: Final = 1
SLIP_ONSET: Final = 2
STICK_ONSET: Final = 3
IMPACT: Final = 4
BREAK: Final = 5
AT_LIMIT: Final = 6
AT_WALL: Final = 7
LOST_CONTACT: Final = 8
NO_SOLUTION: Final = 9
BEGIN: Final = 10
FINISH: Final = 11

# Choices of `analytic.block.CHOICES`.
MOVING: Final = 1

# By what a run left the model's domain.
BY_PIVOT_SLIP: Final = 1
BY_LOST_CONTACT: Final = 2
BY_TIPPING: Final = 3
BY_LEAN: Final = 4
