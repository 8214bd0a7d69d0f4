"""A still picture of every chart, as SVG from the same figure: what the page shows first, and all it shows without scripts."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from html import escape, unescape
from typing import Any, Final

import numpy as np
from markupsafe import Markup

from reports.charts.decimate import kept_samples
from reports.charts.palette import HAIRLINE, INK, MUTED
from reports.charts.static_svg_axes import LETTER, MARGIN, Array, Axis, Json, axes, numbers
from reports.text.numbers import short

WIDE: Final = 1060
"""Width in pixels of a chart that fills the page."""
KNOWN: Final = frozenset({"scatter", "bar", "heatmap"})
POINTS: Final = 1200
"""Most points of a curve: more than pixels across."""
DASHES: Final = {"solid": "", "dash": "6 4", "dot": "1.5 3", "longdash": "10 4", "dashdot": "6 3 1.5 3"}
SCALES: Final[Mapping[str, Sequence[tuple[float, str]]]] = {
    "Cividis": ((0.0, "#00204c"), (0.25, "#414d6b"), (0.5, "#7b7b78"), (0.75, "#bcae6c"), (1.0, "#ffe945"))
}
"""Colour scales that figures call by name."""
_TAG: Final = re.compile(r"<[^>]+>")


def still(figure: Json, width: int = WIDE) -> Markup:
    """The figure as inline SVG; empty for kinds of chart that have no still."""
    if any(trace.get("type") not in KNOWN for trace in figure["data"]):
        return Markup("")
    layout = figure["layout"]
    height = int(layout.get("height", 360))
    places = axes(figure, width, height)
    parts = [*_frames(places), *_levels(layout, places, width, height)]
    bars = [trace for trace in figure["data"] if trace["type"] == "bar" and "offset" not in trace]
    for trace in figure["data"]:
        x, y = places[trace.get("xaxis", "x")], places[trace.get("yaxis", "y")]
        if trace["type"] == "heatmap":
            parts += _heatmap(trace, x, y)
        elif trace["type"] == "bar":
            beside = len(bars) if layout.get("barmode") == "group" and trace in bars else 1
            parts += _bars(trace, x, y, bars.index(trace) if beside > 1 else 0, beside)
        else:
            parts += _curve(trace, x, y)
    parts += _notes(layout, places, width, height) + _legend(figure)
    return Markup(
        f'<svg class="still" viewBox="0 0 {width} {height}" aria-hidden="true" xmlns="http://www.w3.org/2000/svg">'
        + "".join(parts)
        + "</svg>"
    )


def _text(x: float, y: float, text: str, anchor: str = "middle", more: str = "") -> str:
    plain = escape(unescape(_TAG.sub(" ", str(text))).strip())
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{plain}</text>'


def _line(x0: float, y0: float, x1: float, y1: float, colour: str, width: float = 1.0, dash: str = "") -> str:
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" stroke="{colour}" stroke-width="{width:g}"{dashed}/>'


def _frames(places: Mapping[str, Axis]) -> list[str]:
    """Grid, ticks and titles; the lowest row carries the common axis."""
    parts = []
    down = max(axis.start_px for name, axis in places.items() if name.startswith("y"))
    across = next(axis for name, axis in places.items() if name.startswith("x"))
    for name, axis in places.items():
        title = (axis.spec.get("title") or {}).get("text", "")
        if name.startswith("y"):
            for at, text in axis.ticks():
                parts.append(_line(across.start_px, at, across.end_px, at, HAIRLINE))
                parts.append(_text(across.start_px - 6, at + 4, text, "end"))
            middle = 0.5 * (axis.start_px + axis.end_px)
            parts.append(_text(0, 0, title, more=f' transform="translate(14 {middle:.1f}) rotate(-90)"'))
            continue
        top = min(other.end_px for key, other in places.items() if key.startswith("y"))
        for at, text in axis.ticks():
            parts += [_line(at, top, at, down, HAIRLINE), _text(at, down + 17, text)]
        parts.append(_text(0.5 * (axis.start_px + axis.end_px), down + 38, title))
    return parts


def _style(trace: Json) -> tuple[str, float, str]:
    line = trace.get("line") or {}
    dash = str(line.get("dash", ""))
    drawn = DASHES.get(dash, dash.replace("px", "").replace(",", " "))
    return str(line.get("color") or (trace.get("marker") or {}).get("color") or INK), float(line.get("width", 2)), drawn


def _curve(trace: Json, x: Axis, y: Axis) -> list[str]:
    raw_x, raw_y = numbers(trace["x"]), numbers(trace["y"])
    if len(raw_x) == 0:
        return []
    px, py = x.px(raw_x), y.px([np.nan if value is None else value for value in raw_y])
    low, high = sorted((y.start_px, y.end_px))
    inside = np.clip(py, low - 1.0, high + 1.0)
    colour, width, dash = _style(trace)
    parts = []
    mode = str(trace.get("mode", "lines+markers"))
    if trace.get("fill") == "toself":
        fill = trace.get("fillcolor", HAIRLINE)
        return [f'<path d="M{_points(px, inside)}Z" fill="{fill}" stroke="none"/>']
    if "lines" in mode and width > 0:
        pieces = np.split(np.arange(len(px)), np.flatnonzero(~np.isfinite(py)))
        for piece in pieces:
            piece = piece[np.isfinite(py[piece])]
            if len(piece) > 1:
                kept = piece[kept_samples(inside[piece], POINTS)]
                dashed = f' stroke-dasharray="{dash}"' if dash else ""
                path = _points(px[kept], inside[kept])
                parts.append(f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="{width:g}"{dashed}/>')
    if "markers" in mode:
        marker = (trace.get("marker") or {}).get("color", colour)
        colours = marker if isinstance(marker, list) else [marker] * len(px)
        parts += [
            f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3.5" fill="{shade}"/>'
            for a, b, shade in zip(px, py, colours, strict=True)
            if low - 1.0 <= b <= high + 1.0
        ]
    return parts


def _points(px: Array, py: Array) -> str:
    kept = kept_samples(py, POINTS) if len(py) > 2 * POINTS else np.arange(len(py))
    return "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(px[kept].tolist(), py[kept].tolist(), strict=True))


def _bars(trace: Json, x: Axis, y: Axis, number: int, beside: int) -> list[str]:
    """Bars, upright or lying; several of one place stand `beside` each other."""
    lying = trace.get("orientation") == "h"
    along, across = (x, y) if lying else (y, x)
    sizes, places = (trace["x"], trace["y"]) if lying else (trace["y"], trace["x"])
    bases = trace.get("base", [0.0] * len(sizes))
    slot = abs(across.end_px - across.start_px) / max(1, len(across.names) or len(places))
    thick = slot * float(trace.get("width", 0.8)) / beside
    colour = (trace.get("marker") or {}).get("color", INK)
    colours = colour if isinstance(colour, list) else [colour] * len(sizes)
    texts = trace.get("text") or [""] * len(sizes)
    parts = []
    for size, place, base, shade, text in zip(sizes, places, bases, colours, texts, strict=True):
        middle = float(across.px(place)[0]) + (number - 0.5 * (beside - 1)) * thick
        a, b = float(along.px(base)[0]), float(along.px(base + size)[0])
        start, length = min(a, b), abs(b - a)
        box = (start, middle - thick / 2, length, thick) if lying else (middle - thick / 2, start, thick, length)
        parts.append(_rect(*box, shade))
        if text:
            parts.append(_text(b + 5, middle + 4, text, "start") if lying else _text(middle, b - 5, text))
    return parts


def _heatmap(trace: Json, x: Axis, y: Axis) -> list[str]:
    """Cells in the colours of the trace's scale, neighbours of one colour drawn as one; a key where the trace has a bar."""
    levels = np.asarray(numbers(trace["z"]), dtype=np.float64)
    low = float(trace.get("zmin", np.nanmin(levels)))
    high = float(trace.get("zmax", np.nanmax(levels)))
    shades = _shades(trace, (levels - low) / ((high - low) or 1.0))
    xs, ys = _edges(x.px(trace["x"])), _edges(y.px(trace["y"]))
    parts = []
    for i, row in enumerate(shades):
        top, start = min(ys[i], ys[i + 1]), 0
        for j, shade in enumerate(row):
            if j + 1 < len(row) and row[j + 1] == shade:
                continue
            if shade:
                parts.append(_rect(xs[start], top, xs[j + 1] - xs[start], abs(ys[i + 1] - ys[i]), shade))
            start = j + 1
    title = ((trace.get("colorbar") or {}).get("title") or {}).get("text")
    if title:
        key = _shades(trace, np.array([[0.0, 0.25, 0.5, 0.75, 1.0]]))[0]
        right = x.end_px - 40.0
        parts += [_rect(right - 100 + 20 * k, 8, 20, 12, shade) for k, shade in enumerate(key)]
        parts.append(_text(right - 106, 18, f"{title}: {short(low, 3)}", "end"))
        parts.append(_text(right + 6, 18, short(high, 3), "start"))
    return parts


