"""Measured planar drops, and models against them: what is fitted on a third, how probable what was seen is on the others."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize
from scipy.special import expit
from scipy.stats import norm
from scipy.stats.qmc import LatinHypercube

from harness import engines
from harness.accuracy.refinement import simulate_with
from harness.model import Answer, Array, Contact, Finding, Pose, RunOptions, Scene, caution, info, require
from harness.questions.validate.measured_set import MeasuredSet, Rows, by_name, read_groups, target_of, thrown
from harness.questions.validate.scenes import Model
from harness.records.validation import Cell, MeasuredRecord, MeasuredTable

# Measured planar drops: how probable each model makes the final quarter turn that was seen.
#
# One line a frame: `drop` (its name), `row` (its number), the centroid's place `x_m, z_m` over the ground, the rotation
# `theta_rad` (from x to z, not wrapped) and the velocities, which are not read: a flight's own places say them with less noise.

COLUMNS: Final = ("drop", "row", "x_m", "z_m", "theta_rad", "vx_m_s", "vz_m_s", "omega_rad_s")
FRAME_S: Final = 1.0 / 250.0
QUARTER_RAD: Final = 0.5 * math.pi
CLEAR: Final = 0.07
"""Share of the body's radius by which its lowest point is above the ground in flight: a camera is off by a millimetre or two."""
FEWEST_IN_FLIGHT, MOST_IN_FLIGHT = 6, 12
"""Frames before the first contact that say how it meets the ground: with fewer the rates are noise."""
AT_REST_RAD: Final = 0.2
"""Farther from a face than this at its last frame a drop has not come to rest."""
STEPS_A_FRAME: Final = 4
RESTITUTION, FRICTION = (0.0, 0.9), (0.02, 0.5)
"""Between which coefficients are drawn for every drop; what is fitted weighs these draws."""
TURNS: Final = np.arange(-24, 25)
"""Final quarter turns that are told apart; what turns farther counts as the last."""
NARROWEST: Final = 0.08
"""Least spread of a coefficient's weights over its range: some draws of thirty still count."""
KERNEL: Final = (0.25, 0.5, 0.25)
"""A count of a baseline is spread to its neighbours by a quarter each, and"""
SPREAD: Final = 1.0
"""one more count evenly over all turns: nothing that never was is impossible."""


@dataclass(frozen=True, eq=False)
class Drop:
    """One drop from its last frame in flight on: start (x, z, θ counter-clockwise, and their rates), the standard deviations and
    correlation of each coordinate's value and rate as Cholesky factors (3, 2, 2), fall in m/s², final quarter turn, first face.
    """

    name: str
    start: Array
    scatter: Array
    fall_m_s2: float
    end_s: float
    turn: int
    face: int


def read_drops(path: Path, body: Scene) -> tuple[list[Drop], dict[str, str]]:
    """All drops of a table, and those that are refused, by why. Raises `InputError` for a wrong table."""
    drops, refused = [], {}
    for name, table in read_groups(path, COLUMNS):
        counted = np.array_equal(table[:, 0], np.arange(len(table)))
        require(counted, str(path), "0, 1, 2 and so on", f"from {table[0, 0]:g}", key=f"drop {name}: row")
        found = _drop(name, table[:, 1:4], body)
        if isinstance(found, Drop):
            drops.append(found)
        else:
            refused[name] = found
    return drops, refused


def _drop(name: str, frames: Array, body: Scene) -> Drop | str:
    """A drop, or why there is none: it begins on the ground, or does not come to rest."""
    section = body.statue.section_m - [0.0, body.statue.centroid_height_m]
    x, z, theta = frames.T
    lowest = z + np.min(np.outer(np.cos(theta), section[:, 1]) + np.outer(np.sin(theta), section[:, 0]), axis=1)
    # A camera's height has a bias; at rest the body is on the ground.
    height = lowest - lowest[-1]
    turn = round(theta[-1] / QUARTER_RAD)
    if abs(theta[-1] - turn * QUARTER_RAD) > AT_REST_RAD:
        return "not_at_rest"
    first = int(np.argmax(height < CLEAR * np.max(np.linalg.norm(section, axis=1))))
    if first < FEWEST_IN_FLIGHT:
        return "no_flight"
    flight = slice(max(first - MOST_IN_FLIGHT, 0), first)
    t_s = FRAME_S * (np.arange(len(z))[flight] - (first - 1))
    design = np.column_stack([np.ones(t_s.size), t_s])
    fall = float(-2.0 * np.polyfit(t_s, z[flight], 2)[0])
    start, scatter = np.empty((3, 2)), np.empty((3, 2, 2))
    for k, seen in enumerate((x[flight], z[flight] - lowest[-1] + 0.5 * fall * t_s**2, theta[flight])):
        start[k], missed = np.linalg.lstsq(design, seen, rcond=None)[:2]
        # Of the spread alone: a flight without any scatter has no root of its covariance.
        spread = math.sqrt(float(missed[0]) / (t_s.size - 2))
        scatter[k] = spread * np.linalg.cholesky(np.linalg.inv(design.T @ design))
    return Drop(name, start, scatter, fall, FRAME_S * (len(z) - first), turn, face=round(start[2, 0] / QUARTER_RAD))


