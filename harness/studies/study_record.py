"""The record of a study: what its page shows, taken from the store."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.campaign.store import Store
from harness.model import run as record
from harness.model.scene import Scene
from harness.records.result_folder import listing
from harness.records.scene import SceneRecord
from harness.records.study import Curve, Panel, StudyRecord, StudyWitness, Value
from harness.studies import claims
from harness.studies.case_selection import REFERENCE
from harness.studies.cases import base_of
from harness.studies.column_rows import ColumnRows, table
from harness.studies.ensembles import score_sets
from harness.studies.file import StudyFile
from harness.studies.impact_loss import energy_lost_j, last_impact_s
from harness.studies.random_rechecks import recheck
from harness.studies.rows import KeyedRow, study_rows
from harness.studies.study_run import Summary, study_name
from harness.studies.supports import supports

Array = NDArray[np.float64]

CURVE_POINTS: Final = 400
"""Points of a curve in a small panel: least and largest of each of half as many stretches, so that no peak is lost."""


def study_record(
    study: StudyFile,
    path: Path,
    store: Store | ColumnRows,
    summary: Summary,
    seconds: float,
    witness: StudyWitness | None = None,
) -> StudyRecord:
    """Everything that the page of a study holds."""
    base = base_of(study, path)
    scene = base.scene({})
    rows = study_rows(store, study_name(study))
    columns = table(store.store, study, len(rows)) if isinstance(store, ColumnRows) else None
    paper = study.claims == "paper"
    if study.claims:
        rows = _weighed(rows, store, scene)
    verdicts = claims.judge(rows, top_displacement(scene), study.claims) if study.claims else None
    return StudyRecord(
        title=study.title,
        file=path.name,
        scene=SceneRecord.of(scene),
        notes=scene.notes,
        vary={item.key: sorted({row.varied[item.key] for row in rows}, key=_order) for item in study.vary},
        supports=supports(study, scene, rows),
        summary=summary.record(),
        usage=summary.usage.record(),
        seconds=seconds,
        engine_seconds=_seconds(rows, store) if columns is None else {REFERENCE: columns.seconds},
        scores=score_sets(rows, history=store.history),
        audit=recheck(study, rows),
        witness=witness,
        versions=record.versions(),
        machine=record.machine(),
        claims=verdicts,
        headline=None if verdicts is None else claims.headline(verdicts),
        panels=panels(rows, store) if paper else None,
        rows=rows,
        table=columns,
        files=listing(()),
    )


def top_displacement(scene: Scene) -> Any:
    """Horizontal displacement (m) of the silhouette's topmost point at a rotation about the wider side's corner."""
    section = scene.statue.section_m
    side = -1 if scene.statue.corner_left_m > scene.statue.corner_right_m else 1
    corner = np.array([side * scene.statue.corner_m(side), 0.0])
    top = section[np.argmax(section[:, 1])] - corner

    def displaced(theta_rad: float) -> float:
        # Clockwise positive: x' = x cos θ + z sin θ.
        turned = top[0] * np.cos(theta_rad) + side * top[1] * np.sin(theta_rad)
        return float(abs(turned - top[0]))

    return displaced


def panels(rows: Sequence[KeyedRow], store: Store | ColumnRows) -> list[Panel]:
    """Curves in the arrangement of the paper's figures: for each condition, by model, without and with pedestal."""
    by_condition: dict[tuple[float, float, float], dict[str, dict[str, Curve]]] = {}
    drawn: dict[str, Curve] = {}
    for row in rows:
        varied, key = row.varied, row.key
        if row.run is None or key is None:
            continue
        if key not in drawn:
            history = store.history(key)
            if history is None:
                continue
            drawn[key] = _curve(history.t_s, history.theta_rad, history.slip_m)
        keys = "contact.restitution", "motion.x.amplitude_g", "motion.x.frequency_hz"
        restitution, amplitude_g, frequency_hz = (float(varied[name]) for name in keys)
        setting = "floor" if varied["pedestal"] == "none" else "pedestal"
        curves = by_condition.setdefault((restitution, amplitude_g, frequency_hz), {})
        curves.setdefault(row.model, {})[setting] = drawn[key]
    return [Panel(*place, by_condition[place]) for place in sorted(by_condition)]


def _curve(t_s: Array, theta_rad: Array, slip_m: Array) -> Curve:
    keep = decimated(theta_rad, slip_m, points=CURVE_POINTS)
    return Curve(
        [round(float(value), 4) for value in t_s[keep]],
        [float(f"{value:.5g}") for value in theta_rad[keep]],
        [float(f"{value:.5g}") for value in slip_m[keep]],
    )


def decimated(*curves: Array, points: int) -> NDArray[np.int64]:
    """Indices that keep the first, the last and the least and largest of every curve in each of `points`/2 stretches."""
    size = curves[0].size
    if size <= points:
        return np.arange(size)
    edges = np.linspace(0, size, points // 2 + 1).astype(int)
    chosen = {0, size - 1}
    for low, high in pairwise(edges):
        for curve in curves:
            chosen |= {low + int(np.argmin(curve[low:high])), low + int(np.argmax(curve[low:high]))}
    return np.array(sorted(chosen))


def _weighed(rows: Sequence[KeyedRow], store: Store | ColumnRows, scene: Scene) -> list[KeyedRow]:
    """The rows, each run with a history told what an impact costs in the mean, and when the last one was."""
    weighed: dict[str | None, tuple[float | None, float | None]] = {}
    for key in {row.key for row in rows if row.key is not None}:
        history = store.history(key)
        if history is not None:
            losses = energy_lost_j(history, scene.pivot_inertia_kg_m2)
            weighed[key] = float(np.mean(losses)) if losses.size else None, last_impact_s(history)
    shown = []
    for row in rows:
        loss_j, last_s = weighed.get(row.key, (None, None))
        run = row.run and replace(row.run, impact_loss_j=loss_j, last_impact_s=last_s)
        shown.append(replace(row, run=run))
    return shown


def _seconds(rows: Sequence[KeyedRow], store: Store | ColumnRows) -> dict[str, float]:
    total: dict[str, float] = {}
    for key, engine in {(row.key, row.engine) for row in rows if row.key is not None}:
        total[engine] = total.get(engine, 0.0) + (store.seconds(key) or 0.0)
    return total


def _order(value: Value) -> tuple[bool, Any]:
    return isinstance(value, str), value
