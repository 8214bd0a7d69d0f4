"""The bench: work against precision, what skips gain, how cost grows; measured in parts that can be interrupted, one record."""

import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final

import numpy as np
import tomli_w

from harness import engines
from harness.accuracy.horizon import by_model
from harness.accuracy.refinement import first_level, run_to_accuracy, simulate
from harness.comparison.scores import error_rad
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model import Answer, Finding, InputError, Run, RunOptions, Scene, caution, grouped, info, number
from harness.questions.bench.parts import Cost, Measurement, Part, cost, costs, peak_memory_mb, processor_s, timed
from harness.questions.bench.standard_scenes import (
    COLUMN,
    PAESTUM,
    PEDESTAL,
    Standard,
    harmonic,
    record,
    resolved,
    scene_of,
    standard_set,
)
from harness.records.bench import (
    LEVEL,
    TARGET,
    TOGETHER,
    BenchRecord,
    LevelChoice,
    PrecisionRow,
    ScalingRow,
    SkipRow,
    of_parts,
)
from harness.records.run import PLAIN
from harness.runs.runner import LIMIT_S, LocalPool
from harness.runs.store import STORE_NAME, Store
from harness.runs.task import call

# Work against precision: every engine on every level, and what a target takes.

TARGET_RAD: Final = 1e-3
LONG_S: Final = 1.0
"""A level is left out (and said so) when the one before it took this long: finer levels show the same line further."""
REPEATS: Final = 15
"""Turns in which levels are timed: after a long one caches are cold, and a short one needs more turns to show its least time."""
BUDGET_S: Final = 0.1
"""Processor time of one level after which no further turn is begun: what is compared are ratios of whole numbers and more."""
NOBODY: Final = ""
"""The engine of the row of a scene that is not here."""
NOTHING: Final = Cost(0.0, 0.0, 0)
"""Of what was not run."""


def precision_tasks(quick: bool) -> list[str]:
    """The scenes of the standard set, the longest first."""
    names = [item.name for item in standard_set()]
    return names[:3] if quick else sorted(names, key=lambda name: "Maria" not in name)


def precision_rows(quick: bool, name: str) -> list[PrecisionRow]:
    """All rows of one scene of the standard set; one that says why where a file of it is absent."""
    item = next(item for item in standard_set() if item.name == name)
    try:
        scene = item.scene()
    except InputError as error:
        return [PrecisionRow(NOBODY, name, LEVEL, "", failed=str(error))]
    return list(rows_of(item, scene, list(engines.REGISTRY), quick=quick))


def lost_precision(name: str) -> list[PrecisionRow]:
    """A scene whose process died: one row that says so."""
    return [PrecisionRow("any", name, LEVEL, "all", failed="the process died")]


def rows_of(item: Standard, scene: Scene, names: Sequence[str], *, quick: bool) -> Iterator[PrecisionRow]:
    """The rows of one scene: each engine's levels, and what the target takes."""
    exact = by_model(scene, options=RunOptions())
    for name in names:
        engine = engines.load(name)
        if item.spatial and engine.capabilities.dimensions < 3:
            continue
        base = PrecisionRow(name, item.name, LEVEL, "not here", item.block)
        reason = engine.missing()
        if reason is not None:
            yield replace(base, failed=reason)
            continue
        # A self-certifying model has no finer settings of another kind to be judged by than its own finest.
        own = item.reference == "own" or engine.capabilities.certifies
        yield from _levels(base, scene, engine, None if own else exact, quick)


