"""The statue and its pedestal as Bullet takes them: what can touch, how the statue stands at first, collision shapes."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import permutations
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
import pybullet
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from harness.engines.base import EngineFailure
from harness.engines.stepping.step_state import past_edge_m
from harness.engines.stepping.trajectory import ALONE, Row, Vector, matrices
from harness.model import OVERTURN_RAD, Array, Pedestal, Scene, Statue
from harness.statics.plan import SAME, shape_needed
from meshes.solid import thinned

# When the pedestal's edge can meet the statue: only if some part of the statue comes to or below the top's plane beside it.
#
# Above that plane nothing but the plane itself can touch a convex body, and it does so at vertices: the feet are exact. Beside
# the top that plane is not there: a vertex about to come down to it must find the pedestal's edges instead.


DEPTH_M: Final = 1e-4
"""Nearer than this a vertex counts as touching; deeper is beyond any contact's penetration, and where the inset hull begins."""


FLUSH_M: Final = 1e-6
"""A foot no further past an edge than this stands over the top: bases are as wide as pedestals."""


@dataclass(frozen=True, eq=False)
class EdgeCrossing:
    """Called with a row, says whether a foot has come over the edges of the pedestal's top, or back over it, since `start`."""

    feet_m: Array
    across_m: tuple[float, float]
    start: Row

    @cached_property
    def beside(self) -> NDArray[np.bool_]:
        """Which feet (k,) stand beside the top."""
        return past_edge_m(self.feet_m, self.start, self.across_m) > FLUSH_M

    def __call__(self, row: Row) -> bool:
        past = past_edge_m(self.feet_m, row, self.across_m)
        return bool(np.where(self.beside, past < -DEPTH_M, past > DEPTH_M).any())


@dataclass(frozen=True, eq=False)
class EdgeWatch:
    """Called with a row, says whether the statue reaches below the pedestal's top beside it, or may do so before the next look.

    `points_m` (n, 3) are the vertices of the statue's hull about its centroid, in its principal frame; `half_m` the pedestal's
    half width, depth and height; `ahead_s` the longest time between two looks; `pull_m_s2` bounds what weight and table do.
    """

    points_m: Array
    half_m: tuple[float, float, float]
    ahead_s: float = 0.0
    pull_m_s2: float = 0.0

    @cached_property
    def radius_m(self) -> float:
        """Distance of the furthest vertex from the centroid."""
        return float(np.max(np.linalg.norm(self.points_m, axis=1)))

    def __call__(self, row: Row) -> bool:
        # Everything along the axes of the pedestal's top: the statue's place, velocity and rotation, both rates.
        top, statue = matrices(np.array([row[16:20], row[3:7]]))
        state, below = np.array(row[:ALONE]), np.array(row[ALONE:])
        place, velocity = (state[0:3] - below[0:3]) @ top, (state[7:10] - below[7:10]) @ top
        rate, rate_below = state[10:13] @ top, below[10:13] @ top
        arms = self.points_m @ (top.T @ statue).T
        lowest = float(arms[:, 2].min()) + place[2] - self.half_m[2]
        spin = math.hypot(*rate) + math.hypot(*rate_below)
        # A point's acceleration is at most what pulls the body, twice over, and what keeps it on its circle.
        slack = (self.pull_m_s2 + 0.5 * self.radius_m * spin**2) * self.ahead_s**2
        reach = (math.hypot(*velocity) + self.radius_m * spin) * self.ahead_s + slack
        if lowest >= DEPTH_M + reach:
            return False
        if lowest < -DEPTH_M:
            return True
        arms = arms[arms[:, 2] < DEPTH_M + reach + self.half_m[2] - place[2]]
        # A point at p from the centroid moves by v + ω × p − ω_top × (b + p) against the top.
        moving = velocity - place @ _turning(rate_below) + arms @ _turning(rate - rate_below)
        points = arms + place - (0.0, 0.0, self.half_m[2])
        then = points + self.ahead_s * moving
        down = np.minimum(points[:, 2], then[:, 2] - slack) < DEPTH_M
        furthest = np.maximum(np.abs(points[down, :2]), np.abs(then[down, :2]))
        return bool((furthest > (self.half_m[0] + DEPTH_M, self.half_m[1] + DEPTH_M)).any())


Ints = NDArray[np.int64]

