"""What is to be computed (`Problem`) and how (`Options`), each stated once for one run, its certificate and an ensemble, encoded;
and what a run says (`Solution`): frozen, plain numbers and arrays.
"""

import math
from dataclasses import dataclass, field, fields
from enum import StrEnum
from functools import cached_property, lru_cache
from typing import Any, Final, Literal, Required, TypedDict, final

import numpy as np
from numpy.typing import NDArray

from analytic.block import (
    CHOICES,
    GRAVITY_M_S2,
    OVERTURN_RAD,
    AnalyticInputError,
    Block,
    Form,
    Friction,
    Pedestal,
    Wall,
    positive,
    require,
)
from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration, ZeroExcitation
from analytic.kernel.records import (
    EVENT_ROW,
    HARMONIC,
    MAX_ORDER,
    NONE,
    PULSES,
    SAMPLED,
    Base,
    Counts,
    Floats,
    MotionParams,
    Params,
    Records,
    Results,
    State,
)

CONSISTENT: Final = Form()
"""The form in which no event raises the energy (docs/model.md, section 4)."""


@final
@dataclass(frozen=True)
class Problem:
    """A statue on a moving floor, from its initial state to the end; SI units, rotations clockwise positive.

    floor_static, floor_kinetic, floor_impact: friction of the pedestal on the floor (`Friction`); statue_friction: between
    statue and support, assumed to hold and compared with what was needed. Raises AnalyticInputError for numbers that cannot be
    run.
    """

    block: Block
    motion_x: Excitation
    motion_z: Excitation
    duration_s: float
    pedestal: Pedestal | None = None
    floor_static: float = 0.0
    floor_kinetic: float = 0.0
    floor_impact: float | Literal["kinetic", "static"] = "kinetic"
    statue_friction: float = math.inf
    form: Form = CONSISTENT
    theta0_rad: float = 0.0
    theta_rate0_rad_s: float = 0.0
    gravity_m_s2: float = GRAVITY_M_S2
    wall: Wall | None = None
    overturn_rad: float = OVERTURN_RAD

    def __post_init__(self) -> None:
        """Check the numbers."""
        Friction(self.floor_static, self.floor_kinetic, self.floor_impact)
        theta0_rad, rate_rad_s, overturn_rad = self.theta0_rad, self.theta_rate0_rad_s, self.overturn_rad
        positive(duration_s=self.duration_s, gravity_m_s2=self.gravity_m_s2, overturn_rad=overturn_rad)
        require(
            abs(theta0_rad) < overturn_rad < 0.5 * math.pi and math.isfinite(rate_rad_s),
            "|theta0_rad| < overturn_rad < π/2 and a finite rate are wanted, {!r}, {!r}, {!r} came.",
            theta0_rad,
            overturn_rad,
            rate_rad_s,
        )
        require(
            self.statue_friction >= 0.0,
            "statue_friction: a number from 0 is wanted, {!r} came.",
            self.statue_friction,
        )
        if self.wall is None:
            return
        gap_m = self.wall.gap_m(self.block, theta0_rad)
        require(
            gap_m > 0.0, "wall: a start before it is wanted, a statue that reaches {:.6g} m beyond it came.", -gap_m
        )
        if self.pedestal is not None:
            gap_m = self.wall.pedestal_gap_m(self.block, self.pedestal)
            require(gap_m > 0.0, "wall: one beside the pedestal is wanted, one {:.6g} m inside it came.", -gap_m)


@final
@dataclass(frozen=True)
class Options:
    """How a problem is solved and what is kept.

    accuracy_rad: aimed global error (errors grow after many impacts: see ``certify``); dt_s: output step, None for the outcome
    only; step_cap_s: longest step; skip_start, skip_rest: leave out the times in which nothing can move, before anything has
    moved and after; skip_energy: without a history, let the energy decide once the motion is over; events, validity: keep them.
    Raises AnalyticInputError for numbers that cannot be used.
    """

    accuracy_rad: float = 1e-12
    dt_s: float | None = 0.001
    step_cap_s: float = math.inf
    skip_start: bool = True
    skip_rest: bool = True
    skip_energy: bool = True
    events: bool = True
    validity: bool = True

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive(accuracy_rad=self.accuracy_rad)
        if self.dt_s is not None:
            positive(dt_s=self.dt_s)
        require(self.step_cap_s > 0.0, "step_cap_s: a positive number is wanted, {!r} came.", self.step_cap_s)


