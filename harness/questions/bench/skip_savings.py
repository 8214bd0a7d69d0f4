"""Each skip alone: what it gains where it applies, and that the result is the same with it and without."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Final

import tomli_w

from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.engines.base import Engine
from harness.model.errors import InputError
from harness.model.finding import Finding, caution, info
from harness.model.run import Run, RunOptions
from harness.model.scene import Scene
from harness.questions.bench.programs import cost, costs, timed
from harness.questions.bench.skips import (
    ALL,
    RECORDS,
    SHARES,
    STUDY,
    decides_nothing,
    difference,
    level,
    other_outcome,
    outcome_scenes,
    simulate,
)
from harness.questions.bench.standard_scenes import (
    COLUMN,
    PAESTUM,
    PEDESTAL,
    harmonic,
    record,
    resolved,
    scene_of,
    standard_set,
)
from harness.records.bench import SkipRow
from harness.runs.parts import Row


def _alone(skip: str, *beside: str, history: bool = True) -> tuple[RunOptions, RunOptions]:
    """What is asked with a skip, and without it, none but those `beside` it either way."""
    return RunOptions(history, frozenset({skip, *beside})), RunOptions(history, frozenset(beside))


LEVERS: Final = {
    "no_history": (RunOptions(False, frozenset({"no_history"})), RunOptions(True, frozenset())),
    "energy_outcome": _alone("energy_outcome", "no_history", history=False),
    "mirror": _alone("mirror", "base_only"),
    **{skip: _alone(skip) for skip in ("quiet_start", "quiet_rest", "quiet_end", "stop_at_overturn", "base_only")},
}
"""What is asked with a skip alone and without it."""
PLAIN: Final = ("pymunk:plain", "pybullet:plain")
CASES: Final = {
    "quiet_start": {"analytic": "late record", "pymunk": "late record", "pybullet": "late record"},
    "quiet_rest": {"pybullet": "late record"},
    "quiet_end": {"analytic": "pulse", "pymunk": "pulse", "pybullet": "pulse"},
    "energy_outcome": {"analytic": "pulse"},
    "no_history": {"analytic": "study", "pymunk": "late record", "pybullet": "late record"}
    | dict.fromkeys(PLAIN, "short"),
    "stop_at_overturn": {"pymunk": "falls"} | dict.fromkeys(PLAIN, "falls soon"),
    "base_only": {"pybullet": "on a pedestal", "pybullet:plain": "on a pedestal"},
    "mirror": {"pybullet": "on a pedestal"},
}
"""For each skip the engines that have it, and the scene on which it is measured."""
STUDY_RUNS: Final = 16
RESOLVED_RAD: Final = 3e-4
"""A level that is expected to resolve what a skip may change."""
AGAIN, AGAIN_S = 4, 0.3
"""Turns in which a run is timed again, and the processor time after which none is begun."""
LEAST_RAD: Final = 1e-9
"""Rotations nearer than this are the same, whatever a run's own error."""
GAINS: Final = 1.05
"""Times faster from which a skip counts as a gain: below it the clock's own scatter decides."""


def tasks(quick: bool) -> list[str]:
    """Every skip by every engine that has it, then what is no engine's own."""
    own = [f"{skip}: {engine}" for skip, named in CASES.items() for engine in named]
    return own[:1] if quick else [*own, "lazy_engines: *", "cached: analytic", "planar: pymunk for pybullet"]


def compute(task: str) -> list[Row]:
    """The row of one skip and engine; one that says why where a record is absent or an engine not here."""
    skip, _, name = task.partition(": ")
    others: dict[str, Callable[[], SkipRow]] = {"lazy_engines": _imports, "cached": _cached, "planar": _planar}
    try:
        if skip in others:
            return [asdict(others[skip]())]
        engine = engines.load(name)
        if engine.missing() is not None:
            return []
        return [asdict(_measured(skip, engine, CASES[skip][name]))]
    except InputError as error:
        return [asdict(SkipRow(skip, name, failed=str(error)))]


def died(task: str) -> list[Row]:
    """The row of a skip and engine whose process died."""
    skip, _, name = task.partition(": ")
    return [asdict(SkipRow(skip, name, failed="the process died"))]


def scenes_of(kind: str, engine: str) -> list[Scene]:
    """The scenes on which a skip is measured. Raises `InputError` without the records."""
    if kind == "study":
        return list(outcome_scenes(STUDY, SHARES[engine]))
    file, column, duration = RECORDS["coalinga1983"]
    contents = {
        "late record": {"duration_s": duration, "statue": COLUMN, "motion": {"x": record(file, column, pga_g=0.3)}},
        "falls": {"duration_s": duration, "statue": COLUMN, "motion": {"x": record(file, column, pga_g=2.0)}},
        "pulse": PULSE,
        "short": {**PULSE, "duration_s": 1.0},
        "falls soon": {"duration_s": 4.0, "statue": COLUMN, "motion": harmonic(0.6, 1.0)},
        "on a pedestal": {"duration_s": 2.0, "statue": PAESTUM, "pedestal": PEDESTAL, "motion": harmonic(0.3, 3.0)},
    }
    return [scene_of(kind, contents[kind])]


PULSE: Final = {
    "duration_s": 20.0,
    "statue": COLUMN,
    "motion": {"x": {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.28, "duration_s": 0.5}},
}