def _levels(base: PrecisionRow, scene: Scene, engine: Engine, exact: Run | None, quick: bool) -> Iterator[PrecisionRow]:
    """Every level and what the target takes: errors first, then all of them timed in turns, as they are compared."""
    base = replace(base, reference="analytic" if exact is not None else "own finest level")
    tried = _tried(engine, scene, quick)
    good = [(settings, run, once) for settings, run, once in tried if isinstance(run, Run)]
    judge = exact or (good[-1][1] if good else None)
    # An unmodified engine is not asked what a target takes: it refines until it gives up.
    refines = judge is not None and not engine.capabilities.certifies and not engine.name.endswith(PLAIN)
    refine = partial(run_to_accuracy, engine, scene, TARGET_RAD, RunOptions())
    asked, once = timed(partial(_answered, refine)) if refines else (None, NOTHING)
    works: list[Callable[[], object]] = [
        partial(engine.simulate, scene, settings, RunOptions()) for settings, _, _ in good
    ]
    before = [item[2] for item in good]
    if isinstance(asked, Run):
        works.append(refine)
        before.append(once)
    spent = iter(costs(works, REPEATS, BUDGET_S, before))
    for settings, run, _ in tried:
        row = replace(base, label=_label(settings), dt_s=settings.dt_s)
        if isinstance(run, str) or judge is None:
            yield replace(row, failed=str(run))
            continue
        took = next(spent)
        if run is not judge:
            yield costing(_with(row, run, error_rad(run, judge)), took, run.end_s)
    if asked is not None and judge is not None:
        yield _chosen(replace(base, group=TARGET, label=f"--accuracy {TARGET_RAD:g}"), asked, judge, next(spent, None))


def _tried(engine: Engine, scene: Scene, quick: bool) -> list[tuple[Settings, Run | str, Cost]]:
    """Each level's run, whose error is taken, or why there is none, and its cost."""
    tried: list[tuple[Settings, Run | str, Cost]] = []
    levels = engine.refinement_levels(scene)[: 3 if quick else None]
    for settings in levels:
        if tried and isinstance(tried[-1][1], Run) and tried[-1][2].cpu_s > LONG_S:
            left_out = f"not run: the level before it took {LONG_S:g} s of processor time or more"
            return [*tried, *((finer, left_out, NOTHING) for finer in levels[len(tried) :])]
        run = partial(engine.simulate, scene, settings, RunOptions())
        tried.append((settings, *timed(partial(_answered, run))))
    return tried


def _answered(work: Callable[[], Run]) -> Run | str:
    """What a run gives, or why it gives nothing."""
    try:
        run = work()
    except EngineFailure as failure:
        return str(failure)
    return (run.message or run.outcome.value) if run.outcome.failed or run.history is None else run


def _chosen(row: PrecisionRow, run: Run | str, judge: Run, spent: Cost | None) -> PrecisionRow:
    """What the target accuracy takes, its own checks included."""
    if isinstance(run, Run) and run.settings == judge.settings:
        run = "it goes on to the very level by which errors are judged here"
    if isinstance(run, str) or spent is None:
        return replace(row, failed=str(run))
    row = costing(_with(row, run, error_rad(run, judge, run.bounded_until_s)), spent, run.end_s)
    label = f"{row.label}: {run.work.get('runs', 1)} runs, the finest {_label(run.settings)}"
    steps = run.work.get("steps_of_all_runs", run.steps)
    return replace(
        row,
        label=label,
        dt_s=number(run.settings, "dt_s"),
        chosen=True,
        reliable_until_s=run.reliable_until_s,
        steps=steps,
    )


def _with(row: PrecisionRow, run: Run, error: float) -> PrecisionRow:
    """A row with a run's work, its statement and its error."""
    return replace(
        row, error_rad=error, steps=run.steps, iterations=int(number(run.settings, "iterations", 0.0)) or None,
        stated_rad=run.numerical_uncertainty_rad,
    )  # fmt: skip


def costing(row: PrecisionRow, spent: Cost, simulated_s: float) -> PrecisionRow:
    """A row with what it took to simulate so long."""
    factor = simulated_s / spent.cpu_s
    return replace(row, wall_s=spent.wall_s, cpu_s=spent.cpu_s, repeats=spent.repeats, real_time_factor=factor)


def _label(settings: Settings | Mapping[str, object]) -> str:
    """A level by its numbers."""
    plain = settings.as_dict() if isinstance(settings, Settings) else settings
    if "accuracy_rad" in plain:
        return f"{plain['accuracy_rad']:g} rad"
    iterations = f", {plain['iterations']} it." if "iterations" in plain else ""
    return f"{1e3 * number(plain, 'dt_s'):g} ms{iterations}"


# What the rows say.


