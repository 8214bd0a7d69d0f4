"""Where the statue and its pedestal are at a sample, and the statue's mesh for the eye: what pictures, replay and animation share
(docs/model.md, section 1).
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.model import SOLID_COLUMNS, Array, History, Pedestal, centroid_shift_m, rotations
from harness.records.scene import SceneRecord


def pedestal_sides_m(scene: SceneRecord) -> list[float]:
    """x of the pedestal's left and right side at rest, in the statue frame; none without a pedestal."""
    statue, pedestal = scene.statue, scene.pedestal
    if pedestal is None:
        return []
    middle = 0.5 * (statue.corner_right_m - statue.corner_left_m) + pedestal.offset_m
    return [middle + side * pedestal.width_m for side in (-0.5, 0.5)]


def wall_m(scene: SceneRecord) -> float | None:
    """x of the wall in the statue frame; None without one."""
    statue, wall = scene.statue, scene.wall
    if wall is None:
        return None
    right = statue.corner_right_m + wall.distance_m
    return right if wall.side == "right" else -statue.corner_left_m - wall.distance_m


MOVING: Final[tuple[str, ...]] = (
    "theta_rad",
    "slip_m",
    "statue_slip_m",
    "pedestal_tilt_rad",
    "pedestal_yaw_rad",
    "pedestal_y_m",
)
"""Columns of a history that move the statue or the pedestal, where an engine records them."""


def sampled(history: History, t_s: Array | None = None) -> dict[str, Array]:
    """The columns of a history that move anything at times (n,), of its last sample after its end; without times at its own."""
    known = {"theta_rad": history.theta_rad, "slip_m": history.slip_m, **history.extra}
    moving = {name: known[name] for name in (*MOVING, *SOLID_COLUMNS) if name in known}
    return moving if t_s is None else {name: np.interp(t_s, history.t_s, values) for name, values in moving.items()}


