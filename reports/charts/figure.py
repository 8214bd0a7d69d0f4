"""Parts of which every chart is made: curves, bands, intervals, axes, and the whole with its legend above."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from harness.records.scores import Interval
from reports.charts import Json
from reports.charts.palette import HAIRLINE, MUTED, Look, faint

ABOVE: Final = {"orientation": "h", "y": 1.0, "yanchor": "bottom"}
"""A legend in one row over its chart."""
BELOW: Final = {"orientation": "h", "yanchor": "top"}
LOG: Final = {"type": "log", "exponentformat": "power"}
"""A logarithmic axis with its powers written."""


def stroke(style: Look, wider: float = 0.0) -> Json:
    """How a model's line is drawn."""
    return {"color": style.colour, "dash": style.dash, "width": style.width + wider}


def curve(x: Any, y: Any, line: Json, **more: Any) -> Json:
    """A line through points; `mode` makes it marks, or both: without a line where that is empty."""
    return {"type": "scatter", "mode": "lines", "x": x, "y": y, **({"line": line} if line else {}), **more}


def band(x: Any, y: Any, colour: str, opacity: float, **more: Any) -> Json:
    """The area within an outline, without a name and without an answer to the pointer."""
    fill = {"fill": "toself", "fillcolor": faint(colour, opacity), "hoverinfo": "skip", "showlegend": False}
    return curve(x, y, {"width": 0}, **fill, **more)


def intervals(values: Sequence[Interval], factor: float = 1.0, **more: Any) -> Json:
    """The error bars of estimates, in units of one `factor`-th."""
    above, below = (
        [factor * (item.high - item.value) for item in values],
        [factor * (item.value - item.low) for item in values],
    )
    return {"type": "data", "symmetric": False, "array": above, "arrayminus": below, **more}


def axis(title: str, **more: Any) -> Json:
    """An axis with its grid."""
    return {"title": {"text": title}, "gridcolor": HAIRLINE, **more}


def figure(data: Sequence[Json], height: float, x: Json, y: Json, **more: Any) -> Json:
    """A chart of one pair of axes."""
    legend = {} if more.get("showlegend") is False else {"legend": ABOVE}
    return {"data": list(data), "layout": {"height": height, "xaxis": x, "yaxis": y, **legend, **more}}


def level(y: float, line: Json, **more: Any) -> Json:
    """A line across the whole chart."""
    return {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": y, "y1": y, "line": line, **more}


def note(x: Any, y: Any, text: str, **more: Any) -> Json:
    """Small words at a place."""
    return {"x": x, "y": y, "text": text, "showarrow": False, "font": {"size": 11, "color": MUTED}, **more}