def _shades(trace: Json, shares: Array) -> list[list[str]]:
    """The colour of each share of a heatmap's range, empty where there is no value."""
    scale = trace["colorscale"]
    stops = SCALES[scale] if isinstance(scale, str) else scale
    places = np.array([float(at) for at, _ in stops])
    colours = np.array([[int(colour[i : i + 2], 16) for i in (1, 3, 5)] for _, colour in stops])
    clipped = np.clip(1.0 - shares if trace.get("reversescale") else shares, 0.0, 1.0)
    mixed = np.stack([np.interp(clipped, places, colours[:, k]) for k in range(3)], axis=-1)
    return [
        ["" if np.isnan(cell).any() else "#{:02x}{:02x}{:02x}".format(*np.round(cell).astype(int)) for cell in row]
        for row in mixed
    ]


def _rect(left: float, top: float, width: float, height: float, fill: str) -> str:
    return f'<rect x="{left:.1f}" y="{top:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{fill}"/>'


def _edges(centres: Array) -> list[float]:
    if len(centres) < 2:
        return [float(centres[0]) - 20.0, float(centres[0]) + 20.0]
    middle = 0.5 * (centres[1:] + centres[:-1])
    return [2 * centres[0] - middle[0], *middle.tolist(), 2 * centres[-1] - middle[-1]]


