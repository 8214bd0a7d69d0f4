"""Engines against measured tosses: coefficients fitted on a seeded share, rotation and place scored on the others."""

from __future__ import annotations

import csv
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import astuple, fields, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.optimize import minimize

from harness.input.paths import read_files
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.model.finding import Answer, Finding, Say, caution, info
from harness.model.history import Array
from harness.model.scene import Scene
from harness.records.result_folder import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.records.tosses import Clock, Missed, PoseErrors, TossesRecord, TossFit, TossModel, TossRow, TrajectoryMeans
from harness.runs.runner import Crash, LocalPool
from harness.validation.jobs import Model, parse_model
from harness.validation.kinds import thrown_body
from harness.validation.toss_scores import Coefficients, Errors, TossTask, quartiles, scored
from harness.validation.tosses import Toss, read_tosses

TOSS_ENGINES: Final = ("spatial", "pybullet", "pybullet:plain")
FRICTIONS: Final = (0.10, 0.13, 0.15, 0.17, 0.18, 0.19, 0.20, 0.21, 0.23, 0.26, 0.30)
"""Coefficients tried: plastic on wood lies between 0.1 and 0.3."""
RESTITUTIONS: Final = (0.05, 0.1, 0.2, 0.4)
"""Both are looked through first; from the best of them the fit goes downhill, by at most so many"""
EVALUATIONS: Final = 24
AFTER_IMPACT: Final = 8
"""Frames after the first contact that are looked at for what an impact leaves: 0.05 s, before most bodies land again."""
PUBLISHED: Final = {
    "Drake": TrajectoryMeans(0.135, 0.082, math.radians(16.5), math.radians(20.0)),
    "Bullet": TrajectoryMeans(0.149, 0.089, math.radians(16.5), math.radians(20.2)),
    "MuJoCo": TrajectoryMeans(0.251, 0.108, math.radians(21.7), math.radians(21.4)),
}
"""On DAIRLab's cube tosses, by Acosta, Yang and Posa (RA-L 2022, arXiv 2110.00541)."""
PUBLISHED_WIDTH_M: Final = 0.1048
FITTED: Final = 1.0 / 3.0
"""Share of the tosses on which the coefficients are fitted."""
OVER_TIME_S: Final = 0.1
"""Errors over time are told at every so many seconds."""

SCORES: Final = "tosses.csv"

Scored = dict[str, list[Errors | str]]


def validate_tosses(
    table: Path,
    folder: Path,
    body: Path,
    *,
    models: Sequence[str] | None = None,
    seed: int = 0,
    jobs: int | None = None,
    most: int | None = None,
    say: Say = str,
) -> TossesRecord:
    """Run the models on measured tosses of a scene's body and score them; writes result.json and tosses.csv into `folder`.

    `body` is a scene file whose statue is thrown; the coefficients of friction and restitution with which a model comes nearest
    to a seeded third of the tosses are scored on the others. `most` takes the table's first so many tosses. Raises `InputError`
    for a wrong table, scene, model or number.
    """
    start = time.perf_counter()
    base = thrown_body(body)
    names = [RECORD, COMING, *PAGES, SCORES]
    check_folder(folder, ("tosses",), names)
    check_inputs(folder, names, [table, *read_files(base.given, base.source)])
    tosses, clock = read_tosses(table, base.statue, base.gravity_m_s2)
    tosses = tosses[:most]
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
    width = base.statue.corner_left_m + base.statue.corner_right_m
    result = TossesRecord(
        title=f"{len(tosses)} measured tosses",
        answer=_answer(answers),
        findings=_findings(clock, answers),
        tosses=table.name,
        body=body.name,
        count=len(tosses),
        fitted_on=[tosses[k].name for k in fitted],
        raised_m=quartiles([toss.raised_m for toss in tosses]),
        clock=clock,
        published=PUBLISHED if abs(width - PUBLISHED_WIDTH_M) < 1e-4 else {},
        models=answers,
        absent={},
        seed=seed,
        versions=record.versions(),
        machine=record.machine(),
        seconds=time.perf_counter() - start,
    )
    return write_whole(folder, result.texted(say), lambda fresh: _write_scores(fresh / SCORES, answers))


def _answer(models: Mapping[str, TossModel]) -> Answer:
    """Which model's places are nearest at the mean of all trajectories."""
    known = {name: item.fits["trajectory"].means for name, item in models.items()}
    means = {name: each for name, each in known.items() if each is not None}
    if not means:
        return Answer("no_answer", [info("no_answer", asked=len(models))])
    best = min(means, key=lambda name: means[name].place_share)
    return Answer("tosses", [info("tosses_nearest", model=best, **vars(means[best]))])


def _findings(clock: Clock | None, models: Mapping[str, TossModel]) -> list[Finding]:
    """What is to be known of the clock, and of tosses without an answer."""
    found = [] if clock is None or clock.rate_hz == clock.stated_hz else [caution("clock_calibrated", **vars(clock))]
    for name, item in models.items():
        found += [caution("tosses_failed", model=name, count=len(item.failed))] if item.failed else []
        found += [info("tosses_ended", model=name, count=len(item.ended_s))] if item.ended_s else []
    return found


