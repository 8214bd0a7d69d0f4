"""Engines against measured tosses: coefficients fitted on a seeded share, rotation and place scored on the others."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.optimize import minimize

from analytic.block import rotation_matrices
from analytic.excitation import ZeroExcitation
from harness import engines
from harness.accuracy.simulation import RunTarget, simulate_with
from harness.model.errors import InputError, Mistake
from harness.model.finding import Answer, Finding, Say, caution, info
from harness.model.history import Array, History
from harness.model.scene import BaseExcitation, Contact, Initial, Scene, Statue, rotations
from harness.questions.validate.jobs import Model, parse_model
from harness.questions.validate.measured_set import MeasuredSet, Rows, shares
from harness.questions.validate.tosses import Toss, read_tosses
from harness.records.validation import MeasuredRecord, MeasuredTable
from harness.runs.runner import Crash, LocalPool

# One toss computed and scored: how far rotation and place are off at every frame.


STEPS_A_FRAME: Final = 8
"""Steps between two frames where no step is asked for: 0.84 ms at 148 Hz; four times as many change no median by a sixth
of itself, less than the fit of friction leaves open (docs/scores.md)."""
AFTER_IMPACT: Final = 8
"""Frames whose slope is a velocity, one stretch after the other from the first contact on: 0.05 s, before most bodies land
again; differences of two frames would drown in noise."""
TAKEN: Final = 1e-3
"""Metres, and entries of the rotation: some hundred times what an engine's contact settles in its first step."""


@dataclass(frozen=True)
class Coefficients:
    """What is fitted: friction, and the share of the normal velocity that an impact gives back (None: plastic)."""

    friction: float
    restitution: float | None = None


@dataclass(frozen=True, eq=False)
class Errors:
    """By frame (n,): angle between the computed and the measured rotation, distance of the centroids, mean distance of the
    body's outer points (what the two do together; fitted). `rate_m_s` (m,): mean distance of these points' velocities in each
    stretch after the first contact. Beyond `ended_s` the run's last pose is held.
    """

    rotation_rad: Array
    place_m: Array
    points_m: Array
    rate_m_s: Array
    ended_s: float | None = None


@dataclass(frozen=True)
class TossTask:
    """One toss with every pair of coefficients that is wanted of it."""

    base: Scene
    toss: Toss
    model: Model
    coefficients: tuple[Coefficients, ...]


def scored(task: TossTask) -> list[Errors | str]:
    """The errors with each pair of coefficients, or the sentence with which the engine failed."""
    return [_one(task, item) for item in task.coefficients]


def _one(task: TossTask, item: Coefficients) -> Errors | str:
    scene, engine = scene_of(task.base, task.toss, item), engines.load(task.model.engine)
    if task.model.dt_s is not None:
        # Frames are whole steps: poses between two steps would be interpolated across a turn of an angle.
        target = RunTarget(dt_s=task.toss.frame_s / max(round(task.toss.frame_s / task.model.dt_s), 1))
    elif engine.capabilities.certifies:
        target = RunTarget(task.model.accuracy_rad)
    else:
        target = RunTarget(dt_s=task.toss.frame_s / STEPS_A_FRAME)
    run = simulate_with(engine, scene, target)
    if run.history is None:
        return run.message or run.outcome.value
    if not began_as_asked(task.toss, scene.statue, run.history):
        return "its start did not take: its first pose is another one"
    return errors(task.toss, scene.statue, run.history)


def began_as_asked(toss: Toss, body: Statue, history: History) -> bool:
    """Whether a run's first pose is the toss's start: one that is not says nothing of the toss."""
    turn, place = poses(body, history)
    apart = np.linalg.norm(place[0] - toss.start.position_m), np.linalg.norm(turn[0] - toss.start.rotation)
    return bool(max(apart) < TAKEN)


def scene_of(base: Scene, toss: Toss, item: Coefficients) -> Scene:
    """The body of a scene thrown as measured onto a still floor."""
    still = ZeroExcitation()
    return replace(
        base,
        title=f"toss {toss.name}",
        duration_s=toss.end_s,
        contact=Contact(base.contact.floor_static, base.contact.floor_kinetic, item.friction, item.restitution),
        base_excitation=BaseExcitation(still, still, still),
        initial=Initial(pose=toss.start),
        output_dt_s=toss.frame_s,
    )


