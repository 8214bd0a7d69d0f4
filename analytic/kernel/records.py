"""What one run reads and writes, by name: whole numbers that stand for kinds, outcomes and events, and records that the compiled
code sees as one piece of memory.

Each class below is two things: what `mypy` and the interpreter know (a dataclass), and, through `layout` below, the
same fields one after another in memory (a numpy record), which the compiler turns into plain loads and stores at known places.
A field is a float, an int, a bool, another record, or an array of a stated shape.
"""

import math
from dataclasses import dataclass
from struct import Struct
from typing import Annotated, Any, Final, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

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


Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Records = NDArray[np.void]
"""An array whose items are records."""

MAX_ORDER: Final = 26
"""Highest order of a Taylor step; the finest local error that can be asked, 1e-17, takes 23 (`analytic.problem.order_for`)."""
TERMS: Final = MAX_ORDER + 2
"""Room of a series: one term more than the order for X and Z, whose terms run ahead, and one for a sum by pairs of terms."""
# The constant term has no inverse: 1 fills its place.
INVERSE: Final[Floats] = 1.0 / np.maximum(np.arange(MAX_ORDER + 3), 1)
"""1/k, for the k-th term of a series."""
Terms = Annotated[Floats, (TERMS,)]
"""Coefficients of powers of the time since the start of a step, from the constant one on, (TERMS,)."""


@dataclass
class Params:
    """One problem and how it is to be solved; SI units."""

    mass_kg: float
    """Statue."""
    centroid_height_m: float
    inertia_kg_m2: float
    """Statue, about its centroid."""
    gravity_m_s2: float
    statue_friction: float
    """Between statue and support: the model assumes that it holds, and notes when it would not have."""
    base_left_rad: float
    """Leans beyond which something else than the base comes down, to the left"""
    base_right_rad: float
    """and to the right; infinite where nothing does."""
    restitution: float
    """Prescribed ratio of the angular velocities at an impact; negative: by angular momentum."""
    dynamic_normal: bool
    """Friction follows N of section 2 of the model; otherwise M g_e."""
    momentum_at_impact: bool
    """The pedestal takes its momentum at an impact; otherwise its velocity is unchanged."""
    choice: int
    """0 or `MOVING`: a place in `analytic.block.CHOICES`."""
    theta0_rad: float
    theta_rate0_rad_s: float
    duration_s: float
    overturn_rad: float
    time_scale_s: float
    """1/p of the faster outer corner: in it, coefficients of different orders compare."""
    tolerance_rad: float
    """Local error of a step."""
    order: int
    """Highest order of a step."""
    step_cap_s: float
    rest_rad: float
    """A rebound that stays below this rotation is dropped."""
    output_step_s: float
    """0: no history."""
    skip_start: bool
    """Leave out the time before anything moves."""
    skip_rest: bool
    """Leave out the rests after that."""
    skip_energy: bool
    """Let the energy decide the outcome once the motions are over."""
    keep_validity: bool
    has_pedestal: bool = False
    pedestal_mass_kg: float = 0.0
    pedestal_width_m: float = 0.0
    pedestal_height_m: float = 0.0
    pedestal_centre_m: float = 0.0
    """In the statue's frame."""
    floor_static: float = 0.0
    floor_kinetic: float = 0.0
    floor_impact: float = 0.0
    """Acts as an impact breaks a stuck pedestal loose."""
    wall_side: int = 0
    """−1 left, 0 none, 1 right."""
    wall_m: float = math.inf
    """Where the wall stands, from below the centroid of the statue at rest, positive on its side."""
    wall_pedestal_m: float = math.inf
    """Slip towards the wall with which the pedestal touches it; infinite without one."""
    wall_lever_m: float = 0.0
    """Greatest distance of a vertex of the base from a point of the outline: by no more a rotation moves any of these."""


