"""The replay as an animated GIF for slides: the statue's mesh, another model's outline, the histories under it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path as File
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.model.errors import InputError, Mistake
from harness.model.files import check_own, writing
from harness.model.history import History
from harness.model.in_space import SOLID_COLUMNS, centroid_shift_m
from reports.charts.histories import histories_figure
from reports.charts.palette import HAIRLINE, INK, MUTED, look
from reports.charts.static_svg import picture
from reports.charts.static_svg_axes import Axis, axes
from reports.drawing.display_mesh import display_mesh, facing, silhouette_m
from reports.drawing.kinematics import Section, posed_in_space_m, section
from reports.drawing.replay import default_model
from reports.drawing.shapes import Path, Shape, Text, area, box, line, moved
from reports.source import RunSource, run_source

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

Array = NDArray[np.float64]

FRAMES_PER_S: Final = 20
LONGEST_S: Final = 12.0
"""Longer motions are shown around their largest rotation: a slide is not looked at for a minute."""
SIZE: Final = (640, 560)
CHART: Final = 130
GREYS: Final = 64
DARK, BRIGHT = np.array([92, 84, 72]), np.array([244, 238, 226])
STONES: Final = ["#{:02x}{:02x}{:02x}".format(*(DARK + (BRIGHT - DARK) * k // (GREYS - 1))) for k in range(GREYS)]
"""Colours of the stone from its shadow to its light."""
LIGHT, PAPER, STONE, PINK = "#eceff2", "#fcfcfa", "#acb2bb", "#c2185b"
VIEW: Final = (0.42, 0.16)
"""Azimuth and elevation of the view in rad."""
EYE: Final = np.array(
    [math.sin(VIEW[0]) * math.cos(VIEW[1]), -math.cos(VIEW[0]) * math.cos(VIEW[1]), math.sin(VIEW[1])]
)
"""Where the eye is."""
PLACES: Final = {"start": "ls", "middle": "ms", "end": "rs"}
"""Where a text stands at its place on its base line, in the words of pixels."""
SUN: Final = np.array([-0.55, -0.55, 0.63])
FLOOR: Final = np.array([[-0.62, -0.4, 0.0], [0.62, -0.4, 0.0], [0.62, 0.5, 0.0], [-0.62, 0.5, 0.0]])


@dataclass(frozen=True, eq=False)
class Stage:
    """Everything that stays the same from frame to frame; lengths in metres, the picture in pixels."""

    source: RunSource
    solid: str
    ghost: str | None
    shape: Section
    vertices_m: Array
    faces: NDArray[np.int64]

    @property
    def lift_m(self) -> float:
        """Height of the support on which the statue stands."""
        pedestal = self.source.scene.pedestal
        return 0.0 if pedestal is None else pedestal.height_m

    @cached_property
    def scale(self) -> float:
        """Pixels per metre."""
        return (SIZE[1] - CHART - 40) / (1.18 * (self.lift_m + float(self.vertices_m[:, 2].max())))

    def pixels(self, points_m: Array) -> Array:
        """Orthographic projection: pixels (n, 2)."""
        azimuth, elevation = VIEW
        x = points_m[:, 0] * math.cos(azimuth) + points_m[:, 1] * math.sin(azimuth)
        away = -points_m[:, 0] * math.sin(azimuth) + points_m[:, 1] * math.cos(azimuth)
        up = points_m[:, 2] * math.cos(elevation) + away * math.sin(elevation)
        centre = 0.5 * (self.shape.corner_right_m - self.shape.corner_left_m) * math.cos(azimuth)
        left = SIZE[0] / 2 + self.scale * (x - centre)
        return np.column_stack([left, SIZE[1] - CHART - 34 - self.scale * up])


def write_gif(folder: File, path: File | None = None, model: str | None = None) -> File:
    """Write the replay of a run's folder as a GIF (default `replay.gif` in it), in real time at 20 frames per second.

    Raises `InputError` for a folder without a run, without histories, or for a model that it does not hold.
    """
    source = run_source(folder)
    if not source.histories:
        raise InputError(Mistake(str(folder), "", "a run with histories", "a record without any"))
    if model is not None and model not in source.histories:
        raise InputError(Mistake("--model", "", f"one of {', '.join(source.histories)}", repr(model)))
    target = path or folder / "replay.gif"
    if target.suffix != ".gif":
        raise InputError(Mistake("--out", "", "a file ending in .gif", str(target)))
    check_own(target, option="--out")
    stage = _stage(source, model or default_model(source))
    start, end = _window(source.histories[stage.solid])
    times = np.arange(start, end + 0.5 / FRAMES_PER_S, 1.0 / FRAMES_PER_S)
    chart, along = _chart(stage, start, end)
    frames = [_frame(stage, float(t), chart, float(along.px(t)[0])) for t in times]
    with writing(target) as fresh:
        frames[0].save(
            fresh,
            format="GIF",
            save_all=True,
            append_images=frames[1:],
            duration=1000 // FRAMES_PER_S,
            loop=0,
            disposal=1,
        )
    return target


def _stage(source: RunSource, solid: str) -> Stage:
    shape = section(source.scene)
    mesh = display_mesh(source.mesh, shape, source.scene.statue.depth_m, most_faces=4000)
    ghost = "analytic" if "analytic" in source.histories and solid != "analytic" else None
    return Stage(source, solid, ghost, shape, mesh.vertices_m, mesh.faces)


def _window(history: History) -> tuple[float, float]:
    end = float(history.t_s[-1])
    if end <= LONGEST_S:
        return 0.0, end
    peak = float(history.t_s[int(np.argmax(np.abs(history.theta_rad)))])
    start = min(max(0.0, peak - 0.6 * LONGEST_S), end - LONGEST_S)
    return start, start + LONGEST_S


def _chart(stage: Stage, start_s: float, end_s: float) -> tuple[Image, Axis]:
    """The background of every frame: the page's chart of all rotations under an empty floor; its time axis."""
    from PIL import Image, ImageColor, ImageDraw

    whole = histories_figure(stage.source)
    layout = {
        "height": CHART, "showlegend": True, "still": {"top": 24.0, "bottom": 22.0}, "xaxis": {"range": [start_s, end_s]},
        "yaxis": {"range": whole["views"]["near"], "nticks": 3},
    }  # fmt: skip
    rotations = [trace for trace in whole["data"] if trace["yaxis"] == "y" and trace.get("name")]
    figure = {"data": rotations, "layout": layout}
    drawn = picture(figure, SIZE[0])
    names = list(stage.source.runs)
    own = [look(name, names).colour for name in names]
    image = Image.new("P", SIZE)
    # All colours beforehand, so that every frame shares them.
    shades = (LIGHT, *STONES, PAPER, STONE, PINK, INK, MUTED, HAIRLINE, *own)
    image.putpalette([part for shade in shades for part in ImageColor.getrgb(shade)])
    draw = ImageDraw.Draw(image)
    top = SIZE[1] - CHART
    _paint(draw, [box(0, top, SIZE[0], CHART, PAPER), *moved(drawn.shapes, 0.0, top)])
    return image, axes(figure, SIZE[0], CHART)["x"]


