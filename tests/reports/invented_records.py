"""Invented records of a validation, a bench and a stress run for the pages' own tests; scores are the harness's own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from harness.comparison.comparator import compare
from harness.comparison.statistics import fragility
from harness.comparison.statistics.outcomes import FELL, Case, score_outcomes
from harness.model import run as record
from harness.model.history import Outcome
from tests import doubles

COMMON: dict[str, Any] = {"schema_version": record.SCHEMA_VERSION, "seconds": 20.0, "seed": 0}


def _write(folder: Path, found: dict[str, Any]) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    full = COMMON | {"versions": record.versions(), "machine": record.machine()} | found
    record.write_json(folder / "result.json", full)
    return folder


def write_validation(folder: Path, *, skill: float = 0.97) -> Path:
    """Sixty tests of three bodies; the models are right in a share of about `skill`."""
    stream = np.random.default_rng(1)
    pgv = np.exp(stream.uniform(np.log(0.1), np.log(1.2), 60))
    pga = 0.6 * pgv * np.exp(0.3 * stream.standard_normal(60))
    fell = pgv * np.exp(0.25 * stream.standard_normal(60)) > 0.4
    grid = np.geomspace(pgv.min(), pgv.max(), 30)
    observed = fragility.fit(pgv, fell).as_dict(grid)
    rows: list[dict[str, Any]] = []
    for k in range(60):
        row = {"test": f"t{k}", "body": f"stone {k % 3}", "share": "score", "observed": FELL if fell[k] else "stands"}
        rows.append(row | {"pga_g": pga[k], "pgv_m_s": pgv[k], "predicted": {}, "probability": {}})
    measured = compare(doubles.rocking(), doubles.scaled(doubles.rocking(), 2.0))
    models = {}
    for name in ("analytic", "pymunk"):
        right = stream.random(60) < skill
        said = [
            Outcome.OVERTURNED_LEFT if fall == hit else Outcome.STANDS for fall, hit in zip(fell, right, strict=True)
        ]
        for row, outcome in zip(rows, said, strict=True):
            row["predicted"][name] = outcome.value
            row["probability"][name] = float(outcome.overturned)
        curve = fragility.fit(pgv, [o.overturned for o in said]).as_dict(grid)
        models[name] = _model(name, said, fell, curve, record.to_plain(measured))
    bare = [
        Case(Outcome.OVERTURNED_LEFT if v > 0.4 else Outcome.STANDS, FELL if f else Outcome.STANDS)
        for v, f in zip(pgv, fell, strict=True)
    ]
    return _write(
        folder,
        {
            "kind": "validation",
            "tests": 60,
            "bodies": 3,
            "fit_share": {"name": "fit", "tests": 0},
            "unknown": [],
            "unfitted": [],
            "models": models,
            "observed": {"fragility_pgv": observed, "contour": None},
            "baseline": {
                "rule": "overturns when PGV reaches the threshold",
                "threshold_m_s": 0.4,
                "fitted_on": "all tests but the one that is predicted",
                "outcomes": score_outcomes(bare).as_dict(),
                "probability": {"tests": 60, "brier": 0.07, "brier_skill": 0.7},
                "by_intensity": [],
            },
            "rows": rows,
            "experiments": "invented.csv",
            "runs": {"wanted": 120, "computed": 120},
        },
    )


def _model(
    name: str, said: list[Outcome], fell: np.ndarray[Any, Any], curve: dict[str, Any], scores: dict[str, Any]
) -> dict[str, Any]:
    """What a validation keeps of one model that said `said` of sixty tests."""
    cases = [Case(p, FELL if f else Outcome.STANDS) for p, f in zip(said, fell, strict=True)]
    contour = {"contour_50": {"ratio_s": [0.1, 0.3], "pga_g": [0.5, 0.2]}} if name == "pymunk" else None
    return {
        "engine": name,
        "accuracy_rad": 1e-3,
        "dt_s": None,
        "tests": 60,
        "failed": 0,
        "fitted": {"tests": 0, "accuracy": None, "friction": 0.6, "azimuth_deg": {"stone 1": 30.0}},
        "outcomes": score_outcomes(cases).as_dict(),
        "probability": {"samples": 0, "tests": 60, "brier": 0.08, "brier_skill": 0.6},
        "by_intensity": [],
        "fragility_pgv": curve,
        "contour": contour,
        "histories": [{"test": "t1", "scores": scores}],
    }


def bench_rows() -> list[dict[str, Any]]:
    """Three scenes, two engines, five rungs and the engines' own defaults; one row failed."""
    rows = []
    for scene in ("free_rocking", "harmonic_floor", "harmonic_pedestal"):
        for engine, cost, error in (("pymunk", 4e-6, 0.4), ("pybullet", 16e-6, 0.6)):
            for k, dt in enumerate((4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)):
                seconds = cost * 10.0 / dt
                row = {
                    "engine": engine,
                    "scene": scene,
                    "label": f"rung {k}",
                    "group": "ladder",
                    "dt_s": dt,
                    "failed": None,
                }
                row |= {
                    "error_rad": error * dt,
                    "wall_s": seconds,
                    "cpu_s": seconds,
                    "steps": int(10.0 / dt),
                    "real_time_factor": 10.0 / seconds,
                }
                rows.append(row | {"reference": "analytic", "chosen": k == 2, "stated_rad": 2.0 * error * dt})
            rows.append(
                {
                    "engine": engine,
                    "scene": scene,
                    "label": "own defaults",
                    "group": "default",
                    "dt_s": 1 / 240,
                    "failed": None,
                }
                | {
                    "error_rad": 0.11,
                    "wall_s": 0.05,
                    "cpu_s": 0.05,
                    "steps": 2400,
                    "real_time_factor": 200.0,
                    "reference": "analytic",
                }
                | {"chosen": False, "stated_rad": None}
            )
    rows[-1] |= {"failed": "diverged", "error_rad": None}
    return rows