def poses(scene: SceneRecord, columns: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Where the statue and its pedestal are by columns of a history, each (n,) or one number; what is not among them is nought.

    `SOLID_COLUMNS` are the statue's, of an engine in the plane from its rotation and slips; `pedestal_*` the place of
    the pedestal's centroid and its turns about y and then z.
    """
    at = dict(
        zip(MOVING, np.broadcast_arrays(*(np.atleast_1d(columns.get(name, 0.0)) for name in MOVING)), strict=True)
    )
    theta, slip, lean = at["theta_rad"], at["slip_m"], at["pedestal_tilt_rad"]
    statue, pedestal, c, s = scene.statue, scene.pedestal, np.cos(lean), np.sin(lean)
    found: dict[str, Array] = {}
    pivot = np.where(theta >= lean, statue.corner_right_m, -statue.corner_left_m)
    x, z = pivot + slip + at["statue_slip_m"], np.zeros(len(theta))
    if pedestal is not None:
        middle, half = float(np.mean(pedestal_sides_m(scene))), 0.5 * pedestal.height_m
        centre = middle + slip + centroid_shift_m(pedestal, lean)
        up = 0.5 * (pedestal.height_m * c + pedestal.width_m * np.abs(s))
        # Along the top from its middle, which turns about the centroid.
        along = pivot + at["statue_slip_m"] - middle
        x, z = centre + along * c + half * s, up + half * c - along * s
        turns = {"pedestal_tilt_rad": lean, "pedestal_yaw_rad": at["pedestal_yaw_rad"]}
        found = {"pedestal_x_m": centre, "pedestal_y_m": at["pedestal_y_m"], "pedestal_z_m": up, **turns}
    if all(name in columns for name in SOLID_COLUMNS):
        return found | {name: np.atleast_1d(columns[name]) for name in SOLID_COLUMNS}
    to_right = statue.corner_right_m - pivot
    still = dict.fromkeys(("roll_rad", "yaw_rad", "corner_right_y_m"), np.zeros(len(theta)))
    corner = {"corner_right_x_m": x + to_right * np.cos(theta), "corner_right_z_m": z - to_right * np.sin(theta)}
    return found | {"pitch_rad": theta, **corner, **still}


def posed_m(scene: SceneRecord, points_m: Array, pose: Mapping[str, Array]) -> Array:
    """Points (k, 3) of the statue at its `poses` (n,), in the table's frame, z from the floor: (n, k, 3)."""
    return _placed(points_m - [scene.statue.corner_right_m, 0.0, 0.0], pose, SOLID_COLUMNS[3:])


def posed_pedestal_m(pedestal: Pedestal, pose: Mapping[str, Array]) -> Array:
    """The pedestal's corners (n, 8, 3) at `poses` (n,), in the order of the signs of x, y, z."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    tilt, yaw = pose["pedestal_tilt_rad"], pose["pedestal_yaw_rad"]
    turned = {**pose, "pitch_rad": tilt, "roll_rad": np.zeros_like(tilt), "yaw_rad": yaw}
    centre = [f"pedestal_{axis}_m" for axis in "xyz"]
    return _placed(0.5 * signs * [pedestal.width_m, pedestal.depth_m, pedestal.height_m], turned, centre)


def _placed(points_m: Array, pose: Mapping[str, Array], centre: Sequence[str]) -> Array:
    """Points turned about their origin as a pose says, which then lies where its columns of these names say."""
    origin = np.stack([pose[name] for name in centre], axis=-1)
    return np.asarray(points_m @ np.swapaxes(rotations(pose), -1, -2) + origin[:, None, :])


def top_shift_m(scene: SceneRecord, pose: Mapping[str, Array]) -> Array:
    """How far (n, 2) the middle of the statue's top is at its `poses` from where it stood, along the floor in x and y."""
    outline = np.asarray(scene.statue.section_m)
    at_top = outline[outline[:, 1] >= outline[:, 1].max() - 1e-9]
    x = 0.5 * (at_top[:, 0].min() + at_top[:, 0].max())
    return np.asarray(posed_m(scene, np.array([[x, 0.0, at_top[0, 1]]]), pose)[:, 0, :2] - [x, 0.0])


def room_m(scene: SceneRecord, pose: Mapping[str, Array]) -> float:
    """The least room between anything of the statue and its wall over its `poses`; infinite without a wall."""
    wall, x = wall_m(scene), posed_m(scene, body_m(scene), pose)[:, :, 0]
    return math.inf if wall is None else float((abs(wall) - math.copysign(1.0, wall) * x).min())


NEAR: Final = 0.3
"""Share of its height by which a statue moves within what is drawn around it."""


def in_sight_m(scene: SceneRecord, moves: Iterable[Mapping[str, Array]]) -> float:
    """The height, from the floor, in which a moving picture shows the statue: its own on its pedestal, more where by its `poses`
    it is thrown or slides far."""
    pedestal = scene.pedestal
    lift = 0.0 if pedestal is None else pedestal.height_m
    rest = dict(zip(SOLID_COLUMNS[3:], (scene.statue.corner_right_m, 0.0, lift), strict=True))
    high = lift + scene.statue.height_m
    return high + max(
        0.0, *(float(np.abs(each[name] - rest[name]).max()) - NEAR * high for each in moves for name in rest)
    )


# The statue's own mesh made ready for the screen: decimated where needed, edges kept sharp; its true outline as seen along y.

Faces = NDArray[np.int64]

MOST_FACES: Final = 8_000
"""More faces than this do not show on a page: shaded smoothly, each is some six pixels wide; they would make it large."""
CREASE_RAD: Final = float(np.radians(38.0))
"""Faces that meet at a sharper angle, and hang together nowhere else, are drawn with an edge between them, as at a plinth."""

SMOOTHED: Final = 1.0 / 800.0
"""Bends of the outline smaller than this share of the height are left out: less than a pixel in every picture."""


def display_mesh(scene: SceneRecord, path: Path | None, most_faces: int = MOST_FACES) -> tuple[Array, Faces]:
    """Vertices (n, 3) in the statue frame and faces (m, 3) of the mesh of a result folder, split along its creases.

    Of a statue given by numbers those of the block that stands for it.
    """
    if path is None:
        return _prism(scene)
    vertices, faces = read_mesh(path)
    if len(faces) > most_faces:
        vertices, faces = decimated(vertices, faces, most_faces)
    return _creased(vertices, faces)


def read_mesh(path: Path) -> tuple[Array, Faces]:
    """Vertices (n, 3) in the statue frame and faces (m, 3) of the mesh in a result folder."""
    import trimesh

    mesh: Any = trimesh.load(path, force="mesh", process=False)
    return np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.int64)


