"""Where each number stands in the kernel's arrays; every constant is known when the kernel is compiled."""

from __future__ import annotations

from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Runs = NDArray[np.void]
"""An array of RUN."""

MAX_ORDER: Final = 26
"""Highest order of a Taylor step."""
INVERSE: Final[Floats] = 1.0 / np.maximum(np.arange(MAX_ORDER + 3), 1)
"""1/k, for the k-th term of a series."""

# Parameters p of one run.
MASS: Final = 0  # statue, kg
BASE_MASS: Final = 1  # pedestal, kg; 0 without one
INERTIA: Final = 2  # statue about its centroid, kg m²
CENTROID: Final = 3  # h, m
GRAVITY: Final = 4
MU_STATIC: Final = 5
MU_KINETIC: Final = 6
RATIO: Final = 7  # prescribed ratio at impact; negative: angular momentum
DYNAMIC: Final = 8  # 1: friction follows N of section 2; 0: M g_e
MOMENTUM: Final = 9  # 1: pedestal takes its momentum at impact; 0: velocity unchanged
THETA0: Final = 10
OMEGA0: Final = 11
DURATION: Final = 12
OVERTURN: Final = 13
WALL_SIDE: Final = 14  # -1 left, 0 none, 1 right
WALL_ROTATION: Final = 15  # |θ| at which the top touches the wall, rad
SKIP_START: Final = 16  # leave out the time before anything moves
BASE_WIDTH: Final = 17
BASE_HEIGHT: Final = 18
BASE_CENTRE: Final = 19  # pedestal's centre in the statue's frame, m
TOLERANCE: Final = 20  # local error of a step, rad
ORDER: Final = 21
STEP_CAP: Final = 22
REST_ANGLE: Final = 23  # a rebound that stays below it is dropped, rad
GRID_STEP: Final = 24  # output step, s; 0: no history
SKIP_REST: Final = 25  # leave out rests after that
SKIP_ENERGY: Final = 26
WANT_VALIDITY: Final = 27
HAS_BASE: Final = 28
TIME_SCALE: Final = 29  # 1/p of the slender block, s
STATUE_FRICTION: Final = 30  # between statue and support; the model assumes that it holds
N_PARAMETERS: Final = 31

# One motion f.
KIND: Final = 0
AMPLITUDE: Final = 1
OMEGA: Final = 2
PHASE: Final = 3
RAMP: Final = 4
START: Final = 5
END: Final = 6
SCALE: Final = 7  # by which a record's samples are multiplied
N_FORCING: Final = 8

NONE: Final = 0
HARMONIC: Final = 1
RECTANGULAR: Final = 2
SINE: Final = 3
COSINE: Final = 4
RICKER: Final = 5
SAMPLED: Final = 6

# Rows of the workspace w: Taylor coefficients about the start of a step.
TH: Final = 0  # θ
OM: Final = 1  # θ̇
SLIP: Final = 2  # u
RATE: Final = 3  # u̇
PX: Final = 4  # X: pivot to centroid, horizontal
PZ: Final = 5  # Z: pivot to centroid, vertical
AX: Final = 8  # floor's horizontal acceleration
GE: Final = 9  # g + floor's vertical acceleration
ABS: Final = 10  # A, absolute horizontal acceleration of the support
FLOOR: Final = 11  # F, floor on pedestal
NORMAL: Final = 12  # N, floor on pedestal
PIVOT_V: Final = 13  # V, support on statue
PIVOT_H: Final = 14  # H, support on statue
DET: Final = 15  # determinant of the sliding system, kg m²
EVENT: Final = 16
N_ROWS: Final = 17

# State s and discrete state q.
T: Final = 0
S_TH: Final = 1
S_OM: Final = 2
S_U: Final = 3
S_V: Final = 4
LIMIT: Final = 5  # the next break of a motion, or the duration, s
TURNED: Final = 6  # the last rotation that is not 0 of which sine and cosine were taken
SINE_OF: Final = 7
COSINE_OF: Final = 8
N_STATE: Final = 9

PIVOT: Final = 0  # vertex rocked about; -1 at rest
FACET: Final = 1  # facet rested on (or last landed on)
SLIDE: Final = 2  # sign of the pedestal's velocity; 0 stuck
SEG: Final = 3  # breaks passed, of each motion
FRESH: Final = 5  # 1 in the first step after the joint state was chosen
GRID: Final = 6  # next output sample
OUTCOME: Final = 7
LOADED: Final = 8  # 1 if AX and GE hold the floor's coefficients about T
DEGREE: Final = 9  # their degrees
OVER: Final = 11  # 1 once both motions are over
N_DISCRETE: Final = 12

# The floor's two directions.
ALONG_X: Final = 0
ALONG_Z: Final = 1