# A plane touches a rigid body only at vertices of its convex hull, whatever lies between them: one small sphere at each such
# vertex is the body's exact contact with floor and wall, with one fixed contact point each.


REST_LEAN_RAD: Final = 0.2
"""A facet on which the statue rests leans less than this, or the scan was not stood upright."""
FLAT_RAD: Final = 1e-9
"""A lean below this is none: rounding of the hull's normals."""

OTHER_TWO: Final = np.array([[1, 2], [0, 2], [0, 1]])
"""The vertices of a facet without one of them."""
CACHED_STATUES: Final = 8
"""Statues whose vertices are remembered: each level of a climb and each amplitude of a search takes the same."""


@dataclass(frozen=True, eq=False)
class Rest:
    """How the statue stands when nothing moves: `rotation` (3, 3) from its frame, `lean_rad` of its axis, whether found."""

    rotation: Array
    lean_rad: float
    stable: bool


@lru_cache(maxsize=CACHED_STATUES)
def touchable(statue: Statue, lean_rad: float = OVERTURN_RAD) -> Array:
    """Vertices (k, 3), statue frame, that a level support can touch while the statue leans up to `lean_rad` in any direction.

    On the Gaussian sphere the facets' outward normals bound the region of each vertex; a vertex counts when the edges of its
    region come within `lean_rad` of straight down, or when its region holds it.
    """
    vertices, hull = _hull(statue)
    if hull is None:
        return statue.footprint_m
    lean = np.arccos(np.clip(-hull.equations[:, 2], -1.0, 1.0))
    chosen = set(np.unique(hull.simplices[lean <= lean_rad]).tolist())
    chosen.add(int(np.argmin(vertices[:, 2])))
    # Each edge once: its two facets, and which vertex of the first lies opposite.
    facets, opposite = np.nonzero(hull.neighbors > np.arange(len(hull.neighbors))[:, None])
    others = hull.neighbors[facets, opposite]
    near = _arc_leans(hull.equations[facets, :3], hull.equations[others, :3]) <= lean_rad
    chosen.update(hull.simplices[facets[near, None], OTHER_TWO[opposite[near]]].ravel().tolist())
    return np.asarray(vertices[sorted(chosen)])


@lru_cache(maxsize=CACHED_STATUES)
def hull_vertices(statue: Statue) -> Array:
    """All vertices (k, 3) of the statue's convex hull, statue frame; of a block given by numbers its eight corners."""
    vertices, hull = _hull(statue)
    if hull is None:
        top = statue.footprint_m + np.array([0.0, 0.0, statue.height_m])
        return np.vstack([statue.footprint_m, top])
    return np.asarray(vertices[np.sort(hull.vertices)])


@lru_cache(maxsize=CACHED_STATUES)
def rest_of(statue: Statue) -> Rest:
    """The pose on the facet, nearest to upright, over which the centroid stands; upright when no such facet is found."""
    vertices, hull = _hull(statue)
    if hull is None:
        return Rest(np.eye(3), 0.0, True)
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    normals = hull.equations[:, :3]
    lean = np.arccos(np.clip(-normals[:, 2], -1.0, 1.0))
    # From the least lean on: the first that carries the centroid is nearest to upright.
    for facet in np.argsort(lean):
        if lean[facet] > REST_LEAN_RAD:
            break
        if _over(vertices[hull.simplices[facet]], normals[facet], centroid):
            if lean[facet] <= FLAT_RAD:
                return Rest(np.eye(3), 0.0, True)
            return Rest(_turn_down(normals[facet]), float(lean[facet]), True)
    return Rest(np.eye(3), 0.0, False)


def _hull(statue: Statue) -> tuple[Array, ConvexHull | None]:
    if statue.solid is None:
        return statue.footprint_m, None
    vertices = statue.solid.vertices_m
    return vertices, ConvexHull(vertices)


def _arc_leans(a: Array, b: Array) -> Array:
    """Least angles (n,) between straight down and the arcs from unit normals `a` to `b` (n, 3)."""
    down, pole = np.array([0.0, 0.0, -1.0]), np.cross(a, b)
    size = np.linalg.norm(pole, axis=1)
    # Of two normals that are one the arc is a point.
    arc = size >= 1e-12
    nearest = down + (pole[:, 2] / np.where(arc, size, 1.0) ** 2)[:, None] * pole
    inside = arc & (np.sum(np.cross(a, nearest) * pole, axis=1) >= 0.0)
    inside &= np.sum(np.cross(nearest, b) * pole, axis=1) >= 0.0
    cosines = np.where(inside, np.linalg.norm(nearest, axis=1), np.maximum(-a[:, 2], -b[:, 2]))
    return np.asarray(np.arccos(np.clip(cosines, -1.0, 1.0)))