def _paint(draw: ImageDraw, shapes: Iterable[Shape]) -> None:
    """Draw shapes as pixels of full colours."""
    for shape in shapes:
        if isinstance(shape, Text):
            draw.text(
                (shape.x, shape.y), shape.text.replace("−", "-"), fill=shape.colour or INK, anchor=PLACES[shape.anchor]
            )
        elif isinstance(shape, Path):
            points = [tuple(point) for point in shape.points_px.tolist()]
            if shape.fill or shape.closed:
                draw.polygon(points, fill=shape.fill or None, outline=shape.stroke or None)
            else:
                draw.line(points, fill=shape.stroke, width=max(1, round(shape.width)))


def _frame(stage: Stage, t_s: float, chart: Image, x_px: float) -> Image:
    from PIL import ImageDraw

    image = chart.copy()
    solid = stage.source.histories[stage.solid]
    theta = _value(solid, "theta_rad", t_s)
    floor = stage.pixels(1.1 * stage.vertices_m[:, 2].max() * FLOOR)
    shapes: list[Shape] = [area(floor, PAPER, STONE), *_faces(stage, _posed(stage, solid, t_s), solid, t_s)]
    label = f"{t_s:5.2f} s   {stage.solid}: {theta:+.3f} rad"
    if stage.ghost is not None:
        colour = look(stage.ghost, list(stage.source.runs)).colour
        shapes.append(area(_outline(stage, stage.source.histories[stage.ghost], t_s), "", colour))
        label += f"   outline: {stage.ghost}"
    shapes += [line([(x_px, SIZE[1] - CHART), (x_px, SIZE[1])], PINK, 2.0), Text(8.0, 18.0, label, "start")]
    _paint(ImageDraw.Draw(image), shapes)
    return image