@dataclass
class MotionParams:
    """One component of the floor's acceleration; the samples of a record stand in the caller's arrays."""

    kind: int
    """One of the kinds of motion above."""
    amplitude_m_s2: float
    """Of a record, its largest absolute sample."""
    omega_rad_s: float = 0.0
    phase_rad: float = 0.0
    ramp_s: float = 0.0
    start_s: float = 0.0
    end_s: float = 0.0
    scale: float = 1.0
    """By which a record's samples are multiplied."""
    times: int = 0
    """Address of a record's times, s."""
    samples: int = 0
    """Address of its accelerations, m/s²."""
    n_samples: int = 0


@dataclass
class Motion:
    """A component of the floor's acceleration on the way through its breaks."""

    params: MotionParams
    breaks_passed: int
    degree: int
    """Of the coefficients that were written last."""
    sine_terms: Terms
    """Amplitude ω^k/k! with the sign of the k-th derivative of a sine."""


@dataclass
class Base:
    """The statue's base in the caller's arrays, vertices from left to right; facet j joins vertices j and j + 1."""

    x: int
    """Address of the vertices' x from below the centroid, m."""
    z: int
    """Address of their heights above the base plane, m."""
    facets: int
    """Address of the rotations at which each facet lies on the support, rad."""
    n_facets: int
    stands: int
    """Address of where on its support each vertex of the base stands as the statue rolls from one to the next, m."""
    outline_x: int
    """Address of the x of the points that can touch a wall, m."""
    outline_z: int
    """Address of their heights above the base plane, m."""
    n_outline: int


@dataclass
class State:
    """The present instant: motion, joint state, and what was computed for it."""

    time_s: float
    theta_rad: float
    theta_rate_rad_s: float
    slip_m: float
    slip_rate_m_s: float
    pivot: int
    """Vertex rocked about; −1 at rest."""
    facet: int
    """Facet rested on, or landed on last."""
    slide: int
    """Sign of the pedestal's velocity; 0 stuck."""
    outcome: int
    fresh: bool
    """The joint state was chosen at this very instant: terms that are rounding only are not taken for a way out of it."""
    floor_loaded: bool
    """The floor's coefficients stand about this instant."""
    motions_over: bool
    followed: int
    """Impacts before which the energy is not asked for the outcome again."""
    limit_s: float
    """The next break of a motion, or the duration: no step goes beyond."""
    angle_rad: float
    """The last rotation that is not 0 of which sine and cosine were taken."""
    sine: float
    cosine: float


@dataclass
class Series:
    """Taylor coefficients of a step about its start (docs/model.md, section 2)."""

    theta: Terms
    theta_rate: Terms
    slip: Terms
    slip_rate: Terms
    pivot_x: Terms
    """X, from the pivot to the centroid, horizontal."""
    pivot_z: Terms
    """Z, vertical."""
    floor_accel: Terms
    """a_x."""
    gravity: Terms
    """g_e = g + a_z."""
    support_accel: Terms
    """A, absolute horizontal acceleration of the support."""
    floor_force: Terms
    """F, of the floor on the pedestal."""
    floor_normal: Terms
    """N, of the floor on the pedestal."""
    pivot_normal: Terms
    """V, of the support on the statue."""
    pivot_force: Terms
    """H, of the support on the statue."""
    event: Terms
    """The event function that is looked at."""
    determinant: float
    """Of the sliding system, kg m²: positive, or friction has no solution."""


@dataclass
class Results:
    """What a run leaves behind besides its state, before its first step; energies in the floor's frame."""

    peak_theta_rad: float = 0.0
    """Signed."""
    peak_time_s: float = 0.0
    peak_slip_m: float = 0.0
    overturn_time_s: float = math.nan
    no_return_time_s: float = math.nan
    pivot_friction: float = 0.0
    pivot_friction_at_impact: float = 0.0
    least_pivot_normal_n: float = math.inf
    least_floor_normal_n: float = math.inf
    tipping_margin_m: float = math.inf
    tipping_margin_at_impact_m: float = math.inf
    energy_gained_j: float = 0.0
    energy_lost_j: float = 0.0
    event_residual: float = 0.0
    skipped_s: float = 0.0
    outcome_margin: float = math.inf
    left_domain_s: float = math.nan
    left_domain_by: int = 0