def _measured(skip: str, engine: Engine, kind: str) -> SkipRow:
    on, off = LEVERS[skip]
    scenes = scenes_of(kind, engine.name)
    changed: list[str] = []
    apart = own = on_s = off_s = 0.0
    steps = [0, 0]
    for scene in scenes:
        works = [partial(simulate, engine, scene, options, RESOLVED_RAD) for options in (on, off)]
        (first, once_on), (second, once_off) = (timed(work) for work in works)
        text = other_outcome(scene, first, second)
        changed += [text] if text and not decides_nothing(engine, scene, second) else []
        apart = max(apart, difference(first, second))
        own = max(own, own_error_rad(engine, scene, off, second))
        steps = [steps[0] + first.steps, steps[1] + second.steps]
        with_it, without = costs(works, AGAIN, AGAIN_S, [once_on, once_off])
        on_s, off_s = on_s + with_it.cpu_s, off_s + without.cpu_s
    return SkipRow(
        skip, engine.name, len(scenes), on_s, off_s, tuple(changed), apart_rad=apart, own_rad=own,
        steps=(steps[0], steps[1]),
    )  # fmt: skip


def own_error_rad(engine: Engine, scene: Scene, options: RunOptions, run: Run) -> float:
    """What the engine's own finer settings change in a run, rad; of a model that certifies, its stated uncertainty."""
    if engine.capabilities.certifies:
        return run.numerical_uncertainty_rad or 0.0
    return max(
        difference(run, engine.simulate(scene, finer, options))
        for finer in engine.verification_settings(scene, level(engine, scene, RESOLVED_RAD))
    )


def findings(rows: Sequence[SkipRow]) -> list[Finding]:
    """Which skips gain nothing where they were measured alone, and which move a rotation by more than its own error."""
    measured = [row for row in rows if not row.failed]
    if not measured:
        return []
    idle = [f"{row.skip} ({row.engine})" for row in measured if row.gain < GAINS]
    found = [info("skips_alone", gaining=len(measured) - len(idle), measured=len(measured), idle=idle)]
    for row in measured:
        if row.changed:
            found.append(caution("skip_changes", skip=row.skip, changed=list(row.changed)).of(row.engine))
        if row.apart_rad is not None and row.own_rad is not None and row.apart_rad > max(row.own_rad, LEAST_RAD):
            found.append(
                caution("skip_parts", skip=row.skip, apart_rad=row.apart_rad, own_rad=row.own_rad).of(row.engine)
            )
    return found


def _imports() -> SkipRow:
    """Seconds of processor time to be ready to answer `--help`, against importing all simulators as well."""
    lazy = "import reports.cli"
    eager = lazy + "\nfrom harness.engines import REGISTRY, load\nfor name in REGISTRY: load(name).missing()"
    return SkipRow("lazy_engines", "*", 1, _fresh_s(lazy), _fresh_s(eager))


def _fresh_s(code: str) -> float:
    """Least processor time of a fresh interpreter over three tries."""
    tail = "\nimport time; print(time.process_time())"
    tries = [
        subprocess.run([sys.executable, "-c", code + tail], capture_output=True, text=True, check=True)
        for _ in range(3)
    ]
    return min(float(done.stdout.split()[-1]) for done in tries)


def _cached() -> SkipRow:
    """A study of sixteen runs, then the same study again from its store."""
    from harness.questions.study.file import load_study
    from harness.questions.study.study_run import run_study
    from harness.runs.runner import LocalPool
    from harness.runs.store import Store

    with tempfile.TemporaryDirectory(prefix="rockcheck-bench-") as name:
        path = write_study(Path(name), STUDY_RUNS, "analytic")
        study = load_study(path)
        with Store(path.parent / "store.sqlite") as store:
            seen = []

            def work() -> None:
                seen.append(run_study(study, path, store, LocalPool(1)))

            off_s, on_s = cost(work, 1).wall_s, cost(work, 3).wall_s
    again = seen[-1]
    changed = [] if again.computed == 0 and again.found == again.distinct else ["the second study computed again"]
    # Stored failures are found again at no cost as well: a gain over them would be none.
    changed += [f"{seen[0].failed} of the runs failed"] if seen[0].failed else []
    return SkipRow("cached", "analytic", seen[0].wanted, on_s, off_s, tuple(changed))


def write_study(folder: Path, runs: int, engine: str) -> Path:
    """A study of the column over `runs` amplitudes, written to `folder`."""
    scene = {"title": "block", "duration_s": 5.0, "statue": COLUMN, "motion": harmonic(0.3, 2.0)}
    amplitudes = {"key": "motion.x.amplitude_g", "start": 0.2, "stop": 0.5, "count": runs}
    variant = {"name": "block", "engines": [engine]}
    study = {"title": "amplitudes", "scene": "scene.toml", "vary": [amplitudes], "variant": [variant]}
    (folder / "scene.toml").write_text(tomli_w.dumps(scene), encoding="utf-8")
    path = folder / "study.toml"
    path.write_text(tomli_w.dumps(study), encoding="utf-8")
    return path


def _planar() -> SkipRow:
    """Planar questions answered in the plane, against the same in three dimensions: the block scenes of the standard set."""
    scenes = [scene for item, scene in resolved(standard_set())[0] if item.block]
    flat, solid = engines.load("pymunk"), engines.load("pybullet")
    changed: list[str] = []
    apart = on_s = off_s = 0.0
    for scene in scenes:
        first, second = run_to_accuracy(flat, scene, 1e-3, ALL), run_to_accuracy(solid, scene, 1e-3, ALL)
        changed += filter(None, [other_outcome(scene, first, second)])
        apart = max(apart, abs(abs(first.peak_theta_rad) - abs(second.peak_theta_rad)))
        on_s += cost(partial(run_to_accuracy, flat, scene, 1e-3, ALL), 3).cpu_s
        off_s += cost(partial(run_to_accuracy, solid, scene, 1e-3, ALL), 3).cpu_s
    return SkipRow("planar", "pymunk for pybullet", len(scenes), on_s, off_s, tuple(changed), apart_rad=apart)
