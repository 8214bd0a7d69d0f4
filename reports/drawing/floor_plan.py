"""The statue on a floor plan: its outline at rest, every position that it takes while it rocks, the room that this needs; and
the scene from the side.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from jinja2 import Template
from markupsafe import Markup

from harness.model.history import History
from harness.model.scene import SOLID_COLUMNS, base_shift_m
from harness.records.assess import ClearanceRecord
from harness.records.scene import SceneRecord
from meshes.footprint import lower_chain
from reports.charts.histories import shown_samples
from reports.drawing.display_mesh import read_mesh, silhouette_m
from reports.drawing.kinematics import Array, pedestal_sides_m, posed_in_space_m, section, wall_m
from reports.messages import Language
from reports.pages.assets import environment
from reports.source import RunSource

POSES: Final = 240
"""Most poses of one column of a history in which it is sought which points of a body are ever outermost."""
SIDES: Final[Mapping[str, tuple[float, float]]] = {
    "left": (-1.0, 0.0), "right": (1.0, 0.0), "front": (0.0, -1.0), "back": (0.0, 1.0)
}  # fmt: skip
"""Sides of the room as directions seen from above."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Outlines (k, 2) seen from above at rest and over every position, and the room needed beyond the first, m, by side."""

    rest_m: Array
    moved_m: Array
    room_m: Mapping[str, float]


def floor_plan(source: RunSource, names: Sequence[str]) -> Plan:
    """The plan over the histories of these models; a model of a plane alone tells nothing of the front and the back.

    Without a model nothing is known of the room.
    """
    body = _body(source)
    rest = _hull(body[:, :2])
    points, in_space = [rest], False
    for name in names:
        history = source.histories[name]
        solid = all(column in history.extra for column in SOLID_COLUMNS)
        in_space = in_space or solid
        points.append(_in_space(source, body, history) if solid else _in_plane(source, body, history))
    moved = _hull(np.vstack(points))
    sides = SIDES if in_space else {side: SIDES[side] for side in ("left", "right")}
    room = {side: float((moved @ towards).max() - (rest @ towards).max()) for side, towards in sides.items() if names}
    return Plan(rest, moved, room)


def probable_plan(item: ClearanceRecord, share: float) -> Plan | None:
    """The plan that holds this share of the draws that stand, by the model that knows most directions; None where none tells."""
    answer = next(iter(item.answered.values()), None)
    if answer is None or share not in answer.share:
        return None
    rest, beyond = np.asarray(item.rest_m, dtype=np.float64), answer.at(share)
    towards = {side: np.array(way) for side, way in SIDES.items()}
    angles = {side: float(np.degrees(np.arctan2(way[1], way[0])) % 360.0) for side, way in SIDES.items()}
    room = {side: round(beyond[angle], 4) for side, angle in angles.items() if angle in beyond}
    if len(beyond) <= len(room):
        return Plan(rest, _hull(np.vstack([rest + room[side] * towards[side] for side in room])), room)
    from scipy.spatial import HalfspaceIntersection

    ways = np.radians(list(beyond))
    normals = np.column_stack([np.cos(ways), np.sin(ways)])
    reached = (rest @ normals.T).max(axis=0) + list(beyond.values())
    corners = HalfspaceIntersection(np.column_stack([normals, -reached]), rest.mean(axis=0)).intersections
    return Plan(rest, _hull(np.asarray(corners)), room)


def _hull(points: Array) -> Array:
    """The corners of the convex hull of points (n, 2), counter-clockwise: its lower chain, and that of the points turned over.

    A page of a planar run loads no geometry of space for it.
    """
    corners = np.vstack([lower_chain(points), -lower_chain(-points)])
    return corners[np.any(corners != np.roll(corners, 1, axis=0), axis=1)]


def _body(source: RunSource) -> Array:
    """The corners (n, 3) of the body's convex hull: no other point ever reaches farther."""
    if source.mesh is None:
        outline, half = section(source.scene).outline_m, 0.5 * source.scene.statue.depth_m
        return np.vstack([np.insert(outline, 1, y, axis=1) for y in (-half, half)])
    from scipy.spatial import ConvexHull

    vertices, _ = read_mesh(source.mesh)
    return np.asarray(vertices[ConvexHull(vertices).vertices])


