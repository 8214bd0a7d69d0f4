"""One toss computed and scored: how far rotation and place are off at every frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from analytic.excitation import ZeroExcitation
from analytic.rotation import rotation_matrices
from harness import engines
from harness.accuracy.simulation import RunTarget, simulate_with
from harness.model.history import Array, History
from harness.model.in_space import rotations
from harness.model.scene import BaseExcitation, Contact, Initial, Scene, Statue
from harness.questions.validate.jobs import Model
from harness.questions.validate.tosses import Toss

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
