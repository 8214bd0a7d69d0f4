"""The bench: all measurements in one run, one record."""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib import util
from pathlib import Path
from typing import Any, Final

from harness import engines, record
from harness.benchmark import others, precision, scaling, skips
from harness.benchmark.scenes import resolved, standard_set
from harness.benchmark.sentences import choice, sentences
from harness.record import SCHEMA_VERSION
from harness.run import check_folder

COVERAGE_SEEDS: Final = {"pymunk": 30, "pybullet": 3}
"""Seeded scenes for the coverage of the stated uncertainty, as many as the time allows (200 are run outside the bench)."""
CLOCK: Final = "cpu_s: processor time of the process (single-threaded runs); wall_s: by the clock; both best of several"


def run(folder: Path, quick: bool = False, told: Callable[[str], None] = lambda text: None) -> dict[str, Any]:
    """Measure everything and write `result.json` into `folder`; `quick` takes the first scenes and rungs only.

    `told` hears what is at work. Raises `InputError` for a folder that cannot be written.
    """
    check_folder(folder)
    start = time.perf_counter()
    items, absent = resolved(standard_set()[:3] if quick else standard_set())
    names = [name for name in engines.REGISTRY if _ready(name)]
    rows = [row for item, scene in items for row in precision.rows_of(item, scene, names, quick=quick, told=told)]
    coverage_rows = _coverage(quick, told)
    found: dict[str, Any] = {
        "schema_version": SCHEMA_VERSION,
        "kind": "bench",
        "title": "Run time against error",
        "target_rad": precision.TARGET_RAD,
        "clock": CLOCK,
        "rows": rows,
        "absent": absent,
        "choice": choice(rows, precision.TARGET_RAD),
        "coverage_rows": coverage_rows,
        "coverage": _counted(coverage_rows),
        "skips": skips.rows(quick, told),
        "scaling": list(scaling.rows(quick, told)),
        **others.measure(quick),
        "versions": record.versions(),
        "machine": record.machine(),
    }
    found["sentences"] = [
        *sentences(found),
        *others.sentences(found),
        *(f"“{name}” was left out: {why}." for name, why in absent.items()),
    ]
    found["seconds"] = time.perf_counter() - start
    plain: dict[str, Any] = record.to_plain(found)
    folder.mkdir(parents=True, exist_ok=True)
    record.write_json(folder / "result.json", plain)
    return plain


def _ready(name: str) -> bool:
    module = engines.REGISTRY[name].partition(":")[0]
    return util.find_spec(module) is not None and engines.load(name).missing() is None


def _coverage(quick: bool, told: Callable[[str], None]) -> list[dict[str, Any]]:
    from harness.coverage import FIRST_SEED, coverage

    rows = []
    for name, count in COVERAGE_SEEDS.items():
        if not _ready(name):
            continue
        told(f"coverage: {name}")
        seeds = range(FIRST_SEED, FIRST_SEED + (2 if quick else count))
        rows += [row.as_dict() for row in coverage(engines.load(name), precision.TARGET_RAD, seeds)]
    return rows


def _counted(rows: list[dict[str, Any]]) -> dict[str, dict[str, int]]:
    found: dict[str, dict[str, int]] = {}
    for row in rows:
        item = found.setdefault(row["engine"], {"inside": 0, "total": 0})
        item["inside"] += bool(row["covered"])
        item["total"] += 1
    return found
