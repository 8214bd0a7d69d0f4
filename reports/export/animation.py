"""The replay as an animated GIF for slides: the statue's mesh, another model's outline, the histories under it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path as File
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from harness.model.errors import InputError, Mistake
from harness.model.files import check_own, writing
from harness.model.history import History
from reports.charts.drawn import svg
from reports.charts.figure import HAIRLINE, INK, MUTED, across, axis, figure, look, marks, named
from reports.charts.histories import histories_figure
from reports.drawing.display_mesh import display_mesh, facing, silhouette_m
from reports.drawing.kinematics import Section, posed_in_space_m, posed_pedestal_m, poses, section
from reports.drawing.replay import default_model
from reports.source import RunSource, run_source

if TYPE_CHECKING:
    from PIL.Image import Image

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
PLOT: Final = (62, 622)
"""From where to where the chart's time goes, in pixels."""
BOX: Final = np.array(
    [
        tri
        for a, b, c, d in [(0, 4, 5, 1), (2, 3, 7, 6), (0, 1, 3, 2), (4, 6, 7, 5), (1, 5, 7, 3), (0, 2, 6, 4)]
        for tri in ((a, b, c), (a, c, d))
    ]
)
"""The triangles of a block's corners."""
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
    chart = _chart(stage, start, end)
    moves = {name: poses(source.scene, source.histories[name], times) for name in {stage.solid, stage.ghost} if name}
    frames = [
        _frame(
            stage,
            float(t),
            {name: {key: float(column[k]) for key, column in each.items()} for name, each in moves.items()},
            chart,
        )
        for k, t in enumerate(times)
    ]
    for frame, t in zip(frames, times, strict=True):
        _line(frame, PLOT[0] + (t - start) / (end - start) * (PLOT[1] - PLOT[0]))
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


def _chart(stage: Stage, start_s: float, end_s: float) -> Image:
    """The background of every frame: the page's chart of all rotations under an empty floor."""
    import vl_convert
    from PIL import Image, ImageColor

    whole = histories_figure(stage.source)
    names = list(stage.source.histories)
    looks = {name: look(name, names) for name in names}
    x = across("t", "", {"domain": [start_s, end_s], "padding": 0})
    y = axis("theta", "", scale={"domain": whole["usermeta"]["views"]["near"]}, tickCount=3)
    data = {"histories": whole["datasets"]["histories"]}
    sides = {"left": PLOT[0], "right": SIZE[0] - PLOT[1], "top": 26, "bottom": 22}
    rotations = figure([marks("line", "histories", named(looks, chosen=False))], CHART - 48, data, x, y, padding=sides)
    drawn = svg(rotations | {"width": PLOT[1] - PLOT[0], "autosize": {"type": "none"}}, SIZE[0], background=PAPER)
    image = Image.new("P", SIZE)
    # All colours beforehand, so that every frame shares them.
    shades = (LIGHT, *STONES, PAPER, STONE, PINK, INK, MUTED, HAIRLINE, *(each.colour for each in looks.values()))
    image.putpalette([part for shade in shades for part in ImageColor.getrgb(shade)])
    with Image.open(BytesIO(vl_convert.svg_to_png(drawn))) as chart:
        image.paste(chart.convert("RGB").quantize(palette=image, dither=Image.Dither.NONE), (0, SIZE[1] - CHART))
    return image


def _line(frame: Image, x: float) -> None:
    """The time of a frame in its chart."""
    from PIL import ImageDraw

    ImageDraw.Draw(frame).line([(x, SIZE[1] - CHART + 26), (x, SIZE[1] - 22)], fill=PINK, width=2)


def _frame(stage: Stage, t_s: float, at: Mapping[str, Mapping[str, float]], chart: Image) -> Image:
    """The statue and its pedestal from far to near in their shades, another model's outline, and what is said of them."""
    from PIL import ImageDraw

    image = chart.copy()
    draw = ImageDraw.Draw(image)

    def area(points_px: Array, fill: str | None, outline: str | None = None) -> None:
        draw.polygon([tuple(point) for point in points_px.tolist()], fill=fill, outline=outline)

    area(stage.pixels(1.1 * stage.vertices_m[:, 2].max() * FLOOR), PAPER, STONE)
    corner, pose, pedestal = stage.shape.corner_right_m, at[stage.solid], stage.source.scene.pedestal
    groups = [(posed_in_space_m(stage.vertices_m, corner, pose), stage.faces, GREYS - 1)]
    if pedestal is not None:
        groups.insert(0, (posed_pedestal_m(pedestal, pedestal.depth_m, pose), BOX, GREYS // 2))
    for vertices, faces, bright in groups:
        order, normals = facing(vertices, faces, EYE)
        shade = np.round(bright * (0.35 + 0.65 * np.clip(normals[order] @ SUN, 0.0, 1.0))).astype(int)
        for points, k in zip(stage.pixels(vertices)[faces[order]], shade, strict=True):
            area(points, STONES[k])
    label = f"{t_s:5.2f} s   {stage.solid}: {_theta(stage, stage.solid, t_s):+.3f} rad"
    if stage.ghost is not None:
        outline = silhouette_m(stage.source.scene, stage.source.mesh)
        flat = np.column_stack([outline[:, 0], np.zeros(len(outline)), outline[:, 1]])
        area(
            stage.pixels(posed_in_space_m(flat, corner, at[stage.ghost])),
            None,
            look(stage.ghost, list(stage.source.runs)).colour,
        )
        label += f"   outline: {stage.ghost}"
    draw.text((8, 18), label, fill=INK, anchor="ls")
    return image


def _theta(stage: Stage, model: str, t_s: float) -> float:
    history = stage.source.histories[model]
    return float(np.interp(t_s, history.t_s, history.theta_rad))
