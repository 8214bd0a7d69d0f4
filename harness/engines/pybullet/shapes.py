"""Collision shapes: spheres at the vertices that touch, planes for floor, wall and pedestal's top, convex bodies for edges."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
import pybullet

from harness.engines.base import EngineFailure
from harness.engines.pybullet.feet import CACHED_STATUES, hull_vertices
from harness.model import Array, Pedestal, Scene, Statue
from harness.statics.plan import shape_needed
from meshes.solid import thinned

MARGIN_M: Final = 1e-3
"""What Bullet adds to a hull of its own accord, rounding its edges."""
HULL_INSET_M: Final = 1.1 * MARGIN_M
"""Hull and parts are drawn inside the body by that, and a tenth: the feet touch first."""
LEAST_THICKNESS_M: Final = 1e-5
"""A body thinner than this, once drawn inside, is left out: its neighbours or the hull's vertices touch in its place."""
NOTHING: Final = '<mass value="0"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'
MOST_IN_ARRAY: Final = 16
"""`createCollisionShapeArray` silently keeps the first 16 shapes and drops the rest."""


def feet(centres_m: Array, radius_m: float, client: int) -> int:
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
        linkCollisionShapeIndices=[plane((0.0, 0.0, 1.0), client), feet(corners, radius_m, client)],
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
        return FullShape("hull", _hull(scene.statue))
    try:
        return FullShape("parts", _parts(scene.statue))
    except MeshError as error:
        return FullShape("hull", _hull(scene.statue), str(error))


@lru_cache(maxsize=CACHED_STATUES)
def _hull(statue: Statue) -> tuple[Array, ...]:
    # Moving the faces makes corners anew: more of them than there were.
    return tuple(thinned(points, HULL_VERTICES)[0] for points in _drawn_inside((hull_vertices(statue),)))


@lru_cache(maxsize=CACHED_STATUES)
def _parts(statue: Statue) -> tuple[Array, ...]:
    from meshes.decomposition import parts_of

    return () if statue.solid is None else _drawn_inside(parts_of(statue.solid))


def _drawn_inside(bodies_m: tuple[Array, ...]) -> tuple[Array, ...]:
    return tuple(body for points in bodies_m if len(body := inset(points)))
