"""A still picture of every chart from its figure: what a page shows first and without scripts, and what is printed."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from html import unescape
from typing import Any, Final

import numpy as np
from markupsafe import Markup

from reports.charts import Json
from reports.charts.palette import HAIRLINE, INK, MUTED, solid
from reports.charts.samples import numbers, thinned_px
from reports.charts.static_svg_axes import MARGIN, Array, Axis, axes
from reports.drawing.shapes import LETTER, Disc, Path, Picture, Shape, Text, area, box, line
from reports.messages.numbers import short

# A heatmap's still picture: cells in the colours of its scale, and a key.


SCALES: Final[Mapping[str, Sequence[tuple[float, str]]]] = {
    "Cividis": ((0.0, "#00204c"), (0.25, "#414d6b"), (0.5, "#7b7b78"), (0.75, "#bcae6c"), (1.0, "#ffe945"))
}
"""Colour scales that figures call by name."""


def heatmap(trace: Json, x: Axis, y: Axis) -> list[Shape]:
    """Cells in the colours of the trace's scale, neighbours of one colour drawn as one; a key where the trace has a bar."""
    levels = np.asarray(numbers(trace["z"]), dtype=np.float64)
    low = float(trace.get("zmin", np.nanmin(levels)))
    high = float(trace.get("zmax", np.nanmax(levels)))
    shades = _shades(trace, (levels - low) / ((high - low) or 1.0))
    xs, ys = cell_edges(x.px(trace["x"])), cell_edges(y.px(trace["y"]))
    shapes: list[Shape] = []
    for i, row in enumerate(shades):
        top, start = min(ys[i], ys[i + 1]), 0
        for j, shade in enumerate(row):
            if j + 1 < len(row) and row[j + 1] == shade:
                continue
            if shade:
                shapes.append(box(xs[start], top, xs[j + 1] - xs[start], abs(ys[i + 1] - ys[i]), shade))
            start = j + 1
    title = ((trace.get("colorbar") or {}).get("title") or {}).get("text")
    if title:
        key = _shades(trace, np.array([[0.0, 0.25, 0.5, 0.75, 1.0]]))[0]
        right = x.end_px - 40.0
        shapes += [box(right - 100 + 20 * k, 8, 20, 12, shade) for k, shade in enumerate(key)]
        shapes.append(Text(right - 106, 18, f"{title}: {short(low, 3)}", "end"))
        shapes.append(Text(right + 6, 18, short(high, 3), "start"))
    return shapes


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


def cell_edges(centres: Array) -> list[float]:
    """Bounds of the cells around places: halfway to the neighbours."""
    if len(centres) < 2:
        return [float(centres[0]) - 20.0, float(centres[0]) + 20.0]
    middle = 0.5 * (centres[1:] + centres[:-1])
    return [float(2.0 * centres[0] - middle[0]), *middle.tolist(), float(2.0 * centres[-1] - middle[-1])]


WIDE: Final = 1060
"""Width in pixels of a chart that fills the page."""
POINTS: Final = 1200
"""Most points of a curve: more than pixels across."""
MARK_PX: Final = 3.5
NOTE_LETTER: Final = 6.2
"""Width of a letter of a note in pixels, on average."""
HATCH_PX: Final = 6.0
"""Distance of a hatching's lines, which tell patterns apart where colours do not."""
PARTED: Final = (np.nan, np.nan)
DASHES: Final = {"solid": "", "dash": "6 4", "dot": "1.5 3", "longdash": "10 4", "dashdot": "6 3 1.5 3"}
_TAG: Final = re.compile(r"<[^>]+>")


def still(figure: Json, width: int = WIDE) -> Markup:
    """The figure as inline SVG."""
    return picture(figure, width).svg()


def picture(figure: Json, width: float = WIDE, points: int = POINTS) -> Picture:
    """The figure drawn `width` pixels wide, each curve with at most so many points; its charts are of `assets.CHART_KINDS`."""
    layout = figure["layout"]
    height = int(layout.get("height", 360))
    places = axes(figure, width, height)
    shapes = [*_frames(places), *_levels(layout, places)]
    bars = [trace for trace in figure["data"] if trace["type"] == "bar" and "offset" not in trace]
    for trace in figure["data"]:
        x, y = places[trace.get("xaxis", "x")], places[trace.get("yaxis", "y")]
        if trace["type"] == "heatmap":
            shapes += heatmap(trace, x, y)
        elif trace["type"] == "bar":
            beside = len(bars) if layout.get("barmode") == "group" and trace in bars else 1
            shapes += _bars(trace, x, y, bars.index(trace) if beside > 1 else 0, beside)
        else:
            shapes += _curve(trace, x, y, points)
    return Picture(width, height, [*shapes, *_notes(layout, places), *_legend(figure, width)])