def errors(toss: Toss, body: Statue, history: History) -> Errors:
    """A computed pose history beside the measured one, frame by frame."""
    turn, place = poses(body, history)
    count = len(toss.places_m)
    # A frame that a run did not reach counts too: a model must not gain by giving up.
    reached = np.minimum(np.arange(count), len(turn) - 1)
    turn, place = turn[reached], place[reached]
    measured, seen = rotation_matrices(toss.quaternions), toss.places_m
    apart = np.einsum("nij,nik->njk", measured, turn)
    # The angle of a rotation from both its sine and its cosine: neither is good near 0 and π alone.
    axis = np.stack([apart[:, 2, 1] - apart[:, 1, 2], apart[:, 0, 2] - apart[:, 2, 0], apart[:, 1, 0] - apart[:, 0, 1]])
    angle = np.arctan2(np.linalg.norm(axis, axis=0), np.trace(apart, axis1=1, axis2=2) - 1.0)
    points = body.outer_points_m
    shift = place - seen
    moved = points @ np.swapaxes(turn - measured, 1, 2) + shift[:, None, :]
    end_s = float(history.t_s[-1])
    ended_s = end_s if end_s < toss.end_s - 0.5 * toss.frame_s else None
    size = min(AFTER_IMPACT, count)
    first = min(toss.contact + 1, count - size)
    stretches = moved[first : first + (count - first) // size * size].reshape(-1, size, *moved.shape[1:])
    since = np.arange(size) - 0.5 * (size - 1)
    slopes = np.einsum("n,mnpk->mpk", since, stretches) / (toss.frame_s * float(since @ since))
    rate = np.mean(np.linalg.norm(slopes, axis=2), axis=1)
    return Errors(angle, np.linalg.norm(shift, axis=1), np.mean(np.linalg.norm(moved, axis=2), axis=1), rate, ended_s)


def poses(body: Statue, history: History) -> tuple[Array, Array]:
    """Rotations (n, 3, 3) and centroids (n, 3) from the columns that every engine of three dimensions records."""
    turn = rotations(history.extra)
    corner = np.stack([history.extra[f"corner_right_{axis}_m"] for axis in "xyz"], axis=1)
    return turn, corner - turn @ np.array([body.corner_right_m, 0.0, -body.centroid_height_m])


def quartiles(values: Sequence[float] | Array) -> list[float]:
    """Lower quartile, median and upper quartile."""
    return [float(each) for each in np.percentile(np.asarray(values), [25.0, 50.0, 75.0])]


TOSS_ENGINES: Final = ("spatial", "pybullet", "pybullet:plain")
FRICTIONS: Final = (0.10, 0.13, 0.15, 0.17, 0.18, 0.19, 0.20, 0.21, 0.23, 0.26, 0.30)
"""Coefficients tried: plastic on wood lies between 0.1 and 0.3."""
RESTITUTIONS: Final = (0.05, 0.1, 0.2, 0.4)
"""Both are looked through first; from the best of them the fit goes downhill, by at most so many"""
EVALUATIONS: Final = 24
TRAJECTORY, VELOCITIES = "trajectory", "impact_velocities"
"""What a fit looks at: the points at all frames, or their velocities after impacts."""
PUBLISHED: Final = (
    ("Drake", "published", None, None, 13.5, 8.2, 16.5, 20.0),
    ("Bullet", "published", None, None, 14.9, 8.9, 16.5, 20.2),
    ("MuJoCo", "published", None, None, 25.1, 10.8, 21.7, 21.4),
)
"""On DAIRLab's cube tosses, by Acosta, Yang and Posa (RA-L 2022, arXiv 2110.00541)."""
PUBLISHED_WIDTH_M: Final = 0.1048
OVER_TIME_S: Final = 0.1
"""Errors over time are told at every so many seconds."""

MEANS: Final = (
    "model", "fitted_on", "friction", "restitution", "place_percent", "place_sd_percent", "rotation_deg", "rotation_sd_deg",
)  # fmt: skip
POSES: Final = (
    "model", "at_s", "tosses", "rotation_low_rad", "rotation_median_rad", "rotation_high_rad", "place_low_m", "place_median_m",
    "place_high_m",
)  # fmt: skip
LOSSES: Final = ("model", "fitted_on", "along", "friction", "restitution", "missed")
"""Missed: m at the median of all frames, or m/s at the median of all stretches after the first contact."""
TOSSES: Final = ("model", "toss", "rotation_rad", "end_rotation_rad", "end_place_m")

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
) -> MeasuredRecord:
    """Run the models on measured tosses of a scene's body and score them; writes result.json into `folder`.

    `body` is a scene file whose statue is thrown; the coefficients of friction and restitution with which a model comes nearest
    to a seeded third of the tosses are scored on the others. `most` takes the table's first so many tosses. Raises `InputError`
    for a wrong table, scene, model or number.
    """
    measured = MeasuredSet(table, folder, body)
    base = measured.base
    tosses, clock = read_tosses(table, base.statue, base.gravity_m_s2)
    tosses = tosses[:most]
    if len(tosses) < 2:
        raise InputError(Mistake(str(table), "", "two tosses: one to fit, one to score", str(len(tosses))))
    known = [parse_model(name) for name in dict.fromkeys(models or TOSS_ENGINES)]
    fitting, rest = ([tosses[k] for k in numbers] for numbers in shares(len(tosses), seed))
    with closing(LocalPool(jobs)) as pool:
        answers = {model.name: _of_model(pool, base, fitting, rest, model) for model in known}
    width = base.statue.corner_left_m + base.statue.corner_right_m
    means = [row for item in answers.values() for row in item.means]
    found = [] if clock is None or clock.rate_hz == clock.stated_hz else [caution("clock_calibrated", **vars(clock))]
    raised = [toss.raised_m for toss in tosses]
    found.append(info("tosses_raised", **dict(zip(("low_m", "median_m", "high_m"), quartiles(raised), strict=True))))
    found += [each for item in answers.values() for each in item.findings]
    return measured.written(
        "tosses",
        f"{len(tosses)} measured tosses",
        [
            MeasuredTable("means", MEANS, [*means, *(PUBLISHED if abs(width - PUBLISHED_WIDTH_M) < 1e-4 else ())]),
            MeasuredTable("poses", POSES, [row for item in answers.values() for row in item.poses]),
            MeasuredTable("losses", LOSSES, [row for item in answers.values() for row in item.losses]),
            MeasuredTable("tosses", TOSSES, [row for item in answers.values() for row in item.tosses]),
        ],
        say,
        answer=_answer(means, len(known)),
        findings=found,
        seed=seed,
    )


