"""Engines against measured tosses: coefficients fitted on a seeded share, rotation and place scored on the others."""

from __future__ import annotations

import csv
import time
from collections.abc import Mapping, Sequence
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.campaign.runner import Crash, LocalPool
from harness.input.paths import read_files
from harness.input.scene_file import load_scene
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene
from harness.records.result_folder import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.records.tosses import Missed, PoseErrors, TossesRecord, TossModel, TossRow
from harness.validation.jobs import Model, parse_model
from harness.validation.toss_scores import Coefficients, Errors, TossTask, quartiles, scored
from harness.validation.tosses import Toss, holds_tosses, read_tosses

TOSS_ENGINES: Final = ("spatial", "pybullet", "pybullet:plain")
FRICTIONS: Final = (0.10, 0.13, 0.15, 0.17, 0.18, 0.19, 0.20, 0.21, 0.23, 0.26, 0.30)
"""Coefficients tried: plastic on wood lies between 0.1 and 0.3."""
RESTITUTIONS: Final = (None, 0.05, 0.1, 0.2, 0.4)
FITTED: Final = 1.0 / 3.0
"""Share of the tosses on which the coefficients are fitted."""
OVER_TIME_S: Final = 0.1
"""Errors over time are told at every so many seconds."""

SCORES: Final = "tosses.csv"

Scored = dict[str, list[Errors | str]]


def body_of_tosses(table: Path, body: Path | None, **options: object) -> Path | None:
    """The scene whose statue is thrown where a table holds tosses, else None.

    Raises `InputError` for a body without tosses, tosses without a body, or options of other tables.
    """
    if not holds_tosses(table):
        if body is not None:
            raise InputError(Mistake("--body", "", "a table of tosses beside it", str(table)))
        return None
    if body is None:
        raise InputError(Mistake("--body", "", f"the scene whose statue was thrown in {table}", "nothing"))
    plain = {"samples": 0, "resume": False, "fit_share": "fit"}
    mistakes = [
        Mistake(f"--{name.replace('_', '-')}", "", "no such option with a table of tosses", repr(value))
        for name, value in options.items()
        if value != plain[name]
    ]
    if mistakes:
        raise InputError(mistakes)
    return body


def validate_tosses(
    table: Path,
    folder: Path,
    body: Path,
    *,
    models: Sequence[str] | None = None,
    seed: int = 0,
    jobs: int | None = None,
    most: int | None = None,
) -> TossesRecord:
    """Run the models on measured tosses of a scene's body and score them; writes result.json and tosses.csv into `folder`.

    `body` is a scene file whose statue is thrown; the coefficients of friction and restitution with which a model comes nearest
    to a seeded third of the tosses are scored on the others. `most` takes the table's first so many tosses. Raises `InputError`
    for a wrong table, scene, model or number.
    """
    start = time.perf_counter()
    base = load_scene(body)
    names = [RECORD, COMING, *PAGES, SCORES]
    check_folder(folder, ("tosses",), names)
    check_inputs(folder, names, [table, *read_files(base.given, base.source)])
    tosses = read_tosses(table, base.statue, base.gravity_m_s2)[:most]
    if len(tosses) < 2:
        raise InputError(Mistake(str(table), "", "two tosses: one to fit, one to score", str(len(tosses))))
    known = [parse_model(name) for name in dict.fromkeys(models or TOSS_ENGINES)]
    drawn = np.random.default_rng(seed).permutation(len(tosses))
    fitted = sorted(int(k) for k in drawn[: max(round(FITTED * len(tosses)), 1)])
    pool = LocalPool(jobs)
    try:
        answers = {model.name: _of_model(pool, base, tosses, fitted, model) for model in known}
    finally:
        pool.close()
    result = TossesRecord(
        tosses=table.name,
        body=body.name,
        count=len(tosses),
        fitted_on=[tosses[k].name for k in fitted],
        raised_m=quartiles([toss.raised_m for toss in tosses]),
        models=answers,
        absent={},
        seed=seed,
        versions=record.versions(),
        machine=record.machine(),
        seconds=time.perf_counter() - start,
    )
    return write_whole(folder, result, lambda fresh: _write_scores(fresh / SCORES, answers))


