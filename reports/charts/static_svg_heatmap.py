"""A heatmap's still picture: cells in the colours of its scale, and a key."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from reports.charts import Json
from reports.charts.samples import numbers
from reports.charts.static_svg_axes import Array, Axis
from reports.drawing.shapes import Shape, Text, box
from reports.messages.numbers import short

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
