"""What skips gain, and that they change no outcome: all together on an outcome study of real records, and each alone where it
applies.
"""

import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import tomli_w

from harness import engines
from harness.accuracy.refinement import first_level, run_to_accuracy
from harness.comparison.scores import error_rad
from harness.engines.base import Engine, Settings
from harness.model import Finding, InputError, Run, RunOptions, Scene, caution, grouped, info
from harness.questions.bench.parts import cost, costs, timed
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
from harness.records.bench import TOGETHER, SkipRow
from harness.runs.runner import LocalPool
from harness.runs.store import STORE_NAME, Store

RECORDS: Final = {
    "elcentro1940": ("elcentro1940_NS.csv", "a_NS_ms2", 31.18),
    "coalinga1983": ("coalinga1983_PFZ14.csv", "a_90_ms2", 64.98),
    "kaikoura2016": ("kaikoura2016_WTMC.csv", "a_N28W_ms2", 69.98),
}
"""The records as they come, whole and without padding: file, column, duration in s."""
STATUES: Final = {"block": COLUMN, "Paestum": PAESTUM}
SHARES: Final = {
    "analytic": (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0),
    "pymunk": (0.5, 1.5, 4.0),
    "pybullet": (0.5, 1.5, 4.0),
}
"""Peak accelerations by engine, in units of the least g b/h: from nothing moves to overturning."""
ENGINE_ACCURACY_RAD: Final = 1e-2
"""What an outcome needs: a level coarse enough for a study, not a history."""
ALL: Final = RunOptions(history=False)
NONE: Final = RunOptions(history=True, skips=frozenset())


def _alone(skip: str, *beside: str) -> tuple[RunOptions, RunOptions]:
    """What is asked with a skip, and without it, none but those `beside` it either way."""
    return RunOptions(skips=frozenset({skip, *beside})), RunOptions(skips=frozenset(beside))


