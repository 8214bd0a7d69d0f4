"""What leaves a page: its charts at print sizes (`rockcheck figures DIR`), itself as PDF, its replay as an animated GIF."""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from html import escape
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from harness.model import Array, History, InputError, Mistake, check_known, check_own, require, required, writing
from harness.records.base import Record, read_result
from harness.records.effects3d import EffectsRecord
from harness.records.run import RunRecord
from harness.records.scene import SceneRecord
from harness.records.study import StudyRecord
from reports.blocks import Chart, walk
from reports.charts.figure import (
    HAIRLINE,
    INK,
    MUTED,
    Json,
    across,
    axis,
    dark_css,
    figure,
    hatched,
    look,
    marks,
    named,
    svg,
)
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
from reports.drawing.pictures import Picture, plane
from reports.pages.page import page_blocks, source_text
from reports.pages.run_page import changes, default_model, histories_figure, rose
from reports.pages.study_page import panels_figure, rose_picture
from reports.source import Answers, RunSource, run_source, source_of

if TYPE_CHECKING:
    from PIL.Image import Image


# A page printed to PDF by the machine's own Chromium: the stills in place of the live charts, nothing folded away.

BROWSERS: Final = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
LIMIT_S: Final = 180.0
"""A page of 15 MB prints in some ten seconds; a browser that takes longer than this hangs."""
_SCRIPT: Final = re.compile(r"<script\b.*?</script>", re.DOTALL)
_PAGE_LINK: Final = re.compile(r' href="(?:report|conservator)\.html"')
"""Links to pages beside this one, which would name a folder of this machine in the PDF."""


def browser() -> str:
    """The path of the browser that prints. Raises `InputError` where there is none."""
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    wanted = "Chromium on this machine, which prints the page"
    return required(path, "--pdf", wanted, "none found", "on Debian: apt-get install chromium")


def write_pdf(page: Path) -> Path:
    """Print a page beside itself, as .pdf; returns that file.

    Raises `InputError` without a browser, for a PDF of another's making in the way, and where the browser fails.
    """
    program, target = browser(), page.with_suffix(".pdf")
    check_own(target, option="--pdf")
    text = _PAGE_LINK.sub("", _SCRIPT.sub("", page.read_text(encoding="utf-8")))
    text = text.replace("</body>", f"<script>{source_text('units.js')}</script></body>")
    with tempfile.TemporaryDirectory() as spare, writing(target) as fresh:
        copy, printed = Path(spare, page.name), Path(spare, target.name)
        copy.write_text(text.replace("<details", "<details open"), "utf-8")
        # Chromium refuses its sandbox to root.
        alone = ["--no-sandbox"] if os.geteuid() == 0 else []
        options = ["--headless", *alone, "--disable-gpu", f"--user-data-dir={spare}/profile", "--no-pdf-header-footer"]
        call = [program, *options, f"--print-to-pdf={printed}", copy.as_uri()]
        try:
            done = subprocess.run(call, capture_output=True, text=True, timeout=LIMIT_S, check=False)
        except subprocess.TimeoutExpired as error:
            raise InputError(Mistake("--pdf", "", f"a PDF within {LIMIT_S:g} s", f"none from {program}")) from error
        *_, said = ["nothing", *done.stderr.strip().splitlines()]
        require(printed.is_file(), "--pdf", "a PDF", f"none: {program} ended with {done.returncode}, {said}")
        fresh.write_bytes(printed.read_bytes())
    return target


DPI: Final = 300
TYPE_PT: Final = 8.0
"""Height of the type on paper: what journals ask for."""
MM_PER_PT: Final = 25.4 / 72.0
PT_PER_PX: Final = 72.0 / 96.0
"""Points of a pixel as SVG counts them."""
TYPE_PX: Final = 13.0
"""Height of the type of charts."""


def pixels_across(width_mm: float) -> float:
    """Width in pixels of a chart whose type is `TYPE_PT` high when it is printed that wide."""
    return width_mm / MM_PER_PT * TYPE_PX / TYPE_PT


def printed(drawing: Picture | Json, width_px: float, words: str = "") -> str:
    """A picture, or a chart with `words` over it, as SVG as wide on paper as so many pixels, its type `TYPE_PT` high."""
    if isinstance(drawing, Picture):
        type_px = TYPE_PX * drawing.width / width_px
        drawn = str(drawing.svg()).replace(
            "<svg ", f'<svg font-family="sans-serif" font-size="{type_px:g}" fill="{INK}" ', 1
        )
    else:
        drawn = hatched(svg(drawing, width_px, POINTS, words))
    head, box, rest = re.split(r'(?:width="[\d.]+" height="[\d.]+" )?viewBox="([^"]*)"', drawn, maxsplit=1)
    wide, high = map(float, box.split()[2:])
    # A chart is drawn about as wide as asked: on paper it is.
    per_px = TYPE_PT / TYPE_PX * MM_PER_PT * width_px / wide
    size = f'width="{wide * per_px:.2f}mm" height="{high * per_px:.2f}mm" viewBox="{box}"'
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{head}{size}{rest}\n'