def picture_of(figure: Json, width_px: float, points: int) -> Picture:
    """The figure drawn for print, with room for the names over it."""
    names = [shape.y for shape in _legend(figure, width_px) if isinstance(shape, Text)]
    room = {"top": max(names, default=0.0) + 22.0}
    return picture({**figure, "layout": figure["layout"] | {"still": room}}, width_px, points)


def _text(x: float, y: float, text: str, anchor: str = "middle", **more: Any) -> Text:
    """A text of a figure, in which a browser would read tags."""
    return Text(x, y, unescape(_TAG.sub(" ", str(text))).strip(), anchor, **more)


def _frames(places: Mapping[str, Axis]) -> list[Shape]:
    """Grid, ticks and titles; rows over one common axis share its ticks under the lowest."""
    shapes: list[Shape] = []
    for name, axis in places.items():
        title, others = (axis.spec.get("title") or {}).get("text", ""), _crossed(name, places)
        if name.startswith("y"):
            left, right = others[0].start_px, others[0].end_px
            for at, text in axis.ticks():
                shapes += [line([(left, at), (right, at)], HAIRLINE), _text(left - 6, at + 4, text, "end")]
            # Beside the picture's edge; in a row of charts beside its own axis.
            first = min(place.start_px for key, place in places.items() if key.startswith("x"))
            beside = 14 if left == first else left - 52
            shapes.append(_text(beside, 0.5 * (axis.start_px + axis.end_px), title, turned=True))
            continue
        top, down = min(other.end_px for other in others), max(other.start_px for other in others)
        for at, text in axis.ticks():
            shapes += [line([(at, top), (at, down)], HAIRLINE), _text(at, down + 17, text)]
        shapes.append(_text(0.5 * (axis.start_px + axis.end_px), down + 38, title))
    return [shape for shape in shapes if not isinstance(shape, Text) or shape.text]


def _crossed(name: str, places: Mapping[str, Axis]) -> list[Axis]:
    """The axes of the other direction that an axis crosses: the one that it names, or all."""
    others = {key: axis for key, axis in places.items() if key[0] != name[0]}
    beside = sum(key.startswith("x") for key in places) > 1
    named = str(places[name].spec.get("anchor", ""))
    return [others[named]] if beside and named in others else list(others.values())


def _style(trace: Json) -> tuple[str, float, str]:
    spec = trace.get("line") or {}
    dash = str(spec.get("dash", ""))
    drawn = DASHES.get(dash, dash.replace("px", "").replace(",", " "))
    return str(spec.get("color") or (trace.get("marker") or {}).get("color") or INK), float(spec.get("width", 2)), drawn


def _curve(trace: Json, x: Axis, y: Axis, points: int) -> list[Shape]:
    raw_x, raw_y = numbers(trace["x"]), numbers(trace["y"])
    if len(raw_x) == 0:
        return []
    px, py = x.px(raw_x), y.px([np.nan if value is None else value for value in raw_y])
    low, high = sorted((y.start_px, y.end_px))
    left, right = sorted((x.start_px, x.end_px))
    seen = (low - 1.0 <= py) & (py <= high + 1.0) & (left - 1.0 <= px) & (px <= right + 1.0)
    # Of what leaves the axis the first point is drawn on its edge, the others not at all.
    beside = seen | np.roll(seen, 1) | np.roll(seen, -1)
    px = np.clip(px, left, right)
    inside = np.column_stack([px, np.where(beside, np.clip(py, low - 1.0, high + 1.0), np.nan)])
    colour, width, dash = _style(trace)
    mode = str(trace.get("mode", "lines+markers"))
    if trace.get("fill") == "toself":
        fill, opacity = solid(trace.get("fillcolor", HAIRLINE))
        edge = np.column_stack([px, np.clip(py, low - 1.0, high + 1.0)])
        return [area(thinned_px(edge, points), fill, opacity=opacity)]
    shapes: list[Shape] = []
    if "lines" in mode and width > 0:
        for piece in np.split(inside, np.flatnonzero(np.isnan(inside[:, 1]))):
            finite = piece[np.isfinite(piece[:, 1])]
            if len(finite) > 1:
                shapes.append(Path(thinned_px(finite, points), colour, width, dash))
    if "markers" in mode:
        bars = [
            bar for axis, letter in ((x, "x"), (y, "y")) for bar in _error_bars(trace, inside, axis, letter, colour)
        ]
        shapes += [*bars, *_marks(trace, inside, seen, colour)]
    return shapes