def coefficients(samples: int, seed: int) -> Array:
    """Restitution and friction (samples, 2) in their ranges, a Latin hypercube: the same for every drop and model."""
    low, high = np.array([RESTITUTION, FRICTION]).T
    return np.asarray(low + (high - low) * LatinHypercube(2, rng=seed).random(samples))


def turns(base: Scene, model: Model, samples: int, seed: int, drop: Drop) -> list[int | None] | str:
    """The final quarter turn of each draw, None of one that comes to no end; or why the model computes none."""
    engine, random = engines.load(model.engine), np.random.default_rng(seed)
    target = replace(target_of(model, FRAME_S, STEPS_A_FRAME), options=RunOptions(stated=False))
    found: list[int | None] = []
    failed = ""
    for restitution, friction in coefficients(samples, seed).tolist():
        noise = random.standard_normal((3, 2))
        start = drop.start + np.einsum("kij,kj->ki", drop.scatter, noise)
        bounce = None if model.engine in engines.PLASTIC_THROWN else restitution
        scene = scene_of(base, drop, start, Contact(friction, friction, friction, bounce))
        run = simulate_with(engine, scene, target)
        if run.history is None:
            failed = run.message or run.outcome.value
            found.append(None)
            continue
        theta = np.unwrap(run.history.theta_rad)
        ended = run.history.t_s[-1] >= scene.duration_s - FRAME_S
        found.append(round((start[2, 0] - (theta[-1] - theta[0])) / QUARTER_RAD) if ended else None)
    return failed if failed and not any(turn is not None for turn in found) else found


def scene_of(base: Scene, drop: Drop, start: Array, contact: Contact) -> Scene:
    """The body of a scene as it falls onto a still floor; a scene's rotation is clockwise."""
    (x, u), (z, v), (theta, omega) = start.tolist()
    turn = (math.cos(0.5 * theta), 0.0, -math.sin(0.5 * theta), 0.0)
    pose = Pose((x, 0.0, z), turn, (u, 0.0, v), (0.0, -omega, 0.0))
    return thrown(base, pose, contact, drop.end_s, FRAME_S)


def smoothed(values: ArrayLike) -> Array:
    """Probability of each of `TURNS` by how often it was seen."""
    counts = np.bincount(np.clip(values, TURNS[0], TURNS[-1]) - TURNS[0], minlength=TURNS.size)
    spread = np.convolve(counts, KERNEL, "same") + SPREAD / TURNS.size
    return np.asarray(spread / spread.sum())


def baselines(drops: Sequence[Drop]) -> dict[str, Array]:
    """Probabilities (drops, turns) that need no model, each from all other drops: of the turn itself, and of how far it is from
    the face that lands first.
    """
    all_turns, faces = np.array([drop.turn for drop in drops]), np.array([drop.face for drop in drops])
    others = [np.delete(np.arange(len(drops)), k) for k in range(len(drops))]
    return {
        "all_drops": np.array([smoothed(all_turns[rest]) for rest in others]),
        "first_face": np.array([smoothed((all_turns - faces)[rest] + faces[k]) for k, rest in enumerate(others)]),
    }


@dataclass(frozen=True)
class Fit:
    """Means and standard deviations with which the draws of restitution and friction are weighed, and the share of the
    probability that is left to the distance from the first face (`background`)."""

    means: tuple[float, float]
    widths: tuple[float, float]
    background: float


