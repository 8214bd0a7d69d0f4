"""Invented records of most kinds for the pages' own tests; scores are the harness's own."""

from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness import Outcome, assess, compare, compare_files, load_scene
from harness.comparison.comparator import write_comparison as write_comparison_of
from harness.comparison.statistics import FELL, Prediction, fit_fragility, score_outcomes
from harness.model import Answer, info
from harness.model import run as record
from harness.questions.study.cases import BaseScene
from harness.questions.trust import Plane, answer_of, findings_of, saved_by
from harness.records import bench as stress_record
from harness.records.base import as_file, plain
from harness.records.bench import (
    BenchRecord,
    HardRow,
    LevelChoice,
    Measure,
    PartRow,
    PrecisionRow,
    ScalingRow,
    SkipRow,
    StabilityCell,
    StressRecord,
)
from harness.records.scene import SceneRecord
from harness.records.scores import Interval, Scores
from harness.records.trust import CLASSES, CONTOURS, Rotation, TrustCell, TrustMap, TrustRecord, TrustSummary
from harness.records.validation import FallScores, FragilityCurve
from reports.messages import ENGLISH
from tests import doubles
from tests.scenes_for_tests import paestum

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
    observed = fit_fragility(pgv, fell).curve(grid)
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
        curve = fit_fragility(pgv, [o.overturned for o in said]).curve(grid)
        models[name] = _model(name, said, fell, curve, measured)
    bare = [
        Prediction(Outcome.OVERTURNED_LEFT if v > 0.4 else Outcome.STANDS, FELL if f else Outcome.STANDS)
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
                "outcomes": _bare_outcomes(bare),
                "probability": {"tests": 60, "brier": 0.07, "brier_skill": 0.7},
                "by_intensity": [],
            },
            "rows": rows,
            "experiments": "invented.csv",
            "runs": {"wanted": 120, "computed": 120},
        },
    )


def _bare_outcomes(cases: list[Prediction]) -> dict[str, Any]:
    scores = vars(score_outcomes(cases))
    return {item.name: scores[item.name] for item in fields(FallScores)}


def _model(
    name: str, said: list[Outcome], fell: np.ndarray[Any, Any], curve: FragilityCurve, scores: Scores
) -> dict[str, Any]:
    """What a validation keeps of one model that said `said` of sixty tests."""
    cases = [Prediction(p, FELL if f else Outcome.STANDS) for p, f in zip(said, fell, strict=True)]
    contour = (
        {
            "cases": 60,
            "fell": 30,
            "coefficients": [1.0, 2.0, 3.0],
            "separated": False,
            "contour_50": {"ratio_s": [0.1, 0.3], "pga_g": [0.5, 0.2]},
        }
        if name == "pymunk"
        else None
    )
    return {
        "engine": name,
        "accuracy_rad": 1e-3,
        "dt_s": None,
        "tests": 60,
        "failed": 0,
        "fitted": {
            "tests": 9,
            "log_score": 0.2,
            "width": 1.0,
            "width_at_end": False,
            "counts": 0.25,
            "inputs": [
                {"body": "stone 1", "day": "", "input": "azimuth_deg", "value": 30.0, "weight": 0.8, "at_end": False}
            ],
        },
        "outcomes": score_outcomes(cases),
        "by_probability": None,
        "probability": {"samples": 0, "tests": 60, "brier": 0.08, "brier_skill": 0.6},
        "by_intensity": [],
        "fragility_pgv": curve,
        "contour": contour,
        "histories": [{"test": "t1", "scores": scores}],
    }


def bench_rows() -> list[PrecisionRow]:
    """Three scenes, two engines, five levels and what the target takes; one row failed."""
    rows = []
    for scene in ("free_rocking", "harmonic_floor", "harmonic_pedestal"):
        for engine, cost, error in (("pymunk", 4e-6, 0.4), ("pybullet", 16e-6, 0.6)):
            base = PrecisionRow(engine, scene, "level", "")
            for k, dt in enumerate((4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)):
                seconds = cost * 10.0 / dt
                row = replace(base, label=f"level {k}", dt_s=dt, error_rad=error * dt, wall_s=seconds, cpu_s=seconds)
                row = replace(row, steps=int(10.0 / dt), real_time_factor=10.0 / seconds, chosen=k == 2)
                rows.append(replace(row, stated_rad=2.0 * error * dt))
            own = replace(base, group="accuracy", label="--accuracy 0.001", dt_s=1 / 240, error_rad=0.11, wall_s=0.05)
            rows.append(replace(own, cpu_s=0.05, steps=2400, real_time_factor=200.0))
    rows[-1] = replace(rows[-1], failed="diverged", error_rad=None)
    return rows


def bench() -> BenchRecord:
    """A bench of three scenes."""
    return BenchRecord(
        title="An invented bench",
        target_rad=1e-3,
        rows=bench_rows(),
        scaling=[ScalingRow("pymunk", "duration_s", v, 0.04 * v, 80.0) for v in (1.0, 10.0, 100.0)],
        choice=[
            LevelChoice("pymunk", 3, 3, 0.3, 1.2, 0.25, "harmonic, pedestal", 2.5),
            LevelChoice("pybullet", 3, 2, 3.0, None, None, None, None),
        ],
        skips=[
            SkipRow("all together", "analytic", 48, 0.1, 0.8),
            SkipRow("quiet_end", "pymunk", 1, 1.0, 3.0, ["stands, without overturned_left"], apart_rad=1e-7),
            SkipRow("quiet_start", "pymunk", failed="no record here"),
        ],
        parts=[PartRow("precision", 60.0, 3, [])],
        answer=Answer(
            "met", [info("meets_target", model="pymunk", factor=250.0, scene="free rocking", target_rad=1e-3)]
        ),
        seconds=1.0,
        versions=record.versions(),
        machine=record.machine(),
    )