class CommonKeywords(TypedDict, total=False):
    """The fields of `Problem` and `Options` as keywords of ``simulate``, ``certify`` and ``ensemble``."""

    duration_s: Required[float]
    pedestal: Pedestal | None
    floor_static: float
    floor_kinetic: float
    floor_impact: float | Literal["kinetic", "static"]
    statue_friction: float
    form: Form | None
    theta0_rad: float
    theta_rate0_rad_s: float
    gravity_m_s2: float
    wall: Wall | None
    overturn_rad: float
    dt_s: float | None
    skip_start: bool
    skip_rest: bool
    skip_energy: bool
    events: bool
    validity: bool


class Keywords(CommonKeywords, total=False):
    """Those too by which ``certify`` tells its own runs apart."""

    accuracy_rad: float
    step_cap_s: float


OPTIONS: Final = tuple(item.name for item in fields(Options))
DEFAULT_OPTIONS: Final = Options()


def stated(
    block: Block, motion_x: Excitation, motion_z: Excitation | None, keywords: Keywords
) -> tuple[Problem, Options]:
    """The problem and the options that keywords state; raises TypeError for an unknown one."""
    rest: dict[str, Any] = dict(keywords)
    options = Options(**{name: rest.pop(name) for name in OPTIONS if name in rest})
    if rest.get("form", True) is None:
        del rest["form"]
    return Problem(block, motion_x, motion_z if motion_z is not None else ZeroExcitation(), **rest), options


# A problem as the compiled kernel reads it: records of numbers, and the samples of a motion.

LOCAL_SHARE: Final = 1e-2
"""Local error of a step, in the accuracy asked: most steps end at an event, far inside their length, and err much less."""
FINEST_REST_RAD: Final = 1e-14
"""A rebound lower than the local error (or than this) is dropped. In the consistent form the momentum that its impacts and the
friction between them give the pedestal does not depend on when the statue comes to rest, to first order in its rate: what is
lost goes with the square of the rate, thus with the height."""
FINEST_ROOT_RAD: Final = 1e-12
"""Where friction follows M g_e, or an impact leaves the pedestal's velocity unchanged, each impact creates momentum in proportion
to its rate: what is lost then goes with the rate (2.7e-7 rad and 4e-8 m were measured within 2 s), and only a rebound lower
than the square of the accuracy (or of this) is dropped."""
FINEST: Final = 1e-17
"""No local error below rounding is asked."""
LEAST_ORDER: Final = 6
"""Least order of a step; reached only above an aimed error of 0.2 rad."""
_EMPTY: Final = np.empty(0)
_NOWHERE: Final = (_EMPTY.ctypes.data, _EMPTY.ctypes.data, 0)
"""The outline of a statue without a wall."""


STILL: Final = MotionParams(NONE, 0.0)
"""No motion; not to be written to."""


def encode_motion(motion: Excitation) -> tuple[MotionParams, Floats, Floats]:
    """The motion's numbers, and its samples' times (n,) and accelerations (n,), empty unless it is a record: the numbers hold
    their addresses, so the caller keeps them alive.

    Raises AnalyticInputError for a motion that the kernel does not know.
    """
    if motion.peak_m_s2 == 0.0:
        return STILL, _EMPTY, _EMPTY
    if isinstance(motion, Harmonic):
        params = MotionParams(HARMONIC, motion.amplitude_m_s2, motion.omega_rad_s, motion.phase_rad, motion.ramp_s)
        return params, _EMPTY, _EMPTY
    if isinstance(motion, Pulse):
        wave = PULSES[motion.shape], motion.amplitude_m_s2, motion.omega_rad_s
        return MotionParams(*wave, start_s=motion.start_s, end_s=motion.end_s), _EMPTY, _EMPTY
    if isinstance(motion, SampledAcceleration):
        times, samples = (np.ascontiguousarray(each, np.float64) for each in (motion.t_s, motion.samples_m_s2))
        record = {"times": times.ctypes.data, "samples": samples.ctypes.data, "n_samples": times.size}
        return MotionParams(SAMPLED, motion.peak_m_s2, **record), times, samples
    known = ", ".join(each.__name__ for each in (ZeroExcitation, Harmonic, Pulse, SampledAcceleration))
    raise AnalyticInputError(
        f"motion: one of {known} is wanted, {type(motion).__name__} came: sample it into the last."
    )


