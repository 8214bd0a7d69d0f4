"""One plot of how time and memory grow with duration, mesh vertices, number of runs and workers, as multiples of the smallest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from harness.records.bench import ScalingRow
from reports.charts import Json
from reports.charts.figure import BELOW, LOG, axis, curve, figure, stroke
from reports.charts.palette import MUTED, look
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
        for measure, (place, _, _) in PANELS.items():
            data.append(
                curve(
                    [item.value / mine[0].value for item in mine], [getattr(item, measure) for item in mine],
                    stroke(style) | {"width": 1.6}, mode="lines+markers", name=f"{engine}, {words}",
                    legendgroup=f"{engine} {quantity}", showlegend=measure == "wall_s", xaxis="x", yaxis=place,
                    marker={"color": style.colour, "symbol": SYMBOLS[quantity], "size": 9},
                    text=[f"{item.value:g}" for item in mine],
                    hovertemplate=f"{engine}, {words} %{{text}}: %{{y:.3g}}<extra></extra>",
                )
            )  # fmt: skip
    time, memory = (axis(title, dtick=1, domain=domain, anchor="x", **LOG) for _, domain, title in PANELS.values())
    # Memory spans less than a decade: 20, 50, 100 are wanted as well.
    below = {"yaxis2": memory | {"dtick": "D2"}, "margin_bottom": 210, "margin_top": 20, "legend": BELOW | {"y": -0.14}}
    return figure(data, 720, axis("size, as a multiple of the smallest", dtick=1, anchor="y2", **LOG), time, **below)


def _proportional(items: Sequence[ScalingRow]) -> Json:
    """What grows with the size itself, from the least time of all."""
    by_line: dict[tuple[str, str], list[float]] = {}
    for item in items:
        by_line.setdefault((item.engine, item.quantity), []).append(item.value)
    most = max(max(values) / min(values) for values in by_line.values())
    least = min(item.wall_s for item in items)
    line = {"color": MUTED, "width": 6}
    rest = {"name": "in proportion", "xaxis": "x", "yaxis": "y", "opacity": 0.25, "hoverinfo": "skip"}
    return curve([1.0, most], [least, least * most], line, **rest)
