"""The replay as an animated GIF for slides: the statue's mesh, another model's outline, the histories under it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path as File
from typing import TYPE_CHECKING, Final

import numpy as np

from harness.model import Array, History, check_known, check_own, require, writing
from harness.records.scene import SceneRecord
from reports.charts.drawn import svg
from reports.charts.figure import HAIRLINE, INK, MUTED, across, axis, figure, look, marks, named
from reports.charts.histories import histories_figure
from reports.drawing.kinematics import (
    display_mesh,
    eye_axes,
    facing,
    in_sight_m,
    posed_m,
    posed_pedestal_m,
    poses,
    sampled,
    silhouette_m,
)
from reports.drawing.shapes import plane
from reports.pages.run_page import default_model
from reports.source import RunSource, run_source

if TYPE_CHECKING:
    from PIL.Image import Image

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
VIEW: Final = eye_axes(0.42 - 0.5 * math.pi, 0.16)
"""The axes of the eye: it looks along y, from somewhat to the right and above."""
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


def write_gif(folder: File, path: File | None = None, model: str | None = None) -> File:
    """Write the replay of a run's folder as a GIF (default `replay.gif` in it), in real time at 20 frames per second.

    Raises `InputError` for a folder without a run, without histories, or for a model that it does not hold.
    """
    source = run_source(folder)
    require(source.histories, str(folder), "a run with histories", "a record without any")
    target = path or folder / "replay.gif"
    require(target.suffix == ".gif", "--out", "a file ending in .gif", str(target))
    check_own(target, option="--out")
    solid = model or default_model(source)
    check_known(solid, source.histories, "--model")
    window_s = _window(source.histories[solid])
    frames = list(_frames(source, solid, window_s, _chart(source, window_s)))
    with writing(target) as fresh:
        pace = {"duration": 1000 // FRAMES_PER_S, "loop": 0, "disposal": 1}
        frames[0].save(fresh, format="GIF", save_all=True, append_images=frames[1:], **pace)
    return target


def _window(history: History) -> tuple[float, float]:
    end = float(history.t_s[-1])
    if end <= LONGEST_S:
        return 0.0, end
    peak = float(history.t_s[int(np.argmax(np.abs(history.theta_rad)))])
    start = min(max(0.0, peak - 0.6 * LONGEST_S), end - LONGEST_S)
    return start, start + LONGEST_S


def _chart(source: RunSource, window_s: tuple[float, float]) -> Image:
    """The background of every frame: the page's chart of all rotations under an empty floor."""
    import vl_convert
    from PIL import Image, ImageColor

    whole = histories_figure(source)
    names = list(source.histories)
    looks = {name: look(name, names) for name in names}
    x = across("t", "", {"domain": list(window_s), "padding": 0})
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


def _frames(source: RunSource, solid: str, window_s: tuple[float, float], chart: Image) -> Iterator[Image]:
    """Of each time the statue and its pedestal from far to near in their shades, another model's outline and words."""
    from PIL import ImageDraw

    scene, histories = source.scene, source.histories
    times = np.arange(window_s[0], window_s[1] + 0.5 / FRAMES_PER_S, 1.0 / FRAMES_PER_S)
    vertices_m, faces = display_mesh(scene, source.mesh, most_faces=4000)
    moves = poses(scene, sampled(histories[solid], times))
    size_m = in_sight_m(scene, [moves])
    place = _projection(scene, size_m)
    bodies = [(posed_m(scene, vertices_m, moves), faces, GREYS - 1)]
    if scene.pedestal is not None:
        bodies.insert(0, (posed_pedestal_m(scene.pedestal, moves), BOX, GREYS // 2))
    theta_rad = np.interp(times, histories[solid].t_s, histories[solid].theta_rad)
    ghost = "analytic" if "analytic" in histories and solid != "analytic" else None
    outline = np.insert(silhouette_m(scene, source.mesh), 1, 0.0, axis=1)
    other = posed_m(scene, outline, poses(scene, sampled(histories[ghost or solid], times)))
    for k, t in enumerate(times):
        frame = chart.copy()
        draw = ImageDraw.Draw(frame)
        draw.polygon(place(1.1 * size_m * FLOOR).ravel().tolist(), fill=PAPER, outline=STONE)
        for posed, corners, bright in bodies:
            order, normals = facing(posed[k], corners, VIEW[2])
            shade = np.round(bright * (0.35 + 0.65 * np.clip(normals[order] @ SUN, 0.0, 1.0))).astype(int)
            for points, grey in zip(place(posed[k])[corners[order]], shade, strict=True):
                draw.polygon(points.ravel().tolist(), fill=STONES[grey])
        label = f"{t:5.2f} s   {solid}: {round(float(theta_rad[k]), 3) + 0.0:+.3f} rad"
        if ghost is not None:
            draw.polygon(place(other[k]).ravel().tolist(), outline=look(ghost, list(source.runs)).colour)
            label += f"   outline: {ghost}"
        draw.text((8, 18), label, fill=INK, anchor="ls")
        x = PLOT[0] + (t - window_s[0]) / (window_s[1] - window_s[0]) * (PLOT[1] - PLOT[0])
        draw.line([(x, SIZE[1] - CHART + 26), (x, SIZE[1] - 22)], fill=PINK, width=2)
        yield frame


def _projection(scene: SceneRecord, size_m: float) -> Callable[[Array], Array]:
    """What places points (n, 3) in the picture, so that what is so high fills it."""
    middle = 0.5 * (scene.statue.corner_right_m - scene.statue.corner_left_m) * VIEW[0, 0]
    scale = (SIZE[1] - CHART - 40) / (1.18 * size_m)
    seen = plane(scale, (middle, 0.0), (SIZE[0] / 2, SIZE[1] - CHART - 34))
    return lambda points_m: seen(points_m @ VIEW[:2].T)