def _marks(trace: Json, points_px: Array, seen: Any, colour: str) -> list[Shape]:
    """A disc, a ring or a cross at each point that is seen."""
    marker = trace.get("marker") or {}
    shade, symbol, r = marker.get("color", colour), str(marker.get("symbol", "")), MARK_PX
    colours = shade if isinstance(shade, list) else [shade] * len(points_px)
    shapes: list[Shape] = []
    for (a, b), own, shown in zip(points_px.tolist(), colours, seen, strict=True):
        if not shown:
            continue
        if symbol.startswith("x"):
            edge = str((marker.get("line") or {}).get("color", own))
            shapes += [line([(a - r, b - s * r), (a + r, b + s * r)], edge, 1.5) for s in (1, -1)]
        elif symbol.endswith("-open"):
            shapes.append(Disc(a, b, r, stroke=own, width=1.5))
        else:
            shapes.append(Disc(a, b, r, own))
    return shapes


def _error_bars(trace: Json, points_px: Array, along: Axis, letter: str, colour: str) -> list[Shape]:
    """The interval of each point along one axis, of which the trace gives one."""
    errors = trace.get(f"error_{letter}")
    if not errors:
        return []
    values = np.asarray(numbers(trace[letter]))
    ends = along.px(values + errors["array"]), along.px(values - errors.get("arrayminus", errors["array"]))
    return [
        line([(a, high), (a, low)] if letter == "y" else [(low, b), (high, b)], colour)
        for (a, b), high, low in zip(points_px, *ends, strict=True)
    ]


def _bars(trace: Json, x: Axis, y: Axis, number: int, beside: int) -> list[Shape]:
    """Bars, upright or lying; several of one place stand `beside` each other."""
    lying = trace.get("orientation") == "h"
    along, across = (x, y) if lying else (y, x)
    sizes, places = (trace["x"], trace["y"]) if lying else (trace["y"], trace["x"])
    bases = trace.get("base", [0.0] * len(sizes))
    slot = abs(across.end_px - across.start_px) / max(1, len(across.names) or len(places))
    thick = slot * float(trace.get("width", 0.8)) / beside
    marker = trace.get("marker") or {}
    colour = marker.get("color", INK)
    colours = colour if isinstance(colour, list) else [colour] * len(sizes)
    texts = trace.get("text") or [""] * len(sizes)
    boxes: list[tuple[float, ...]] = []
    shapes: list[Shape] = []
    for size, place, base, shade, text in zip(sizes, places, bases, colours, texts, strict=True):
        middle = float(across.px(place)[0]) + (number - 0.5 * (beside - 1)) * thick
        a, b = (along.inside(float(along.px(end)[0])) for end in (base, base + size))
        start, length = min(a, b), abs(b - a)
        sides = (start, middle - thick / 2, length, thick) if lying else (middle - thick / 2, start, thick, length)
        shapes.append(box(*sides, shade))
        boxes.append(sides)
        if text:
            shapes.append(_text(b + 5, middle + 4, text, "start") if lying else _text(middle, b - 5, text))
    return [*shapes, *_hatching(boxes, (marker.get("pattern") or {}).get("shape", ""))]


def _hatching(boxes: Sequence[tuple[float, ...]], shape: str) -> list[Shape]:
    """White lines across boxes at 45°: upwards to the right for "/", both ways for "x"; none in boxes too small for them."""
    points: list[tuple[float, float]] = []
    for left, top, width, height in boxes:
        if not shape or min(width, height) < HATCH_PX / 2.0:
            continue
        for start in np.arange(HATCH_PX / 2.0, width + height, HATCH_PX):
            # Where x + y = start meets the box's sides.
            (x0, y0), (x1, y1) = (
                (min(start, width), max(0.0, start - width)),
                (max(0.0, start - height), min(start, height)),
            )
            points += [(left + x0, top + y0), (left + x1, top + y1), PARTED]
            if shape == "x":
                points += [(left + x0, top + height - y0), (left + x1, top + height - y1), PARTED]
    return [line(points[:-1], "#ffffff")] if points else []


