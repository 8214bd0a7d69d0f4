"""Figures for papers: the charts of a record's page at print sizes, `rockcheck figures DIR`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Final

from harness.model.errors import InputError, Mistake
from harness.model.files import check_own, writing
from harness.records.base import Record
from harness.records.effects3d import EffectsRecord
from harness.records.kinds import read_result
from harness.records.run import RunRecord
from harness.records.study import Panel, StudyRecord
from reports.blocks import Chart, walk
from reports.charts.histories import histories_figure
from reports.charts.palette import INK, dark_css
from reports.charts.static_svg import picture_of
from reports.charts.study_figures import panel_groups, panels_picture, rose_picture
from reports.drawing.effects_figures import changes, rose
from reports.drawing.shapes import ANCHORS, Disc, Picture, Text, titled
from reports.drawing.shapes import Path as Line
from reports.messages.numbers import drawn_text
from reports.pages.page import page_blocks
from reports.source import RunSource, source_of
from reports.text.pedestal_effect import pedestal_effect
from reports.text.study_rows import conditions

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# The shapes of a picture written for print: PNG and PDF through matplotlib's own drawing, SVG as they are.


DPI: Final = 300
TYPE_PT: Final = 8.0
"""Height of the type on paper: what journals ask for."""
MM_PER_PT: Final = 25.4 / 72.0


def pixels_across(width_mm: float, type_px: float = 13.0) -> float:
    """Width in pixels of a picture whose type is `TYPE_PT` high when it is printed that wide."""
    return width_mm / MM_PER_PT * type_px / TYPE_PT


def write_picture(picture: Picture, path: Path, dpi: int = DPI) -> Path:
    """Write a picture as .png, .pdf, .svg or .html, its type `TYPE_PT` high; one picture always gives one vector file."""
    kind = path.suffix[1:]
    with writing(path) as fresh:
        if kind == "html":
            fresh.write_text(_html(picture, path.stem), encoding="utf-8")
        elif kind == "svg":
            fresh.write_text(_svg(picture), encoding="utf-8")
        else:
            import matplotlib as mpl

            # Text stays text in a PDF; without a date the same record gives the same file.
            with mpl.rc_context({"pdf.fonttype": 42}):
                figure(picture).savefig(
                    fresh, format=kind, dpi=dpi, metadata={"CreationDate": None} if kind == "pdf" else None
                )
    return path


def _html(picture: Picture, name: str) -> str:
    """A page of the picture alone, which fits its window and takes a dark screen's colours; its texts describe it."""
    words = ". ".join(shape.text for shape in picture.shapes if isinstance(shape, Text) and len(shape.text) > 1)
    look = (
        "body{margin:0;background:#fff}svg{display:block;margin:auto;max-width:100%;height:96vh;font:13px sans-serif}"
    )
    dark = "@media screen and (prefers-color-scheme:dark){body{background:#1a2028}svg{fill:#e4e8ee}}"
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escape(name)}</title>'
    style = f"<style>{look}{dark}{dark_css()}</style>"
    body = f"<main>{picture.svg(words)}</main>"
    return f'<!doctype html>\n<html lang="en"><head>{head}{style}</head>\n<body>{body}</body></html>\n'


def _svg(picture: Picture) -> str:
    per_px = TYPE_PT / picture.type_px * MM_PER_PT
    size = f'width="{picture.width * per_px:.2f}mm" height="{picture.height * per_px:.2f}mm" '
    type_ = f'font-family="DejaVu Sans, sans-serif" font-size="{picture.type_px:g}" fill="{INK}" '
    drawn = picture.svg().replace("<svg ", f"<svg {size}{type_}", 1)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{drawn}\n'