def _write_scores(path: Path, models: Mapping[str, TossModel]) -> None:
    """Every scored toss by every model as a table."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["model", *(each.name for each in fields(TossRow))])
        writer.writerows([name, *astuple(row)] for name, model in models.items() for row in model.rows)


def _of_model(pool: LocalPool, base: Scene, tosses: Sequence[Toss], fitted: Sequence[int], model: Model) -> TossModel:
    """What is fitted for a model, and its scores on the tosses that are left."""
    fitting = [tosses[k] for k in fitted]
    rest = [toss for k, toss in enumerate(tosses) if k not in set(fitted)]
    looks = {"trajectory": fitting, "first_impact": [_landing(toss) for toss in fitting]}
    width = base.statue.corner_left_m + base.statue.corner_right_m
    fits, losses, answers = {}, {}, {}
    for name, seen in looks.items():
        loss = _Loss(pool, base, seen, model, after_contact=name == "first_impact")
        best, missed = loss.least()
        answers[name] = _computed(pool, [TossTask(base, toss, model, (best,)) for toss in rest])
        means = _means([item[0] for item in answers[name].values() if isinstance(item[0], Errors)], width)
        fits[name] = TossFit(best.friction, best.restitution or 0.0, missed, means)
        losses[name] = loss
    answer, own, loss = answers["trajectory"], fits["trajectory"], losses["trajectory"]
    known = {name: item[0] for name, item in answer.items() if isinstance(item[0], Errors)}
    failed = {name: item[0] for name, item in answer.items() if isinstance(item[0], str)}
    tried = {"friction": loss.tried[None], "restitution": loss.bouncing}
    plastic, bouncing = (
        {str(key): each if np.isfinite(each) else None for key, each in one.items()} for one in tried.values()
    )
    return TossModel(
        model.engine,
        model.dt_s,
        own.friction,
        own.restitution,
        Missed(plastic, {key: each for key, each in bouncing.items() if each is not None}),
        failed,
        {name: item.ended_s for name, item in known.items() if item.ended_s is not None},
        fits,
        *_scores(known, rest),
    )


def _landing(toss: Toss) -> Toss:
    """A toss up to the frames just after its first impact, whose places say the velocities after it."""
    end = min(max(toss.contact, 1) + AFTER_IMPACT, len(toss.places_m))
    return replace(toss, places_m=toss.places_m[:end], quaternions=toss.quaternions[:end])


def _means(errors: Sequence[Errors], width_m: float) -> TrajectoryMeans | None:
    """Over tosses, of each toss's mean over its frames."""
    if not errors:
        return None
    places = [float(np.mean(each.place_m)) / width_m for each in errors]
    turns = [float(np.mean(each.rotation_rad)) for each in errors]
    return TrajectoryMeans(float(np.mean(places)), float(np.std(places)), float(np.mean(turns)), float(np.std(turns)))


class _Loss:
    """How far a model's points are off, by friction and restitution: a coarse look, then downhill from its best."""

    def __init__(self, pool: LocalPool, base: Scene, tosses: Sequence[Toss], model: Model, after_contact: bool) -> None:
        self._from = [toss.contact if after_contact else 0 for toss in tosses]
        self._pool, self._base, self._tosses, self._model = pool, base, tosses, model
        self.tried: dict[float | None, dict[float, float]] = {}
        self.bouncing: dict[float, float] = {}

    def least(self) -> tuple[Coefficients, float]:
        """The coefficients of least loss, and that."""
        plastic = self._all([Coefficients(friction) for friction in FRICTIONS])
        self.tried[None] = dict(zip(FRICTIONS, plastic, strict=True))
        friction = FRICTIONS[int(np.argmin(plastic))]
        bounced = self._all([Coefficients(friction, each) for each in RESTITUTIONS])
        self.bouncing = {0.0: min(plastic), **dict(zip(RESTITUTIONS, bounced, strict=True))}
        bounces = bool(np.isfinite(bounced).any())
        first = np.array([friction, min(self.bouncing, key=lambda each: self.bouncing[each])])
        simplex = first + np.array([[0.0, 0.0], [0.1 * friction, 0.0], [0.0, 0.03]])[: 3 if bounces else 2]
        found = minimize(
            self._at,
            first if bounces else first[:1],
            method="Nelder-Mead",
            options={
                "initial_simplex": simplex[:, : 2 if bounces else 1],
                "maxfev": EVALUATIONS,
                "xatol": 1e-3,
                "fatol": 1e-5,
            },
        )
        return _coefficients(found.x), float(found.fun)

    def _at(self, point: Array) -> float:
        item = _coefficients(point)
        outside = float(np.sum(np.abs(point - [item.friction, item.restitution or 0.0][: point.size])))
        return self._all([item])[0] + outside

    def _all(self, items: Sequence[Coefficients]) -> list[float]:
        tasks = [TossTask(self._base, toss, self._model, tuple(items)) for toss in self._tosses]
        answers = _computed(self._pool, tasks)
        return [_miss(self._tosses, [found[k] for found in answers.values()], self._from) for k in range(len(items))]


def _coefficients(point: Array) -> Coefficients:
    """The coefficients at a point, or the nearest that there are."""
    friction = float(np.clip(point[0], 1e-3, 2.0))
    restitution = float(np.clip(point[1], 0.0, 1.0)) if point.size > 1 else 0.0
    return Coefficients(friction, restitution or None)


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


def _miss(tosses: Sequence[Toss], answers: Sequence[Errors | str], first: Sequence[int]) -> float:
    """Median over the frames from the `first` of each toss on of the mean distance of the body's points, m: infinite in a toss
    that could not be computed.
    """
    missed = [
        (item.points_m if isinstance(item, Errors) else np.full(len(toss.places_m), np.inf))[begin:]
        for toss, item, begin in zip(tosses, answers, first, strict=True)
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