def _over(triangle: Array, normal: Array, point: Array) -> bool:
    """Whether `point` projected along `normal` falls into the triangle (3, 3)."""
    sides = np.roll(triangle, -1, axis=0) - triangle
    turning = np.cross(sides, point - triangle) @ normal
    scale = 1e-12 * float(np.sum(sides**2))
    return bool(np.all(turning >= -scale) or np.all(turning <= scale))


def _turn_down(normal: Array) -> Array:
    """The least rotation (3, 3) that takes unit `normal` to (0, 0, −1) (Rodrigues)."""
    down = np.array([0.0, 0.0, -1.0])
    cosine, cross = float(normal @ down), _turning(np.cross(normal, down)).T
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + cosine))


def _turning(axis: Array) -> Array:
    """The matrix (3, 3) by which a row vector p becomes axis × p; numpy's own product of vectors takes ten times as long."""
    a, b, c = axis
    return np.array([[0.0, c, -b], [-c, 0.0, a], [b, -a, 0.0]])


# The statue in its principal frame and as it starts, rotations as quaternions (x, y, z, w).


LOCKED_KG_M2: Final = 1e20
"""A moment of inertia that nothing turns: across the plane."""


def halved(feet_m: Array) -> Array:
    """Feet (n, 3) in the plane: one for each pair of `feet_m` (k, 3), one for each foot that lies in it."""
    # The two feet of a pair agree to rounding only.
    first = np.unique(np.round(feet_m[:, [0, 2]] / SAME), axis=0, return_index=True)[1]
    return np.asarray(feet_m[np.sort(first)] * np.array([1.0, 0.0, 1.0]))


def locked(moments_kg_m2: Array) -> Array:
    """Principal moments (3,) of a body that turns in the plane alone."""
    return np.array([LOCKED_KG_M2, moments_kg_m2[1], LOCKED_KG_M2])


@dataclass(frozen=True, eq=False)
class Setup:
    """The statue in its principal frame, origin at its centroid: `axes` (3, 3) as columns in the statue frame, `moments` (3,),
    `feet_m` (k, 3) and `hull_m` (n, 3); `rest` is its pose at rest, `start` its part of the row at t = 0.
    """

    axes: Array
    moments: Array
    feet_m: Array
    hull_m: Array
    rest: Rest
    start: Row
    mirrored: bool = False
    in_plane: bool = False

    @property
    def axis(self) -> Vector:
        """The statue's vertical axis in its principal frame."""
        return vector(self.axes[2])

    @property
    def flat(self) -> Setup:
        """All of a scene that mirrors itself, its bodies turning in the plane alone."""
        return replace(self, moments=locked(self.moments), in_plane=True)

    @property
    def halved(self) -> Setup:
        """The half of a scene that mirrors itself."""
        return replace(self.flat, feet_m=halved(self.feet_m), mirrored=True)


def prepare(scene: Scene) -> Setup:
    """Feet, hull, inertia, rest pose and start of a scene's statue."""
    statue = scene.statue
    moments, axes = principal(statue)
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    hull = hull_vertices(statue)
    # Any vertex can touch a wall, and the floor under a thrown body; else those that a lean brings down to a level support.
    touching = hull if scene.wall is not None or scene.initial.pose is not None else touchable(statue)
    rest = rest_of(statue)
    return Setup(
        axes, moments, (touching - centroid) @ axes, (hull - centroid) @ axes, rest, start(scene, touching, rest, axes)
    )


def principal(statue: Statue) -> tuple[Array, Array]:
    """Principal moments (3,), kg m², and axes (3, 3) as columns of the rotation nearest to none (exactly none if diagonal)."""
    tensor = statue.inertia_tensor_kg_m2
    off = tensor - np.diag(np.diag(tensor))
    if float(np.max(np.abs(off))) <= 1e-12 * float(np.trace(tensor)):
        return np.diag(tensor).copy(), np.eye(3)
    moments, axes = np.linalg.eigh(0.5 * (tensor + tensor.T))
    order = max(permutations(range(3)), key=lambda item: float(np.sum(np.abs(np.diag(axes[:, list(item)])))))
    moments, axes = moments[list(order)], axes[:, list(order)]
    axes = axes * np.where(np.diag(axes) < 0.0, -1.0, 1.0)
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] = -axes[:, 2]
    return moments, axes