def write_bench(folder: Path) -> Path:
    """A bench of three scenes."""
    scaling = [
        {"engine": "pymunk", "quantity": "duration_s", "value": v, "wall_s": 0.04 * v, "memory_mb": 80.0}
        for v in (1.0, 10.0, 100.0)
    ]
    return _write(
        folder,
        {
            "kind": "bench",
            "title": "An invented bench",
            "target_rad": 1e-3,
            "rows": bench_rows(),
            "scaling": scaling,
            "coverage": {"pymunk": {"inside": 15, "total": 15}, "pybullet": {"inside": 14, "total": 15, "missed": [7]}},
            "choice": [
                {"engine": "pymunk", "scenes": 3, "met": 3, "total_s": 0.3, "fixed_s": 1.2, "share": 0.25}
                | {"worst_times": 2.5, "worst_scene": "harmonic, pedestal"},
                {"engine": "pybullet", "scenes": 3, "met": 2, "total_s": 3.0, "fixed_s": None, "share": None}
                | {"worst_times": None, "worst_scene": None},
            ],
            "seeded": [
                {"engine": "pymunk", "scenes": 15, "met": 15, "total_s": 0.5, "fixed_s": 2.0, "share": 0.25}
                | {"median_times": 2.6, "worst_times": 5.5, "worst_scene": "seed 7"},
            ],
            "skips": [
                {"skip": "all together", "engine": "analytic", "scenes": 48, "on_s": 0.1, "off_s": 0.8, "gain": 8.0}
                | {"same": True, "changed": []},
                {"skip": "quiet_end", "engine": "pymunk", "scenes": 1, "on_s": 1.0, "off_s": 3.0, "gain": 3.0}
                | {"same": False, "changed": ["stands, without overturned_left"], "apart_rad": 1e-7},
                {"skip": "quiet_start", "engine": "pymunk", "failed": "no record here"},
            ],
            "parts": [{"part": "precision", "wall_s": 60.0, "tasks": 3, "left": []}],
            "sentences": ["pymunk meets 1e-3 rad at 250 times real time"],
        },
    )


def write_stress(folder: Path, *, sound: bool = True) -> Path:
    """A stability map and a catalogue of hard scenes; `sound` False leaves one scene wrong."""
    cells = []
    for engine in ("pymunk", "pybullet"):
        for k, setting in enumerate(("1/60 s", "1 ms", "0.1 ms")):
            for m, difficulty in enumerate(("slenderness 5", "slenderness 50", "1 cm")):
                category = ("stable", "inaccurate", "drifting", "diverged")[max(0, m - k + (engine == "pybullet"))]
                cell = {"engine": engine, "setting": setting, "difficulty": difficulty, "category": category}
                cells.append(cell | {"evidence": f"error {10.0 ** -(k + 2):.0e} rad", "explained": ""})
    lifted = "lift_off" if sound else "stands"
    answers = {"600 s at rest": ("stands", "stands", "stands"), "vertical −1 g": ("lift_off", "lift_off", lifted)}
    scenes = [
        {"name": name, "wanted": wanted, "got": {"pymunk": munk, "pybullet": bullet}, "holds": munk == bullet == wanted}
        | {"checks": ["finite", "no creep"], "note": ""}
        for name, (wanted, munk, bullet) in answers.items()
    ]
    fuzz = [{"reader": "scene", "inputs": 10_000, "tracebacks": 0, "hangs": 0, "half_written": 0}]
    found = {"kind": "stress", "title": "Invented hard scenes", "cells": cells, "scenes": scenes, "fuzz": fuzz}
    return _write(folder, found)
