"""Whole numbers that stand for kinds, outcomes and events in compiled code."""

from __future__ import annotations

from typing import Final

# Kinds of motion.
NONE, HARMONIC, RECTANGULAR, SINE, COSINE, RICKER, SAMPLED = range(7)
PULSES: Final = {"rectangular": RECTANGULAR, "one_sine": SINE, "one_cosine": COSINE, "ricker": RICKER}

# Outcomes.
RUNNING, STANDS, OVERTURNED_LEFT, OVERTURNED_RIGHT, TOUCHES_WALL, LIFT_OFF, FRICTION_PARADOX, UNDECIDED = range(8)

# Events.
(
    NO_EVENT,
    UPLIFT,
    SLIP_ONSET,
    STICK_ONSET,
    IMPACT,
    BREAK,
    AT_LIMIT,
    AT_WALL,
    LOST_CONTACT,
    NO_SOLUTION,
    BEGIN,
    FINISH,
) = range(12)

# Choices of `analytic.block.CHOICES`.
MOVING: Final = 1

# By what a run left the model's domain: from 1 on, 0 while it is inside.
BY_PIVOT_SLIP, BY_LOST_CONTACT, BY_TIPPING, BY_LEAN = range(1, 5)