def encode_base(problem: Problem) -> Base:
    """Where the arrays of a block's base and of what can touch a wall stand, which live as long as the block and the wall."""
    block, wall = problem.block, problem.wall
    x, z, facets, stands = block.addresses
    outline = _NOWHERE if wall is None else (*(each.ctypes.data for each in wall.arrays), wall.arrays[0].size)
    return Base(x, z, facets, block.arrays[2].size, stands, *outline)


@lru_cache(maxsize=16)
def order_for(tolerance: float) -> int:
    """Order of the Taylor step that is cheapest at a local tolerance: two above Jorba and Zou's 1 − ln(tol)/2, which counts the
    terms alone and not what every step costs besides."""
    return int(min(max(math.ceil(3.0 - 0.5 * math.log(tolerance)), LEAST_ORDER), MAX_ORDER))


HELD: Final = 1.0 + 1e-9
"""Friction under the statue up to which it is held: a pedestal that slides on a floor of the same friction asks just that much,
and rounding adds to it."""


def encode(problem: Problem, options: Options) -> Params:
    """The kernel's numbers of a problem and its options."""
    block, form, pedestal = problem.block, problem.form, problem.pedestal
    tolerance = max(options.accuracy_rad * LOCAL_SHARE, FINEST)
    balanced = pedestal is None or (form.friction_normal == "dynamic" and form.pedestal_at_impact == "momentum")
    params = Params(
        mass_kg=block.mass_kg,
        centroid_height_m=block.centroid_height_m,
        inertia_kg_m2=block.inertia_kg_m2,
        gravity_m_s2=problem.gravity_m_s2,
        statue_friction=problem.statue_friction * HELD,
        base_left_rad=block.base_ends_rad[0],
        base_right_rad=block.base_ends_rad[1],
        restitution=-1.0 if form.restitution is None else form.restitution,
        dynamic_normal=form.friction_normal == "dynamic",
        momentum_at_impact=form.pedestal_at_impact == "momentum",
        choice=CHOICES.index(form.choice),
        theta0_rad=problem.theta0_rad,
        theta_rate0_rad_s=problem.theta_rate0_rad_s,
        duration_s=problem.duration_s,
        overturn_rad=problem.overturn_rad,
        time_scale_s=1.0 / max(block.p_rad_s(1, problem.gravity_m_s2), block.p_rad_s(-1, problem.gravity_m_s2)),
        tolerance_rad=tolerance,
        order=order_for(tolerance),
        step_cap_s=options.step_cap_s,
        rest_rad=max(tolerance, FINEST_REST_RAD) if balanced else max(options.accuracy_rad, FINEST_ROOT_RAD) ** 2,
        output_step_s=0.0 if options.dt_s is None else options.dt_s,
        skip_start=options.skip_start,
        skip_rest=options.skip_rest,
        skip_energy=options.skip_energy,
        keep_validity=options.validity,
    )
    if pedestal is not None:
        params.has_pedestal, params.pedestal_mass_kg = True, pedestal.mass_kg
        params.pedestal_width_m, params.pedestal_height_m = pedestal.width_m, pedestal.height_m
        params.pedestal_centre_m = 0.5 * (block.profile_m[0][0] + block.profile_m[-1][0]) + pedestal.offset_m
        friction = Friction(problem.floor_static, problem.floor_kinetic, problem.floor_impact)
        params.floor_static, params.floor_kinetic = friction.static, friction.kinetic
        params.floor_impact = friction.at_impact
    wall = problem.wall
    if wall is not None:
        params.wall_side, params.wall_m = wall.sign, wall.place_m(block)
        if pedestal is not None:
            params.wall_pedestal_m = wall.pedestal_gap_m(block, pedestal)
        base, outline = np.array(block.profile_m), np.array(wall.silhouette_m)
        params.wall_lever_m = float(np.hypot(*(outline[:, None] - base[None]).T).max())
    return params


# What a run says.


class Outcome(StrEnum):
    """How a run ended."""

    STANDS = "stands"
    OVERTURNED_LEFT = "overturned_left"
    OVERTURNED_RIGHT = "overturned_right"
    TOUCHES_WALL = "touches_wall"
    LIFT_OFF = "lift_off"
    FRICTION_PARADOX = "friction_paradox"
    UNDECIDED = "undecided"


OUTCOMES = (Outcome.UNDECIDED, *Outcome)
"""Outcome of each of the kernel's codes."""


class EventKind(StrEnum):
    """What changed the state of motion."""

    START = "start"
    UPLIFT = "uplift"
    SLIP_ONSET = "slip"
    STICK_ONSET = "halt"
    IMPACT = "impact"
    BREAK = "break"
    OVERTURN = "overturn"
    WALL = "wall"
    LIFT_OFF = "lift_off"
    PARADOX = "paradox"
    END = "end"


