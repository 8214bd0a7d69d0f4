"""All skips together on an outcome study of real records: what they gain, and that they change no outcome."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Final

from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.bench.standard_scenes import COLUMN, PAESTUM, record, scene_of
from harness.bench.timing import cost
from harness.campaign.parts import Row
from harness.engines.base import Engine, Settings
from harness.model.errors import InputError
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene

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
"""What an outcome needs: a rung coarse enough for a study, not a history."""
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
        return [{"engine": name, "failed": str(error)}]
    simulate(engine, scenes[0], ALL)
    on_s = off_s = 0.0
    changed: list[str] = []
    unsettled: list[str] = []
    outcomes = set()
    for scene in scenes:
        kept: dict[bool, Run] = {}
        on_s += cost(partial(_keep, kept, engine, scene, True), REPEATS.get(name, 1)).cpu_s
        off_s += cost(partial(_keep, kept, engine, scene, False), REPEATS.get(name, 1)).cpu_s
        outcomes.add(kept[True].outcome.value)
        if kept[True].outcome is not kept[False].outcome:
            said = f"{scene.title}: {kept[True].outcome.value}, without skips {kept[False].outcome.value}"
            (unsettled if decides_nothing(engine, scene, kept[False]) else changed).append(said)
    return [
        {
            "engine": name, "case": case, "scenes": len(scenes), "on_s": on_s, "off_s": off_s, "changed": changed,
            "unsettled": unsettled, "outcomes": sorted(outcomes),
        }
    ]  # fmt: skip


def together(rows: Sequence[Row]) -> list[Row]:
    """One row for each engine, over all statues and records; the sentence of what is missing where a record is."""
    found = []
    for name in dict.fromkeys(row["engine"] for row in rows):
        mine = [row for row in rows if row["engine"] == name]
        failed = next((row["failed"] for row in mine if "failed" in row), None)
        if failed is not None:
            found.append({"skip": "all together", "engine": name, "failed": failed})
            continue
        on_s, off_s = (sum(row[side] for row in mine) for side in ("on_s", "off_s"))
        changed, unsettled = ([text for row in mine for text in row[kind]] for kind in ("changed", "unsettled"))
        found.append(
            {
                "skip": "all together", "engine": name, "scenes": sum(row["scenes"] for row in mine), "on_s": on_s,
                "off_s": off_s, "gain": off_s / on_s, "same": not changed, "changed": changed, "unsettled": unsettled,
                "outcomes": sorted({outcome for row in mine for outcome in row["outcomes"]}),
            }
        )  # fmt: skip
    return found


def decides_nothing(engine: Engine, scene: Scene, run: Run) -> bool:
    """Whether the engine's own finer settings, without any skip, end otherwise: then this rung decides nothing here."""
    if engine.capabilities.certifies:
        return False
    verification_settings = engine.verification_settings(scene, level(engine, scene))
    return any(engine.simulate(scene, probe, NONE).outcome is not run.outcome for probe in verification_settings)


def level(engine: Engine, scene: Scene, expected_rad: float = ENGINE_ACCURACY_RAD) -> Settings:
    """The coarsest settings of which such an error is expected; without it what an outcome needs."""
    refinement_levels = engine.refinement_levels(scene)
    return next((item for item in refinement_levels if item.expected_error_rad <= expected_rad), refinement_levels[-1])


def simulate(engine: Engine, scene: Scene, want: RunOptions, expected_rad: float = ENGINE_ACCURACY_RAD) -> Run:
    """One run of the outcome study: certified, or on the rung that an outcome needs."""
    if engine.capabilities.certifies:
        return run_to_accuracy(engine, scene, 1e-3, want)
    return engine.simulate(scene, level(engine, scene, expected_rad), want)


def _keep(kept: dict[bool, Run], engine: Engine, scene: Scene, skip: bool) -> None:
    kept[skip] = simulate(engine, scene, ALL if skip else NONE)