def start(scene: Scene, feet_m: Array, rest: Rest, axes: Array) -> Row:
    """The statue's part of the first row: at rest on its facet, or turned from upright by the rotation that the scene gives.

    The lowest foot touches the support; the centroid of an upright statue stands over the origin. Where the scene gives a pose,
    that.
    """
    statue, initial = scene.statue, scene.initial
    if initial.pose is not None:
        turn, spin = initial.pose.rotation, np.array(initial.pose.angular_velocity_rad_s)
        pose = initial.pose
        return (*pose.position_m, *quaternion(turn @ axes), *pose.velocity_m_s, *vector(turn @ spin))
    height = 0.0 if scene.pedestal is None else scene.pedestal.height_m
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    stands = rest.rotation if initial.theta_rad == 0.0 else np.eye(3)
    rested, turned = feet_m @ stands.T, about_y(initial.theta_rad) @ stands
    side = math.copysign(1.0, initial.theta_rad if initial.theta_rad != 0.0 else initial.theta_rate_rad_s)
    turned_feet_m = feet_m @ turned.T
    low = turned_feet_m[:, 2] - side * 1e-9 * turned_feet_m[:, 0]
    pivot = int(np.argmin(low))
    shift = rested[pivot] - turned_feet_m[pivot]
    shift[2] = height - turned_feet_m[pivot, 2]
    place = turned @ centroid + shift
    rate = np.array([0.0, initial.theta_rate_rad_s, 0.0])
    velocity = np.cross(rate, place - (turned_feet_m[pivot] + shift))
    return (*vector(place), *quaternion(turned @ axes), *vector(velocity), *vector(rate))


def vector(values: Array) -> Vector:
    """Three numbers of an array, plain."""
    return float(values[0]), float(values[1]), float(values[2])


def about_y(theta_rad: float) -> Array:
    """Rotation (3, 3) that tips z towards +x: the planar rotation θ."""
    cos, sin = math.cos(theta_rad), math.sin(theta_rad)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def quaternion(rotation: Array) -> tuple[float, float, float, float]:
    """Quaternion (x, y, z, w), w ≥ 0, of a rotation matrix (3, 3)."""
    x, y, z, w = Rotation.from_matrix(rotation).as_quat(canonical=True).tolist()
    return x, y, z, w


# Collision shapes: spheres at the vertices that touch, planes for floor, wall and pedestal's top, convex bodies for edges.


MARGIN_M: Final = 1e-3
"""What Bullet adds to a hull of its own accord, rounding its edges."""
HULL_INSET_M: Final = 1.1 * MARGIN_M
"""Hull and parts are drawn inside the body by that, and a tenth: the feet touch first."""
LEAST_THICKNESS_M: Final = 1e-5
"""A body thinner than this, once drawn inside, is left out: its neighbours or the hull's vertices touch in its place."""
NOTHING: Final = '<mass value="0"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'
MOST_IN_ARRAY: Final = 16
"""`createCollisionShapeArray` silently keeps the first 16 shapes and drops the rest."""


def compound(centres_m: Array, radius_m: float, client: int) -> int:
    """Compound of spheres at `centres_m` (k ≤ 16, 3)."""
    count = len(centres_m)
    if count > MOST_IN_ARRAY:
        raise EngineFailure(f"a compound of {count} spheres was asked, at most {MOST_IN_ARRAY} are kept")
    return int(
        pybullet.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_SPHERE] * count,
            radii=[radius_m] * count,
            collisionFramePositions=centres_m.tolist(),
            physicsClientId=client,
        )
    )


def halved_pedestal(body: Pedestal, radius_m: float, client: int) -> int:
    """Two spheres in the rocking plane, which bear for the four lower corners, and a plane without end `radius_m` below the
    pedestal's top, where the statue's spheres stand at height 0: its contact with a sphere is a closed form.
    """
    x, z = 0.5 * body.width_m, 0.5 * body.height_m
    return int(
        pybullet.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_SPHERE, pybullet.GEOM_SPHERE, pybullet.GEOM_PLANE],
            radii=[radius_m, radius_m, 0.0],
            planeNormals=[[0.0, 0.0, 1.0]] * 3,
            collisionFramePositions=[[x, 0.0, -z], [-x, 0.0, -z], [0.0, 0.0, z - radius_m]],
            physicsClientId=client,
        )
    )


