"""Contact of the spatial reference: forces in one joint state, and the joint state that keeps its own signs.

The same equations serve forces and impulses: `free` is the motion without contact (accelerations, or velocities before an
impact), `drift` what the constraints add to it (centripetal accelerations, or nothing).
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog, root

from tests.analytic.spatial.reference_body import Array, Case

SIGNS = 1e-8
"""A sign counts as kept down to this share of the scale (gravity, or the speed before an impact): events are located, and
constraints drift, by less."""
CUTS = 60
STARTS = 4
DIRECTION = 1e-10


class FrictionParadox(Exception):
    """No joint state keeps its own signs."""


@dataclass(frozen=True)
class Joint:
    """Which touching vertices stick and which slide; the others that touch are free."""

    sticking: tuple[int, ...] = ()
    sliding: tuple[int, ...] = ()

    @property
    def contacts(self) -> list[int]:
        """All that hold a force."""
        return sorted(self.sticking + self.sliding)


@dataclass(frozen=True)
class Answer:
    """The motion in one joint state, the forces on its vertices (floor's frame), and the directions of sliding."""

    joint: Joint
    motion: Array
    forces: dict[int, Array]
    directions: dict[int, Array]


def respond(
    case: Case, joint: Joint, jacobians: Array, free: Array, drift: Array, directions: dict[int, Array]
) -> Answer:
    """The motion with v_i (or a_i) = 0 at sticking vertices, z only at sliding ones with T = −μ_k N d.

    Where the split of forces is not determined, that of least squares (vertices as equal springs).
    """
    if not joint.contacts:
        return Answer(joint, free, {}, {})
    basis, rows, wanted, place = [], [], [], []
    for i in joint.contacts:
        if i in joint.sticking:
            basis.append(np.eye(3))
            rows.append(jacobians[i])
            wanted.append(-(jacobians[i] @ free + drift[i]))
        else:
            d = directions[i]
            basis.append(np.array([[-case.friction_kinetic * d[0]], [-case.friction_kinetic * d[1]], [1.0]]))
            rows.append(jacobians[i][2:])
            wanted.append(-(jacobians[i][2:] @ free + drift[i][2:]))
        place.extend([i] * basis[-1].shape[1])
    generalised = np.hstack([jacobians[i].T @ b for i, b in zip(joint.contacts, basis, strict=True)])
    matrix = np.vstack(rows) @ case.inverse_mass @ generalised
    x = np.linalg.lstsq(matrix, np.concatenate(wanted), rcond=1e-11)[0]
    forces = {
        i: b @ x[[k for k, at in enumerate(place) if at == i]] for i, b in zip(joint.contacts, basis, strict=True)
    }
    return Answer(joint, free + case.inverse_mass @ (generalised @ x), forces, directions)


def cone(mu: float, force: Array) -> float:
    """μN − |T|, N alone where friction is infinite."""
    return float(force[2] if math.isinf(mu) else mu * force[2] - np.hypot(force[0], force[1]))


def edge_margin(mu: float, points: Array, forces: Sequence[Array]) -> float:
    """Positive while some split along the edge keeps both forces in their cones: |P| < Σ √(μ²N² − c²).

    N and c are the forces' parts upwards and across the edge, P their sum along it, of which the split is open.
    """
    both = np.array(forces)
    normal = both[:, 2]
    if math.isinf(mu):
        return float(np.min(normal))
    along = points[1, :2] - points[0, :2]
    along = along / np.linalg.norm(along)
    across = both[:, :2] @ np.array([-along[1], along[0]])
    left = mu * normal - np.abs(across)
    room = np.sqrt(np.maximum(left * (mu * normal + np.abs(across)), 0.0))
    return float(min(np.min(left), np.sum(room) - abs(float(np.sum(both[:, :2] @ along)))))


def base_margin(mu: float, jacobians: Array, total: Array) -> float:
    """max min (μN_i − |T_i|) over the forces at all vertices that together give `total`: a cone program by cutting planes."""
    n = len(jacobians)
    size = max(float(np.linalg.norm(total)), 1e-300)
    balance = np.hstack([*(j.T for j in jacobians), np.zeros((6, 1))])
    cuts = [(i, np.array([math.cos(a), math.sin(a)])) for i in range(n) for a in np.arange(8) * math.pi / 4.0]
    best = -math.inf
    for _ in range(CUTS):
        above = np.zeros((len(cuts), 3 * n + 1))
        for row, (i, d) in enumerate(cuts):
            above[row, 3 * i : 3 * i + 2] = 0.0 if math.isinf(mu) else d
            above[row, 3 * i + 2], above[row, -1] = (-1.0 if math.isinf(mu) else -mu), 1.0
        cost = np.zeros(3 * n + 1)
        cost[-1] = -1.0
        free = [(None, None)] * (3 * n) + [(None, 10.0)]
        done = linprog(
            cost, A_ub=above, b_ub=np.zeros(len(cuts)), A_eq=balance, b_eq=total / size, bounds=free, method="highs"
        )
        if done.status != 0:
            return -math.inf
        forces = done.x[:-1].reshape(n, 3)
        best = min(cone(mu, force) for force in forces)
        if best > done.x[-1] - 1e-9:
            break
        cuts.extend((i, f[:2] / np.hypot(f[0], f[1])) for i, f in enumerate(forces) if np.hypot(f[0], f[1]) > 0.0)
    return best * size


def sticking_margin(case: Case, answer: Answer, points: Array, jacobians: Array) -> float:
    """By how much the sticking vertices stay within static friction."""
    sticking, mu = answer.joint.sticking, case.friction_static
    if len(sticking) == 1:
        return cone(mu, answer.forces[sticking[0]])
    if len(sticking) == 2:
        return edge_margin(mu, points[list(sticking)], [answer.forces[i] for i in sticking])
    total = sum((jacobians[i].T @ answer.forces[i] for i in sticking), np.zeros(6))
    return base_margin(mu, jacobians[list(sticking)], total)


def candidates(touching: Sequence[int], moving: Sequence[int], *, slippery: bool = True) -> Iterator[Joint]:
    """All joint states, most sticking first.

    Nothing slides unless `slippery`. With two sticking vertices a third that touches cannot slide; with three all are still.
    """
    options = [("free", "slide") if i in moving else ("free", "slide", "stick") for i in touching]
    every = []
    for pick in itertools.product(*options):
        sticking = tuple(i for i, how in zip(touching, pick, strict=True) if how == "stick")
        sliding = tuple(i for i, how in zip(touching, pick, strict=True) if how == "slide")
        if (
            (sliding and not slippery)
            or (len(sticking) >= 2 and sliding)
            or (len(sticking) >= 3 and len(sticking) < len(touching))
        ):
            continue
        every.append(Joint(sticking, sliding))
    return iter(sorted(every, key=lambda joint: (-len(joint.sticking), -len(joint.sliding))))


@dataclass(frozen=True)
class Choice:
    """What a joint state is chosen from: vertices that touch, those that slide already (their directions), and the motion."""

    points: Array
    jacobians: Array
    free: Array
    drift: Array
    touching: tuple[int, ...]
    moving: dict[int, Array]
    scale: float


def choose(case: Case, choice: Choice, excluded: Joint | None = None) -> Answer:
    """The joint state that keeps its own signs, most sticking first. Raises `FrictionParadox`."""
    for joint in candidates(choice.touching, list(choice.moving), slippery=not math.isinf(case.friction_kinetic)):
        for answer in answers(case, choice, joint) if joint != excluded else ():
            if keeps_signs(case, choice, answer):
                return answer
    raise FrictionParadox


def keeps_signs(case: Case, choice: Choice, answer: Answer) -> bool:
    """N ≥ 0, friction within its cone, and nothing that touches goes down."""
    tiny = SIGNS * choice.scale
    after = choice.jacobians @ answer.motion + choice.drift
    rising = all(after[i, 2] >= -tiny for i in choice.touching)
    pressing = all(answer.forces[i][2] >= -tiny * case.mass_kg for i in answer.joint.sliding)
    if not rising or not pressing:
        return False
    if not answer.joint.sticking:
        return True
    return sticking_margin(case, answer, choice.points, choice.jacobians) >= -tiny * case.mass_kg


def answers(case: Case, choice: Choice, joint: Joint, first: Array | None = None) -> Iterator[Answer]:
    """The motions of one joint state: one, or as many as there are directions in which its still vertices can begin to slide."""

    def response(angles: Array) -> Answer:
        fresh = {i: np.array([math.cos(a), math.sin(a)]) for i, a in zip(starting, angles, strict=True)}
        return respond(case, joint, choice.jacobians, choice.free, choice.drift, choice.moving | fresh)

    def along(angles: Array, *, across: bool) -> Array:
        answer = response(angles)
        after = choice.jacobians @ answer.motion + choice.drift
        d = np.array([answer.directions[i] for i in starting])
        turned = np.stack([-d[:, 1], d[:, 0]], axis=1) if across else d
        return np.asarray(np.sum(turned * after[list(starting), :2], axis=1) / choice.scale)

    starting = [i for i in joint.sliding if i not in choice.moving]
    if not starting:
        yield response(np.empty(0))
        return
    guesses = _starts(case, choice, joint, starting)
    for start in guesses if first is None else (first, *guesses):
        if np.max(np.abs(along(start, across=True))) < DIRECTION and np.min(along(start, across=False)) >= -SIGNS:
            yield response(start)
            continue
        solution = root(lambda angles: along(angles, across=True), start, method="hybr", options={"xtol": 1e-14})
        if np.max(np.abs(solution.fun)) < DIRECTION and np.min(along(solution.x, across=False)) >= -SIGNS:
            yield response(solution.x)


def _starts(case: Case, choice: Choice, joint: Joint, starting: Sequence[int]) -> Iterator[Array]:
    """First guesses of the directions: against the force with which they would stick, with the free motion, and all round."""
    held = respond(
        case,
        Joint(tuple(sorted((*joint.sticking, *starting))), tuple(i for i in joint.sliding if i in choice.moving)),
        choice.jacobians,
        choice.free,
        choice.drift,
        choice.moving,
    )
    yield np.array([math.atan2(-held.forces[i][1], -held.forces[i][0]) for i in starting])
    together = sum((held.forces[i][:2] for i in starting), np.zeros(2))
    yield np.full(len(starting), math.atan2(-together[1], -together[0]))
    loose = choice.jacobians @ choice.free + choice.drift
    yield np.array([math.atan2(loose[i, 1], loose[i, 0]) for i in starting])
    for k in range(STARTS):
        yield np.full(len(starting), 2.0 * math.pi * k / STARTS)