def _answer(means: Rows, asked: int) -> Answer:
    """Which model's places are nearest at the mean of all trajectories."""
    known = [dict(zip(MEANS, row, strict=True)) for row in means if row[1] == TRAJECTORY]
    best = min(known, key=lambda row: float(row["place_percent"] or 0.0), default=None)
    if best is None:
        return Answer("no_answer", [info("no_answer", asked=asked)])
    share = {name: 0.01 * float(best[name] or 0.0) for name in ("place_percent", "place_sd_percent")}
    turn = [math.radians(float(best[name] or 0.0)) for name in ("rotation_deg", "rotation_sd_deg")]
    values = {"place_share": share["place_percent"], "place_share_sd": share["place_sd_percent"]}
    return Answer(
        "tosses",
        [info("tosses_nearest", model=best["model"], **values, rotation_rad=turn[0], rotation_rad_sd=turn[1])],
    )


@dataclass(frozen=True)
class _Scored:
    """What a model's tables hold, and what is to be known of it."""

    means: Rows
    poses: Rows
    losses: Rows
    tosses: Rows
    findings: list[Finding]


def _of_model(pool: LocalPool, base: Scene, fitting: Sequence[Toss], rest: Sequence[Toss], model: Model) -> _Scored:
    """What is fitted for a model, and its scores on the tosses that are left."""
    width = base.statue.corner_left_m + base.statue.corner_right_m
    found = _Scored([], [], [], [], [])
    for name in (TRAJECTORY, VELOCITIES):
        loss = _Loss(pool, base, fitting, model, _points_missed if name == TRAJECTORY else _rates_missed)
        best, missed = loss.least()
        found.losses.extend(
            [model.name, name, *row] for row in [*loss.rows, ("fitted", best.friction, best.restitution or 0.0, missed)]
        )
        answer = {
            key: item[0]
            for key, item in _computed(pool, [TossTask(base, toss, model, (best,)) for toss in rest]).items()
        }
        known = {key: item for key, item in answer.items() if isinstance(item, Errors)}
        if known:
            found.means.append(
                [model.name, name, best.friction, best.restitution or 0.0, *_means([*known.values()], width)]
            )
        if name == TRAJECTORY:
            lost, ended = len(answer) - len(known), sum(item.ended_s is not None for item in known.values())
            found.findings.extend([caution("tosses_failed", model=model.name, count=lost)] if lost else [])
            found.findings.extend([info("tosses_ended", model=model.name, count=ended)] if ended else [])
            found.poses.extend([model.name, *row] for row in _poses(known, rest))
            found.tosses.extend(
                [
                    model.name,
                    key,
                    float(np.median(item.rotation_rad)),
                    float(item.rotation_rad[-1]),
                    float(item.place_m[-1]),
                ]
                for key, item in known.items()
            )
    return found


