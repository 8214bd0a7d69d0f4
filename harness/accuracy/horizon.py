"""How long a model can predict a scene at all: perturbed starts of that model alone."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Final

import numpy as np

from harness import engines
from harness.engines.analytic import TwoBlockSettings
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model import History, Outcome, Run, RunOptions, Scene, first_beyond_s, number, pair
from harness.records.run import HorizonRecord
from harness.statics.plan import as_one

MODEL: Final = "analytic"
"""Its runs take milliseconds: it tells how errors grow in a scene."""
PERTURBED_SHARE: Final = 0.03
"""Start and motion are perturbed by this share of what a level is expected to err by. On the paper's conditions with a pedestal a
run of 1 ms parts from its neighbours as the model parts from itself under a tenth of that: with less no climb is given up that
could succeed."""

REST_TIMES: Final = 20.0
"""The model drops rebounds of a hundredth of its aimed error, engines those of some 1e-5 rad, where the floor all but lifts the
statue of more: with an aim of so many times what a level is expected to err by, what they lose alike is seen to grow."""


def by_model(scene: Scene, settings: Settings | None = None, options: RunOptions | None = None) -> Run:
    """One run of the model, by its finest settings where none are given. Raises `EngineFailure` where it refuses the scene."""
    model = engines.load(MODEL)
    finest = model.refinement_levels(scene)[-1]
    return model.simulate(scene, settings or finest, options or RunOptions(stated=False))


def outgrown_s(scene: Scene, error_rad: float, target_rad: float) -> float:
    """When errors as small as these have grown past the target; infinite if not before the scene ends or there is no return from
    a fall.

    By the analytic model's own runs: with perturbed starts and motions, and one that takes small rebounds for rest. Infinite,
    too, where it refuses the scene or has left its domain by then.
    """
    try:
        run = by_model(scene)
        others = [by_model(each) for each in perturbed(scene, PERTURBED_SHARE * error_rad)]
        others.append(by_model(scene, TwoBlockSettings(0.0, error_rad, REST_TIMES * error_rad)))
    except EngineFailure:
        return math.inf
    if run.history is None:
        return math.inf
    until_s = min(last_s(run), number(run.validity, "left_domain_s", math.inf))
    apart_s = [None if other.history is None else parted_s(other.history, run.history, target_rad) for other in others]
    return min((each for each in apart_s if each is not None and each < until_s), default=math.inf)


SEEN: Final = 4.0
"""Times an error that a tilt must be to be seen, and to which of it what both bodies rock as one may come: what a contact's depth
gives way by is as large as the error of a step (4.7e-5 and 4.5e-5 rad in a scene where both rock by 3e-3)."""


def unseen_tipping_s(scene: Scene, run: Run, error_rad: float) -> float:
    """From when a pedestal tips that the run does not see tip, by little more than an error as small as this; else infinite.

    Levels that all hold a tall pedestal by their contacts' depth agree on it, and none tells what its rocking grows to. When it
    tips is known by the model, which leaves its domain there; that it matters by the model of both as one body, which rocks by
    more than that error.
    """
    pedestal = scene.pedestal
    tilt_rad = _tilt_rad(run)
    if pedestal is None or tilt_rad > SEEN * error_rad:
        return math.inf
    try:
        validity = by_model(scene).validity
        if validity.get("left_domain_by") != "pedestal_tips":
            return math.inf
        one = replace(scene, statue=as_one(scene.statue, pedestal), pedestal=None)
        together = by_model(one)
    except EngineFailure:
        return math.inf
    unseen = abs(together.peak_theta_rad) > max(error_rad, SEEN * tilt_rad)
    return number(validity, "left_domain_s") if unseen else math.inf


def _tilt_rad(run: Run) -> float:
    """How far the pedestal of a run tilts before there is no return from a fall, in which it may be taken along."""
    history = run.history
    tilt_rad = None if history is None else history.extra.get("pedestal_tilt_rad")
    if history is None or tilt_rad is None:
        return number(run.validity, "pedestal_tilt_rad", 0.0)
    # Of what coarse steps leave of a tilt nothing is told.
    coarser_s = (number(found.values, "from_s") for found in run.findings if found.code == "coarser_steps")
    return float(np.abs(tilt_rad[history.t_s <= min([last_s(run), *coarser_s])]).max(initial=0.0))


def several_slides_s(scene: Scene, run: Run) -> float:
    """When the statue slides on a corner on which friction may hold it in several ways, or none (Painlevé); else infinite.

    There μ b h > J/m + b²: what presses the corner down turns it into its support. Each engine's levels agree on one motion, and
    two engines converge to two.
    """
    statue, slides = scene.statue, "statue_slides" in run.validity.get("plain_because", ())
    turning_m2 = statue.inertia_kg_m2 / statue.mass_kg
    several = any(
        scene.contact.statue * corner_m * statue.centroid_height_m > turning_m2 + corner_m**2
        for corner_m in (statue.corner_left_m, statue.corner_right_m)
    )
    return number(run.validity, "plain_from_s") if slides and several else math.inf


def last_s(run: Run) -> float:
    """Until when a run is to be bounded: its end, or where there is no return from a fall."""
    return run.end_s if run.no_return_time_s is None else min(run.no_return_time_s, run.end_s)


PERTURBATIONS: Final = (1e-9, 1e-7, 1e-5, 1e-3)
"""Sizes of the perturbations: from what rounding does in some thousand steps to what no measurement could tell."""
TOLERANCE_RAD: Final = 0.01
"""Rotation to which a prediction is asked: 1.5 cm at the top of a statue of 1.5 m."""


def perturbed(scene: Scene, size: float) -> tuple[Scene, ...]:
    """The scene with slightly other starts: rotation + size (rad), rate + size·p (rad/s), to the side on which it starts, and
    all motion times 1 ± size.

    p = √(mgR/J) is the statue's frequency parameter. A statue at rest forgets a perturbed start as soon as it rests again, so
    its motion is perturbed as well.
    """
    statue, start = scene.statue, scene.initial
    side = -1 if (start.theta_rad or start.theta_rate_rad_s) < 0.0 else 1
    arm = math.hypot(statue.corner_m(side), statue.centroid_height_m)
    p = math.sqrt(statue.mass_kg * scene.gravity_m_s2 * arm / scene.pivot_inertia_kg_m2[side])
    leaning = replace(scene, initial=start.plus(side * size, 0.0))
    if start.pose is not None:
        leaning = replace(scene, initial=start.plus(0.0, -size * p))
    thrown = replace(scene, initial=start.plus(0.0, side * size * p))
    if scene.base_excitation.still:
        return leaning, thrown
    return leaning, thrown, amplified(scene, 1.0 + size), amplified(scene, 1.0 - size)


def amplified(scene: Scene, factor: float) -> Scene:
    """The scene with all its motion multiplied by a factor."""
    return replace(scene, base_excitation=scene.base_excitation.scaled(factor))


SAMPLED_S: Final = 5e-3
"""Samples of the runs that are compared: from 1 ms to 10 ms the horizon moves by less than 0.1 ms, as histories are read between
their samples by their rates; what is told of each sample takes most of a run in space."""


def horizon(
    scene: Scene,
    run: Callable[[Scene], Run],
    *,
    tolerance_rad: float = TOLERANCE_RAD,
    perturbations: tuple[float, ...] = PERTURBATIONS,
) -> HorizonRecord:
    """The horizon of a model, `run` being that model with its settings; perturbed runs that fail are left out and counted.

    `perturbations` are their sizes, from the smallest.

    Raises `EngineFailure` when the unperturbed run has no history.
    """
    scene = replace(scene, output_dt_s=max(scene.output_dt_s, SAMPLED_S))
    reference = run(scene)
    if reference.history is None:
        raise EngineFailure(reference.message or "the unperturbed run has no history")
    own, path = reference.outcome, reference.history

    def same(end: Outcome) -> bool:
        # Beside one that overturns what is undecided still falls as the scene ends.
        falls = Outcome.UNDECIDED in (end, own) and (end.overturned or own.overturned)
        return falls or end.same_as(own) or end is Outcome.LIFT_OFF

    outcomes, failed, flips = {own}, 0, None
    until, rates = list[float](), list[float]()
    for size in perturbations:
        tried = [_tried(run, variant) for variant in perturbed(scene, size)]
        known = [each for each in tried if each is not None]
        failed += len(tried) - len(known)
        outcomes |= {end for end, _ in known}
        if flips is None and not all(same(end) for end, _ in known):
            flips = size
        parted = [time_s for _, other in known if (time_s := parted_s(other, path, tolerance_rad)) is not None]
        until.append(min([scene.duration_s, *parted]))
        if parted and size < tolerance_rad and until[-1] > 0.0:
            rates.append(math.log(tolerance_rad / size) / until[-1])
    # A larger perturbation cannot be predicted for longer; where chance lets it, the shorter time holds.
    least = np.minimum.accumulate(until)
    return HorizonRecord(
        tolerance_rad,
        scene.duration_s,
        perturbations,
        tuple(least.tolist()),
        float(np.mean(rates)) if rates else None,
        tuple(sorted(outcomes)),
        failed,
        float(least[0]),
        flips,
    )


def _tried(run: Callable[[Scene], Run], scene: Scene) -> tuple[Outcome, History] | None:
    """How a perturbed run ends, and its path; None of one that has no path that could part from another."""
    try:
        tried = run(scene)
    except EngineFailure:
        return None
    # It ends because no mode was found, or was given up.
    ended = tried.outcome.failed or tried.outcome is Outcome.FRICTION_PARADOX
    given_up = tried.outcome is Outcome.UNDECIDED and tried.end_s < scene.duration_s
    return None if ended or given_up or tried.history is None else (tried.outcome, tried.history)


def parted_s(a: History, b: History, tolerance_rad: float) -> float | None:
    """When two histories are first further apart than the tolerance; a shorter one parts at its end, None: never."""
    both = pair(a, b)
    apart = first_beyond_s(both.t_s, np.abs(both.difference_rad), tolerance_rad)
    if apart is not None:
        return apart
    shorter = abs(a.duration_s - b.duration_s) > max(np.diff(both.t_s).max(initial=0.0), 1e-9)
    return both.end_s if shorter else None


def horizon_of(
    engine: Engine, scene: Scene, settings: Settings, perturbations: tuple[float, ...] = PERTURBATIONS
) -> HorizonRecord:
    """The horizon of an engine with its settings (see `horizon`)."""
    options = RunOptions(history=True, stated=False)
    return horizon(scene, lambda each: engine.simulate(each, settings, options), perturbations=perturbations)


def settings_of(engine: Engine, scene: Scene, run: Run) -> Settings:
    """An engine's settings by the step that `run` took, or its finest where it chooses its steps by itself."""
    dt_s = number(run.settings, "dt_s", 0.0)
    return engine.settings_for_dt(scene, dt_s) if dt_s else engine.refinement_levels(scene)[-1]
