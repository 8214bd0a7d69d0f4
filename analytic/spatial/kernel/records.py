"""What one run reads and writes, by name: codes, plain numbers in a record, vectors and tables in arrays."""

from dataclasses import dataclass
from typing import Annotated, Final

from analytic.kernel.records import Floats, Ints, Motion, layout

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

# What one vertex does, where it touches.
FREE, STICKING, SLIDING = range(3)

# Outcomes.
RUNNING, STANDS, OVERTURNED, NO_MODE, UNDECIDED, GAVE_UP = range(6)

# Events.
START, UPLIFT, SLIP_ONSET, STICK_ONSET, IMPACT, BREAK, OVERTURN, END, SETTLED = range(9)

# What one event function watches.
WATCH_GAP, WATCH_NORMAL, WATCH_FRICTION, WATCH_SPEED, WATCH_TILT = range(5)


STATE: Final = 15
"""Items of a state: place of the centroid (3), quaternion w, x, y, z (4), velocity (3), angular velocity in the body's frame (3),
work done by the field g_e on the body and work lost by sliding."""
WORK: Final = 13
LOST: Final = 14
MAX_VERTICES: Final = 256
"""Room for the base's vertices: a record's arrays have their sizes from the start."""
SECTORS: Final = (48, 768)
"""Directions between which a sign change is looked for, and where no mode is found so: of two in one sector none is seen."""
Triples = Annotated[Floats, (MAX_VERTICES, 3)]
Pairs = Annotated[Floats, (MAX_VERTICES, 2)]
Scalars = Annotated[Floats, (MAX_VERTICES,)]
Marks = Annotated[Ints, (MAX_VERTICES,)]
Matrix = Annotated[Floats, (3, 3)]
State = Annotated[Floats, (STATE,)]
Stages = Annotated[Floats, (13, STATE)]
Columns = Annotated[Floats, (8, 3)]
# A vertex has a gap in the air, a normal force and a speed of sliding on the floor; the rest are the body's own.
WATCHED: Final = 3 * MAX_VERTICES + 8


@dataclass
class Run:
    """One problem, how it is solved, and the present instant; SI units."""

    mass_kg: float
    gravity_m_s2: float
    friction_static: float
    friction_kinetic: float
    restitution: float
    """Share of the normal velocity that an impact gives back."""
    duration_s: float
    overturn_cos: float
    """Cosine of the tilt at which the body counts as overturned."""
    stands_cos: float
    """Cosine of the tilt up to which a body that still moves at the end stands."""
    tolerance: float
    """Local error of a step, relative to 1 m, 1 rad and their rates."""
    touch_m: float
    """A gap below this is none."""
    still_m_s: float
    """A speed of sliding below this is none."""
    settle_m_s: float
    """A vertex that leaves an impact more slowly than this stays."""
    step_cap_s: float
    most_steps: int
    """Steps, rejected ones included, after which the run is given up."""
    output_step_s: float
    """0: no history."""
    keep_events: bool
    try_all: bool
    """At each choice of a mode, whether another one is possible too."""
    time_s: float
    event_s: float
    step_s: float
    limit_s: float
    """The next break of a motion or the end."""
    mode: int
    a: int
    """The vertex touched, or the first of the edge; the one that sticks where the other slides."""
    b: int
    sign: float
    """Of the yaw rate about a vertex that sticks while others slide."""
    fresh: bool
    """The mode was chosen at this very instant."""
    slow: bool
    """The present step is one of slow sliding."""
    outcome: int
    sectors: int
    """Between which directions of sliding are sought: few, or many where nothing was found (`SECTORS`)."""
    touching: int
    samples: int
    events: int
    intervals: int
    steps: int
    rejected: int
    impacts: int
    ties: int
    """Choices of a mode that another motion could have followed."""
    settled: int
    stalled: int
    watched: int
    """Event functions of the mode."""
    least_friction: float
    """Largest over the run of the least friction that suffices, while sticking."""
    peak_tilt_rad: float
    impact_loss_j: float
    energy_residual: float
    momentum_residual: float
    cone_residual: float
    energy_scale_j: float
    start_j: float


