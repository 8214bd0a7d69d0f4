"""The scene drawn to scale as inline SVG: floor, pedestal, silhouette, corners, centroid, wall, dimensions."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from jinja2 import Template
from markupsafe import Markup

from harness.records.scene import SceneRecord, WallRecord
from reports.drawing.display_mesh import silhouette_m
from reports.drawing.kinematics import section
from reports.pages.assets import environment
from reports.text.numbers import given, length

WIDTH: Final = 460.0
HEIGHT: Final = 440.0
MARGIN: Final = {"left": 74.0, "right": 74.0, "top": 26.0, "bottom": 84.0}


def scene_svg(scene: SceneRecord, axes: Collection[str] = (), mesh: Path | None = None) -> Markup:
    """The picture of a record's scene, seen along y: x to the right, z up.

    The floor moves along `axes`; `mesh` gives the statue's true outline.
    """
    template: Template = environment().get_template("scene.svg.j2")
    shape = section(scene)
    outline = silhouette_m(scene, mesh)
    pedestal, wall = scene.pedestal, scene.wall
    lift = 0.0 if pedestal is None else pedestal.height_m
    left, right = float(outline[:, 0].min()), float(outline[:, 0].max())
    boxes = {}
    if pedestal is not None:
        centre = 0.5 * (shape.corner_right_m - shape.corner_left_m) + pedestal.offset_m
        half = 0.5 * pedestal.width_m
        boxes = {"left": centre - half, "right": centre + half}
        left, right = min(left, centre - half), max(right, centre + half)
    wall_x = _wall_x(wall, shape.corner_left_m, shape.corner_right_m)
    if wall_x is not None:
        left, right = min(left, wall_x), max(right, wall_x)
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
        width=WIDTH, height=HEIGHT, x=x, z=z, path=_path(outline, x, z, lift), lift=lift, top=top, left=left, right=right,
        statue=scene.statue, pedestal=pedestal, box=boxes, wall=wall, wall_x=wall_x, axes=axes, description=describe(scene),
    )  # fmt: skip
    return Markup(drawn)


def describe(scene: SceneRecord) -> str:
    """The picture in words, for those who cannot see it."""
    statue, pedestal, wall = scene.statue, scene.pedestal, scene.wall
    text = (
        f"A statue of {given(statue.mass_kg, 'kg')}, {length(statue.height_m)} high, its centroid "
        f"{length(statue.centroid_height_m)} above its base, {length(statue.corner_left_m)} from the left corner and "
        f"{length(statue.corner_right_m)} from the right corner"
    )
    if pedestal is None:
        text += ", stands on the floor"
    else:
        text += (
            f", stands on a pedestal of {given(pedestal.mass_kg, 'kg')}, {length(pedestal.width_m)} wide and "
            f"{length(pedestal.height_m)} high"
        )
    if wall is not None:
        text += f"; a wall stands {length(wall.distance_m)} to the {wall.side} of its base"
    return text + "."


def _wall_x(wall: WallRecord | None, b_l: float, b_r: float) -> float | None:
    if wall is None:
        return None
    return b_r + wall.distance_m if wall.side == "right" else -b_l - wall.distance_m


def _path(outline: np.ndarray[Any, np.dtype[np.float64]], x: Any, z: Any, lift: float) -> str:
    points: Sequence[str] = [f"{x(px)} {z(lift + pz)}" for px, pz in outline.tolist()]
    return "M" + " L".join(points) + " Z"
