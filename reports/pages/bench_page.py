"""The page of a bench (`harness/records/bench.py`): run time against error for every engine and setting."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from harness.records.bench import (
    DEFAULT,
    LEVEL,
    OTHER_PROJECT,
    TARGET,
    BenchRecord,
    PrecisionRow,
    ScalingRow,
)
from reports.charts import Json
from reports.charts.figure import BELOW, LOG, axis, curve, figure, level, stroke
from reports.charts.palette import INK, MUTED, look
from reports.messages.numbers import heading
from reports.text.limits import by_severity
from reports.text.wording import Verdict

SYMBOLS: Final = {LEVEL: "circle", TARGET: "star", DEFAULT: "square-open", OTHER_PROJECT: "diamond-open"}
WORDS: Final = {
    LEVEL: "",
    TARGET: "to the target",
    DEFAULT: "own defaults",
    OTHER_PROJECT: "another project's settings",
}

SIGNS: Final = {"duration_s": "circle", "mesh_vertices": "square", "runs": "diamond", "workers": "triangle-up"}
PANELS: Final = {"wall_s": ("y", [0.42, 1.0], "time  [s]"), "memory_mb": ("y2", [0.0, 0.34], "memory  [MB]")}
"""For each measure its axis, its part of the height and its title."""


def context(_folder: Path, record: BenchRecord) -> dict[str, object]:
    """Everything that the bench template shows."""
    rows, scenes = record.rows, list(dict.fromkeys(row.scene for row in record.rows))
    charts = [(f"work-{k}", scene, precision_figure(scene, rows, record.target_rad)) for k, scene in enumerate(scenes)]
    return {
        "verdict": bench_verdict(record),
        "notes": by_severity(record.findings),
        "charts": charts,
        "scaling": scaling_figure(record.scaling) if record.scaling else None,
        "scaling_rows": record.scaling,
        "scenes": scenes,
        "on_front": on_front,
        "baselines": [name.removesuffix("_ratio") for name in record.overhead if name.endswith("_ratio")],
    }


def bench_verdict(record: BenchRecord) -> Verdict:
    """Who meets the target on every scene, and how fast on the slowest of them."""
    found = [] if record.answer is None else record.answer.findings
    first, *points = [each.text for each in found] or [""]
    met = record.answer is not None and record.answer.code == "met"
    return Verdict(first, "agree" if met else "differ", points)


def on_front(row: PrecisionRow, rows: Sequence[PrecisionRow]) -> bool:
    """Whether no other setting of its kind on the same scene is both faster and more accurate.

    Contact engines, which have a step, compete with each other; the analytic model, which has none, would leave no front.
    An error of exactly nothing is that of a run compared with itself: it stands in the table only.
    """
    if not row.error_rad or row.failed is not None:
        return False
    mine = row.error_rad, row.cpu_s or 0.0
    others = [
        (other.error_rad, other.cpu_s or 0.0)
        for other in rows
        if other.scene == row.scene and bool(other.dt_s) == bool(row.dt_s) and other.failed is None and other.error_rad
    ]
    return not any(error <= mine[0] and cost <= mine[1] and (error, cost) != mine for error, cost in others)


def precision_figure(scene: str, rows: Sequence[PrecisionRow], target_rad: float) -> Json:
    """Work–precision of one scene on logarithmic axes: one line per engine's levels, open signs for other settings."""
    here = [row for row in rows if row.scene == scene and row.failed is None and row.error_rad]
    engines = list(dict.fromkeys(row.engine for row in rows))
    data: list[Json] = []
    for engine in engines:
        style = look(engine, engines)
        for group, symbol in SYMBOLS.items():
            mine = sorted((row for row in here if (row.engine, row.group) == (engine, group)), key=_error)
            if not mine:
                continue
            marker = {"color": style.colour, "symbol": symbol, "size": [15 if row.chosen else 8 for row in mine]}
            data.append(
                curve(
                    [row.cpu_s for row in mine], [row.error_rad for row in mine], stroke(style) | {"width": 1.6},
                    mode="lines+markers" if group == LEVEL else "markers", marker=marker,
                    name=f"{engine} {WORDS[group]}".strip(), text=[row.label for row in mine],
                    hovertemplate=f"{engine}, %{{text}}: %{{y:.2e}} rad in %{{x:.3g}} s<extra></extra>",
                )
            )  # fmt: skip
    front = sorted((row for row in here if row.dt_s and on_front(row, here)), key=_error)
    best = {"name": "best contact engine", "opacity": 0.25, "hoverinfo": "skip"}
    line = {"color": MUTED, "width": 6, "shape": "hv"}
    data.append(curve([row.cpu_s for row in front], [row.error_rad for row in front], line, **best))
    shape = level(target_rad, {"color": INK, "dash": "dash", "width": 1})
    x, y = axis("time to compute  [s]", dtick=1, **LOG), axis("error  [rad]", dtick=2, **LOG)
    return figure(data, 600, x, y, margin_bottom=250, margin_top=20, shapes=[shape], legend=BELOW | {"y": -0.28})


def _error(row: PrecisionRow) -> float:
    return row.error_rad or 0.0


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
                    marker={"color": style.colour, "symbol": SIGNS[quantity], "size": 9},
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