# The caller's arrays: address and number of items.
BASE_X: Final = 0  # base vertices from left to right, statue's frame
BASE_Z: Final = 1
FACET_RAD: Final = 2  # rotation at which facet j (vertex j to j + 1) lies on the support
TIMES: Final = 3  # of each motion's samples
SAMPLES: Final = 5
HISTORY: Final = 7  # rows of t, θ, θ̇, u, u̇; its items are those before the last instant, each row has one more
TABLE: Final = 8  # of the events
N_MEMORY: Final = 9

# Outcomes.
RUNNING: Final = 0
STANDS: Final = 1
OVERTURNED_LEFT: Final = 2
OVERTURNED_RIGHT: Final = 3
TOUCHES_WALL: Final = 4
LIFT_OFF: Final = 5
PARADOX: Final = 6
UNDECIDED: Final = 7

# Events.
NO_EVENT: Final = 0
UPLIFT: Final = 1
SLIP_EVENT: Final = 2
HALT: Final = 3
IMPACT: Final = 4
BREAK: Final = 5
AT_LIMIT: Final = 6
AT_WALL: Final = 7
FLIGHT: Final = 8
NO_SOLUTION: Final = 9
BEGIN: Final = 10
FINISH: Final = 11

# Columns of the event table.
E_TIME: Final = 0
E_KIND: Final = 1
E_PIVOT: Final = 2
E_FACET: Final = 3
E_SLIDE: Final = 4
E_THETA: Final = 5
E_OMEGA_BEFORE: Final = 6
E_OMEGA_AFTER: Final = 7
E_SLIP: Final = 8
E_RATE_BEFORE: Final = 9
E_RATE_AFTER: Final = 10
E_ENERGY: Final = 11  # energy after less before, floor's frame, J
E_TIED: Final = 12  # number of feasible joint states, where they were searched
E_RESIDUAL: Final = 13  # event function at the event, relative to its terms
N_EVENT: Final = 14

# Results r.
PEAK: Final = 0
PEAK_TIME: Final = 1
PEAK_SLIP: Final = 2
OVERTURN_TIME: Final = 3
NO_RETURN: Final = 4
PIVOT_FRICTION: Final = 5
PIVOT_FRICTION_IMPACT: Final = 6
LEAST_V: Final = 7
LEAST_N: Final = 8
TIP_MARGIN: Final = 9
TIP_MARGIN_IMPACT: Final = 10
ENERGY_GAINED: Final = 11
ENERGY_LOST: Final = 12
RESIDUAL: Final = 13
SKIPPED_S: Final = 14
OUTCOME_MARGIN: Final = 15
LEFT_TIME: Final = 16  # when the run first left the model's domain, s
LEFT_BY: Final = 17
N_RESULT: Final = 18

# By what a run left the model's domain.
BY_PIVOT_SLIP: Final = 1
BY_FLIGHT: Final = 2
BY_TIPPING: Final = 3

# Counts c.
STEPS: Final = 0
COEFFICIENTS: Final = 1
EVENTS: Final = 2
IMPACTS: Final = 3
TIES: Final = 4
TANGENTS: Final = 5
ZENO: Final = 6
QUIET_SAMPLES: Final = 7
BY_ENERGY: Final = 8
STALLED: Final = 9
UPLIFTS: Final = 10
SLIPS: Final = 11
GAVE_UP: Final = 12
N_COUNT: Final = 13


RUN: Final = np.dtype(
    [
        ("p", np.float64, N_PARAMETERS),
        ("f", np.float64, (2, N_FORCING)),
        ("wave", np.float64, (2, MAX_ORDER + 2)),
        ("s", np.float64, N_STATE),
        ("r", np.float64, N_RESULT),
        ("w", np.float64, (N_ROWS, MAX_ORDER + 2)),
        ("q", np.int64, N_DISCRETE),
        ("c", np.int64, N_COUNT),
        ("address", np.int64, N_MEMORY),
        ("length", np.int64, N_MEMORY),
    ],
    align=True,
)
"""All that one run reads and writes, in one piece: the compiled code passes its address on."""


class Task(Protocol):
    """One record of RUN, as the compiled code sees it."""

    @property
    def p(self) -> Floats:
        """Parameters."""

    @property
    def f(self) -> Floats:
        """The two motions."""

    @property
    def wave(self) -> Floats:
        """Amplitude ω^k/k! of the two motions, where they are sines, with the sign of the k-th derivative."""

    @property
    def s(self) -> Floats:
        """State."""

    @property
    def r(self) -> Floats:
        """Results."""

    @property
    def w(self) -> Floats:
        """Taylor coefficients."""

    @property
    def q(self) -> Ints:
        """Discrete state."""

    @property
    def c(self) -> Ints:
        """Counts."""

    @property
    def address(self) -> Ints:
        """Where the caller's arrays stand."""

    @property
    def length(self) -> Ints:
        """How many items they have."""