@dataclass
class Counts:
    """How often what happened."""

    steps: int
    coefficients: int
    events: int
    impacts: int
    ties: int
    """Choices among several feasible joint states."""
    tangents: int
    """Steps in which an event was nearly tangent."""
    dropped_rebounds: int
    quiet_samples: int
    energy_endings: int
    stalled: int
    """Events in a row in which the clock did not move."""
    given_up: int
    samples: int
    """Output samples written."""


@dataclass
class EventRow:
    """One event: the joint state after it, the velocities before and after."""

    time_s: float
    kind: int
    pivot: int
    facet: int
    slide: int
    theta_rad: float
    theta_rate_before_rad_s: float
    theta_rate_after_rad_s: float
    slip_m: float
    slip_rate_before_m_s: float
    slip_rate_after_m_s: float
    energy_j: float
    feasible_states: int
    residual: float


@dataclass
class Output:
    """The caller's arrays that a run fills."""

    history: int
    """Address of the rows of t, θ, θ̇, u, u̇."""
    n_samples: int
    """Items of each row before the last instant, which has one more."""
    events: int
    """Address of the table of events."""
    n_events: int
    """Rows of that table; 0: events are not kept."""


@dataclass
class Task:
    """All that one run reads and writes: the compiled functions pass its address on."""

    params: Params
    base: Base
    motion_x: Motion
    motion_z: Motion
    output: Output
    state: State
    results: Results
    counts: Counts
    series: Series


# Where the fields of a record stand in memory: for numpy, which the compiler reads, and for packing
# without numpy.


_PLAIN: Final[dict[Any, tuple[str, type]]] = {float: ("d", np.float64), int: ("q", np.int64), bool: ("?", np.bool_)}
_ITEMS: Final[dict[Any, type]] = {Floats: np.float64, Ints: np.int64}
"""Of arrays of a stated shape; other items are records."""


def layout(record: type) -> np.dtype[np.void]:
    """The numpy record with the fields of a class of records, each where a C compiler would put it."""
    fields: list[tuple[Any, ...]] = []
    for name, hint in get_type_hints(record, include_extras=True).items():
        if get_origin(hint) is Annotated:
            items, shape = hint.__origin__, hint.__metadata__[0]
            fields.append((name, _ITEMS[items] if items in _ITEMS else layout(get_args(items)[0]), shape))
        else:
            fields.append((name, _PLAIN[hint][1] if hint in _PLAIN else layout(hint)))
    # align=True pads as the native format of `struct` does: `packing` then writes where this record is read.
    return np.dtype(fields, align=True)


def packing(*parts: type | int) -> Struct:
    """Packs and unpacks records without others in them one after another, each in the same places, and so many bytes of zeros
    between them: some ten times faster than numpy, item by item."""
    formats = [
        f"{part}x" if isinstance(part, int) else "".join(_PLAIN[hint][0] for hint in get_type_hints(part).values())
        for part in parts
    ]
    return Struct("".join(formats))


def row(record: Any) -> tuple[Any, ...]:
    """The fields of a record one after another."""
    return tuple(vars(record).values())


TASK: Final = layout(Task)
PARAMS: Final = layout(Params)
MOTION_PARAMS: Final = layout(MotionParams)
BASE: Final = layout(Base)
STATE: Final = layout(State)
RESULTS: Final = layout(Results)
COUNTS: Final = layout(Counts)
EVENT_ROW: Final = layout(EventRow)
TABLES: Final = np.dtype(
    [
        (name, np.int64)
        for name in ("params", "motion_x", "motion_z", "bases", "states", "results", "counts", "start", "stop")
    ]
)
"""Addresses of the tables of many runs, row by row, and which of their rows are to be run."""
