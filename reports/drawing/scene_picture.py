"""The scene drawn to scale as inline SVG: floor, pedestal, silhouette, corners, centroid, wall, dimensions."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Final

from jinja2 import Template
from markupsafe import Markup

from harness.records.scene import SceneRecord
from reports.drawing.display_mesh import silhouette_m
from reports.drawing.kinematics import section
from reports.messages import Language
from reports.pages.assets import environment

WIDTH: Final = 460.0
HEIGHT: Final = 440.0
MARGIN: Final = {"left": 74.0, "right": 74.0, "top": 26.0, "bottom": 84.0}


def scene_svg(scene: SceneRecord, say: Language, axes: Collection[str] = (), mesh: Path | None = None) -> Markup:
    """The picture of a record's scene, seen along y: x to the right, z up, with the words of a language.

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
    wall_x = None
    if wall is not None:
        beyond = wall.distance_m
        wall_x = shape.corner_right_m + beyond if wall.side == "right" else -shape.corner_left_m - beyond
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
        width=WIDTH, height=HEIGHT, x=x, z=z, outline=outline.tolist(), lift=lift, top=top, left=left, right=right,
        statue=scene.statue, pedestal=pedestal, box=boxes, wall=wall, wall_x=wall_x, axes=axes, say=say,
    )  # fmt: skip
    return Markup(drawn)