def forecast(fit: Fit, drawn: Array, answers: Mapping[str, Sequence[int | None]], behind: Array) -> Array:
    """Probabilities (drops, turns) of draws (samples, 2) that ended in `answers`, with those of the background."""
    weights = np.prod(norm.pdf(drawn, fit.means, fit.widths), axis=1)
    ends = np.array([[math.nan if turn is None else turn for turn in found] for found in answers.values()])
    places = np.clip(np.nan_to_num(ends), TURNS[0], TURNS[-1]).astype(int) - TURNS[0]
    seen = np.zeros_like(behind)
    np.add.at(seen, (np.arange(len(ends))[:, None], places), np.where(np.isnan(ends), 0.0, weights))
    total = seen.sum(axis=1, keepdims=True)
    # Where no draw ended, or none that counts, nothing but the background is known.
    drawn_share = np.where(total > 0.0, 1.0 - fit.background, 0.0)
    return np.asarray(drawn_share * seen / np.maximum(total, np.finfo(float).tiny) + (1.0 - drawn_share) * behind)


def fit(drawn: Array, answers: Mapping[str, Sequence[int | None]], behind: Array, seen: Sequence[int]) -> Fit:
    """The weights of greatest likelihood on these drops; no run is made for it."""
    low, high = np.array([RESTITUTION, FRICTION]).T

    def unpacked(at: Array) -> Fit:
        share = expit(at)
        means = low + (high - low) * share[:2]
        widths = (high - low) * (NARROWEST + share[2:4])
        return Fit(
            (float(means[0]), float(means[1])),
            (float(widths[0]), float(widths[1])),
            float(np.clip(share[4], 0.01, 0.99)),
        )

    def loss(at: Array) -> float:
        return float(np.mean(log_scores(forecast(unpacked(at), drawn, answers, behind), seen)))

    starts = [np.array([e, -0.5, -1.5, -1.0, -1.5]) for e in (-1.0, 0.0, 1.0)]
    found = [minimize(loss, at, method="Nelder-Mead", options={"maxiter": 250}) for at in starts]
    return unpacked(min(found, key=lambda each: float(each.fun)).x)


def log_scores(probabilities: Array, seen: Sequence[int]) -> Array:
    """−ln of the probability of what was seen, by drop."""
    place = np.clip(seen, TURNS[0], TURNS[-1]) - TURNS[0]
    return np.asarray(-np.log(probabilities[np.arange(len(place)), place]))


def crps(probabilities: Array, seen: Sequence[int]) -> Array:
    """Continuous ranked probability score by drop, in quarter turns: Σ (F(k) − [k ≥ seen])² (Gneiting and Raftery 2007)."""
    reached = TURNS[None, :] >= np.asarray(seen)[:, None]
    return np.asarray(np.sum((np.cumsum(probabilities, axis=1) - reached) ** 2, axis=1))


def turns_by_drop(found: Mapping[str, Any], samples: int) -> dict[str, list[int | None]] | str:
    """The turns of each drop's draws by its name, None where it could not be computed; or why the model gives none of any."""
    wrong = [str(each) for each in found.values() if not isinstance(each, list)]
    if len(wrong) == len(found):
        return wrong[0]
    return {name: each if isinstance(each, list) else [None] * samples for name, each in found.items()}


ENGINES: Final = ("spatial", "pymunk", "pymunk:plain", "pybullet:plain")
"""pybullet, which locates plastic impacts alone, takes as long as the others together: who wants it names it."""
SAMPLES: Final = 32
MOST_SAMPLES: Final = 1000
TOLD: Final = 2.0
"""A gain of this many standard errors is told from none."""
SCORES: Final = (
    "model", "log_score", "crps_turns", "gain_all_drops", "error_all", "gain_first_face", "error_face",
    "restitution", "restitution_sd", "friction", "friction_sd", "background", "draws_without_end",
)  # fmt: skip
ROWS: Final = ("drop", "model", "seen_quarter_turn", "probability", "log_score", "crps_quarter_turns")