def write_bench(folder: Path) -> Path:
    """The invented bench in a folder."""
    return _write(folder, plain(bench()))


CHECKED = {"pymunk": [Measure("finite", True), Measure("creep_rad", True, 1e-9, 1e-6)]}


def stress(*, sound: bool = True) -> StressRecord:
    """A stability map and a catalogue of hard scenes; `sound` False leaves one scene wrong."""
    cells = []
    for engine in ("pymunk", "pybullet"):
        for k, setting in enumerate(("1/60 s", "1 ms", "0.1 ms")):
            for m, difficulty in enumerate(("slenderness 5", "slenderness 50", "1 cm")):
                category = ("stable", "inaccurate", "drifting", "diverged")[max(0, m - k + (engine == "pybullet"))]
                error = Measure("error_rad", category == "stable", 10.0 ** -(k + 2), 1e-3)
                cells.append(StabilityCell(engine, setting, difficulty, category, [error]))
    lifted = "lift_off" if sound else "stands"
    answers = {"600 s at rest": ("stands", "stands", "stands"), "vertical −1 g": ("lift_off", "lift_off", lifted)}
    scenes = [
        HardRow(name, wanted, {"pymunk": munk, "pybullet": bullet}, munk == bullet == wanted, CHECKED)
        for name, (wanted, munk, bullet) in answers.items()
    ]
    made = StressRecord(
        title="Invented hard scenes",
        scenes=scenes,
        cells=cells,
        seconds=1.0,
        versions=record.versions(),
        machine=record.machine(),
    )
    told = {"answer": stress_record.answer_of(made), "findings": stress_record.findings_of(made)}
    return replace(made, **told).texted(ENGLISH.say)


def write_stress(folder: Path, *, sound: bool = True) -> Path:
    """The invented stress run in a folder."""
    return _write(folder, plain(stress(sound=sound)))


def write_assessment(folder: Path) -> Path:
    """The model's probability of the paper's statue over a few draws."""
    folder.mkdir(parents=True)
    found = assess(paestum(0.429, 3.0, duration_s=2.0), ["analytic"], draws=200).record
    record.write_json(folder / "result.json", as_file(found))
    return folder


def write_comparison(folder: Path) -> Path:
    """Two histories given as files, one with few digits."""
    folder.mkdir(parents=True)
    a, b = folder.parent / "a.csv", folder.parent / "b.csv"
    doubles.rocking().write_csv(a)
    history = doubles.rocking()
    np.savetxt(b, np.column_stack((history.t_s, history.theta_rad)), "%.5g", ",", header="t_s,theta_rad", comments="")
    write_comparison_of(a, b, compare_files(a, b), folder)
    return folder


def trust() -> TrustRecord:
    """A map of two frequencies on which every class stands once."""
    cells = [
        TrustCell({
            "amplitude_g": 0.1 * 1.5 ** (k % 4), "frequency_hz": (1.0, 2.0)[k // 4], "class": kind, "basis": "runs",
            "answer": "agree", "why": ["statue_slides"] if kind == "left_domain" else [],
            "outcomes": {"analytic": "overturned" if k > 4 else "stands", "pymunk": "stands"}, "peak_rad": 0.01,
            "peak_over_alpha": 0.05 * k, "peaks_apart_rad": 1e-4, "agree_until_s": 3.0, "horizon_s": 4.0,
            "probability": {"analytic": Interval(0.4, 0.3, 0.5, 0.9)} if kind == "probability" else {},
            "amplitude_over_g_tan_alpha": 1.0, "frequency_over_p": 0.5, "set": ["motion.x.amplitude_g=0.1"],
            "paths": {"analytic": Rotation(4.0, [0.0, 0.01 * k, 0.0]), "pymunk": Rotation(2.0, [0.0, 0.011 * k])},
        })
        for k, kind in enumerate(CLASSES)
    ]  # fmt: skip
    shares = dict.fromkeys(CLASSES, 1.0 / len(CLASSES))
    summary = TrustSummary(points=8, asked=8, checked=0, changed=0, found=0, cpu_s=1.0)
    scene = paestum(0.429, 3.0)
    block = load_scene(Path(__file__).parents[2] / "scenes" / "paestum_block.toml")
    whole = Plane(BaseScene(block.source, block.given), scene, "sine", [0.1, 0.15, 0.225, 0.3375], [1.0, 2.0])
    contours = {name: [0.12, None] for name in CONTOURS}
    maps = [TrustMap("pedestal", shares, 0.15, contours, cells), TrustMap("floor", shares, None, contours, cells)]
    saved = saved_by(["analytic", "pymunk"], maps)
    return TrustRecord(
        title="An invented map",
        answer=answer_of(whole, ("analytic", "pymunk"), maps, saved),
        findings=findings_of(maps, saved, summary, 0),
        scene=SceneRecord.of(scene),
        motion="sine",
        coarse=True,
        engines=["analytic", "pymunk"],
        seed=0,
        maps=maps,
        saved=saved,
        summary=summary,
        seconds=1.0,
        versions=record.versions(),
        machine=record.machine(),
    )


def write_trust(folder: Path) -> Path:
    """The invented map in a folder."""
    return _write(folder, plain(trust()))