def choice(rows: Sequence[PrecisionRow], target_rad: float) -> list[LevelChoice]:
    """For each engine what the target takes on the scenes where it gave an answer."""
    choices = []
    for engine, mine in grouped((row.engine, row) for row in rows).items():
        taken = {row.scene: row for row in mine if row.group == TARGET and row.failed is None}
        if not taken:
            continue
        by_scene = grouped((row.scene, row) for row in mine if row.group == LEVEL and row.scene in taken)
        # By its place among the levels: one level may have other iterations on another scene.
        levels = [
            {row.scene: row for row in at if row is not None and row.failed is None}
            for at in zip_longest(*by_scene.values())
        ]
        whole = [by for by in levels if set(by) == set(taken) and all(row.meets(target_rad) for row in by.values())]
        fixed_s = min((sum(row.cpu_s or 0.0 for row in by.values()) for by in whole), default=None)
        good = grouped((scene, row.cpu_s or 0.0) for by in levels for scene, row in by.items() if row.meets(target_rad))
        times = {scene: (row.cpu_s or 0.0) / min(good[scene]) for scene, row in taken.items() if scene in good}
        total_s = sum(row.cpu_s or 0.0 for row in taken.values())
        worst = max(times, key=lambda scene: times[scene], default=None)
        choices.append(
            LevelChoice(
                engine,
                len(taken),
                sum(row.meets(target_rad) for row in taken.values()),
                total_s,
                fixed_s,
                None if fixed_s is None else total_s / fixed_s,
                worst,
                None if worst is None else times[worst],
                statistics.median(times.values()) if times else None,
            )
        )
    return choices


def fastest(rows: Sequence[PrecisionRow], target_rad: float) -> dict[str, tuple[float, str]]:
    """For each engine the least real-time factor, over the block scenes, of the fastest level that meets the target."""
    factors = grouped(
        ((row.engine, row.scene), (row.real_time_factor or 0.0) if row.meets(target_rad) else 0.0)
        for row in rows
        if row.block and row.group == LEVEL
    )
    by_engine = grouped((engine, (max(of_levels), scene)) for (engine, scene), of_levels in factors.items())
    return {engine: min(of_scenes) for engine, of_scenes in by_engine.items()}


def speeds(rows: Sequence[PrecisionRow], target_rad: float) -> list[Finding]:
    """How fast each engine meets the target."""
    return [
        info("meets_target", model=engine, factor=factor, scene=scene, target_rad=target_rad)
        if factor > 0.0
        else caution("misses_target", model=engine, scene=scene, target_rad=target_rad)
        for engine, (factor, scene) in fastest(rows, target_rad).items()
    ]


def takes(choices: Sequence[LevelChoice], target_rad: float) -> list[Finding]:
    """What the target takes."""
    return [info("target_takes", target_rad=target_rad, **vars(item)).of(item.engine) for item in choices]