@dataclass
class Memory:
    """The arrays of one run of a body with n vertices, in the first n rows each; addresses are those of the caller's arrays."""

    vertices: int
    """n."""
    inertia: Matrix
    inverse: Matrix
    about: Annotated[Floats, (MAX_VERTICES, 3, 3)]
    """Inverse of the inertia about each vertex."""
    at: Triples
    """Vertices from the centroid, body's frame."""
    motions: Annotated[tuple[Motion, Motion, Motion], (3,)]
    """Of the floor along x, y and z."""
    y: State
    """The state at the start of a step,"""
    y1: State
    """at its end, and"""
    y2: State
    """in between."""
    ys: State
    """Of a stage."""
    k: Stages
    """Stages of a step, and the rates at its end."""
    k1: Stages
    """Stages of a part of a step."""
    bent: Annotated[Floats, (3,)]
    """Level motion added to what touches where its directions of sliding are read: velocities of its first vertex, yaw."""
    gain: Annotated[Floats, (3, STATE)]
    """What the rates change with each of these, and"""
    returned: Matrix
    """the level motion of that change."""
    table: Annotated[Floats, (8, STATE)]
    """Extrapolated changes of the state over a slow step."""
    u: Triples
    """Each vertex' response without contact, body's frame."""
    response: Annotated[Floats, (6,)]
    """What the contact forces add: linear and angular, body's frame."""
    chosen: Annotated[Floats, (6,)]
    """The same of the mode chosen, while others are tried."""
    force: Triples
    """Contact forces or impulses, body's frame."""
    slide: Pairs
    """Direction in which each vertex slides, table's frame."""
    heading: Pairs
    """The same where a velocity gives it."""
    known: Marks
    """Whether that direction is given by a velocity."""
    stick_limit: Scalars
    """Coefficient up to which a vertex sticks, and"""
    slide_limit: Scalars
    """that at which it slides."""
    touch: Marks
    """The vertices that touch, in the polygon's order."""
    down: Marks
    """Whether each vertex touches."""
    loaded: Marks
    """Whether each vertex of a flat base bears pressure, and"""
    pressure: Scalars
    """how much, N."""
    effect: Annotated[Floats, (MAX_VERTICES + 2, 5)]
    """What a unit of each vertex' normal force does to a flat base, and of a pivot's two horizontal ones;"""
    undone: Annotated[Floats, (5,)]
    """what they must undo;"""
    multiplier: Annotated[Floats, (5,)]
    """λ of the forces, and"""
    before: Annotated[Floats, (5,)]
    """the one before."""
    across: Annotated[Floats, (SECTORS[1] + 1,)]
    """Response across each direction in which a vertex may begin to slide."""
    anchor: Pairs
    """Where each vertex sticks, table's frame."""
    column: Annotated[Ints, (8,)]
    """Vertex of each column of the contact system."""
    push: Columns
    """Direction of its force, and"""
    hold: Columns
    """of its constraint, body's frame."""
    matrix: Annotated[Floats, (8, 9)]
    impulse: Triples
    """Of the last impact, table's frame."""
    cone: Annotated[Floats, (2, MAX_VERTICES, 3)]
    """Impulses on their way to a balance inside the cones."""
    watch: Annotated[Floats, (WATCHED,)]
    """Event functions, positive while the mode lasts."""
    watch_kind: Annotated[Ints, (WATCHED,)]
    watch_vertex: Annotated[Ints, (WATCHED,)]
    offset: Annotated[Floats, (WATCHED,)]
    """What is added to each until it is clear of zero."""
    history: int
    """Address of rows of time and the first 13 items of the state."""
    instants: int
    """Rows there are."""
    event_table: int
    """Address of rows of 6 + 3 n: see `analytic.spatial.kernel.motion`."""
    interval_table: int
    """Address of rows of 2 + n."""
    rows: int
    """Rows of either table."""


RUN: Final = layout(Run)
MEMORY: Final = layout(Memory)
EVENT_HEAD: Final = 6
"""Items of an event before the impulses at its vertices (3 each): time, kind, vertex, mode after, energy lost, cone residual."""
INTERVAL_HEAD: Final = 2
"""Items of an interval before the vertices' states: start and mode."""
MOST: Final = 1_000_000
"""Steps after which a run is given up where nothing else is asked: a hundred times those of the usual slow slide, some 20 s."""
