"""One run of the two-block model: plain numbers in, a frozen solution out."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from analytic.block import Block, Form, Friction, Pedestal, Wall, positive
from analytic.encode import encode
from analytic.errors import AnalyticInputError
from analytic.excitation import Excitation, Rest
from analytic.kernel import layout as at
from analytic.kernel.integrator import run
from analytic.results import Finished, read
from analytic.solution import Solution

OVERTURN_RAD: Final = 1.5
"""Rotation at which a statue counts as overturned."""
FIRST_EVENTS: Final = 256
"""Rows of the event table at the first try; a run that has more is repeated with enough."""
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


def order_for(tolerance: float) -> int:
    """Order of the Taylor step that is cheapest at a local tolerance: two above Jorba and Zou's 1 − ln(tol)/2, which counts the
    terms alone and not what every step costs besides."""
    return int(min(max(math.ceil(3.0 - 0.5 * math.log(tolerance)), 6), at.MAX_ORDER))


def parameters(
    block: Block,
    *,
    pedestal: Pedestal | None,
    friction: Friction,
    statue_friction: float,
    form: Form,
    theta0_rad: float,
    theta_rate0_rad_s: float,
    duration_s: float,
    gravity_m_s2: float,
    wall: Wall | None,
    overturn_rad: float,
    accuracy_rad: float,
    dt_s: float | None,
    step_cap_s: float,
    skip_start: bool,
    skip_rest: bool,
    skip_energy: bool,
    validity: bool,
) -> at.Floats:
    """The kernel's row of numbers; raises AnalyticInputError for what cannot be run."""
    positive(duration_s=duration_s, gravity_m_s2=gravity_m_s2, accuracy_rad=accuracy_rad, overturn_rad=overturn_rad)
    if not overturn_rad < 0.5 * math.pi or not abs(theta0_rad) < overturn_rad or not math.isfinite(theta_rate0_rad_s):
        wanted = f"|theta0_rad| < overturn_rad < π/2 and a finite rate are wanted, {theta0_rad!r}, {overturn_rad!r},"
        raise AnalyticInputError(f"{wanted} {theta_rate0_rad_s!r} came.")
    if dt_s is not None:
        positive(dt_s=dt_s)
    if not statue_friction >= 0.0:
        raise AnalyticInputError(f"statue_friction: a number from 0 is wanted, {statue_friction!r} came.")
    if not step_cap_s > 0.0:
        raise AnalyticInputError(f"step_cap_s: a positive number is wanted, {step_cap_s!r} came.")
    tolerance = max(accuracy_rad * LOCAL_SHARE, FINEST)
    p = np.zeros(at.N_PARAMETERS)
    p[at.MASS], p[at.CENTROID], p[at.INERTIA] = block.mass_kg, block.centroid_height_m, block.inertia_kg_m2
    p[at.GRAVITY], p[at.DURATION], p[at.OVERTURN] = gravity_m_s2, duration_s, overturn_rad
    p[at.STATUE_FRICTION] = statue_friction
    p[at.THETA0], p[at.OMEGA0] = theta0_rad, theta_rate0_rad_s
    p[at.RATIO] = -1.0 if form.restitution is None else form.restitution
    p[at.DYNAMIC] = form.friction_normal == "dynamic"
    p[at.MOMENTUM] = form.pedestal_at_impact == "momentum"
    p[at.TOLERANCE], p[at.ORDER], p[at.STEP_CAP] = tolerance, order_for(tolerance), step_cap_s
    balanced = pedestal is None or (p[at.DYNAMIC] > 0.0 and p[at.MOMENTUM] > 0.0)
    p[at.REST_ANGLE] = max(tolerance, FINEST_REST_RAD) if balanced else max(accuracy_rad, FINEST_ROOT_RAD) ** 2
    p[at.GRID_STEP] = 0.0 if dt_s is None else dt_s
    p[at.SKIP_START], p[at.SKIP_REST] = skip_start, skip_rest
    p[at.SKIP_ENERGY], p[at.WANT_VALIDITY] = skip_energy, validity
    p[at.TIME_SCALE] = 1.0 / max(block.p_rad_s(1, gravity_m_s2), block.p_rad_s(-1, gravity_m_s2))
    if pedestal is not None:
        p[at.HAS_BASE], p[at.BASE_MASS] = 1.0, pedestal.mass_kg
        p[at.BASE_WIDTH], p[at.BASE_HEIGHT] = pedestal.width_m, pedestal.height_m
        p[at.BASE_CENTRE] = 0.5 * (block.profile_m[0][0] + block.profile_m[-1][0]) + pedestal.offset_m
        p[at.MU_STATIC], p[at.MU_KINETIC] = friction.static, friction.kinetic
    if wall is not None and math.isfinite(wall.rotation_rad):
        p[at.WALL_SIDE], p[at.WALL_ROTATION] = wall.sign, wall.rotation_rad
    return p