PATTERNS: Final = ("rest", "sliding", "rocking", "both")
"""Of motion, by 2 where the statue rocks and 1 where the pedestal slides."""
_START, *_BETWEEN, _END = EventKind
KINDS = (_END, *_BETWEEN, _START, _END)
"""Event of each of the kernel's codes."""


@final
@dataclass(frozen=True)
class Event:
    """One event: the joint state after it, and the velocities before and after.

    pivot is the base vertex rocked about (counted from the left), None at rest; slide the sign of the pedestal's velocity, 0
    stuck; energy_j the kinetic energy after less before, in the floor's frame; feasible_states how many joint states were
    possible where one had to be chosen (0: nothing was free); residual the event's own function, relative to its terms.
    """

    time_s: float
    kind: EventKind
    pivot: int | None
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

    @property
    def rocking(self) -> bool:
        """Whether the statue rocks after the event."""
        return self.pivot is not None

    @property
    def pattern(self) -> str:
        """Motion pattern after the event: rest, rocking, sliding or both."""
        return PATTERNS[2 * self.rocking + (self.slide != 0)]


@final
@dataclass(frozen=True)
class Interval:
    """A stretch of one motion pattern: rest, rocking, sliding or both."""

    start_s: float
    end_s: float
    pattern: str


@final
@dataclass(frozen=True)
class Validity:
    """How far the run stayed inside the model (docs/model.md, section 5); margins are None without a pedestal.

    Friction needed at the statue's pivot |H|/V, during motion and at impacts; least V and N, N; the pedestal's tipping margin,
    m, negative where it would tip. left_domain_s is when one of these limits was first passed, None if none was.
    """

    pivot_friction_needed: float
    pivot_friction_needed_at_impact: float
    least_pivot_force_n: float
    least_floor_force_n: float
    pedestal_tipping_margin_m: float | None
    pedestal_tipping_margin_at_impact_m: float | None
    left_domain_s: float | None
    left_domain_by: str


# The solution that the kernel's records say.

LEFT_BY: Final = ("", "statue_slides", "contact_lost", "pedestal_tips", "beyond_base")
"""What each of the kernel's codes for a limit passed says: statue on its support, statue or pedestal in flight, pedestal, a lean
beyond the statue's base."""
NO_EVENTS: Final[Records] = np.zeros(0, EVENT_ROW)
NO_TIMES: Final[NDArray[np.float64]] = np.zeros(0)
NO_HISTORY: Final = (NO_TIMES,) * 5
"""The columns of a run without one."""