def _write_scores(path: Path, models: Mapping[str, TossModel]) -> None:
    """Every scored toss by every model as a table."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["model", *(each.name for each in fields(TossRow))])
        writer.writerows([name, *astuple(row)] for name, model in models.items() for row in model.rows)


def _of_model(pool: LocalPool, base: Scene, tosses: Sequence[Toss], fitted: Sequence[int], model: Model) -> TossModel:
    """What is fitted for a model, and its scores on the tosses that are left."""
    grid = tuple(Coefficients(mu, e) for e in RESTITUTIONS for mu in FRICTIONS)
    fitting = [tosses[k] for k in fitted]
    tried = _computed(pool, [TossTask(base, toss, model, grid) for toss in fitting])
    miss = [_miss(fitting, [answers[k] for answers in tried.values()]) for k in range(len(grid))]
    best = grid[int(np.argmin(miss))]
    rest = [toss for k, toss in enumerate(tosses) if k not in set(fitted)]
    answers = _computed(pool, [TossTask(base, toss, model, (best,)) for toss in rest])
    known = {name: item[0] for name, item in answers.items() if isinstance(item[0], Errors)}
    failed = {name: item[0] for name, item in answers.items() if isinstance(item[0], str)}
    plastic = {str(item.friction): value for item, value in zip(grid, miss, strict=True) if item.restitution is None}
    bouncing = {
        str(item.restitution or 0.0): value
        for item, value in zip(grid, miss, strict=True)
        if item.friction == best.friction
    }
    return TossModel(
        model.engine,
        model.dt_s,
        best.friction,
        0.0 if best.restitution is None else best.restitution,
        Missed(
            {name: value if np.isfinite(value) else None for name, value in plastic.items()},
            {name: value for name, value in bouncing.items() if np.isfinite(value)},
        ),
        failed,
        {name: item.ended_s for name, item in known.items() if item.ended_s is not None},
        *_scores(known, rest),
    )


def _computed(pool: LocalPool, tasks: Sequence[TossTask]) -> Scored:
    """The errors of each task's toss by its name, in the tasks' order."""
    answers: Scored = {}

    def done(task: TossTask, result: Any) -> None:
        if isinstance(result, Crash):
            answers[task.toss.name] = [f"the engine's process died: {result}" for _ in task.coefficients]
        else:
            answers[task.toss.name] = result

    pool.run(scored, tasks, done)
    return {task.toss.name: answers[task.toss.name] for task in tasks}


def _miss(tosses: Sequence[Toss], answers: Sequence[Errors | str]) -> float:
    """Median over all frames of the mean distance of the body's points, m: infinite in a toss that could not be computed."""
    missed = [
        item.points_m if isinstance(item, Errors) else np.full(len(toss.places_m), np.inf)
        for toss, item in zip(tosses, answers, strict=True)
    ]
    return float(np.median(np.concatenate(missed)))


def _scores(
    known: Mapping[str, Errors], tosses: Sequence[Toss]
) -> tuple[PoseErrors | None, PoseErrors | None, list[PoseErrors], list[TossRow]]:
    """Quartiles over all frames, at the end, and over time; each toss by its name."""
    if not known:
        return None, None, [], []
    every = list(known.values())
    frame_s = {toss.name: toss.frame_s for toss in tosses}
    longest = max(len(item.rotation_rad) * frame_s[name] for name, item in known.items())
    over_time = []
    for time_s in np.arange(OVER_TIME_S, longest, OVER_TIME_S).tolist():
        at = {name: round(time_s / frame_s[name]) for name in known}
        there = [(item, at[name]) for name, item in known.items() if at[name] < len(item.rotation_rad)]
        rotations, places = [item.rotation_rad[k] for item, k in there], [item.place_m[k] for item, k in there]
        over_time.append(
            PoseErrors(t_s=time_s, tosses=len(there), rotation_rad=quartiles(rotations), place_m=quartiles(places))
        )
    turned, apart = (np.concatenate([getattr(item, name) for item in every]) for name in ("rotation_rad", "place_m"))
    rows = [
        TossRow(name, float(np.median(item.rotation_rad)), float(item.rotation_rad[-1]), float(item.place_m[-1]))
        for name, item in known.items()
    ]
    end = PoseErrors(
        rotation_rad=quartiles([row.end_rotation_rad for row in rows]),
        place_m=quartiles([row.end_place_m for row in rows]),
    )
    frames = PoseErrors(count=turned.size, rotation_rad=quartiles(turned), place_m=quartiles(apart))
    return frames, end, over_time, rows