def _in_plane_m(stage: Stage, points_m: Array, history: History, t_s: float) -> Array:
    """Points (k, 2) of the statue in the plane at a time, from the floor: on its pedestal's top, slid and tilted as that is."""
    names = ("theta_rad", "slip_m", "statue_slip_m", "pedestal_tilt_rad")
    theta, slip, own, tilt = (_value(history, name, t_s) for name in names)
    standing = float(stage.shape.pivot_m(theta - tilt))
    corner = standing + slip + own, 0.0
    if (pedestal := stage.source.scene.pedestal) is not None:
        # Along the top from its middle, which turns about the centroid.
        (x, up), half = _centre(stage, pedestal, slip, tilt), 0.5 * pedestal.height_m
        along, c, s = standing + own - _centre(stage, pedestal, 0.0, 0.0)[0], math.cos(tilt), math.sin(tilt)
        corner = x + along * c + half * s, up + half * c - along * s
    # Wherever the corner comes to lie as if the support were the table, it is there.
    there = stage.shape.posed_m([[standing, 0.0]], theta, 0.0)[0, 0]
    return np.asarray(stage.shape.posed_m(points_m, theta, 0.0)[0] + (np.array(corner) - there))


def _centre(stage: Stage, pedestal: Any, slip_m: float, tilt_rad: float) -> tuple[float, float]:
    """The pedestal's centroid, slid and on its lower edge."""
    middle = 0.5 * (stage.shape.corner_right_m - stage.shape.corner_left_m) + pedestal.offset_m
    x = middle + slip_m + float(centroid_shift_m(pedestal, np.asarray(tilt_rad)))
    return x, 0.5 * (pedestal.height_m * math.cos(tilt_rad) + pedestal.width_m * abs(math.sin(tilt_rad)))


def _posed(stage: Stage, history: History, t_s: float) -> Array:
    """The statue's vertices at a time: the whole pose of a 3D engine, else the planar one."""
    if all(name in history.extra for name in SOLID_COLUMNS):
        pose = {name: _value(history, name, t_s) for name in SOLID_COLUMNS}
        return posed_in_space_m(stage.vertices_m, stage.shape.corner_right_m, pose)
    posed = stage.vertices_m.copy()
    posed[:, [0, 2]] = _in_plane_m(stage, stage.vertices_m[:, [0, 2]], history, t_s)
    return posed


def _faces(stage: Stage, posed: Array, history: History, t_s: float) -> list[Shape]:
    """Visible faces of pedestal and statue from far to near in their shades."""
    groups = [(posed, stage.faces, GREYS - 1)]
    pedestal = stage.source.scene.pedestal
    if pedestal is not None:
        groups.insert(0, (*_pedestal(stage, pedestal, history, t_s), GREYS // 2))
    shapes: list[Shape] = []
    for vertices, faces, bright in groups:
        order, normals = facing(vertices, faces, EYE)
        shade = np.round(bright * (0.35 + 0.65 * np.clip(normals[order] @ SUN, 0.0, 1.0))).astype(int)
        corners = stage.pixels(vertices)[faces[order]]
        shapes += [area(points, STONES[k]) for points, k in zip(corners, shade, strict=True)]
    return shapes


def _pedestal(stage: Stage, pedestal: Any, history: History, t_s: float) -> tuple[Array, NDArray[np.int64]]:
    """The pedestal at a time: slid, and tilted, turned and shifted across where the engine recorded that."""
    slip, tilt, yaw, across = (
        _value(history, name, t_s) for name in ("slip_m", "pedestal_tilt_rad", "pedestal_yaw_rad", "pedestal_y_m")
    )
    w, d, h = 0.5 * pedestal.width_m, 0.5 * pedestal.depth_m, 0.5 * pedestal.height_m
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    c, s, cy, sy = math.cos(tilt), math.sin(tilt), math.cos(yaw), math.sin(yaw)
    turn = np.array([[cy * c, -sy, cy * s], [sy * c, cy, sy * s], [-s, 0.0, c]])
    x, up = _centre(stage, pedestal, slip, tilt)
    vertices = (signs * [w, d, h]) @ turn.T + [x, across, up]
    quads = [(0, 4, 5, 1), (2, 3, 7, 6), (0, 1, 3, 2), (4, 6, 7, 5), (1, 5, 7, 3), (0, 2, 6, 4)]
    return vertices, np.array([tri for a, b, c, e in quads for tri in ((a, b, c), (a, c, e))], dtype=np.int64)


def _value(history: History, name: str, t_s: float) -> float:
    """A column of a history at a time, 0 where the engine does not record it."""
    values = {"theta_rad": history.theta_rad, "slip_m": history.slip_m, **history.extra}.get(name)
    return 0.0 if values is None else float(np.interp(min(t_s, float(history.t_s[-1])), history.t_s, values))


def _outline(stage: Stage, history: History, t_s: float) -> Array:
    """The ghost's silhouette in the plane of its base's middle, in pixels."""
    posed = _in_plane_m(stage, silhouette_m(stage.source.scene, stage.source.mesh), history, t_s)
    return stage.pixels(np.column_stack([posed[:, 0], np.zeros(len(posed)), posed[:, 1]]))