def decimated(vertices: Array, faces: Faces, most_faces: int) -> tuple[Array, Faces]:
    """The surface with so many faces or a few more, for the eye alone."""
    import fast_simplification

    share = 1.0 - most_faces / len(faces)
    points, triangles = fast_simplification.simplify(vertices.astype(np.float32), faces.astype(np.int32), share)
    return np.asarray(points, dtype=np.float64), np.asarray(triangles, dtype=np.int64)


def eye_axes(azimuth_rad: float, raised_rad: float) -> Array:
    """Rows: to the right, upwards and towards the eye, of an eye far away at that azimuth and so high."""
    eye = np.array([
        np.cos(raised_rad) * np.cos(azimuth_rad), np.cos(raised_rad) * np.sin(azimuth_rad), np.sin(raised_rad)
    ])  # fmt: skip
    right = np.array([-np.sin(azimuth_rad), np.cos(azimuth_rad), 0.0])
    return np.stack([right, np.cross(eye, right), eye])


def facing(vertices: Array, faces: Faces, eye: Array) -> tuple[NDArray[np.intp], Array]:
    """The faces that look at an eye far away in a direction (3,), the farthest first, and the unit normals (m, 3) of all."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    seen = np.flatnonzero(normals @ eye > 0.0)
    return seen[np.argsort(corners[seen].mean(axis=1) @ eye)], normals


def body_m(scene: SceneRecord, mesh: Path | None = None) -> Array:
    """The corners (n, 3) of the body's convex hull: no other point ever reaches farther."""
    if mesh is None:
        return _prism(scene)[0]
    from scipy.spatial import ConvexHull

    vertices, _ = read_mesh(mesh)
    return np.asarray(vertices[ConvexHull(vertices).vertices])


def _prism(scene: SceneRecord) -> tuple[Array, Faces]:
    """The section pulled along y; its outline runs counter-clockwise as seen with x right and z up."""
    outline, half_m = np.asarray(scene.statue.section_m, dtype=np.float64), 0.5 * scene.statue.depth_m
    count = len(outline)
    rings = [np.insert(outline, 1, y, axis=1) for y in (-half_m, half_m)]
    here = np.arange(count)
    after = np.roll(here, -1)
    front = np.column_stack([np.zeros_like(here), here, after])[1:-1]
    back = count + front[:, ::-1]
    sides = [np.column_stack([here, here + count, after]), np.column_stack([after, here + count, after + count])]
    return np.vstack(rings), np.vstack([front, back, *sides])


def _creased(vertices: Array, faces: Faces) -> tuple[Array, Faces]:
    """The surface with its vertices split along creases: what shares a vertex is shaded as one."""
    import trimesh

    mesh: Any = trimesh.Trimesh(vertices, faces, process=False)
    smooth = trimesh.graph.smooth_shade(mesh, angle=CREASE_RAD, facet_minarea=None)
    return np.asarray(smooth.vertices, dtype=np.float64), np.asarray(smooth.faces, dtype=np.int64)


def silhouette_m(scene: SceneRecord, mesh: Path | None) -> Array:
    """The outline (k, 2) in (x, z), statue frame: the mesh's shadow along y, or the section of a statue without one."""
    if mesh is None:
        return np.asarray(scene.statue.section_m, dtype=np.float64)
    return _shadow(mesh, mesh.stat().st_mtime_ns)


@lru_cache(maxsize=4)
def _shadow(mesh: Path, _changed_ns: int) -> Array:
    import shapely

    vertices, faces = read_mesh(mesh)
    corners = vertices[faces][:, :, [0, 2]]
    edges = corners[:, 1:] - corners[:, :1]
    towards = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0] > 0.0
    shadow: Any = shapely.union_all(shapely.polygons(corners[towards]))
    whole = max(shapely.get_parts(shadow), key=lambda part: float(part.area))
    outline = shapely.Polygon(whole.exterior).simplify(SMOOTHED * float(np.ptp(vertices[:, 2]))).exterior
    return np.asarray(outline.coords, dtype=np.float64)[:-1]
