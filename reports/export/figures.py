"""Figures for papers: the charts of a record's page at print sizes, `rockcheck figures DIR`; a page as PDF."""

import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Final

from harness.model import InputError, Mistake, check_known, check_own, require, required, writing
from harness.records.base import Record, read_result
from harness.records.effects3d import EffectsRecord
from harness.records.run import RunRecord
from harness.records.study import StudyRecord
from reports.blocks import Chart, walk
from reports.charts import Json
from reports.charts.drawn import hatched, svg
from reports.charts.figure import INK, dark_css
from reports.charts.histories import histories_figure
from reports.charts.study_figures import panels_figure, rose_picture
from reports.drawing.effects_figures import changes, rose
from reports.drawing.shapes import Picture
from reports.pages.assets import source_text
from reports.pages.page import page_blocks
from reports.source import source_of
from reports.text.answers import Answers

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