def prepare(block: Block, p: at.Floats, motion_x: Excitation, motion_z: Excitation, event_rows: int) -> Finished:
    """Everything that one run reads and writes, freshly allocated."""
    fx, times_x, samples_x = encode(motion_x)
    fz, times_z, samples_z = encode(motion_z)
    dt = float(p[at.GRID_STEP])
    instants = math.floor(float(p[at.DURATION]) / dt * (1.0 + 1e-12)) + 2 if dt > 0.0 else 0
    history, events = np.zeros((5, instants)), np.zeros((event_rows, at.N_EVENT))
    records = times_x, times_z, samples_x, samples_z
    return Finished(np.zeros(1, at.RUN), (p, fx, fz, *block.arrays, *records, history, events))


def simulate(
    block: Block,
    motion_x: Excitation,
    motion_z: Excitation | None = None,
    *,
    pedestal: Pedestal | None = None,
    floor_static: float = 0.0,
    floor_kinetic: float = 0.0,
    form: Form | None = None,
    theta0_rad: float = 0.0,
    theta_rate0_rad_s: float = 0.0,
    statue_friction: float = math.inf,
    duration_s: float,
    gravity_m_s2: float = 9.81,
    wall: Wall | None = None,
    overturn_rad: float = OVERTURN_RAD,
    accuracy_rad: float = 1e-12,
    dt_s: float | None = 0.001,
    step_cap_s: float = math.inf,
    skip_start: bool = True,
    skip_rest: bool = True,
    skip_energy: bool = True,
    events: bool = True,
    validity: bool = True,
) -> Solution:
    """Run the model of docs/model.md, sections 1 to 5 and 8.

    motion_x, motion_z: floor's accelerations; floor_static, floor_kinetic: friction of the pedestal on the floor;
    statue_friction: friction between statue and support, assumed to hold and compared with what was needed; accuracy_rad: aimed
    global error (errors grow after many impacts: see ``certify``); dt_s: output step, None for the outcome only; step_cap_s:
    longest step; skip_start, skip_rest: leave out the times in which nothing can move, before anything has moved and after;
    skip_energy: without a history, let the energy decide once the motion is over; events, validity: keep them.
    Raises AnalyticInputError for numbers that cannot be run.
    """
    p = parameters(
        block,
        pedestal=pedestal,
        friction=Friction(floor_static, floor_kinetic),
        form=form if form is not None else Form(),
        statue_friction=statue_friction,
        theta0_rad=theta0_rad,
        theta_rate0_rad_s=theta_rate0_rad_s,
        duration_s=duration_s,
        gravity_m_s2=gravity_m_s2,
        wall=wall,
        overturn_rad=overturn_rad,
        accuracy_rad=accuracy_rad,
        dt_s=dt_s,
        step_cap_s=step_cap_s,
        skip_start=skip_start,
        skip_rest=skip_rest,
        skip_energy=skip_energy,
        validity=validity,
    )
    motion_z = motion_z if motion_z is not None else Rest()
    task = prepare(block, p, motion_x, motion_z, FIRST_EVENTS if events else 0)
    run(task.runs, *task.arguments)
    if events and task.c[at.EVENTS] > FIRST_EVENTS:
        task = prepare(block, p, motion_x, motion_z, int(task.c[at.EVENTS]))
        run(task.runs, *task.arguments)
    return read(task)