LEVERS: Final = {
    TOGETHER: (ALL, NONE),
    "no_history": (RunOptions(False, frozenset({"no_history"})), RunOptions(True, frozenset())),
    "mirror": _alone("mirror", "base_only"),
    **{skip: _alone(skip) for skip in ("quiet_start", "quiet_rest", "quiet_end", "stop_at_overturn", "base_only")},
}
"""What is asked with a skip and without it."""
PLAIN: Final = ("pymunk:plain", "pybullet:plain")
CASES: Final = {
    "quiet_start": {"analytic": "late record", "pymunk": "late record", "pybullet": "late record"},
    "quiet_rest": {"pybullet": "late record"},
    "quiet_end": {"analytic": "pulse", "pymunk": "pulse", "pybullet": "pulse"},
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


STUDY: Final = "block, elcentro1940"
"""The part of the study that stands for it where time is short."""


def outcome_scenes(case: str, shares: Sequence[float]) -> Iterator[Scene]:
    """One statue under one record ("block, elcentro1940"), scaled across overturning. Raises `InputError` without the record."""
    statue, under = case.split(", ")
    file, column, duration = RECORDS[under]
    given = STATUES[statue]
    limit = min(given["corner_left_m"], given["corner_right_m"]) / given["centroid_height_m"]
    for share in shares:
        motion = {"x": record(file, column, pga_g=share * limit)}
        yield scene_of(f"{case}, {share:g} g b/h", {"duration_s": duration, "statue": given, "motion": motion})


def together_tasks(quick: bool) -> list[str]:
    """All skips together: an engine, a statue and a record each."""
    listed = [
        f"{TOGETHER}: {engine}: {statue}, {under}" for engine in SHARES for statue in STATUES for under in RECORDS
    ]
    return [task for task in listed if not quick or (STUDY in task and "pybullet" not in task)]


def alone_tasks(quick: bool) -> list[str]:
    """Every skip by every engine that has it, then what is no engine's own."""
    own = [f"{skip}: {engine}" for skip, named in CASES.items() for engine in named]
    return own[:1] if quick else [*own, "lazy_engines: *", "cached: analytic", "planar: pymunk for pybullet"]


def _named(task: str) -> tuple[str, str, str]:
    """The skip and the engine of a task, and of the study its statue and record."""
    skip, _, rest = task.partition(": ")
    name, _, case = rest.partition(": ")
    return skip, name, case


def compute(task: str) -> list[SkipRow]:
    """The row of one skip and engine; one that says why where a record is absent, none where the engine is not here."""
    skip, name, case = _named(task)
    others: dict[str, Callable[[], SkipRow]] = {"lazy_engines": _imports, "cached": _cached, "planar": _planar}
    try:
        if skip in others:
            return [others[skip]()]
        engine = engines.load(name)
        if engine.missing() is not None:
            return []
        scenes = list(outcome_scenes(case, SHARES[name])) if case else scenes_of(CASES[skip][name], name)
        return [_measured(skip, engine, scenes)]
    except InputError as error:
        return [SkipRow(skip, name, failed=str(error))]


def died(task: str) -> list[SkipRow]:
    """The row of a skip and engine whose process died."""
    skip, name, _ = _named(task)
    return [SkipRow(skip, name, failed="the process died")]


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


def _measured(skip: str, engine: Engine, scenes: Sequence[Scene]) -> SkipRow:
    """The cost of some scenes with a skip and without it, what it changes, and of one skip alone how far rotations part."""
    # Once before it is timed: what is compiled and loaded then is no run's.
    simulate(engine, scenes[0], LEVERS[skip][0], ENGINE_ACCURACY_RAD if skip == TOGETHER else RESOLVED_RAD)
    return _summed([_of_scene(skip, engine, scene) for scene in scenes])


def _of_scene(skip: str, engine: Engine, scene: Scene) -> SkipRow:
    on, off = LEVERS[skip]
    expected_rad = ENGINE_ACCURACY_RAD if skip == TOGETHER else RESOLVED_RAD
    works = [partial(simulate, engine, scene, options, expected_rad) for options in (on, off)]
    (first, once_on), (second, once_off) = (timed(work) for work in works)
    with_it, without = costs(works, AGAIN, AGAIN_S, [once_on, once_off])
    other = [text] if (text := other_outcome(scene, first, second)) else []
    row = SkipRow(skip, engine.name, 1, with_it.cpu_s, without.cpu_s, other, outcomes=[first.outcome.value])
    if other and decides_nothing(engine, scene, second, expected_rad):
        row = replace(row, changed=(), unsettled=other)
    if skip == TOGETHER:
        return row
    apart_rad, own_rad = difference(first, second), own_error_rad(engine, scene, off, second)
    return replace(row, apart_rad=apart_rad, own_rad=own_rad, steps=[first.steps, second.steps])


def _summed(rows: Sequence[SkipRow]) -> SkipRow:
    """One row of those of one skip and engine; the first that says what is missing, where one does."""
    missing = next((row for row in rows if row.failed), None)
    return missing or replace(
        rows[0],
        scenes=sum(row.scenes for row in rows),
        on_s=sum(row.on_s for row in rows),
        off_s=sum(row.off_s for row in rows),
        changed=tuple(text for row in rows for text in row.changed),
        unsettled=tuple(text for row in rows for text in row.unsettled),
        outcomes=tuple(sorted({outcome for row in rows for outcome in row.outcomes})),
        apart_rad=max((row.apart_rad for row in rows if row.apart_rad is not None), default=None),
        own_rad=max((row.own_rad for row in rows if row.own_rad is not None), default=None),
        steps=[sum(each) for each in zip(*(row.steps or () for row in rows), strict=True)] or None,
    )


def own_error_rad(engine: Engine, scene: Scene, options: RunOptions, run: Run) -> float:
    """What the engine's own finer settings change in a run, rad; of a model that certifies, its stated uncertainty."""
    if engine.capabilities.certifies:
        return run.numerical_uncertainty_rad or 0.0
    return max(
        difference(run, engine.simulate(scene, finer, options))
        for finer in engine.verification_settings(scene, level(engine, scene, RESOLVED_RAD))
    )


def together(rows: Sequence[SkipRow]) -> list[SkipRow]:
    """One row for each engine, over all statues and records; the sentence of what is missing where a record is."""
    return [_summed(mine) for mine in grouped((row.engine, row) for row in rows).values()]


def together_findings(rows: Sequence[SkipRow]) -> list[Finding]:
    """What all skips together gain, and change."""
    found = []
    for row in rows:
        values = {"scenes": row.scenes, "changed": list(row.changed), "unsettled": len(row.unsettled)}
        if row.failed:
            found.append(caution("not_measured", what=row.skip, reason=row.failed))
        elif row.changed:
            found.append(caution("skips_change", gain=row.gain, **values).of(row.engine))
        else:
            found.append(info("skips_gain", gain=row.gain, **values).of(row.engine))
    return found


def alone_findings(rows: Sequence[SkipRow]) -> list[Finding]:
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


def other_outcome(scene: Scene, on: Run, off: Run) -> str:
    """What a skip changed of an outcome, or nothing."""
    if on.outcome is off.outcome:
        return ""
    return f"{scene.title}: {on.outcome.value}, without {off.outcome.value}"


def difference(one: Run, other: Run) -> float:
    """Largest difference of two rotations, rad, where both were kept; of the two peaks otherwise."""
    if one.history is None or other.history is None:
        return abs(one.peak_theta_rad - other.peak_theta_rad)
    return error_rad(one, other)


def decides_nothing(engine: Engine, scene: Scene, run: Run, expected_rad: float) -> bool:
    """Whether the engine's own finer settings, without any skip, end otherwise: then this level decides nothing here."""
    if engine.capabilities.certifies:
        return False
    finer = engine.verification_settings(scene, level(engine, scene, expected_rad))
    return any(engine.simulate(scene, settings, NONE).outcome is not run.outcome for settings in finer)


def level(engine: Engine, scene: Scene, expected_rad: float = ENGINE_ACCURACY_RAD) -> Settings:
    """The coarsest settings of which such an error is expected; without it what an outcome needs."""
    return first_level(engine.refinement_levels(scene), expected_rad, 1.0)[0]


def simulate(engine: Engine, scene: Scene, options: RunOptions, expected_rad: float = ENGINE_ACCURACY_RAD) -> Run:
    """One run of the outcome study: certified, or on the level that an outcome needs."""
    aimed_rad = 1e-3 if engine.capabilities.certifies else expected_rad
    return engine.simulate(scene, level(engine, scene, aimed_rad), options)


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
    seen: list[Any] = []
    with written_study(STUDY_RUNS, "analytic") as run:

        def work() -> None:
            seen.append(run(LocalPool(1)))

        off_s, on_s = cost(work, 1).wall_s, cost(work, 3).wall_s
    again = seen[-1]
    changed = [] if again.computed == 0 and again.found == again.distinct else ["the second study computed again"]
    # Stored failures are found again at no cost as well: a gain over them would be none.
    changed += [f"{seen[0].failed} of the runs failed"] if seen[0].failed else []
    return SkipRow("cached", "analytic", seen[0].wanted, on_s, off_s, tuple(changed))


@contextmanager
def written_study(runs: int, engine: str) -> Iterator[Callable[[LocalPool], Any]]:
    """A study of the column over so many amplitudes, in a store of its own; yields what runs it in a pool."""
    from harness.questions.study.cases import load_study
    from harness.questions.study.study_run import run_study

    scene = {"title": "block", "duration_s": 5.0, "statue": COLUMN, "motion": harmonic(0.3, 2.0)}
    amplitudes = {"key": "motion.x.amplitude_g", "start": 0.2, "stop": 0.5, "count": runs}
    variant = {"name": "block", "engines": [engine]}
    study = {"title": "amplitudes", "scene": "scene.toml", "vary": [amplitudes], "variant": [variant]}
    with tempfile.TemporaryDirectory(prefix="rockcheck-bench-") as name:
        path = Path(name) / "study.toml"
        path.with_name("scene.toml").write_text(tomli_w.dumps(scene), encoding="utf-8")
        path.write_text(tomli_w.dumps(study), encoding="utf-8")
        with Store(path.parent / STORE_NAME) as store:
            yield partial(run_study, load_study(path), path, store)


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
