"""Maps of numbers: how far the statue rotates and its pedestal slides over what varies, and where the pedestal would tip."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from harness.records.study import CaseRun
from reports.charts import Json
from reports.charts.figure import figure
from reports.charts.palette import INK
from reports.messages.numbers import heading, short
from reports.text.study_rows import Condition, runs_of

MOST_PLACES: Final = 10_000
"""Larger maps show where the statue falls only: a number for every place would make the page large."""
TIPPING: Final = ("pedestal_tipping_margin_m", "pedestal_tipping_margin_at_impact_m")
"""The margins of the record: the pedestal's half width less the reach of the floor's force, in motion and at impacts."""


def design_figures(
    models: Sequence[str], conditions: Sequence[Condition], axes: tuple[str, str] | None
) -> list[tuple[str, Json]]:
    """For each model maps of the largest rotation where it stands, and where it slides of the pedestal's largest displacement.

    Places that would tip the pedestal are marked. Empty when what varies makes no map, or a place stands for several conditions.
    """
    if axes is None or len({tuple(item.varied[key] for key in axes) for item in conditions}) != len(conditions):
        return []
    figures = []
    for model in models if len(conditions) <= MOST_PLACES else ():
        peak = _value_map(
            model, conditions, axes, lambda run: abs(run.peak_theta_rad) if run.outcome == "stands" else np.nan, "rad"
        )
        if peak is not None:
            figures.append((f"{model}: largest rotation where the statue stands", {**peak, "data": peak["data"][:1]}))
    for model in models:
        slip = _value_map(model, conditions, axes, lambda run: 1000.0 * run.peak_slip_m, "mm")
        if slip is not None:
            figures.append((f"{model}: largest displacement of the pedestal; ✕ where the pedestal would tip", slip))
    return figures


def best_designs(models: Sequence[str], conditions: Sequence[Condition], axes: tuple[str, str] | None) -> list[str]:
    """For each model that slides one sentence: of the designs in which the statue stands and nothing tips, the least slip."""
    if axes is None or len({tuple(item.varied[key] for key in axes) for item in conditions}) != len(conditions):
        return []
    sentences = []
    for model in models:
        runs = [(run, item) for item, run in runs_of(conditions, model)]
        if not any(run.peak_slip_m > 0.0 for run, _ in runs):
            continue
        good = [(run, item) for run, item in runs if run.outcome == "stands" and not _tips(run)]
        if not good:
            sentences.append(
                f"In none of {len(runs)} designs does the statue stand on a pedestal that does not tip ({model})."
            )
            continue
        run, item = min(good, key=lambda pair: float(pair[0].peak_slip_m))
        where = " and ".join(f"{heading(key)} = {short(float(item.varied[key]))}" for key in axes)
        sentences.append(
            f"The statue stands and the pedestal does not tip in {len(good)} of {len(runs)} designs; of these the pedestal moves "
            f"least, {1000.0 * float(run.peak_slip_m):.0f} mm, at {where} ({model})."
        )
    return sentences


def _tips(run: CaseRun) -> bool:
    margins = [run.validity.get(name) for name in TIPPING]
    return any(isinstance(margin, float) and margin < 0.0 for margin in margins)


def _value_map(
    model: str, conditions: Sequence[Condition], axes: tuple[str, str], value_of: Callable[[CaseRun], float], unit: str
) -> Json | None:
    """A heatmap of one number of each run; None where it is nought everywhere."""
    xs, ys = (sorted({item.number(key) for item in conditions}) for key in axes)
    rows, columns = ({value: k for k, value in enumerate(side)} for side in (ys, xs))
    values = np.full((len(ys), len(xs)), np.nan)
    tips: list[tuple[float, float]] = []
    for item, run in runs_of(conditions, model):
        x, y = (item.number(key) for key in axes)
        values[rows[y], columns[x]] = value_of(run)
        tips += [(x, y)] if _tips(run) else []
    if not np.nanmax(values, initial=0.0) > 0.0:
        return None
    shown = [[None if np.isnan(value) else float(f"{value:.4g}") for value in line] for line in values]
    heat = {
        "type": "heatmap", "x": xs, "y": ys, "z": shown, "colorscale": "Cividis", "reversescale": True,
        "colorbar": {"title": {"text": unit}, "thickness": 12},
        "hovertemplate": f"{heading(axes[0])} %{{x:.4g}}<br>{heading(axes[1])} %{{y:.4g}}<br>%{{z}} {unit}<extra></extra>",
    }  # fmt: skip
    marks = {
        "type": "scatter", "mode": "markers", "x": [x for x, _ in tips], "y": [y for _, y in tips],
        "marker": {"symbol": "x-thin", "size": 7, "line": {"width": 1.2, "color": INK}}, "hoverinfo": "skip",
    }  # fmt: skip
    return figure(
        [heat, marks], 380, *({"title": {"text": heading(key)}} for key in axes), showlegend=False, margin_top=12
    )
