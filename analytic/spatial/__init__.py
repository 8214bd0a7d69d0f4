"""The rigid body on a polygon of base vertices, in three dimensions, event by event: plain numbers in, arrays out.

SI units; the table's frame has z up; the quaternion (w, x, y, z) turns the body's frame into the table's; angular velocity stands
in the body's frame. docs/spatial.md has the equations and what they assume.

>>> import analytic
>>> from analytic import spatial
>>> block = spatial.Body.block(500.0, 0.30, 0.40, 1.20)
>>> run = spatial.simulate(
...     block,
...     analytic.Harmonic(0.5 * 9.81, 2.0),
...     analytic.Harmonic(0.45 * 9.81, 1.0 / 0.6),
...     duration_s=0.08,
...     friction_static=10.0,
... )
>>> run.outcome
<Outcome.STANDS: 'stands'>
"""

from analytic.spatial.problem import (
    Body,
    Event,
    EventKind,
    Interval,
    Mode,
    Outcome,
    Problem,
    Solution,
    VertexState,
)
from analytic.spatial.solver import (
    Certified,
    Outcomes,
    attitude_difference_rad,
    certify,
    outcomes,
    simulate,
    solve,
)

__all__ = [
    "Body", "Certified", "Event", "EventKind", "Interval", "Mode", "Outcome", "Outcomes", "Problem", "Solution",
    "VertexState", "attitude_difference_rad", "certify", "outcomes", "simulate", "solve",
]  # fmt: skip
