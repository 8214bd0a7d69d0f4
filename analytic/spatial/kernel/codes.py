"""Whole numbers that stand for modes, motions, outcomes and events in compiled code."""

from __future__ import annotations

from typing import Final

# Modes: what touches, and how. The order is that of preference where several are possible: the one that sticks most.
FLAT_REST: Final = 0
EDGE_STICK: Final = 1
FLAT_PIVOT: Final = 2
EDGE_PIVOT: Final = 3
VERTEX_STICK: Final = 4
FLAT_SLIDE: Final = 5
EDGE_SLIDE: Final = 6
VERTEX_SLIDE: Final = 7
FLIGHT: Final = 8

# Outcomes.
RUNNING: Final = 0
STANDS: Final = 1
OVERTURNED: Final = 2
NO_MODE: Final = 3
UNDECIDED: Final = 4
GAVE_UP: Final = 5

# Events.
START: Final = 0
UPLIFT: Final = 1
SLIP_ONSET: Final = 2
STICK_ONSET: Final = 3
IMPACT: Final = 4
BREAK: Final = 5
OVERTURN: Final = 6
END: Final = 7
SETTLED: Final = 8

# What one event function watches.
WATCH_GAP: Final = 0
WATCH_NORMAL: Final = 1
WATCH_FRICTION: Final = 2
WATCH_SPEED: Final = 3
WATCH_TILT: Final = 4