def _at(value: Any, ref: str, places: Mapping[str, Axis], width: float, height: float, letter: str) -> float:
    """A place of a shape or note: on an axis, or as a share of an axis' stretch or of the whole picture."""
    axis, _, domain = ref.partition(" ")
    if axis == "paper":
        inner = places["x"] if letter == "x" else None
        start, end = (inner.start_px, inner.end_px) if inner else (height - MARGIN["bottom"], MARGIN["top"])
        return start + float(value) * (end - start)
    if domain:
        return places[axis].start_px + float(value) * (places[axis].end_px - places[axis].start_px)
    return float(places[axis].px(value)[0])


def _levels(layout: Json, places: Mapping[str, Axis], width: float, height: float) -> list[str]:
    parts = []
    for shape in layout.get("shapes") or ():
        (x0, x1), (y0, y1) = (
            [
                _at(shape[f"{letter}{end}"], shape.get(f"{letter}ref", letter), places, width, height, letter)
                for end in "01"
            ]
            for letter in "xy"
        )
        line = shape.get("line") or {}
        if shape["type"] == "line":
            dash = DASHES.get(str(line.get("dash", "")), "")
            parts.append(_line(x0, y0, x1, y1, line.get("color", INK), float(line.get("width", 1)), dash))
        else:
            box = (min(x0, x1), min(y0, y1), abs(x1 - x0), abs(y1 - y0), shape.get("fillcolor", HAIRLINE))
            faint = f' opacity="{shape.get("opacity", 1)}"'
            parts.append(
                '<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"'.format(*box) + faint + "/>"
            )
    return parts


def _notes(layout: Json, places: Mapping[str, Axis], width: float, height: float) -> list[str]:
    parts = []
    for note in layout.get("annotations") or ():
        x, y = (_at(note[letter], note.get(f"{letter}ref", letter), places, width, height, letter) for letter in "xy")
        anchor = {"left": "start", "right": "end"}.get(note.get("xanchor", ""), "middle")
        drop = {"bottom": -4.0, "top": 13.0}.get(note.get("yanchor", ""), 4.0)
        colour = (note.get("font") or {}).get("color", MUTED)
        parts.append(_text(x, y + drop, note["text"], anchor, f' fill="{colour}" font-size="11"'))
    return parts


def _legend(figure: Json) -> list[str]:
    parts, x = [], MARGIN["left"]
    named: Sequence[Json] = [
        trace for trace in figure["data"] if trace.get("name") and trace.get("showlegend") is not False
    ]
    for trace in named if figure["layout"].get("showlegend", len(named) > 1) else ():
        colour, _, dash = _style(trace)
        parts += [_line(x, 14, x + 26, 14, colour, 2.5, dash), _text(x + 32, 18, trace["name"], "start")]
        x += 56 + LETTER * len(str(trace["name"]))
    return parts