def _in_plane(source: RunSource, body: Array, history: History) -> Array:
    """Each corner moves along one line: the ends of its way are all that the outline needs."""
    shape, moved_m = section(source.scene), base_shift_m(source.scene.pedestal, history.slip_m, history.extra)

    def reached(points: Array, chosen: Any) -> Array:
        x = shape.posed_m(points[:, [0, 2]], history.theta_rad[chosen], moved_m[chosen])[:, :, 0]
        ends = np.column_stack([np.concatenate([x.min(axis=0), x.max(axis=0)]), np.tile(points[:, 1], 2)])
        return ends.reshape(2, -1, 2)

    # No geometry of space is loaded for a body of a few corners.
    few = source.mesh is None
    return reached(body, slice(None)).reshape(-1, 2) if few else _outline(body, [history.theta_rad, moved_m], reached)


def _in_space(source: RunSource, body: Array, history: History) -> Array:
    """The outline of all that the body comes over."""
    columns = {name: history.extra[name] for name in SOLID_COLUMNS}

    def reached(points: Array, chosen: Any) -> Array:
        shown = {name: values[chosen] for name, values in columns.items()}
        return posed_in_space_m(points, source.scene.statue.corner_right_m, shown)[:, :, :2]

    return _outline(body, [history.theta_rad, *columns.values()], reached)


def _outline(body: Array, columns: Sequence[Array], reached: Callable[[Array, Any], Array]) -> Array:
    """The outline (k, 2) of what the body's points `reached` (m, n, 2) in chosen samples: in all of them, of points that are
    outermost in some."""
    from scipy.spatial import ConvexHull

    some = np.unique(np.concatenate([shown_samples(values, POSES) for values in columns]))
    outer = np.unique(ConvexHull(reached(body, some).reshape(-1, 2)).vertices % len(body))
    every = reached(body[outer], slice(None)).reshape(-1, 2)
    return np.asarray(every[ConvexHull(every).vertices])


# The scene drawn to scale as inline SVG: floor, pedestal, silhouette, corners, centroid, wall, dimensions.

WIDTH: Final = 460.0
HEIGHT: Final = 440.0
MARGIN: Final = {"left": 74.0, "right": 74.0, "top": 26.0, "bottom": 84.0}


def scene_svg(scene: SceneRecord, say: Language, axes: Collection[str] = (), mesh: Path | None = None) -> Markup:
    """The picture of a record's scene, seen along y: x to the right, z up, with the words of a language.

    The floor moves along `axes`; `mesh` gives the statue's true outline.
    """
    template: Template = environment().get_template("scene.svg.j2")
    outline = silhouette_m(scene, mesh)
    pedestal, sides, wall_x = scene.pedestal, pedestal_sides_m(scene), wall_m(scene)
    lift = 0.0 if pedestal is None else pedestal.height_m
    xs = [*outline[:, 0].tolist(), *sides, *([] if wall_x is None else [wall_x])]
    left, right = float(min(xs)), float(max(xs))
    top = lift + float(outline[:, 1].max())
    scale = min(
        (WIDTH - MARGIN["left"] - MARGIN["right"]) / (right - left), (HEIGHT - MARGIN["top"] - MARGIN["bottom"]) / top
    )
    middle = 0.5 * (left + right)

    def x(value: float) -> float:
        return round(WIDTH / 2 + scale * (value - middle), 2)

    def z(value: float) -> float:
        return round(HEIGHT - MARGIN["bottom"] - scale * value, 2)

    drawn = template.render(
        width=WIDTH, height=HEIGHT, x=x, z=z, outline=outline.tolist(), lift=lift, top=top, left=left, right=right,
        statue=scene.statue, pedestal=pedestal, sides=sides, wall=scene.wall, wall_x=wall_x, axes=axes, say=say,
    )  # fmt: skip
    return Markup(drawn)
