"""The exact rigid body on a polygon of base vertices, once more: simple, slow, and written from its equations alone.

Each phase is one joint state (which touching vertices stick, slide, are free), integrated by DOP853 at 1e-12 to its first event:
a vertex lands, a normal force or the friction left vanishes, a sliding vertex stops, a motion breaks. After it the joint state
whose own accelerations keep its signs is chosen from all, most sticking first. Impacts are plastic in the normal direction and
Coulomb in the tangent, at all touching vertices at once. Rest holds while the line of action of gravity meets the base.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from tests.analytic.spatial.reference_body import Array, Case, Kinematics, snapped, unforced
from tests.analytic.spatial.reference_contact import Answer, Choice, FrictionParadox, Joint, answers, choose
from tests.analytic.spatial.reference_events import (
    SETTLED_M,
    SETTLED_M_S,
    direction_of,
    events_of,
    rates,
    rest_until,
)

RTOL, ATOL = 1e-12, 1e-13
STILL_M_S = 1e-9
BEGIN_S = 3e-5
"""The first step of sliding from rest, in which its direction is a straight line in time."""
LATER_S = 1e-6
"""A joint state whose sign vanishes continuously is followed by one chosen this much later, where it is strictly lost."""
EVENTS = 400
Given = Callable[[float], dict[int, Array] | None]
Dense = Callable[[float], Array]


@dataclass(frozen=True)
class Event:
    """What ended a phase, when, and at which vertices."""

    time_s: float
    kind: str
    vertices: tuple[int, ...] = ()


@dataclass(frozen=True)
class Run:
    """States on the output times (n, 13), events and joint states in order, and how it ended: ran, or friction_paradox."""

    times_s: Array
    states: Array
    events: list[Event]
    joints: list[Joint]
    outcome: str

    def impacts(self) -> list[Event]:
        """The impacts alone."""
        return [event for event in self.events if event.kind == "impact"]


def initial_state(
    position_m: Array,
    quaternion_wxyz: Array | None = None,
    velocity_m_s: Array | None = None,
    angular_velocity_rad_s: Array | None = None,
) -> Array:
    """A state from its parts; upright and still where nothing is said."""
    q = np.array([1.0, 0.0, 0.0, 0.0]) if quaternion_wxyz is None else np.asarray(quaternion_wxyz, dtype=float)
    v = np.zeros(3) if velocity_m_s is None else velocity_m_s
    omega = np.zeros(3) if angular_velocity_rad_s is None else angular_velocity_rad_s
    return np.concatenate([position_m, v, q / np.linalg.norm(q), omega]).astype(float)


def simulate(case: Case, start: Array, times_s: Array, *, max_events: int = EVENTS) -> Run:
    """Run a case from a state at times_s[0], with its states at times_s (after an event that falls on one: those before it)."""
    states = np.full((len(times_s), 13), np.nan)
    states[0] = start
    events: list[Event] = []
    joints: list[Joint] = []
    t, y, end = float(times_s[0]), start.copy(), float(times_s[-1])
    stops = sorted({b for b in case.breaks_s if t < b < end} | {end})
    previous: Joint | None = None
    outcome = "ran"
    try:
        y, touching = _impact(case, y)
        if touching:
            events.append(Event(t, "impact", touching))
        while len(events) < max_events:
            answer, y = _enter(case, t, y, previous)
            joints.append(answer.joint)
            stop = next(s for s in stops if s > t)
            after, kind, vertices, dense = _advance(case, t, y, answer, stop)
            inside = (times_s > t) & (times_s <= after)
            states[inside] = np.reshape([dense(s) for s in times_s[inside]], (-1, 13))
            y, t, previous = dense(after), after, answer.joint if kind in ("lifts", "slips", "unrest") else None
            if after >= end:
                break
            if kind == "lands":
                y, touching = _impact(case, y, vertices)
                events.append(Event(t, "impact", touching or vertices))
            else:
                events.append(Event(t, kind, vertices))
        else:
            outcome = "too many events"
    except FrictionParadox:
        outcome = "friction_paradox"
    return Run(times_s, states, events, joints, outcome)


def _impact(case: Case, y: Array, landing: tuple[int, ...] = ()) -> tuple[Array, tuple[int, ...]]:
    """The state after an impact at all vertices that touch, and these; the state as it is if none goes down."""
    now = Kinematics.of(case, y)
    touching = tuple(i for i, p in enumerate(now.points) if p[2] <= SETTLED_M or i in landing)
    if not any(now.velocities[i, 2] < -STILL_M_S for i in touching):
        return y, ()
    scale = float(np.max(np.abs(now.velocities)))
    choice = Choice(now.points, now.jacobians, now.speeds, np.zeros((len(now.points), 3)), touching, {}, scale)
    answer = choose(case, choice)
    fresh = y.copy()
    fresh[3:6], fresh[10:13] = answer.motion[:3], answer.motion[3:]
    return fresh, touching


def _enter(case: Case, t: float, y: Array, lost: Joint | None) -> tuple[Answer, Array]:
    """The joint state from here on, and the state made exact for it.

    lost: the joint state whose own sign has just vanished, continuously. At that instant its successors are borderline too, so
    they are chosen a moment later, where it is strictly lost; directions in which sliding begins are taken back to t.
    """
    now = Kinematics.of(case, y)
    near = [i for i, p in enumerate(now.points) if p[2] <= SETTLED_M and now.velocities[i, 2] <= SETTLED_M_S]
    y = snapped(case, y, near, [i for i in near if np.hypot(*now.velocities[i, :2]) <= STILL_M_S])
    if lost is None:
        return choose(case, _choice(case, t, y, near)), y
    choices = [_choice(case, t + k * LATER_S, _step(case, t, y, lost, k * LATER_S), near) for k in (1, 2)]
    answer = choose(case, choices[0], lost)
    starting = [i for i in answer.joint.sliding if i not in choices[0].moving]
    if starting:
        early = [math.atan2(*answer.directions[i][::-1]) for i in starting]
        late = next(iter(answers(case, choices[1], answer.joint, np.array(early)))).directions
        turned = np.array([math.atan2(*late[i][::-1]) for i in starting]) - early
        back = early - (turned + math.pi) % (2.0 * math.pi) + math.pi
        answer.directions.update({i: np.array([math.cos(a), math.sin(a)]) for i, a in zip(starting, back, strict=True)})
    return answer, y


def _choice(case: Case, t: float, y: Array, near: list[int]) -> Choice:
    """What the joint state at an instant is chosen from."""
    now = Kinematics.of(case, y)
    moving = {i: direction_of(now.velocities[i]) for i in near if np.hypot(*now.velocities[i, :2]) > STILL_M_S}
    free = unforced(case, t, y)
    return Choice(now.points, now.jacobians, free, now.centripetal, tuple(near), moving, case.gravity_m_s2)


def _step(case: Case, t: float, y: Array, joint: Joint, h: float, given: Given = lambda _t: None) -> Array:
    """One classical Runge-Kutta step in a joint state (still at rest)."""
    if len(joint.sticking) >= 3:
        return y
    k1 = rates(case, t, y, joint, given(t))
    k2 = rates(case, t + h / 2, y + h / 2 * k1, joint, given(t + h / 2))
    k3 = rates(case, t + h / 2, y + h / 2 * k2, joint, given(t + h / 2))
    k4 = rates(case, t + h, y + h * k3, joint, given(t + h))
    return np.asarray(y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))


def _advance(case: Case, t: float, y: Array, answer: Answer, stop: float) -> tuple[float, str, tuple[int, ...], Dense]:
    """From a state to the first event or the stop: its time, kind and vertices, and the states up to it."""
    joint = answer.joint
    if len(joint.sticking) >= 3:
        after = rest_until(case, t, y, joint, stop)
        return after, "unrest" if after < stop else "break", joint.sticking, lambda _s: y
    now = Kinematics.of(case, y)
    starting = {i: answer.directions[i] for i in joint.sliding if np.hypot(*now.velocities[i, :2]) <= STILL_M_S}
    t1, y1, first = t, y, None
    if starting:
        t1 = min(t + BEGIN_S, 0.5 * (t + stop))
        first = _begin(case, t, y, joint, starting, t1)
        y1 = first(t1)
    leaving = [v for i, v in enumerate(now.velocities[:, 2]) if now.points[i, 2] <= SETTLED_M and v > SETTLED_M_S]
    functions = events_of(case, joint, now)
    run = solve_ivp(
        lambda s, x: rates(case, s, x, joint),
        (t1, stop),
        y1,
        method="DOP853",
        rtol=RTOL,
        atol=ATOL,
        events=[function for _, _, function in functions],
        dense_output=True,
        max_step=0.02,
        first_step=min([1e-6, 0.5 * (stop - t1), *(0.1 * v / case.gravity_m_s2 for v in leaving)]),
    )
    assert run.success, run.message
    after = float(run.t[-1])
    struck = [(kind, vertices) for (kind, vertices, _), at in zip(functions, run.t_events, strict=True) if len(at)]
    kind, vertices = struck[0] if struck else ("break", ())

    def dense(s: float) -> Array:
        x = first(s) if first is not None and s <= t1 else run.sol(s)
        x[6:10] /= np.linalg.norm(x[6:10])
        return np.asarray(x)

    return after, kind, vertices, dense


def _begin(case: Case, t: float, y: Array, joint: Joint, starting: dict[int, Array], t1: float) -> Dense:
    """Sliding from rest: directions that turn evenly, such that each is that of its velocity at t1."""
    order = list(starting)
    angles = np.array([math.atan2(starting[i][1], starting[i][0]) for i in order])

    def to(s: float, turning: Array) -> Array:
        def given(at: float) -> dict[int, Array]:
            now = angles + turning * (at - t)
            return {i: np.array([math.cos(a), math.sin(a)]) for i, a in zip(order, now, strict=True)}

        return _step(case, t, y, joint, s - t, given)

    def missed(turning: Array) -> Array:
        velocities = Kinematics.of(case, to(t1, turning)).velocities[order, :2]
        now = angles + turning * (t1 - t)
        across = -velocities[:, 0] * np.sin(now) + velocities[:, 1] * np.cos(now)
        return np.asarray(across / np.maximum(np.hypot(velocities[:, 0], velocities[:, 1]), 1e-16))

    turning = root(missed, np.zeros(len(order)), method="hybr", options={"eps": 1e-3}).x
    return lambda s: to(s, turning)
