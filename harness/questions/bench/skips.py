"""All skips together on an outcome study of real records: what they gain, and that they change no outcome."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from functools import partial
from typing import Final

from harness import engines
from harness.accuracy.refinement import first_level, run_to_accuracy
from harness.comparison.scores.pointwise import error_rad
from harness.engines.base import Engine, Settings
from harness.model.errors import InputError
from harness.model.finding import Finding, caution, info
from harness.model.run import Run, RunOptions
from harness.model.scene import Scene
from harness.questions.bench.programs import cost
from harness.questions.bench.standard_scenes import COLUMN, PAESTUM, record, scene_of
from harness.records.bench import TOGETHER, SkipRow
from harness.runs.parts import Row

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
REPEATS: Final = {"analytic": 3}
"""Repetitions of each run where one is short; one where it takes seconds."""


def outcome_scenes(case: str, shares: Sequence[float]) -> Iterator[Scene]:
    """One statue under one record ("block, elcentro1940"), scaled across overturning. Raises `InputError` without the record."""
    statue, under = case.split(", ")
    file, column, duration = RECORDS[under]
    given = STATUES[statue]
    limit = min(given["corner_left_m"], given["corner_right_m"]) / given["centroid_height_m"]
    for share in shares:
        motion = {"x": record(file, column, pga_g=share * limit)}
        yield scene_of(f"{case}, {share:g} g b/h", {"duration_s": duration, "statue": given, "motion": motion})


def tasks(quick: bool) -> list[str]:
    """An engine, a statue and a record each."""
    listed = [f"{engine}: {statue}, {under}" for engine in SHARES for statue in STATUES for under in RECORDS]
    return [task for task in listed if not quick or (STUDY in task and not task.startswith("pybullet"))]


STUDY: Final = "block, elcentro1940"
"""The part of the study that stands for it where time is short."""


def compute(task: str) -> list[Row]:
    """The cost of one engine, statue and record with all skips and with none."""
    name, _, case = task.partition(": ")
    engine = engines.load(name)
    if engine.missing() is not None:
        return []
    try:
        scenes = list(outcome_scenes(case, SHARES[name]))
    except InputError as error:
        return [asdict(SkipRow(TOGETHER, name, failed=str(error)))]
    simulate(engine, scenes[0], ALL)
    row = SkipRow(TOGETHER, name, len(scenes))
    for scene in scenes:
        runs: dict[bool, Run] = {}
        on, off = (
            cost(partial(_keep, runs, engine, scene, skip), REPEATS.get(name, 1)).cpu_s for skip in (True, False)
        )
        outcomes = tuple(sorted({*row.outcomes, runs[True].outcome.value}))
        row = replace(row, on_s=row.on_s + on, off_s=row.off_s + off, outcomes=outcomes)
        if text := other_outcome(scene, runs[True], runs[False]):
            if decides_nothing(engine, scene, runs[False]):
                row = replace(row, unsettled=(*row.unsettled, text))
            else:
                row = replace(row, changed=(*row.changed, text))
    return [asdict(row)]


def died(task: str) -> list[Row]:
    """One whose process died: a row that says so."""
    return [asdict(SkipRow(TOGETHER, task.partition(": ")[0], failed="the process died"))]


def together(rows: Sequence[SkipRow]) -> list[SkipRow]:
    """One row for each engine, over all statues and records; the sentence of what is missing where a record is."""
    sums: dict[str, SkipRow] = {}
    for row in rows:
        known = sums.get(row.engine)
        if known is None or known.failed or row.failed:
            sums[row.engine] = known if known is not None and known.failed else row
            continue
        sums[row.engine] = replace(
            known,
            scenes=known.scenes + row.scenes,
            on_s=known.on_s + row.on_s,
            off_s=known.off_s + row.off_s,
            changed=(*known.changed, *row.changed),
            unsettled=(*known.unsettled, *row.unsettled),
            outcomes=tuple(sorted({*known.outcomes, *row.outcomes})),
        )
    return list(sums.values())


def findings(rows: Sequence[SkipRow]) -> list[Finding]:
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


def decides_nothing(engine: Engine, scene: Scene, run: Run) -> bool:
    """Whether the engine's own finer settings, without any skip, end otherwise: then this level decides nothing here."""
    if engine.capabilities.certifies:
        return False
    verification_settings = engine.verification_settings(scene, level(engine, scene))
    return any(engine.simulate(scene, finer, NONE).outcome is not run.outcome for finer in verification_settings)


def level(engine: Engine, scene: Scene, expected_rad: float = ENGINE_ACCURACY_RAD) -> Settings:
    """The coarsest settings of which such an error is expected; without it what an outcome needs."""
    return first_level(engine.refinement_levels(scene), expected_rad, 1.0)[0]


def simulate(engine: Engine, scene: Scene, options: RunOptions, expected_rad: float = ENGINE_ACCURACY_RAD) -> Run:
    """One run of the outcome study: certified, or on the level that an outcome needs."""
    if engine.capabilities.certifies:
        return run_to_accuracy(engine, scene, 1e-3, options)
    return engine.simulate(scene, level(engine, scene, expected_rad), options)


def _keep(runs: dict[bool, Run], engine: Engine, scene: Scene, skip: bool) -> None:
    runs[skip] = simulate(engine, scene, ALL if skip else NONE)
