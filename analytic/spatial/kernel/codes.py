"""Whole numbers that stand for modes, motions, outcomes and events in compiled code."""

from __future__ import annotations

from typing import Final

# Modes: what touches, and how. The order is that of preference where several are possible: the one that sticks most.
(
    FLAT_REST,
    EDGE_STICK,
    FLAT_PIVOT,
    EDGE_PIVOT,
    VERTEX_STICK,
    FLAT_SLIDE,
    EDGE_SLIDE,
    VERTEX_SLIDE,
    FLIGHT,
) = range(9)

# By mode, what of the polygon of the vertices that touch stays on the floor, and
FACET, EDGE, VERTEX, NOTHING = range(4)
KEEPS: Final = (FACET, EDGE, FACET, EDGE, VERTEX, FACET, EDGE, VERTEX, NOTHING)
# how: all of it sticks, it turns about vertex a, all of it slides, or it is nowhere.
STICKS, PIVOTS, SLIDES, FLIES = range(4)
DOES: Final = (STICKS, STICKS, PIVOTS, PIVOTS, STICKS, SLIDES, SLIDES, SLIDES, FLIES)

# Outcomes.
RUNNING, STANDS, OVERTURNED, NO_MODE, UNDECIDED, GAVE_UP = range(6)

# Events.
START, UPLIFT, SLIP_ONSET, STICK_ONSET, IMPACT, BREAK, OVERTURN, END, SETTLED = range(9)

# What one event function watches.
WATCH_GAP, WATCH_NORMAL, WATCH_FRICTION, WATCH_SPEED, WATCH_TILT = range(5)
