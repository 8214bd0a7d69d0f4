"""The page of a study: verdict, claims, outcome matrix, panels, maps, fragility, what was asked and what was not."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.model.finding import Finding, info, texted
from harness.records.study import StudyRecord, StudyRow
from harness.records.witness import PLAIN
from reports.charts.axis_curves import curve_figures
from reports.charts.design_figures import best_designs, design_figures
from reports.charts.map_figures import map_axes, map_figures
from reports.charts.static_svg import WIDE
from reports.charts.study_figures import (
    PANEL_POINTS,
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
    agreement,
    cell,
    conditions,
    family,
    runs_of,
    varying_keys,
)
from reports.text.wording import Verdict

MOST_MATRIX_ROWS: Final = 300
"""Longer matrices are not read; the map shows them."""
MOST_WARNINGS: Final = 30
ROSE_WORDS: Final = "Least amplitude that overturns the statue, by direction"


def context(folder: Path, record: StudyRecord) -> dict[str, object]:
    """Everything that the study template shows."""
    models, cases = conditions(record.rows)
    keys = varying_keys(cases)
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
        "pedestal_effect": pedestal_effect(record, models, cases),
        "charts": charts,
        "rose": None if rose is None else rose.svg(ROSE_WORDS),
        "reasons": Counter(row.reason for row in record.rows).most_common(),
        "witness_rows": witness_rows(record),
        "notes": by_severity(texted([*study_findings(record.rows), *record.findings], ENGLISH.say)),
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
    """The study in words: the claims where there are any, else how often the models agree; no green without a probability."""
    pairs = agreement(models, cases)
    points = [
        f"{first} and {second} say the same of {same} of {total} conditions ({_percent(same, total)})."
        for first, second, same, total in pairs
    ]
    keys = [key for key in record.vary if key in varying_keys(cases)]
    points += best_designs(models, cases, map_axes(cases, keys))
    points += left_domain(record.rows)
    points += [] if record.table is None else [record.table.sentence]
    same, total = sum(item[2] for item in pairs), sum(item[3] for item in pairs)
    if record.headline:
        sentences = {item.claim: item.sentence for item in record.claims or ()}
        claims = [f"({claim}) {sentences[claim]}: {verdict}." for claim, verdict in record.headline.items()]
        return Verdict(_claims_headline(record.headline), "differ", [*claims, *points])
    if not pairs:
        ends = [family(run.outcome) for model in models for _, run in runs_of(cases, model)]
        return Verdict(_falls(models, cases), tone_of_study(ends), points)
    headline = f"The models give the same outcome in {same} of {total} comparisons ({_percent(same, total)})"
    return Verdict(headline, "differ", points)


def left_domain(rows: Sequence[StudyRow]) -> list[str]:
    """In how many runs each model left its own domain, and by what: there its outcome cannot be relied on."""
    sentences = []
    for model in dict.fromkeys(row.model for row in rows):
        runs = [row.run for row in rows if row.run is not None and row.model == model]
        causes = Counter(run.validity.get("left_domain_by") or "" for run in runs)
        del causes[""]
        if causes:
            each = ENGLISH.listed(f"{cause}: {count}" for cause, count in causes.most_common())
            sentences.append(f"{model} left its domain in {causes.total()} of {len(runs)} runs ({each}).")
    return sentences


def _falls(models: Sequence[str], cases: Sequence[Condition]) -> str:
    """In how many conditions each model lets the statue overturn."""
    parts = []
    for model in models:
        ends = [run.outcome.overturned for _, run in runs_of(cases, model)]
        parts.append(f"in {sum(ends)} of {len(ends)} conditions by {model}")
    return f"The statue overturns {ENGLISH.listed(parts)}" if parts else "No model was asked"


def _percent(part: int, whole: int) -> str:
    return f"{100.0 * part / whole:.0f} %"


def _claims_headline(headline: Mapping[str, str]) -> str:
    groups: dict[str, list[str]] = {}
    for claim, verdict in headline.items():
        groups.setdefault(verdict, []).append(f"({claim})")
    words = {
        "holds": "true in every model",
        "does not hold": "true in no model",
        "holds for some": "true in every model in part of the cases",
        "the models differ": "judged differently by the models",
        "not tested": "not tested",
    }
    parts = [f"{ENGLISH.listed(names)} {words[verdict]}" for verdict, names in groups.items()]
    return f"The paper's claims: {'; '.join(parts)}"


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


def study_findings(rows: Sequence[StudyRow]) -> list[Finding]:
    """Each kind of finding of the rows' runs once, with the number of runs that have it and the median of its numbers."""
    kinds: dict[tuple[str, str], list[Finding]] = {}
    for row in rows:
        for found in row.run.findings if row.run is not None else ():
            kinds.setdefault((row.engine, found.code), []).append(found)
    ordered = sorted(kinds.items(), key=lambda item: -len(item[1]))
    return [
        info("in_runs", count=len(found), text=ENGLISH.say(replace(found[0], values=_medians(found)))).of(engine)
        for (engine, _), found in ordered[:MOST_WARNINGS]
    ]


def _medians(found: Sequence[Finding]) -> dict[str, object]:
    """The values of findings of one code: of numbers the median, else the first's."""
    values = dict(found[0].values)
    for key, first in values.items():
        if isinstance(first, float):
            values[key] = float(np.median([each.values[key] for each in found]))
    return values


def witness_rows(record: StudyRecord) -> list[str]:
    """What unmodified engines say of a tenth of the scenes."""
    witness = record.witness
    if witness is None:
        return []
    counts = [
        info("study_witness_count", witness=name.removesuffix(PLAIN), **vars(count))
        for name, count in witness.counts.items()
    ]
    found = [info("study_witness", scenes=witness.scenes, of=witness.of), *counts, *witness.differing]
    return [ENGLISH.say(each) for each in found]
