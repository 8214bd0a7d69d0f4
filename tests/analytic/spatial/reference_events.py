"""What ends a phase of the spatial reference, and the equations of motion in one joint state."""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq
from scipy.spatial import ConvexHull

from tests.analytic.spatial.reference_body import Array, Case, Kinematics, quaternion_rate, unforced
from tests.analytic.spatial.reference_contact import Answer, Joint, cone, edge_margin, respond

TOUCH_M = 1e-12
"""A vertex that leaves the floor without a velocity stays within rounding of it for some 1e-5 s: it lands this far below."""
STOP_M_S = 1e-10
"""A sliding vertex stops at this speed: what is left of it is taken away."""
SCAN_S = 1e-3
SETTLED_M_S, SETTLED_M = 1e-7, 1e-9
"""A vertex slower and nearer than this after an impact stays: chattering ends here."""


def direction_of(velocity: Array) -> Array:
    """The horizontal direction of a vertex's velocity."""
    return np.asarray(velocity[:2] / np.hypot(velocity[0], velocity[1]))


def force_in(case: Case, t: float, y: Array, joint: Joint, still: dict[int, Array] | None = None) -> Answer:
    """Accelerations and forces in a joint state; directions of sliding from the velocities unless they are given."""
    now = Kinematics.of(case, y)
    directions = {i: direction_of(now.velocities[i]) for i in joint.sliding if i not in (still or {})} | (still or {})
    return respond(case, joint, now.jacobians, unforced(case, t, y), now.centripetal, directions)


def rates(case: Case, t: float, y: Array, joint: Joint, still: dict[int, Array] | None = None) -> Array:
    """ẏ in a joint state."""
    motion = force_in(case, t, y, joint, still).motion
    return np.concatenate([y[3:6], motion[:3], quaternion_rate(y[6:10], y[10:13]), motion[3:]])


def events_of(
    case: Case, joint: Joint, start: Kinematics
) -> list[tuple[str, tuple[int, ...], Callable[[float, Array], float]]]:
    """The functions whose fall through zero ends a phase, with what it is called."""
    listed: list[tuple[str, tuple[int, ...], Callable[[float, Array], float]]] = []
    for i in range(len(case.vertices_m)):
        if i not in joint.contacts:
            deep = TOUCH_M if start.points[i, 2] <= SETTLED_M and start.velocities[i, 2] <= SETTLED_M_S else 0.0
            listed.append(("lands", (i,), lambda _t, y, i=i, deep=deep: Kinematics.of(case, y).points[i, 2] + deep))
    for i in joint.sliding:
        listed.append(("lifts", (i,), lambda t, y, i=i: force_in(case, t, y, joint).forces[i][2]))
        listed.append(
            ("stops", (i,), lambda _t, y, i=i: np.hypot(*Kinematics.of(case, y).velocities[i, :2]) - STOP_M_S)
        )
    for i in joint.sticking:
        listed.append(("lifts", (i,), lambda t, y, i=i: force_in(case, t, y, joint).forces[i][2]))
    if joint.sticking and not math.isinf(case.friction_static):
        listed.append(("slips", joint.sticking, lambda t, y: _holding(case, t, y, joint)))
    for _, _, function in listed:
        function.terminal, function.direction = True, -1.0  # type: ignore[attr-defined]
    return listed


def _holding(case: Case, t: float, y: Array, joint: Joint) -> float:
    """What is left of static friction at the sticking vertex or edge, N."""
    forces = force_in(case, t, y, joint).forces
    if len(joint.sticking) == 1:
        return cone(case.friction_static, forces[joint.sticking[0]])
    points = Kinematics.of(case, y).points[list(joint.sticking)]
    return edge_margin(case.friction_static, points, [forces[i] for i in joint.sticking])


def rest_margin(case: Case, t: float, y: Array, sticking: tuple[int, ...]) -> float:
    """Positive while a body at rest stays: gravity's line through the centroid meets the base inside its hull and its cone, m.

    All friction in proportion to N along the force then balances it, also about the vertical, so nothing less is needed.
    """
    g = case.gravity(t)
    if g[2] >= 0.0:
        return float(-g[2])
    corners = Kinematics.of(case, y).points[list(sticking), :2]
    pressure = y[:2] - y[2] / g[2] * g[:2]
    hull = ConvexHull(corners)
    inside = float(np.min(-(hull.equations[:, :2] @ pressure + hull.equations[:, 2])))
    if math.isinf(case.friction_static):
        return inside
    return min(inside, case.friction_static - float(np.hypot(g[0], g[1])) / -float(g[2]))


def rest_until(case: Case, t: float, y: Array, joint: Joint, stop: float) -> float:
    """When rest ends, by a scan of its margin and a root."""
    times = np.append(np.arange(t, stop, SCAN_S), stop)
    low = times[0]
    for high in times[1:]:
        if rest_margin(case, float(high), y, joint.sticking) < 0.0:
            return float(brentq(lambda s: rest_margin(case, s, y, joint.sticking), low, high, xtol=1e-15, rtol=1e-14))
        low = high
    return stop
