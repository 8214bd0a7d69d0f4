"""Studies along one axis: each model's outcome, largest rotation and slip against what varies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from harness.records.study import CaseRun
from reports.charts import Json
from reports.charts.map_figures import LEAST, map_axes, numeric
from reports.charts.palette import HAIRLINE, look
from reports.text.numbers import heading
from reports.text.study_rows import FAILED, SYMBOLS, Condition

MOST_GROUPS: Final = 6
"""More combinations of what else varies are no curves of one axis: the table shows them."""
ROWS: Final = (((0.70, 1.0), ""), ((0.36, 0.62), "rotation  [rad]"), ((0.0, 0.28), "slip  [mm]"))
"""Share of the chart's height and title of each row, from above."""


def curve_figures(
    models: Sequence[str], conditions: Sequence[Condition], keys: Sequence[str]
) -> list[tuple[str, Json]]:
    """For each axis of numbers, and each combination of the other `keys`, a chart of all models; none where there is a map."""
    if map_axes(conditions, keys) is not None:
        return []
    figures = []
    for key in keys:
        if len(numeric(conditions, key)) < LEAST:
            continue
        groups: dict[tuple[str, ...], list[Condition]] = {}
        for item in conditions:
            where = tuple(f"{heading(other)} {item.varied[other]}" for other in keys if other != key)
            groups.setdefault(where, []).append(item)
        if len(groups) <= MOST_GROUPS:
            figures += [
                (" · ".join([f"By {heading(key)}", *where]), _curves(models, members, key))
                for where, members in groups.items()
            ]
    return figures


def _curves(models: Sequence[str], members: Sequence[Condition], key: str) -> Json:
    engines = [model.partition(" (")[0] for model in models]
    data: list[Json] = []
    slips = False
    for number, model in enumerate(models):
        runs = [
            (float(item.varied[key]), row.run)
            for item in sorted(members, key=lambda item: float(item.varied[key]))
            for row in [item.answers.get(model)]
            if row is not None and row.run is not None
        ]
        style = look(engines[number] if engines.count(engines[number]) == 1 else model, list(models))
        slips = slips or any(run.peak_slip_m > 0.0 for _, run in runs)
        shown: Json = {
            "type": "scatter", "mode": "lines+markers", "name": model, "legendgroup": model,
            "line": {"color": style.colour, "dash": style.dash, "width": style.width}, "marker": {"color": style.colour},
        }  # fmt: skip
        for axis, values in enumerate(_values([run for _, run in runs]), start=1):
            row_axis = {"yaxis": f"y{axis if axis > 1 else ''}", "showlegend": axis == 1}
            data.append(shown | row_axis | {"x": [x for x, _ in runs], "y": values})
    rows = ROWS if slips else (((0.58, 1.0), ""), ((0.0, 0.46), ROWS[1][1]))
    data = [trace for trace in data if slips or trace["yaxis"] != "y3"]
    layout: Json = {
        "height": 560, "xaxis": {"title": {"text": heading(key)}, "anchor": f"y{len(rows)}", "gridcolor": HAIRLINE},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"},
    }  # fmt: skip
    for number, (domain, title) in enumerate(rows, start=1):
        layout[f"yaxis{number if number > 1 else ''}"] = {
            "domain": list(domain), "title": {"text": title}, "gridcolor": HAIRLINE, "automargin": True,
            "type": "category" if number == 1 else "linear", "rangemode": "tozero", "nticks": 4, "exponentformat": "none",
        }  # fmt: skip
    return {"data": data, "layout": layout}


def _values(runs: Sequence[CaseRun]) -> tuple[list[str], list[float | None], list[float | None]]:
    """Outcome in words, largest rotation in rad and slip in mm; where it does not stand these two say nothing."""
    stands = [run.outcome == "stands" for run in runs]
    return (
        [SYMBOLS.get(run.outcome, FAILED)[1] for run in runs],
        [abs(run.peak_theta_rad) if shown else None for run, shown in zip(runs, stands, strict=True)],
        [1e3 * run.peak_slip_m if shown else None for run, shown in zip(runs, stands, strict=True)],
    )
