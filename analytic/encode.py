"""A problem as the compiled kernel reads it: records of numbers, and the samples of a motion."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np

from analytic.block import CHOICES, Friction
from analytic.errors import AnalyticInputError
from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration, ZeroExcitation
from analytic.kernel.codes import HARMONIC, NONE, PULSES, SAMPLED
from analytic.kernel.records import MAX_ORDER, Base, Floats, MotionParams, Params
from analytic.problem import Options, Problem

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


def _params(kind: int, peak: float, omega: float = 0.0, phase: float = 0.0, ramp: float = 0.0) -> MotionParams:
    return MotionParams(kind, peak, omega, phase, ramp, 0.0, 0.0, 1.0, 0, 0, 0)


STILL: Final = _params(NONE, 0.0)
"""No motion; not to be written to."""


def encode_motion(motion: Excitation) -> tuple[MotionParams, Floats, Floats]:
    """The motion's numbers, and its samples' times (n,) and accelerations (n,), empty unless it is a record: the numbers hold
    their addresses, so the caller keeps them alive.

    Raises AnalyticInputError for a motion that the kernel does not know.
    """
    if motion.peak_m_s2 == 0.0:
        return STILL, _EMPTY, _EMPTY
    if isinstance(motion, Harmonic):
        wave = motion.amplitude_m_s2, motion.omega_rad_s, motion.phase_rad, motion.ramp_s
        return _params(HARMONIC, *wave), _EMPTY, _EMPTY
    if isinstance(motion, Pulse):
        params = _params(PULSES[motion.shape], motion.amplitude_m_s2, motion.omega_rad_s)
        params.start_s, params.end_s = motion.start_s, motion.end_s
        return params, _EMPTY, _EMPTY
    if isinstance(motion, SampledAcceleration):
        times, samples = (np.ascontiguousarray(each, np.float64) for each in (motion.t_s, motion.samples_m_s2))
        params = _params(SAMPLED, motion.peak_m_s2)
        params.times, params.samples, params.n_samples = times.ctypes.data, samples.ctypes.data, times.size
        return params, times, samples
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
        statue_friction=problem.statue_friction,
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
        has_pedestal=pedestal is not None,
        pedestal_mass_kg=0.0,
        pedestal_width_m=0.0,
        pedestal_height_m=0.0,
        pedestal_centre_m=0.0,
        floor_static=0.0,
        floor_kinetic=0.0,
        floor_impact=0.0,
        wall_side=0,
        wall_m=math.inf,
        wall_pedestal_m=math.inf,
        wall_lever_m=0.0,
    )
    if pedestal is not None:
        params.pedestal_mass_kg = pedestal.mass_kg
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
