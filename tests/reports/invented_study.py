"""Invented study records for the pages' own tests; the claims are judged by the harness's own code from the invented rows."""

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.model import run as record
from harness.questions.study import claims
from harness.questions.study.study_record import answer_of, findings_of
from harness.records.base import as_file, part, plain, read_result
from harness.records.scene import SceneRecord
from harness.records.study import CaseRun, StudyRecord, StudyRow
from reports.messages import ENGLISH
from tests.reports.invented_run import block_scene, invented_history

OWN = {
    "code": "own_contact",
    "severity": "caution",
    "values": {"keys": ["model.friction_normal"]},
    "engine": "",
    "text": "",
}
VARIANTS = {
    "own impact": ("analytic", "pymunk", "pybullet"),
    "paper": ("analytic",),
    "imposed ratio": ("analytic", "pymunk"),
}


def _run(engine: str, outcome: str, peak_rad: float, **more: Any) -> dict[str, Any]:
    fell = outcome.startswith("overturned")
    return {
        "engine": engine,
        "outcome": outcome,
        "peak_theta_rad": peak_rad,
        "peak_time_s": 2.0,
        "no_return_time_s": 1.7 if fell else None,
        "overturn_time_s": 2.4 if fell else None,
        "peak_slip_m": 0.012,
        "residual_slip_m": 0.001,
        "numerical_uncertainty_rad": 2e-4,
        "reliable_until_s": 5.0,
        "steps": 1000,
        "labels": [],
        "findings": [OWN] if engine == "pybullet" else [],
        "validity": {},
        "impacts": 12,
        **more,
    }


def case_run(outcome: str = "stands", peak_rad: float = 0.1, **more: Any) -> CaseRun:
    """A study's run of this outcome."""
    return part(CaseRun, _run("analytic", outcome, peak_rad, **more), Path("invented"))


def case_row(engine: str, run: CaseRun | None, reason: str = "every case is asked", variant: str = "own") -> StudyRow:
    """A study's row of a run."""
    return StudyRow(number=0, engine=engine, reason=reason, varied={"variant": variant}, run=run)


def study(folder: Path) -> StudyRecord:
    """The record that a folder holds."""
    found = read_result(folder)
    assert isinstance(found, StudyRecord)
    return found


def _record(title: str, rows: list[dict[str, Any]], **more: Any) -> dict[str, Any]:
    keys = [key for key in rows[0]["varied"] if key not in ("variant", "contact.floor_static")]
    return {
        "schema_version": record.SCHEMA_VERSION,
        "kind": "study",
        "title": title,
        "file": "invented.toml",
        "scene": plain(SceneRecord.of(block_scene(wall=False))),
        "findings": [],
        "vary": {key: sorted({row["varied"][key] for row in rows}, key=str) for key in keys},
        "summary": {"wanted": len(rows), "computed": len(rows)},
        "seconds": 12.5,
        "engine_seconds": {"analytic": 0.2, "pymunk": 8.0},
        "rows": rows,
        "audit": None,
        "versions": record.versions(),
        "machine": record.machine(),
        **more,
    }


def _write(folder: Path, found: dict[str, Any]) -> Path:
    """The record with the answer and the findings of its own rows, in a folder."""
    made = part(StudyRecord, record.to_plain(found), folder)
    answered = replace(made, answer=answer_of(made), findings=findings_of(made)).texted(ENGLISH.say)
    folder.mkdir(parents=True, exist_ok=True)
    record.write_json(folder / "result.json", as_file(answered))
    return folder


def write_table_study(folder: Path) -> Path:
    """The paper's 60 conditions with invented outcomes, panels and judged claims."""
    rows: list[dict[str, Any]] = []
    panels = []
    number = itertools.count()
    for r, a, f in itertools.product((0.85, 0.875, 0.9), (0.334, 0.429), (1.5, 2.0, 3.0, 4.5, 6.0)):
        curves: dict[str, Any] = {}
        for pedestal, (variant, engines) in itertools.product(("none", "keep"), VARIANTS.items()):
            case = next(number)
            for engine in engines:
                falls = f < (2.5 if pedestal == "none" else 1.8) and not (engine == "pybullet" and f > 1.9)
                varied = {"variant": variant, "contact.restitution": r, "motion.x.amplitude_g": a}
                varied |= {"motion.x.frequency_hz": f, "pedestal": pedestal}
                outcome = "overturned_left" if falls else "stands"
                run = _run(engine, outcome, 1.5 if falls else 0.6 / f)
                rows.append(
                    {"number": case, "engine": engine, "reason": "every case is asked", "varied": varied, "run": run}
                )
                history = invented_history(0.01 * f, falls=falls, samples=400)
                setting = "floor" if pedestal == "none" else "pedestal"
                curves.setdefault(f"{engine} ({variant})", {})[setting] = {
                    name: getattr(history, name) for name in ("t_s", "theta_rad", "slip_m")
                }
        panels.append({"restitution": r, "amplitude_g": a, "frequency_hz": f, "curves": curves})
    typed = [part(StudyRow, row, Path("invented")) for row in rows]
    verdicts = claims.judge(typed, 1.46 * float(np.sin(0.5)))
    found = _record(
        "An invented table of 60 conditions",
        rows,
        claims=plain(verdicts),
        headline=claims.headline(verdicts),
        panels=panels,
    )
    return _write(folder, found)


def write_map_study(folder: Path) -> Path:
    """A map over amplitude and frequency, with a random sample at each point and a cell that was not asked."""
    rows: list[dict[str, Any]] = []
    number = itertools.count()
    for f, a, sample in itertools.product(np.geomspace(0.5, 8.0, 9), np.linspace(0.1, 1.0, 10), (0.97, 1.0, 1.04)):
        case = next(number)
        varied = {"variant": "own", "motion.x.frequency_hz": float(f), "motion.x.amplitude_g": float(a)}
        varied |= {"contact.floor_static": sample}
        for engine, bias in (("analytic", 1.0), ("pymunk", 1.05)):
            falls = a * sample > 0.12 * bias * (1.0 + f)
            asked = engine == "analytic" or abs(a - 0.12 * (1.0 + f)) < 0.3
            run = _run(engine, "overturned_right" if falls else "stands", 1.5 if falls else 0.05) if asked else None
            reason = "every case is asked" if asked else "not sent: the map's points around it agree"
            rows.append({"number": case, "engine": engine, "reason": reason, "varied": varied, "run": run})
    return _write(folder, _record("An invented map", rows))


def write_rose_study(folder: Path) -> Path:
    """Least overturning amplitude by azimuth."""
    rows: list[dict[str, Any]] = []
    number = itertools.count()
    for azimuth, a in itertools.product(range(0, 360, 30), np.linspace(0.1, 0.8, 8)):
        falls = a > 0.33 + 0.2 * np.cos(np.radians(azimuth))
        varied = {"variant": "own", "statue.mesh.azimuth_deg": float(azimuth), "motion.x.amplitude_g": float(a)}
        run = _run("analytic", "overturned_left" if falls else "stands", 1.5 if falls else 0.05)
        rows.append(
            {
                "number": next(number),
                "engine": "analytic",
                "reason": "every case is asked",
                "varied": varied,
                "run": run,
            }
        )
    return _write(folder, _record("An invented rose", rows))
