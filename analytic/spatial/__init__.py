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

from analytic.spatial.outcomes import Outcomes as Outcomes
from analytic.spatial.outcomes import outcomes as outcomes
from analytic.spatial.problem import Body as Body
from analytic.spatial.problem import Problem as Problem
from analytic.spatial.solution import Event as Event
from analytic.spatial.solution import EventKind as EventKind
from analytic.spatial.solution import Interval as Interval
from analytic.spatial.solution import Mode as Mode
from analytic.spatial.solution import Outcome as Outcome
from analytic.spatial.solution import Solution as Solution
from analytic.spatial.solution import VertexState as VertexState
from analytic.spatial.solver import Certified as Certified
from analytic.spatial.solver import attitude_difference_rad as attitude_difference_rad
from analytic.spatial.solver import certify as certify
from analytic.spatial.solver import simulate as simulate
from analytic.spatial.solver import solve as solve