def scored_drops(measured: MeasuredSet) -> MeasuredRecord:
    """How probable each model makes the final quarter turn of every drop that was not fitted on.

    Each drop is run in `samples` draws (0: 32) of its measured start and of the two coefficients; how the draws are weighed is
    fitted. Raises `InputError` for a wrong table, model or number.
    """
    base, seed, count, models = measured.base, measured.seed, measured.samples or SAMPLES, measured.asked(ENGINES)
    require(0 <= count <= MOST_SAMPLES, "--samples", f"a whole number from 0 to {MOST_SAMPLES}", str(count))
    drops, refused = read_drops(measured.table, base)
    wanted = "four drops that begin in flight and come to rest"
    require(len(drops) >= 4, str(measured.table), wanted, str(len(drops)))
    fitted, rest = measured.shares(len(drops))
    answered: list[tuple[Model, dict[str, list[int | None]]]] = []
    failed: list[Finding] = []
    for place, model in enumerate(models):

        def told(done: int, before: int = place * len(drops)) -> None:
            measured.on_progress(before + done, len(models) * len(drops))

        answers = turns_by_drop(by_name(measured.pool, partial(turns, base, model, count, seed), drops, told), count)
        if isinstance(answers, str):
            failed.append(caution("model_not_run", model=model.name, reason=answers))
        else:
            answered.append((model, answers))
    rows, each = _scored(drops, fitted, rest, answered, coefficients(count, seed))
    fall = float(np.median([drops[k].fall_m_s2 for k in fitted]))
    found = [caution("drops_dragged", fall_m_s2=fall, drag_m_s2=base.gravity_m_s2 - fall), *failed]
    if refused:
        found.append(caution("drops_refused", count=len(refused), names=list(refused)))
    return measured.told(
        title=f"{len(drops)} measured planar drops",
        answer=_answer(rows, len(rest), len(drops)),
        tables=[MeasuredTable("models", SCORES, rows), MeasuredTable("drops", ROWS, each)],
        findings=found,
        samples=count,
    )


def _scored(
    drops: Sequence[Drop],
    fitted: Sequence[int],
    rest: Sequence[int],
    answered: Sequence[tuple[Model, Mapping[str, Sequence[int | None]]]],
    drawn: Array,
) -> tuple[Rows, Rows]:
    """A row for each model and for what needs none, fitted on some drops, scored on the rest; for each of these one by model."""
    turned = [drops[k].turn - drops[k].face for k in fitted]
    behind = np.array([smoothed([turn + drop.face for turn in turned]) for drop in drops])
    seen = [drops[k].turn for k in rest]
    bare = {name: values[rest] for name, values in baselines(drops).items()}

    def scores(name: str, likely: Array) -> list[Cell]:
        own = log_scores(likely, seen)
        gains = [log_scores(values, seen) - own for values in bare.values()]
        told = [float(each) for gain in gains for each in (gain.mean(), gain.std(ddof=1) / np.sqrt(gain.size))]
        return [name, float(own.mean()), float(crps(likely, seen).mean()), *told]

    rows: Rows = []
    by_drop: Rows = []
    for model, answers in answered:
        fitting, others = ({drops[k].name: answers[drops[k].name] for k in part} for part in (fitted, rest))
        best = fit(drawn, fitting, behind[fitted], [drops[k].turn for k in fitted])
        likely = forecast(best, drawn, others, behind[rest])
        lost = float(np.mean([turn is None for found in answers.values() for turn in found]))
        (e, mu), (e_sd, mu_sd) = best.means, best.widths
        restitution = (None, None) if model.engine in engines.PLASTIC_THROWN else (e, e_sd)
        rows.append([*scores(model.name, likely), *restitution, mu, mu_sd, best.background, lost])
        by_drop += [
            [name, model.name, turn, float(np.exp(-score)), float(score), float(rank)]
            for name, turn, score, rank in zip(others, seen, log_scores(likely, seen), crps(likely, seen), strict=True)
        ]
    rows += [[*scores(name, values), *[None] * 6] for name, values in bare.items()]
    return rows, by_drop


def _answer(rows: Sequence[Sequence[Cell]], scored: int, count: int) -> Answer:
    """Which model predicts best, and whether it is told from what needs none."""
    models = [dict(zip(SCORES, row, strict=True)) for row in rows if row[SCORES.index("background")] is not None]
    if not models:
        return Answer("no_answer", [info("no_answer")])
    best = min(models, key=lambda row: float(row["log_score"] or 0.0))
    gains = [(float(best[a] or 0.0), float(best[b] or 0.0)) for a, b in zip(SCORES[3:7:2], SCORES[4:7:2], strict=True)]
    least, error = min(gains)
    told = "less" if least < 0.0 else "more" if all(gain > TOLD * noise for gain, noise in gains) else "chance"
    values = {"model": best["model"], "log_score": best["log_score"], "gain": abs(least), "error": error, "told": told}
    code = "drops_told" if told == "more" else "drops_not_told"
    return Answer(code, [info("drops_best", scored=scored, of=count, **values)])