def _optional(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _event(given: tuple[Any, ...]) -> Event:
    """The event of a row of the kernel's table, whose fields are in the same order."""
    time_s, kind, pivot, *rest = given
    return Event(time_s, KINDS[kind], pivot if pivot >= 0 else None, *rest)


def peak_is_ahead(energy_endings: Any, peak_time_s: Any, end_s: Any) -> Any:
    """Whether the largest rotation is yet to come at a run's end, as its energy tells: of numbers, or of arrays of them (n,)."""
    return (energy_endings > 0) & (peak_time_s == end_s)


@final
@dataclass(frozen=True, eq=False)
class Solution:
    """One run: outcome, history on the grid 0, dt, 2dt, ... and at the last instant (arrays of equal length, empty in an
    outcome-only run), events, motion patterns, validity.

    overturn_time_s is the instant of the overturning limit and no_return_time_s the last outward crossing of the balance
    point before it; both None where they did not happen or where energy decided before them.
    """

    outcome: Outcome
    results: Results
    params: Params = field(repr=False)
    state: State = field(repr=False)
    counts: Counts = field(repr=False)
    """What it cost, what it left out, and how often it was in doubt."""
    event_rows: Records = field(repr=False)
    """The kernel's own records, made into what is asked of them when it is asked."""
    t_s: Floats = field(repr=False)
    """Times of the history, s (n,), and at each of them"""
    theta_rad: Floats = field(repr=False)
    """θ,"""
    theta_rate_rad_s: Floats = field(repr=False)
    """θ̇,"""
    slip_m: Floats = field(repr=False)
    """u and"""
    slip_rate_m_s: Floats = field(repr=False)
    """u̇."""

    @property
    def end_s(self) -> float:
        """When it ended, s."""
        return self.state.time_s

    @property
    def peak_theta_rad(self) -> float:
        """Largest |θ|."""
        return abs(self.results.peak_theta_rad)

    @property
    def peak_signed_rad(self) -> float:
        """θ where it was largest."""
        return self.results.peak_theta_rad

    @property
    def peak_time_s(self) -> float | None:
        """When it was; None where it is yet to come, as the energy at the run's end tells."""
        peak_s = self.results.peak_time_s
        return None if peak_is_ahead(self.counts.energy_endings, peak_s, self.end_s) else peak_s

    @property
    def peak_slip_m(self) -> float:
        """Largest |u|."""
        return self.results.peak_slip_m

    @property
    def final_slip_m(self) -> float:
        """u at the end."""
        return self.state.slip_m

    @property
    def overturn_time_s(self) -> float | None:
        """Instant of the overturning limit, s."""
        return _optional(self.results.overturn_time_s)

    @property
    def no_return_time_s(self) -> float | None:
        """Last outward crossing of the balance point before an overturning, s."""
        overturned = self.outcome in (Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT)
        return _optional(self.results.no_return_time_s) if overturned else None

    @property
    def energy_lost_j(self) -> float:
        """Energy lost at impacts, J."""
        return self.results.energy_lost_j

    @property
    def energy_gained_j(self) -> float:
        """Energy gained at impacts, J."""
        return self.results.energy_gained_j

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Every event, from the start to the end."""
        return tuple(_event(each) for each in self.event_rows.tolist())

    @cached_property
    def validity(self) -> Validity | None:
        """How far the run stayed inside the model, None where that was not kept."""
        r, on_pedestal = self.results, self.params.has_pedestal
        if not self.params.keep_validity:
            return None
        return Validity(
            pivot_friction_needed=r.pivot_friction,
            pivot_friction_needed_at_impact=r.pivot_friction_at_impact,
            least_pivot_force_n=r.least_pivot_normal_n,
            least_floor_force_n=r.least_floor_normal_n,
            pedestal_tipping_margin_m=_optional(r.tipping_margin_m) if on_pedestal else None,
            pedestal_tipping_margin_at_impact_m=_optional(r.tipping_margin_at_impact_m) if on_pedestal else None,
            left_domain_s=_optional(r.left_domain_s),
            left_domain_by=LEFT_BY[r.left_domain_by],
        )

    @property
    def impacts(self) -> tuple[Event, ...]:
        """The impacts."""
        return tuple(event for event in self.events if event.kind is EventKind.IMPACT)

    @property
    def _impact_rows(self) -> Records:
        return np.asarray(self.event_rows[self.event_rows["kind"] == KINDS.index(EventKind.IMPACT)])

    @property
    def impact_times_s(self) -> Floats:
        """Times of the impacts, s."""
        return np.asarray(self._impact_rows["time_s"])

    @property
    def impact_ratios(self) -> Floats:
        """Angular velocity after each impact over that before it; 0 where there was none."""
        rows = self._impact_rows
        before, after = rows["theta_rate_before_rad_s"], rows["theta_rate_after_rad_s"]
        return np.asarray(np.divide(after, before, out=np.zeros(before.size), where=before != 0.0))

    @property
    def ambiguous_times_s(self) -> Floats:
        """Times of the events after which several states of motion were possible, s."""
        return np.asarray(self.event_rows["time_s"][self.event_rows["feasible_states"] > 1])

    @property
    def uplift_times_s(self) -> Floats:
        """Times at which the statue left its rest, s."""
        rows = self.event_rows
        if not rows.size:
            return NO_TIMES
        rocks = rows["pivot"] >= 0
        # A start at an angle is no uplift.
        rested = np.concatenate([rows["theta_rad"][:1] == 0.0, ~rocks[:-1]])
        return np.asarray(rows["time_s"][rocks & rested])

    @property
    def patterns(self) -> tuple[Interval, ...]:
        """The motion patterns one after another, neighbours of the same pattern joined."""
        if not self.event_rows.size:
            return ()
        time_s, lasts = self.event_rows["time_s"], np.diff(self.event_rows["time_s"]) > 0.0
        kinds = 2 * (self.event_rows["pivot"] >= 0) + (self.event_rows["slide"] != 0)
        begin = np.flatnonzero(lasts)
        begin = begin[np.diff(kinds[begin], prepend=-1) != 0]
        ends = [*time_s[begin[1:]].tolist(), *time_s[-1:].tolist()]
        return tuple(map(Interval, time_s[begin].tolist(), ends, [PATTERNS[kind] for kind in kinds[begin].tolist()]))
