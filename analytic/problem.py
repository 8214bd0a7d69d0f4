"""What is to be computed (`Problem`) and how (`Options`), each stated once for one run, its certificate and an ensemble;
encoded.
"""

import math
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any, Final, Literal, Required, TypedDict, final

import numpy as np

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
from analytic.kernel.records import HARMONIC, MAX_ORDER, NONE, PULSES, SAMPLED, Base, Floats, MotionParams, Params

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
        friction = self.statue_friction
        require(friction >= 0.0, "statue_friction: a number from 0 is wanted, {!r} came.", friction)
        if self.wall is None:
            return
        gap_m = self.wall.gap_m(self.block, theta0_rad)
        told = "wall: a start before it is wanted, a statue that reaches {:.6g} m beyond it came."
        require(gap_m > 0.0, told, -gap_m)
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
        wave = HARMONIC, motion.amplitude_m_s2, motion.omega_rad_s
        return MotionParams(*wave, motion.phase_rad, motion.ramp_s), _EMPTY, _EMPTY
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
