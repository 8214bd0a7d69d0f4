"""The page of a study: verdict, claims, outcome matrix, panels, maps, fragility, what was asked and what was not."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from harness.records.study import StudyRecord
from reports.charts.map_figures import map_axes, map_figures
from reports.charts.static_svg import WIDE
from reports.charts.study_figures import (
    PANEL_POINTS,
    best_designs,
    curve_figures,
    design_figures,
    fragility_figure,
    panel_data,
    panel_groups,
    panels_picture,
    rose_picture,
)
from reports.drawing.scene_picture import scene_svg
from reports.messages import ENGLISH
from reports.messages.numbers import heading, label, plain, short, unit
from reports.pages.assets import source_text
from reports.text.chance import tone_of_study
from reports.text.limits import by_severity
from reports.text.pedestal_effect import pedestal_effect
from reports.text.study_rows import (
    FAILED,
    NOT_SENT,
    SYMBOLS,
    Condition,
    cell,
    conditions,
    family,
    runs_of,
    varying_keys,
)
from reports.text.wording import Verdict

MOST_MATRIX_ROWS: Final = 300
"""Longer matrices are not read; the map shows them."""
ROSE_WORDS: Final = "Least amplitude that overturns the statue, by direction"


def context(folder: Path, record: StudyRecord) -> dict[str, object]:
    """Everything that the study template shows."""
    models, cases = conditions(record.rows)
    keys = varying_keys(cases)
    effect = pedestal_effect(record, models, cases)
    charts, rose = study_charts(record, models, cases, keys), rose_picture(models, cases)
    return {
        "verdict": study_verdict(record, models, cases),
        "picture": scene_svg(record.scene),
        "vary": [(label(key), ", ".join(_shown(value) for value in values)) for key, values in record.vary.items()],
        "models": models,
        "matrix": matrix(models, cases, keys) if len(cases) <= MOST_MATRIX_ROWS else None,
        "matrix_keys": [heading(key) for key in keys],
        "legend": [*SYMBOLS.values(), FAILED, NOT_SENT],
        "panels": panel_data(record.panels) if record.panels else None,
        "panel_stills": [
            panels_picture(group, next(iter(group[0].curves)), WIDE, PANEL_POINTS).svg()
            for group in panel_groups(record.panels)
        ],
        "pedestal_effect": effect,
        "pedestal_saves": effect and ENGLISH.say(effect.finding),
        "claim_words": {claim: ENGLISH.strings[f"claim.{claim}"] for claim in record.headline or ()},
        "charts": charts,
        "rose": None if rose is None else rose.svg(ROSE_WORDS),
        "reasons": Counter(row.reason for row in record.rows).most_common(),
        "notes": by_severity(record.findings),
        "engine_seconds": [(name, unit(value, "s")) for name, value in record.engine_seconds.items()],
        "command": f"rockcheck study {shlex.quote(record.file)}",
        "panel_script": source_text("panels.js"),
    }


def study_charts(
    record: StudyRecord, models: Sequence[str], cases: Sequence[Condition], keys: Sequence[str]
) -> list[tuple[str, str, dict[str, object]]]:
    """The charts that the rows hold, each with its name on the page and its words: maps, curves, fragility."""
    axes = [key for key in record.vary if key in keys]
    if record.panels:  # the paper's arrangement shows the same as histories
        return []
    charts = [(f"map-{k}", title, figure) for k, (title, figure) in enumerate(map_figures(models, cases, axes))]
    designs = design_figures(models, cases, map_axes(cases, axes))
    charts += [(f"map-design-{k}", title, figure) for k, (title, figure) in enumerate(designs)]
    charts += [(f"curve-{k}", title, figure) for k, (title, figure) in enumerate(curve_figures(models, cases, axes))]
    scattered = len(axes) < len(keys)
    for key in axes if scattered else ():
        if "amplitude" in key or key.endswith("scale"):
            figure = fragility_figure(models, cases, key)
            if figure is not None:
                charts.append((f"fragility-{key}", f"Share of runs that overturn, against {heading(key)}", figure))
    return charts


def _shown(value: Any) -> str:
    return short(float(value)) if isinstance(value, (int, float)) and not isinstance(value, bool) else plain(value)


def study_verdict(record: StudyRecord, models: Sequence[str], cases: Sequence[Condition]) -> Verdict:
    """The record's answer; no green without a probability."""
    first, *points = [each.text for each in record.answer.findings] if record.answer else [""]
    keys = [key for key in record.vary if key in varying_keys(cases)]
    points += best_designs(models, cases, map_axes(cases, keys))
    ends = [family(run.outcome) for model in models for _, run in runs_of(cases, model)]
    alone = record.answer is not None and record.answer.code == "overturning"
    return Verdict(first, tone_of_study(ends) if alone else "differ", points)


def matrix(models: Sequence[str], cases: Sequence[Condition], keys: Sequence[str]) -> list[dict[str, object]]:
    """The outcome matrix: what was varied, and every model's answer; `differs` where models of one variant do not agree (falls to
    different sides do)."""
    rows = []
    for item in cases:
        cells = [cell(item.answers.get(model)) for model in models]
        by_variant: dict[str, set[str]] = {}
        for model, shown in zip(models, cells, strict=True):
            if shown.family != "none":
                by_variant.setdefault(model.partition(" (")[2], set()).add(
                    shown.family if shown.family == "overturns" else shown.words
                )
        differs = any(len(words) > 1 for words in by_variant.values())
        rows.append({"keys": [_shown(item.varied[key]) for key in keys], "cells": cells, "differs": differs})
    return rows