def _at(value: Any, ref: str, places: Mapping[str, Axis], letter: str) -> float:
    """A place of a shape or note: on an axis, or as a share of an axis' stretch or of the whole picture."""
    axis, _, domain = ref.partition(" ")
    if axis == "paper":
        stretches = [place for name, place in places.items() if name.startswith(letter)]
        start, end = stretches[0].start_px, stretches[0].end_px
        if letter == "y":
            start, end = max(place.start_px for place in stretches), min(place.end_px for place in stretches)
        return start + float(value) * (end - start)
    if domain:
        return places[axis].start_px + float(value) * (places[axis].end_px - places[axis].start_px)
    return float(places[axis].px(value)[0])


def _within(spec: Json, places: Mapping[str, Axis], at_px: float, letter: str = "y") -> bool:
    """Whether a level or note that names an axis lies within its stretch: else it would stand in another row or beside."""
    axis = places.get(str(spec.get(f"{letter}ref", letter)).partition(" ")[0])
    return axis is None or abs(axis.inside(at_px) - at_px) <= 1.0


def _levels(layout: Json, places: Mapping[str, Axis]) -> list[Shape]:
    shapes: list[Shape] = []
    for spec in layout.get("shapes") or ():
        (x0, x1), (y0, y1) = (
            [_at(spec[f"{letter}{end}"], spec.get(f"{letter}ref", letter), places, letter) for end in "01"]
            for letter in "xy"
        )
        style = spec.get("line") or {}
        if not _within(spec, places, y0) or (x0 == x1 and not _within(spec, places, x0, "x")):
            continue
        if spec["type"] == "line":
            dash = DASHES.get(str(style.get("dash", "")), "")
            shapes.append(line([(x0, y0), (x1, y1)], style.get("color", INK), float(style.get("width", 1)), dash))
        else:
            if (axis := places.get(spec.get("xref", "x"))) is not None:
                x0, x1 = axis.inside(x0), axis.inside(x1)
            sides = min(x0, x1), min(y0, y1), abs(x1 - x0), abs(y1 - y0)
            shapes.append(box(*sides, spec.get("fillcolor", HAIRLINE), float(spec.get("opacity", 1.0))))
    return shapes


def _notes(layout: Json, places: Mapping[str, Axis]) -> list[Shape]:
    shapes: list[Shape] = []
    for note in layout.get("annotations") or ():
        x, y = (_at(note[letter], note.get(f"{letter}ref", letter), places, letter) for letter in "xy")
        if not (_within(note, places, y) and _within(note, places, x, "x")):
            continue
        anchor = {"left": "start", "right": "end"}.get(note.get("xanchor", ""), "middle")
        drop = {"bottom": -4.0, "top": 13.0}.get(note.get("yanchor", ""), 4.0)
        font = note.get("font") or {}
        size = {"colour": font.get("color", MUTED), "size_px": 11.0}
        right = max(place.end_px for name, place in places.items() if name.startswith("x"))
        if anchor == "start" and x + NOTE_LETTER * len(note["text"]) > right:
            x, anchor = right, "end"
        shapes.append(_text(x, y + drop, note["text"], anchor, **size))
    return shapes


def _legend(figure: Json, width: float) -> list[Shape]:
    """The names of the traces over the picture, in a second row where one does not hold them."""
    shapes: list[Shape] = []
    named = [trace for trace in figure["data"] if trace.get("name") and trace.get("showlegend") is not False]
    left, y = MARGIN["left"], 14.0
    x = left
    for trace in named if figure["layout"].get("showlegend", len(named) > 1) else ():
        colour, _, dash = _style(trace)
        long = 56 + LETTER * len(str(trace["name"]))
        if x > left and x + long - 24 > width:
            x, y = left, y + 15.0
        if trace["type"] == "bar" or (trace.get("marker") or {}).get("symbol") == "square":
            shapes += [box(x + 6, y - 6, 20, 12, colour)]
            shapes += _hatching(
                [(x + 6, y - 6, 20, 12)], ((trace.get("marker") or {}).get("pattern") or {}).get("shape", "")
            )
        else:
            shapes += [line([(x, y), (x + 26, y)], colour, 2.5, dash)]
        shapes.append(_text(x + 32, y + 4, trace["name"], "start"))
        x += long
    return shapes
