"""One plot of how time and memory grow with duration, mesh vertices, number of runs and workers, as multiples of the smallest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from harness.records.bench import ScalingRow
from reports.charts import Json
from reports.charts.palette import HAIRLINE, MUTED, look
from reports.text.numbers import heading

SYMBOLS: Final = {"duration_s": "circle", "mesh_vertices": "square", "runs": "diamond", "workers": "triangle-up"}
PANELS: Final = {"wall_s": ("y", [0.42, 1.0], "time  [s]"), "memory_mb": ("y2", [0.0, 0.34], "memory  [MB]")}
"""For each measure its axis, its part of the height and its title."""


def scaling_figure(items: Sequence[ScalingRow]) -> Json:
    """Time above, peak memory below, on logarithmic axes; one line for each engine (colour) and quantity (sign)."""
    engines = list(dict.fromkeys(item.engine for item in items))
    data: list[Json] = [_proportional(items)]
    for engine, quantity in dict.fromkeys((item.engine, item.quantity) for item in items):
        mine = sorted((i for i in items if (i.engine, i.quantity) == (engine, quantity)), key=lambda i: i.value)
        style, words = look(engine, engines), heading(quantity)
        for measure, (axis, _, _) in PANELS.items():
            data.append(
                {
                    "type": "scatter", "mode": "lines+markers", "name": f"{engine}, {words}",
                    "legendgroup": f"{engine} {quantity}", "showlegend": measure == "wall_s", "xaxis": "x", "yaxis": axis,
                    "x": [item.value / mine[0].value for item in mine], "y": [getattr(item, measure) for item in mine],
                    "line": {"color": style.colour, "dash": style.dash, "width": 1.6},
                    "marker": {"color": style.colour, "symbol": SYMBOLS[quantity], "size": 9},
                    "text": [f"{item.value:g}" for item in mine],
                    "hovertemplate": f"{engine}, {words} %{{text}}: %{{y:.3g}}<extra></extra>",
                }
            )  # fmt: skip
    log = {"type": "log", "gridcolor": HAIRLINE, "exponentformat": "power", "dtick": 1}
    layout: Json = {
        "height": 720, "margin_bottom": 210, "margin_top": 20,
        "xaxis": {**log, "anchor": "y2", "title": {"text": "size, as a multiple of the smallest"}},
        "legend": {"orientation": "h", "y": -0.14, "yanchor": "top"},
    }  # fmt: skip
    for axis, domain, title in PANELS.values():
        layout[f"yaxis{axis[1:]}"] = {**log, "domain": domain, "anchor": "x", "title": {"text": title}}
    # Memory spans less than a decade: 20, 50, 100 are wanted as well.
    layout["yaxis2"]["dtick"] = "D2"
    return {"data": data, "layout": layout}


def _proportional(items: Sequence[ScalingRow]) -> Json:
    """What grows with the size itself, from the least time of all."""
    by_line: dict[tuple[str, str], list[float]] = {}
    for item in items:
        by_line.setdefault((item.engine, item.quantity), []).append(item.value)
    most = max(max(values) / min(values) for values in by_line.values())
    least = min(item.wall_s for item in items)
    return {
        "type": "scatter", "mode": "lines", "name": "in proportion", "x": [1.0, most], "y": [least, least * most],
        "xaxis": "x", "yaxis": "y", "line": {"color": MUTED, "width": 6}, "opacity": 0.25, "hoverinfo": "skip",
    }  # fmt: skip