def linked_pedestal(body: Pedestal, radius_m: float, place_m: Sequence[float], client: int) -> int:
    """A pedestal of a box with its edges, and two links fixed to it: the plane of its top, without end, and its four feet.

    Bullet rounds a box by a margin, within which its top is not flat: what turns on an edge would turn a millimetre inside it.
    The margin of a body's own shape can be told to be none, that of a link's cannot.
    """
    x, y, z = 0.5 * body.width_m, 0.5 * body.depth_m, 0.5 * body.height_m
    high = z - radius_m
    box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[x, y, high], physicsClientId=client)
    corners = np.array([[sx * x, sy * y, -z] for sx in (1.0, -1.0) for sy in (1.0, -1.0)])
    drawn = pybullet.createVisualShape(pybullet.GEOM_BOX, halfExtents=[1.0, 1.0, 1.0], physicsClientId=client)
    still, upright = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]
    made = pybullet.createMultiBody(
        body.mass_kg,
        box,
        drawn,
        basePosition=place_m,
        linkMasses=[0.0, 0.0],
        linkCollisionShapeIndices=[plane((0.0, 0.0, 1.0), client), compound(corners, radius_m, client)],
        linkVisualShapeIndices=[drawn, drawn],
        linkPositions=[[0.0, 0.0, high], still],
        linkOrientations=[upright, upright],
        linkInertialFramePositions=[still, still],
        linkInertialFrameOrientations=[upright, upright],
        linkParentIndices=[0, 0],
        linkJointTypes=[pybullet.JOINT_FIXED, pybullet.JOINT_FIXED],
        linkJointAxis=[[0.0, 0.0, 1.0]] * 2,
        physicsClientId=client,
    )
    pybullet.changeDynamics(made, -1, collisionMargin=0.0, physicsClientId=client)
    return int(made)


def described_body(
    centres_m: Array, radius_m: float, convex_m: Sequence[Array], client: int, apart_m: Sequence[Array] = ()
) -> int:
    """A body from a description on disk: any number of spheres, and the hull of each set of points (n, 3) of `convex_m`.

    Each of `apart_m` are the centres (k, 3) of spheres on a link of their own, fixed to the body, which others can be told to
    meet or not. Mass and inertia are set afterwards. One element stands on each line: the reader's buffer holds a line.
    """
    with tempfile.TemporaryDirectory(prefix="rockcheck-") as folder:
        parts = _spheres(centres_m, radius_m)
        for number, points in enumerate(convex_m):
            _write_points(Path(folder) / f"{number}.obj", points)
            parts.append(f'<collision><geometry><mesh filename="{number}.obj"/></geometry></collision>')
        # Without a shape to draw, Bullet would make one of each collision shape: most of the time that a body takes.
        parts.append('<visual><geometry><box size="1 1 1"/></geometry></visual>')
        unit = '<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        links = []
        for number, centres in enumerate(apart_m):
            links += [
                f'<link name="{number}">',
                f"<inertial>{NOTHING}</inertial>",
                *_spheres(centres, radius_m),
                "</link>",
            ]
            links += [f'<joint name="{number}" type="fixed"><parent link="statue"/><child link="{number}"/></joint>']
        inside = [f"<inertial>{unit}</inertial>", *parts, "</link>", *links]
        text = "\n".join(['<robot name="statue"><link name="statue">', *inside, "</robot>"])
        file = Path(folder) / "statue.urdf"
        file.write_text(text, encoding="ascii")
        try:
            return int(pybullet.loadURDF(str(file), flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client))
        except pybullet.error as error:
            raise EngineFailure(
                f"pybullet could not build the statue from {len(centres_m)} spheres and {len(convex_m)} convex bodies: {error}"
            ) from error


def _spheres(centres_m: Array, radius_m: float) -> list[str]:
    """Lines of a description."""
    return [
        f'<collision><origin xyz="{x:.17g} {y:.17g} {z:.17g}"/>'
        f'<geometry><sphere radius="{radius_m:.17g}"/></geometry></collision>'
        for x, y, z in centres_m
    ]


