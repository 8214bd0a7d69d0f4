"""The shapes of a picture written for print: PNG and PDF through matplotlib's own drawing, SVG as they are."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Final

from harness.model.files import writing
from reports.charts.palette import INK, dark_css
from reports.drawing.shapes import ANCHORS, Disc, Picture, Text
from reports.drawing.shapes import Path as Line
from reports.messages.numbers import drawn_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
