"""Studies along one axis: each model's outcome, largest rotation and slip against what varies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from harness.records.study import CaseRun
from reports.charts import Json
from reports.charts.figure import axis, curve, figure, stroke
from reports.charts.map_figures import LEAST, map_axes, numeric
from reports.charts.palette import model_looks
from reports.messages.numbers import heading
from reports.text.study_rows import FAILED, SYMBOLS, Condition, runs_of

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
    looks, along = model_looks(models), sorted(members, key=lambda item: float(item.varied[key]))
    answers = {model: runs_of(along, model) for model in models}
    slips = any(run.peak_slip_m > 0.0 for runs in answers.values() for _, run in runs)
    rows = ROWS if slips else (((0.58, 1.0), ""), ((0.0, 0.46), ROWS[1][1]))
    data: list[Json] = []
    for model, runs in answers.items():
        shown = {"mode": "lines+markers", "name": model, "legendgroup": model, "marker": {"color": looks[model].colour}}
        x = [float(item.varied[key]) for item, _ in runs]
        for number, values in enumerate(_values([run for _, run in runs])[: len(rows)], start=1):
            place = {"yaxis": f"y{number if number > 1 else ''}", "showlegend": number == 1}
            data.append(curve(x, values, stroke(looks[model]), **shown, **place))
    layout = {
        f"yaxis{number if number > 1 else ''}": axis(
            title, domain=list(domain), automargin=True, type="category" if number == 1 else "linear", rangemode="tozero",
            nticks=4, exponentformat="none",
        )
        for number, (domain, title) in enumerate(rows, start=1)
    }  # fmt: skip
    return figure(data, 560, axis(heading(key), anchor=f"y{len(rows)}"), layout.pop("yaxis"), **layout)


def _values(runs: Sequence[CaseRun]) -> tuple[list[str], list[float | None], list[float | None]]:
    """Outcome in words, largest rotation in rad and slip in mm; where it does not stand these two say nothing."""
    stands = [run.outcome == "stands" for run in runs]
    return (
        [SYMBOLS.get(run.outcome, FAILED)[1] for run in runs],
        [abs(run.peak_theta_rad) if shown else None for run, shown in zip(runs, stands, strict=True)],
        [1e3 * run.peak_slip_m if shown else None for run, shown in zip(runs, stands, strict=True)],
    )