# What skips gain, and that they change no outcome: all together on an outcome study of real records, and each alone where it
# applies.

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
PLAIN_ENGINES: Final = ("pymunk:plain", "pybullet:plain")
CASES: Final = {
    "quiet_start": {"analytic": "late record", "pymunk": "late record", "pybullet": "late record"},
    "quiet_rest": {"pybullet": "late record"},
    "quiet_end": {"analytic": "pulse", "pymunk": "pulse", "pybullet": "pulse"},
    "no_history": {"analytic": "study", "pymunk": "late record", "pybullet": "late record"}
    | dict.fromkeys(PLAIN_ENGINES, "short"),
    "stop_at_overturn": {"pymunk": "falls"} | dict.fromkeys(PLAIN_ENGINES, "falls soon"),
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


def skip_rows(task: str) -> list[SkipRow]:
    """The row of one skip and engine; one that says why where a record is absent, none where the engine is not here."""
    skip, name, *case = task.split(": ")
    others: dict[str, Callable[[], SkipRow]] = {"lazy_engines": _imports, "cached": _cached, "planar": _planar}
    try:
        if skip in others:
            return [others[skip]()]
        engine = engines.load(name)
        if engine.missing() is not None:
            return []
        scenes = list(outcome_scenes(case[0], SHARES[name])) if case else scenes_of(CASES[skip][name], name)
        return [_measured(skip, engine, scenes)]
    except InputError as error:
        return [SkipRow(skip, name, failed=str(error))]


def lost_skip(task: str) -> list[SkipRow]:
    """The row of a skip and engine whose process died."""
    skip, name = task.split(": ")[:2]
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
    run_on_level(engine, scenes[0], LEVERS[skip][0], ENGINE_ACCURACY_RAD if skip == TOGETHER else RESOLVED_RAD)
    return _summed([_of_scene(skip, engine, scene) for scene in scenes])


def _of_scene(skip: str, engine: Engine, scene: Scene) -> SkipRow:
    on, off = LEVERS[skip]
    expected_rad = ENGINE_ACCURACY_RAD if skip == TOGETHER else RESOLVED_RAD
    works = [partial(run_on_level, engine, scene, options, expected_rad) for options in (on, off)]
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


def run_on_level(engine: Engine, scene: Scene, options: RunOptions, expected_rad: float = ENGINE_ACCURACY_RAD) -> Run:
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
    with written_study(STUDY_RUNS, "analytic") as run, closing(LocalPool(1)) as pool:
        first, computed = timed(partial(run, pool))
        again, found = timed(partial(run, pool))
        (stored,) = costs([partial(run, pool)], 2, first=[found])
    changed = [] if again.computed == 0 and again.found == again.distinct else ["the second study computed again"]
    # Stored failures are found again at no cost as well: a gain over them would be none.
    changed += [f"{first.failed} of the runs failed"] if first.failed else []
    return SkipRow("cached", "analytic", first.wanted, stored.wall_s, computed.wall_s, tuple(changed))


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


# How time and memory grow with duration, mesh vertices, number of runs and workers; each point in a fresh process.

Point = tuple[str, str, float]

DURATIONS_S: Final = (2.0, 8.0, 32.0)
VERTICES: Final = (16, 128, 1024)
RUNS: Final = (100, 1000, 10_000)
WORKER_RUNS: Final = 32
"""Runs of the study whose time is taken with one worker and with all."""


def scaling_tasks(quick: bool) -> list[str]:
    """The points that are timed by processor time, each named by its engine, quantity and value."""
    few = 1 if quick else None
    engines = ("analytic", "pymunk", "pybullet")
    points = [
        *((engine, "duration_s", value) for engine in engines for value in DURATIONS_S[:few]),
        *((engine, "mesh_vertices", value) for engine in engines for value in VERTICES[:few]),
        *(("analytic", "runs", value) for value in RUNS[:few]),
    ]
    return [f"{engine} {quantity} {value:g}" for engine, quantity, value in points]


def worker_tasks(quick: bool) -> list[str]:
    """The points that are timed by the clock: one worker, and all."""
    return [] if quick else [f"pymunk workers {value}" for value in sorted({1, os.cpu_count() or 1})]


def scaling_rows(task: str) -> list[ScalingRow]:
    """One point, in a process of its own, so that memory is that point's."""
    engine, quantity, value = task.split()
    point = engine, quantity, float(value)
    seconds, memory_mb, cpu_s = call(measured_point, (point,), timeout_s=LIMIT_S)
    return [ScalingRow(engine, quantity, point[2], seconds, memory_mb, cpu_s)]


def measured_point(point: Point) -> tuple[float, float, float]:
    """Seconds by the clock, peak memory in MB and processor seconds of one point."""
    engine, quantity, value = point
    if quantity == "workers":
        return _workers(int(value))
    if quantity == "runs":
        work = _ensemble(int(value))
    else:
        content = {"duration_s": value, "statue": COLUMN, "motion": harmonic(0.25, 2.0)}
        scene = _prism(int(value)) if quantity == "mesh_vertices" else scene_of("longer", content)
        work = partial(simulate, scene, engine)
    # Once before it is timed: what is compiled and loaded then is no run's.
    work()
    spent = cost(work, 3)
    return spent.wall_s, peak_memory_mb(), spent.cpu_s


def _prism(vertices: int) -> Scene:
    """A prism on a polygon of half so many corners, under a motion that makes it rock."""
    import trimesh

    angles = np.arange(vertices // 2) * (2.0 * np.pi / (vertices // 2))
    ring = 0.12 * np.column_stack([np.cos(angles), np.sin(angles)])
    bodies = [np.column_stack([ring, np.full(len(ring), z)]) for z in (0.0, 0.9)]
    with tempfile.TemporaryDirectory(prefix="rockcheck-bench-") as name:
        file = Path(name) / "prism.ply"
        trimesh.Trimesh(np.vstack(bodies)).convex_hull.export(file)
        mesh = {"file": str(file), "unit": "m", "density_kg_m3": 2700.0}
        return scene_of("prism", {"duration_s": 2.0, "statue": {"mesh": mesh}, "motion": harmonic(0.35, 2.0)})


def _ensemble(runs: int) -> Callable[[], object]:
    """So many outcomes of the analytic model, over amplitudes."""
    from analytic import ensemble
    from harness.model import block_of

    scene = scene_of("many", {"duration_s": 10.0, "statue": COLUMN, "motion": harmonic(0.25, 2.0)})
    sweep = {"amplitude_m_s2": np.linspace(0.1, 0.5, runs) * scene.gravity_m_s2}
    return partial(ensemble, block_of(scene), scene.base_excitation.x, sweep=sweep, duration_s=10.0, threads=1)


def _workers(jobs: int) -> tuple[float, float, float]:
    with written_study(WORKER_RUNS, "pymunk") as run, closing(LocalPool(jobs)) as pool:
        begin = time.perf_counter()
        run(pool)
        wall_s = time.perf_counter() - begin
    return wall_s, peak_memory_mb() + jobs * peak_memory_mb(resource.RUSAGE_CHILDREN), processor_s()


def scaling_findings(rows: Sequence[ScalingRow]) -> list[Finding]:
    """The power of each quantity with which time grows between its two largest values; of workers how much faster they are."""
    found = []
    asked = grouped(((row.engine, row.quantity), row) for row in rows)
    for (engine, quantity), mine in asked.items():
        if len(mine) < 2:
            continue
        less, more = sorted(mine, key=lambda row: row.value)[-2:]
        if quantity == "workers":
            times = less.wall_s / more.wall_s
            found.append(info("workers_faster", workers=more.value, fewer=less.value, times=times))
        else:
            times_s = [row.wall_s if row.cpu_s is None else row.cpu_s for row in (less, more)]
            power = math.log(times_s[1] / times_s[0]) / math.log(more.value / less.value)
            found.append(info("time_grows", power=power, quantity=quantity).of(engine))
    return found


# All parts, and the record that is made of their rows.


def all_parts(quick: bool) -> list[Part]:
    """The parts as they are measured: by processor time on all cores, then those that are timed by the clock, alone."""
    return [
        Part("precision", precision_tasks(quick), partial(precision_rows, quick), lost_precision, PrecisionRow),
        Part("skips", together_tasks(quick), skip_rows, lost_skip, SkipRow),
        Part("alone", alone_tasks(quick), skip_rows, lost_skip, SkipRow),
        Part("scaling", scaling_tasks(quick), scaling_rows, _died, ScalingRow),
        Part("workers", worker_tasks(quick), scaling_rows, row=ScalingRow),
    ]


def _died(task: str) -> list[object]:
    raise RuntimeError(f"{task}: its process died")


def assembled(rows: Mapping[str, Sequence[Any]], head: Mapping[str, Any]) -> BenchRecord:
    """The record from the rows of all parts; what is not measured yet is left empty and said."""
    absent = {row.scene: row.failed for row in rows["precision"] if row.engine == NOBODY}
    order = [item.name for item in standard_set()]
    timed = [row for row in rows["precision"] if row.engine != NOBODY]
    timed.sort(key=lambda row: order.index(row.scene))
    alone, summed = rows["alone"], together(rows["skips"])
    made = BenchRecord(
        target_rad=TARGET_RAD,
        rows=timed,
        absent=absent,
        choice=choice(timed, TARGET_RAD),
        skips=[*summed, *alone],
        scaling=[*rows["scaling"], *rows["workers"]],
        **head,
    )
    found = [
        *takes(made.choice, TARGET_RAD),
        *together_findings(summed),
        *alone_findings(alone),
        *scaling_findings(made.scaling),
        *of_parts(made.parts, absent),
    ]
    met = speeds(timed, TARGET_RAD) or [caution("no_engine_timed")]
    answer = Answer("met" if any(each.code == "meets_target" for each in met) else "not_met", met)
    return replace(made, answer=answer, findings=found)


BENCH: Final = Measurement("bench", all_parts, assembled)