def _means(errors: Sequence[Errors], width_m: float) -> list[float]:
    """Over tosses, mean and standard deviation of each one's mean over its frames: place in % of a width, rotation in degrees."""
    places = [100.0 * float(np.mean(each.place_m)) / width_m for each in errors]
    turns = [math.degrees(float(np.mean(each.rotation_rad))) for each in errors]
    return [float(of(values)) for values in (places, turns) for of in (np.mean, np.std)]


class _Loss:
    """How far a model is off, by friction and restitution: a coarse look, then downhill from its best."""

    def __init__(
        self,
        pool: LocalPool,
        base: Scene,
        tosses: Sequence[Toss],
        model: Model,
        missed: Callable[[Sequence[Toss], Sequence[Errors | str]], float],
    ) -> None:
        self._pool, self._base, self._tosses, self._model, self._missed = pool, base, tosses, model, missed
        self.rows: list[tuple[str, float, float, float | None]] = []

    def least(self) -> tuple[Coefficients, float]:
        """The coefficients of least loss, and that."""
        plastic = self._all([Coefficients(friction) for friction in FRICTIONS])
        friction = FRICTIONS[int(np.argmin(plastic))]
        bounced = self._all([Coefficients(friction, each) for each in RESTITUTIONS])
        by_restitution = {0.0: min(plastic), **dict(zip(RESTITUTIONS, bounced, strict=True))}
        tried = [("friction", each, 0.0, missed) for each, missed in zip(FRICTIONS, plastic, strict=True)]
        tried += [("restitution", friction, each, missed) for each, missed in by_restitution.items()]
        self.rows = [(*row[:3], row[3] if math.isfinite(row[3]) else None) for row in tried]
        bounces = bool(np.isfinite(bounced).any())
        first = np.array([friction, min(by_restitution, key=lambda each: by_restitution[each])])
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
        return [self._missed(self._tosses, [found[k] for found in answers.values()]) for k in range(len(items))]


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


def _points_missed(tosses: Sequence[Toss], answers: Sequence[Errors | str]) -> float:
    """Median over all frames of the mean distance of the body's points, m: infinite in a toss that could not be computed."""
    missed = [
        item.points_m if isinstance(item, Errors) else np.full(len(toss.places_m), np.inf)
        for toss, item in zip(tosses, answers, strict=True)
    ]
    return float(np.median(np.concatenate(missed)))


def _rates_missed(_tosses: Sequence[Toss], answers: Sequence[Errors | str]) -> float:
    """Median over all stretches after the first contact of the mean distance of the points' velocities, m/s."""
    return float(
        np.median(np.concatenate([item.rate_m_s if isinstance(item, Errors) else [np.inf] for item in answers]))
    )


def _poses(known: Mapping[str, Errors], tosses: Sequence[Toss]) -> Rows:
    """Quartiles of rotation and place over all frames, at the end, and over time (s)."""
    if not known:
        return []
    every, frame_s = list(known.values()), {toss.name: toss.frame_s for toss in tosses}
    longest = max(len(item.rotation_rad) * frame_s[name] for name, item in known.items())
    turned, apart = (np.concatenate([getattr(item, name) for item in every]) for name in ("rotation_rad", "place_m"))
    rows: Rows = [["all_frames", len(every), *quartiles(turned), *quartiles(apart)]]
    last = [item.rotation_rad[-1] for item in every], [item.place_m[-1] for item in every]
    rows.append(["end", len(every), *quartiles(last[0]), *quartiles(last[1])])
    for time_s in np.arange(OVER_TIME_S, longest, OVER_TIME_S).tolist():
        at = {name: round(time_s / frame_s[name]) for name in known}
        there = [(item, at[name]) for name, item in known.items() if at[name] < len(item.rotation_rad)]
        errors = [item.rotation_rad[k] for item, k in there], [item.place_m[k] for item, k in there]
        rows.append([time_s, len(there), *quartiles(errors[0]), *quartiles(errors[1])])
    return rows