def inset(points_m: Array) -> Array:
    """Vertices (k, 3) of the convex hull of `points_m` with every face moved inwards by `HULL_INSET_M`; none of a thin one."""
    from scipy.spatial import ConvexHull, HalfspaceIntersection

    planes = np.unique(np.round(ConvexHull(points_m).equations, 12), axis=0)
    planes[:, 3] += HULL_INSET_M
    inside = np.mean(points_m, axis=0)
    if np.max(planes[:, :3] @ inside + planes[:, 3]) > -LEAST_THICKNESS_M:
        inside, radius = _innermost(planes)
        if radius < LEAST_THICKNESS_M:
            return np.empty((0, 3))
    corners = HalfspaceIntersection(planes, inside).intersections
    return np.unique(np.round(corners[np.all(np.isfinite(corners), axis=1)], 9), axis=0)


def _innermost(planes: Array) -> tuple[Array, float]:
    """Centre (3,) and radius of the largest ball within half-spaces (k, 4) (negative where they leave nothing)."""
    from scipy.optimize import linprog

    bounds = [(None, None)] * 4
    solution = linprog([0.0, 0.0, 0.0, -1.0], np.c_[planes[:, :3], np.ones(len(planes))], -planes[:, 3], bounds=bounds)
    if solution.x is None:
        raise EngineFailure(f"a convex body could not be drawn inside: {solution.message}")
    return np.asarray(solution.x[:3]), float(solution.x[3])


def _write_points(file: Path, points_m: Array) -> None:
    """A mesh file with these vertices; its faces only mention them all, as Bullet takes the hull of what is mentioned."""
    count = len(points_m)
    lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in points_m]
    lines += [f"f {k} {k % count + 1} {(k + 1) % count + 1}" for k in range(1, count + 1)]
    file.write_text("\n".join(lines) + "\n", encoding="ascii")


def plane(normal: tuple[float, float, float], client: int) -> int:
    """Half-space below a plane through its body's origin."""
    shape: Any = pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=list(normal), physicsClientId=client)
    return int(shape)


# What of the statue meets a pedestal's edge: convex bodies in its place, its hull or the parts of a decomposition.

Kind = Literal["hull", "parts"]

HULL_VERTICES: Final = 256
"""Budget of the hull drawn inside: of a scan's several hundred corners those left out stand out by about a millimetre at most."""


@dataclass(frozen=True, eq=False)
class FullShape:
    """Convex bodies (k, 3) each, statue frame, drawn inside the statue; `no_parts` says why they are its hull where it
    needs convex parts."""

    kind: Kind
    bodies_m: tuple[Array, ...]
    no_parts: str = ""

    @property
    def note(self) -> str:
        """What it is, for the record."""
        return "hull" if self.kind == "hull" else f"{len(self.bodies_m)} convex parts"

    def turned(self, statue: Statue, axes: Array) -> tuple[Array, ...]:
        """The bodies about the statue's centroid along `axes` (3, 3), given as columns."""
        centroid_m = np.array([0.0, 0.0, statue.centroid_height_m])
        return tuple((points - centroid_m) @ axes for points in self.bodies_m)


def full_shape(scene: Scene, wish: Literal["needed", "hull", "parts"] = "needed") -> FullShape:
    """The shape that the scene needs, or the one wished; the hull, with the reason, where parts cannot be made."""
    from meshes import MeshError

    need = shape_needed(scene)
    wanted = need.shape if wish == "needed" else wish
    if wanted != "parts" or scene.statue.solid is None:
        return FullShape("hull", _drawn_hull(scene.statue))
    try:
        return FullShape("parts", _parts(scene.statue))
    except MeshError as error:
        return FullShape("hull", _drawn_hull(scene.statue), str(error))


@lru_cache(maxsize=CACHED_STATUES)
def _drawn_hull(statue: Statue) -> tuple[Array, ...]:
    # Moving the faces makes corners anew: more of them than there were.
    return tuple(thinned(points, HULL_VERTICES)[0] for points in _drawn_inside((hull_vertices(statue),)))


@lru_cache(maxsize=CACHED_STATUES)
def _parts(statue: Statue) -> tuple[Array, ...]:
    from meshes.decomposition import parts_of

    return () if statue.solid is None else _drawn_inside(parts_of(statue.solid))


def _drawn_inside(bodies_m: tuple[Array, ...]) -> tuple[Array, ...]:
    return tuple(body for points in bodies_m if len(body := inset(points)))