def figure(picture: Picture) -> Figure:
    """The picture as a matplotlib figure of its size on paper."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle, PathPatch
    from matplotlib.path import Path as Outline
    from matplotlib.transforms import Affine2D

    pt = TYPE_PT / picture.type_px
    drawing = Figure(figsize=(picture.width * pt / 72.0, picture.height * pt / 72.0))
    onto = Affine2D().scale(1.0 / picture.width, -1.0 / picture.height).translate(0.0, 1.0) + drawing.transFigure
    for shape in picture.shapes:
        if isinstance(shape, Text):
            place = shape.x / picture.width, 1.0 - shape.y / picture.height
            size, turn = pt * (shape.size_px or picture.type_px), 90.0 if shape.turned else 0.0
            drawing.text(
                *place, drawn_text(shape.text), ha=ANCHORS[shape.anchor], va="baseline", fontsize=size, rotation=turn,
                rotation_mode="anchor", color=shape.colour or INK,
            )  # fmt: skip
            continue
        width = pt * shape.width if shape.stroke else 0.0
        # Matplotlib counts dashes in widths of their line.
        dash = (0, [float(part) / shape.width for part in shape.dash.split()]) if shape.dash and width else "solid"
        style = {
            "facecolor": shape.fill or "none", "edgecolor": shape.stroke or "none", "linewidth": width, "linestyle": dash,
            "alpha": None if shape.opacity == 1.0 else shape.opacity, "transform": onto,
        }  # fmt: skip
        if isinstance(shape, Disc):
            drawing.add_artist(Circle((shape.x, shape.y), shape.radius, **style))
        elif isinstance(shape, Line):
            drawing.add_artist(PathPatch(Outline(shape.points_px, closed=False), **style))
    return drawing


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
    for value, known, option in [
        *((item, FORMATS, "--format") for item in formats),
        (width, tuple(WIDTHS_MM), "--width"),
    ]:
        if value not in known:
            raise InputError(Mistake(option, "", f"one of {', '.join(known)}", repr(value)))
    record = read_result(folder)
    pictures = dict(_pictures(folder, record, pixels_across(WIDTHS_MM[width]), model))
    if not pictures:
        raise InputError(Mistake(str(folder), "", "a record with charts", f"a {record.kind} without"))
    target = folder / "figures"
    target.mkdir(exist_ok=True)
    paths = {target / f"{name}.{kind}": drawn for name, drawn in pictures.items() for kind in formats}
    for path in paths:
        check_own(path)
    return [write_picture(drawn, path) for path, drawn in paths.items()]


def _pictures(folder: Path, record: Record, width_px: float, model: str | None) -> Iterator[tuple[str, Picture]]:
    """The name and the picture of each figure of a record: every chart of its page."""
    if isinstance(record, RunRecord):
        source = source_of(folder, record)
        if source.histories:
            yield "histories", histories_picture(source, width_px)
        return
    if isinstance(record, EffectsRecord):
        yield "rose", as_wide(rose(record), width_px)
        yield "effects", as_wide(changes(record), width_px)
        return
    for chart in walk(page_blocks(folder, record)):
        if isinstance(chart, Chart) and chart.name not in ("saved", "moved"):
            yield chart.name, titled(picture_of(chart.figure, width_px, POINTS), chart.words)
    if isinstance(record, StudyRecord):
        yield from _study_pictures(record, width_px, model)


def _study_pictures(record: StudyRecord, width_px: float, model: str | None) -> Iterator[tuple[str, Picture]]:
    """What a study's page shows beside its charts: panels, what the pedestal changes, a rose."""
    for group in panel_groups(record.panels):
        chosen = _chosen(group, model)
        name = f"panels_{group[0].restitution:g}_{chosen}".replace(" ", "_").replace("(", "").replace(")", "")
        yield name, panels_picture(group, chosen, width_px, POINTS)
    models, cases = conditions(record.rows)
    effect = pedestal_effect(record, models, cases)
    for chart in () if effect is None else effect.charts:
        yield chart.name, titled(picture_of(chart.figure, width_px, POINTS), chart.words)
    drawn = rose_picture(models, cases)
    if drawn is not None:
        yield "rose", as_wide(drawn, width_px)


def _chosen(group: Sequence[Panel], model: str | None) -> str:
    known = list(dict.fromkeys(name for panel in group for name in panel.curves))
    if model is not None and model not in known:
        raise InputError(Mistake("--model", "", f"one of {', '.join(known)}", repr(model)))
    return model or known[0]


def histories_picture(source: RunSource, width_px: float) -> Picture:
    """The page's histories of all models over the event, with the key of the motion patterns, which the page writes below."""
    figure = histories_figure(source)
    data = [trace | {"showlegend": True} if trace["type"] == "bar" else trace for trace in figure["data"]]
    layout = figure["layout"] | {"height": 0.8 * figure["layout"]["height"]}
    return picture_of({"data": data, "layout": layout}, width_px, POINTS)


def as_wide(drawn: Picture, width_px: float) -> Picture:
    """A picture of a size of its own as wide on paper as others: its letters stay as high as theirs."""
    return replace(drawn, type_px=drawn.type_px * drawn.width / width_px)