def write_picture(drawn: str, path: Path, dpi: int = DPI) -> Path:
    """Write an SVG of `printed` as .png, .pdf, .svg or .html."""
    kind = path.suffix[1:]
    with writing(path) as fresh:
        if kind == "html":
            fresh.write_text(_html(drawn, path.stem), encoding="utf-8")
        elif kind == "svg":
            fresh.write_text(drawn, encoding="utf-8")
        else:
            import vl_convert

            if kind == "pdf":
                # To that writer a pixel is a point.
                made = vl_convert.svg_to_pdf(
                    re.sub(r'="([\d.]+)mm"', lambda mm: f'="{float(mm[1]) / MM_PER_PT:.2f}"', drawn, count=2)
                )
            else:
                white = re.sub(r"(<svg [^>]*>)", r'\1<rect width="100%" height="100%" fill="#ffffff"/>', drawn, count=1)
                made = vl_convert.svg_to_png(white, PT_PER_PX, dpi)
            fresh.write_bytes(made)
    return path


def _html(drawn: str, name: str) -> str:
    """A page of the picture alone, which fits its window and takes a dark screen's colours; its texts describe it."""
    words = escape(". ".join(re.findall(r">([^<>\n]{2,})</text>", drawn)))
    look = "body{margin:0;background:#fff}svg{display:block;margin:auto;max-width:100%;height:96vh}"
    dark = "@media screen and (prefers-color-scheme:dark){body{background:#1a2028}svg{fill:#e4e8ee}}"
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escape(name)}</title>'
    style = f"<style>{look}{dark}{dark_css()}</style>"
    picture = re.sub(r'aria-hidden="true"', f'role="img" aria-label="{words}"', drawn[drawn.index("<svg") :], count=1)
    return f'<!doctype html>\n<html lang="en"><head>{head}{style}</head>\n<body><main>{picture}</main></body></html>\n'


WIDTHS_MM: Final = {"column": 85.0, "page": 178.0}
"""A column and a page of most journals."""
FORMATS: Final = ("png", "svg", "pdf")
POINTS: Final = 2400
"""Most points of a printed curve: more than dots across a page at 300 dpi."""


def write_figures(
    folder: Path, formats: Sequence[str] = FORMATS, width: str = "page", model: str | None = None
) -> list[Path]:
    """Write the figures of a result folder into `figures/` in it; returns the files.

    `model` chooses the model of a study's panels, such as `pymunk (own impact)`; default: its first.
    Raises `InputError` for an unknown format, width or model, or a record that holds nothing to draw.
    """
    for each in formats:
        check_known(each, FORMATS, "--format")
    check_known(width, WIDTHS_MM, "--width")
    record = read_result(folder)
    width_px = pixels_across(WIDTHS_MM[width])
    pictures = {name: printed(drawn, width_px, words) for name, words, drawn in _pictures(folder, record, model)}
    require(pictures, str(folder), "a record with charts", f"a {record.kind} without")
    target = folder / "figures"
    target.mkdir(exist_ok=True)
    paths = {target / f"{name}.{kind}": drawn for name, drawn in pictures.items() for kind in formats}
    for path in paths:
        check_own(path)
    return [write_picture(drawn, path) for path, drawn in paths.items()]


def _pictures(folder: Path, record: Record, model: str | None) -> Iterator[tuple[str, str, Picture | Json]]:
    """The name, the words over it and the drawing of each figure of a record: every chart of its page."""
    if isinstance(record, RunRecord):
        source = source_of(folder, record)
        if source.histories:
            yield "histories", "", histories_figure(source)
        return
    if isinstance(record, EffectsRecord):
        yield "rose", "", rose(record)
        yield "effects", "", changes(record)
        return
    if isinstance(record, StudyRecord):
        yield from _panels(record, model)
    for chart in walk(page_blocks(folder, record)):
        if isinstance(chart, Chart) and chart.name != "panels":
            yield chart.name, chart.words, chart.figure
    if isinstance(record, StudyRecord) and (drawn := rose_picture(Answers.of(record.rows))) is not None:
        yield "rose", "", drawn


def _panels(record: StudyRecord, model: str | None) -> Iterator[tuple[str, str, Json]]:
    """The panels of a study for every restitution, of which its page shows one."""
    panels = record.panels or []
    known = list(dict.fromkeys(name for panel in panels for name in panel.curves))
    if known and model is not None:
        check_known(model, known, "--model")
    for restitution in sorted({panel.restitution for panel in panels}):
        mine = [panel for panel in panels if panel.restitution == restitution]
        chosen = model or next(iter(mine[0].curves))
        name = re.sub(r"[()]", "", f"panels_{restitution:g}_{chosen}".replace(" ", "_"))
        yield name, f"{chosen}, r = {restitution:g}", panels_figure(mine, chosen)


# The replay as an animated GIF for slides: the statue's mesh, another model's outline, the histories under it.

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


def write_gif(folder: Path, path: Path | None = None, model: str | None = None) -> Path:
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
    seen = plane((SIZE[1] - CHART - 40) / (1.18 * size_m), (middle, 0.0), (SIZE[0] / 2, SIZE[1] - CHART - 34))
    return lambda points_m: seen(points_m @ VIEW[:2].T)
