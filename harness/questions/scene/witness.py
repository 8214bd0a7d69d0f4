"""A witness beside the verdict: do unmodified engines, which nothing of this project steers, confirm what a run says?

Two runs of a plain engine, with steps that the budget allows, state by their own spread how far that engine is from its own
convergence. Each run of the scene is then judged against the finer of the two as any two models are. So much of this is
independent of the model: contact, friction, impact and integration are the engine's; shapes, masses and coefficients are the
scene's. Two coefficients of friction are followed by the plainest rule (`harness.engines.stepping.support.followed`), which is
another convention than the model's: they take the static one as an impact breaks the pedestal loose, and so does the model that
is held against them (`under_static`).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

from harness import engines
from harness.accuracy.horizon import MODEL, PERTURBED_SHARE, by_model, outgrown_s
from harness.accuracy.refinement import Error, RunTarget, simulate_with, spread, target_of
from harness.comparison.comparator import compare
from harness.comparison.scores import errors
from harness.engines.analytic import by_other_impact
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model import Finding, Run, RunOptions, Scene, caution, changes_answer, info, number
from harness.records.run import LEAST_S, PLAIN, DecidedBy, Judged, LawChoice, Witness, has_answer, outcome_family
from harness.records.scores import ROBUST, Scores

# Before two models are said to differ, a contact engine's run is made again to a finer target, up to where they differ.

CONFIRMATION_FACTOR: Final = 4.0
"""The finer run's target is this many times smaller: some two halvings of the step."""
SURE: Final = 30.0
"""A difference of this many times its limit is no luck of two runs that agree: none was off by more than twelve times what it
stated on 303 scenes before their sensitivity was asked."""


GROWING: Final = (0.1, 0.3, 1.0)
"""Shares of what a step is expected to err by, up to all of it, that are held against a difference which stands."""
PAST_S: Final = 0.05
"""The finer run goes so far past where the difference passes its limit: a difference that grows is clear by then."""


def finer_rad(target: RunTarget) -> float:
    """The accuracy of a run that is made again before models are said to differ."""
    return target.target_rad / CONFIRMATION_FACTOR


def finer_runs(
    scene: Scene,
    runs: Mapping[str, Run],
    scores: Iterable[Scores],
    refinable: set[str],
    target: RunTarget,
    on_progress: Callable[[str], None],
) -> tuple[list[str], dict[str, Run]]:
    """The engines that were run again to a finer target up to where their difference stands, and what takes their runs' place.

    Of those whose difference is gone with the finer target a whole finer run is made; of the others a run states no more than
    what an error of its own step leaves of it in the model.
    """
    # Those said to differ robustly, by less than `SURE` times their limit; no finer step gives a motion left out.
    doubts = [each for each in scores if each.verdict in ROBUST and not each.evidence.aside and _close(each)]
    until_s: dict[str, float] = {}
    for each in doubts:
        for name in {each.a, each.b} & refinable:
            parts_s = scene.duration_s if each.evidence.exceeded_s is None else each.evidence.exceeded_s
            until_s[name] = max(until_s.get(name, 0.0), min(parts_s + PAST_S, scene.duration_s))
    finer = replace(target, accuracy_rad=finer_rad(target))
    again = {}
    for name, end_s in sorted(until_s.items()):
        on_progress(f"{name}, again and finer")
        run = simulate_with(engines.load(name), replace(scene, duration_s=end_s), finer)
        if not run.outcome.failed:
            again[name] = run
    gone = set()
    for each in doubts:
        a, b = (again.get(name, runs[name]) for name in (each.a, each.b))
        apart_s = compare(a, b).evidence.exceeded_s
        if apart_s is None or apart_s > min(a.bounded_until_s, b.bounded_until_s):
            gone |= {each.a, each.b} & again.keys()
    whole = {name: simulate_with(engines.load(name), scene, finer) for name in sorted(gone)}
    instead = {name: run for name, run in whole.items() if not run.outcome.failed}
    for name in again.keys() - gone:
        instead |= _outgrown(scene, name, runs[name], until_s[name] - PAST_S, target)
    return sorted(again), instead


def _outgrown(scene: Scene, name: str, run: Run, parts_s: float, target: RunTarget) -> dict[str, Run]:
    """The run, known only until an error of its own step has grown past the target in the model, where that is before it parts.

    Levels may all fall on one side of an event that the scene all but has, such as a statue that turns back a millionth of a
    radian before it would meet its support: they then agree, and differ from what is true by more than from each other.
    """
    for share in GROWING:
        small_rad = share * number(run.settings, "expected_error_rad")
        until_s = outgrown_s(scene, small_rad / PERTURBED_SHARE, target.target_rad)
        if until_s < min(parts_s, run.bounded_until_s):
            said = caution(
                "target_met_until", target_rad=target.target_rad, until_s=until_s, end_s=run.end_s, small_rad=small_rad
            )
            others = (each for each in run.findings if not each.code.startswith("target_met_until"))
            return {name: replace(run, reliable_until_s=until_s, findings=(*others, said))}
    return {}


def _close(scores: Scores) -> bool:
    seen = scores.evidence
    if seen.differs_in == "slip":
        return seen.largest_reliable_slip_difference_m < SURE * seen.slip_limit_m
    return seen.largest_reliable_difference_rad < SURE * seen.limit_rad


BUDGET: Final = 1.0
"""A witness costs at most so many times what the run beside it cost, in steps of that run's engine: counts, as times would make
what is said a matter of the machine."""
CHECK_TIMES: Final = 10.0
"""A run is refuted only by the plain engine's finest level, which may cost so many times the budget: on the floor two runs of
pymunk's own steps of 2 to 0.4 ms were 0.009 rad off and 2e-6 rad from each other, and at 0.08 ms 0.001 rad off."""
FALLS: Final = 0.7
"""A difference from the finer of a plain engine's two runs that is less than this share of that from the coarser falls with the
plain engine's own step (0.45 of the other's): it is that engine's error, and refutes nothing."""
TARGET_RAD: Final = 5e-3
"""Nothing is confirmed from where the plain engine's own error is above this: a twentieth of a slender statue's balance angle."""


def plain_names(names: Sequence[str]) -> list[str]:
    """The unmodified engines of those that are asked."""
    return [name + PLAIN for name in names if name + PLAIN in engines.REGISTRY]


def witnesses(scene: Scene, runs: Mapping[str, Run], options: RunOptions) -> dict[str, Witness]:
    """What the plain engines of these runs say of all of them; nothing where no engine of contact was asked."""
    answers = {name: run for name, run in runs.items() if not run.outcome.failed and run.history is not None}
    said: dict[str, Witness] = {}
    for name in plain_names(list(answers)):
        if name in runs:
            continue
        try:
            said[name] = _witness(scene, answers, name, options)
        except EngineFailure as failure:
            reason = info("witness_failed", witness=name.removesuffix(PLAIN), message=str(failure))
            said[name] = Witness(name, 0.0, None, None, [reason])
    return said


def findings_of(witnesses: Mapping[str, Witness]) -> list[Finding]:
    """What the unmodified engines confirm, do not confirm, or leave open."""
    found = []
    for item in witnesses.values():
        name = item.engine.removesuffix(PLAIN)
        agree = {run: judged for run, judged in item.runs.items() if judged.agrees and judged.until_s > LEAST_S}
        parted = {run: judged for run, judged in item.runs.items() if not judged.agrees}
        # The model under the witness's own rule is held further than runs that begin to differ by another.
        for rule in sorted({judged.floor_impact for judged in agree.values()}, reverse=True):
            like = {run: judged for run, judged in agree.items() if judged.floor_impact == rule}
            until_s, to_rad = min(each.until_s for each in like.values()), max(each.to_rad for each in like.values())
            values = {"models": [*like], "until_s": until_s, "to_rad": to_rad, "floor_impact": item.floor_impact}
            found.append(info("witness_confirms", witness=name, **values))
        if parted:
            first_s = min(each.until_s for each in parted.values())
            values = {"models": [*parted], "from_s": first_s, "floor_impact": item.floor_impact}
            found.append(caution("witness_parts", witness=name, **values))
        if not agree and not parted:
            found += [info("witness_silent", witness=name), *item.reasons]
    return found


def _witness(scene: Scene, runs: Mapping[str, Run], name: str, options: RunOptions) -> Witness:
    """What one plain engine says. Raises `EngineFailure` where it cannot run the scene."""
    engine, own = engines.load(name), runs[name.removesuffix(PLAIN)]
    missing, wanted_s = engine.missing(), own.bounded_until_s
    if missing is not None:
        raise EngineFailure(missing)
    if wanted_s <= LEAST_S:
        return Witness(name, 0.0, None, None, [info("witness_of_nothing", engine=own.engine)])
    affordable = BUDGET * own.work.get("steps_of_all_runs", own.steps) / engine.step_cost(scene)
    settings, finer, until_s = _affordable(engine, scene, wanted_s, affordable)
    short = replace(scene, duration_s=until_s)
    with_history = RunOptions(skips=options.skips, history=True)
    coarse = engine.simulate(short, settings, with_history)
    fine = engine.simulate(short, finer, with_history)
    apart = spread(coarse, fine, target_of(scene, TARGET_RAD))
    height_m = 0.0 if scene.pedestal is None else scene.statue.centroid_height_m
    error = apart.stated.or_more(Error(finer.expected_error_rad, finer.expected_error_rad * height_m))
    fine = fine.with_uncertainty(error.rotation_rad, error.slip_m, apart.until_s)
    as_it_acts, held = under_static(scene, runs)
    judged = {each: _judged(as_it_acts, run, fine, coarse) for each, run in held.items()}
    steps = coarse.steps + fine.steps
    if parted_s := [each.parts_s for each in judged.values() if each.parts_s is not None]:
        third = _third(engine, scene, max(parted_s), CHECK_TIMES * affordable, with_history)
        if third is not None:
            steps += third.steps
            third = third.with_uncertainty(error.rotation_rad, error.slip_m, third.end_s)
        judged = {each: _confirmed(as_it_acts, held[each], third, fine, first) for each, first in judged.items()}
        if any(not each.agrees for each in judged.values()):
            # All its levels may take for rest what rocks by less than they resolve: in the model that grows to a difference.
            grown_s = outgrown_s(as_it_acts, error.rotation_rad, error.rotation_rad)
            judged = {each: _until_grown(first, grown_s, error.rotation_rad) for each, first in judged.items()}
    mine = judged[own.engine]
    if as_it_acts is not scene and MODEL in judged:
        judged[MODEL] = mine = replace(judged[MODEL], floor_impact="static")
    return Witness(
        name,
        mine.until_s,
        mine.to_rad,
        mine.agrees,
        [*_why_no_further(own, fine, apart.until_s, until_s, wanted_s), *_in_the_plane(scene, engine, runs)],
        finer.dt_s,
        error.rotation_rad,
        steps,
        judged,
        str(fine.settings.get("floor_impact") or ""),
    )


def _affordable(engine: Engine, scene: Scene, until_s: float, steps: float) -> tuple[Settings, Settings, float]:
    """The finest settings, with their verification run's, whose two runs to `until_s` take at most so many steps.

    Where the coarsest take more, the time that these reach.
    """
    levels = engine.refinement_levels(scene)
    for settings in reversed(levels):
        finer = engine.verification_settings(scene, settings)[0]
        if until_s * (1.0 / settings.dt_s + 1.0 / finer.dt_s) <= steps:
            return settings, finer, until_s
    finer = engine.verification_settings(scene, levels[0])[0]
    reached_s = steps / (1.0 / levels[0].dt_s + 1.0 / finer.dt_s)
    return levels[0], finer, min(max(reached_s, 2.0 * levels[0].dt_s), until_s)


def _judged(scene: Scene, run: Run, plain: Run, coarser: Run) -> Judged:
    evidence = compare(run, plain).evidence
    known_s = min(run.bounded_until_s, plain.bounded_until_s)
    parts_s = evidence.exceeded_s
    if parts_s is None or parts_s > known_s:
        own_rad = plain.numerical_uncertainty_rad or 0.0
        return Judged(True, known_s, evidence.largest_reliable_difference_rad + own_rad)
    if _falls(scene, run, plain, coarser, parts_s):
        return Judged(True, parts_s, evidence.limit_rad)
    return Judged(False, parts_s, evidence.largest_difference_rad, parts_s)


def _third(engine: Engine, scene: Scene, until_s: float, steps: float, options: RunOptions) -> Run | None:
    """The plain engine's finest run up to where a run parts from two coarser ones; None where it takes more than `steps`."""
    finest, until_s = engine.refinement_levels(scene)[-1], min(until_s + PAST_S, scene.duration_s)
    if until_s / finest.dt_s > steps:
        return None
    return engine.simulate(replace(scene, duration_s=until_s), finest, options)


def _confirmed(scene: Scene, run: Run, third: Run | None, finer: Run, first: Judged) -> Judged:
    """What was said of a run, refuted only where the finest plain run parts from it as the finer one of the first two does."""
    if first.parts_s is None or (third is not None and not _judged(scene, run, third, finer).agrees):
        return first
    return Judged(True, first.parts_s, compare(run, finer).evidence.limit_rad)


def _until_grown(judged: Judged, grown_s: float, limit_rad: float) -> Judged:
    """What was said of a run, refuted only where a plain engine's own error has not grown to as much before."""
    parts_s = judged.parts_s
    return judged if parts_s is None or judged.agrees or grown_s > parts_s else Judged(True, grown_s, limit_rad)


def _falls(scene: Scene, run: Run, plain: Run, coarser: Run, parts_s: float) -> bool:
    """Whether two runs' difference by the instant at which they part falls with the plain engine's step."""
    until_s = parts_s + scene.output_dt_s  # between two samples of the histories the instant is interpolated
    (rad, m), (coarser_rad, coarser_m) = errors(run, plain, until_s), errors(run, coarser, until_s)
    return rad <= FALLS * coarser_rad and m <= max(FALLS * coarser_m, (plain.slip_uncertainty_m or 0.0))


def _in_the_plane(scene: Scene, engine: Engine, runs: Mapping[str, Run]) -> list[Finding]:
    """That what is compared is the rotation in the rocking plane, where one of both was not given all of the floor's motion."""
    given = scene.base_excitation.axes(engine.capabilities.dimensions)
    unlike = [name for name, run in runs.items() if run.motion_axes is not None and tuple(run.motion_axes) != given]
    return [info("witness_in_plane", models=unlike)] if unlike else []


def _why_no_further(own: Run, plain: Run, bounded_s: float, reached_s: float, wanted_s: float) -> list[Finding]:
    if own.end_s - min(bounded_s, wanted_s) <= LEAST_S:
        return []
    if bounded_s < min(plain.end_s, reached_s):
        return [info("witness_not_bounded", witness=own.engine, limit_rad=TARGET_RAD, from_s=bounded_s)]
    if reached_s < wanted_s:
        return [info("witness_budget", witness=own.engine, times=BUDGET, until_s=reached_s)]
    return [info("witness_run_not_bounded", engine=own.engine, from_s=wanted_s)]


# Whether the coefficient that acts as an impact breaks the pedestal loose decides the answer: the model by another one.
#
# Where the floor has two coefficients, which of them acts there is a choice between laws (docs/model.md, section 3).

KEY: Final = "contact.floor_impact"


def _by_another(scene: Scene) -> tuple[Run, float] | None:
    """The model by the other coefficient, and when an impact first makes the choice; None where none does, or it fails."""
    # Only with two coefficients, and where an impact moves the pedestal at all.
    two = scene.contact.floor_kinetic < scene.contact.floor_static
    if not two or scene.pedestal is None or scene.form.pedestal_at_impact != "momentum":
        return None
    try:
        other, at_s = by_other_impact(scene)
    except EngineFailure:
        return None
    return None if at_s is None else (other, at_s)


def decided_by(scene: Scene, runs: Mapping[str, Run]) -> DecidedBy | None:
    """Outcomes of the model by the scene's choice and by another, from one run more; None where no impact makes the choice.

    It decides where both tell what becomes of the statue, and not the same: one that still falls at the end tells nothing.
    """
    model = runs.get(MODEL)
    found = None if model is None or model.outcome.failed else _by_another(scene)
    if model is None or found is None:
        return None
    (other, at_s), contact = found, scene.contact
    another = "kinetic" if contact.at_impact == contact.floor_static else "static"
    outcomes = {str(contact.floor_impact): model, another: other}
    said = {name: LawChoice(run.outcome, run.end_s, run.peak_theta_rad) for name, run in outcomes.items()}
    told = {outcome_family(run.outcome) for run in outcomes.values() if has_answer(run)}
    return DecidedBy(KEY, at_s, said, len(told) > 1)


def findings_of_choice(choice: DecidedBy | None) -> list[Finding]:
    """That the choice decides the outcome, with both."""
    if choice is None or not choice.decides:
        return []
    outcomes = {name: each.outcome.value for name, each in choice.outcomes.items()}
    return [changes_answer("floor_impact_decides", outcomes=outcomes)]


def under_static(scene: Scene, runs: Mapping[str, Run]) -> tuple[Scene, dict[str, Run]]:
    """The scene as unmodified engines act, and the runs to hold against them: the model's anew, every other one's until an
    impact makes the choice otherwise.
    """
    contact = scene.contact
    found = None if contact.at_impact == contact.floor_static else _by_another(scene)
    if found is None:
        return scene, dict(runs)
    static = replace(scene, contact=replace(contact, floor_impact="static"))
    held = {name: replace(run, reliable_until_s=min(run.bounded_until_s, found[1])) for name, run in runs.items()}
    if MODEL in runs:
        try:
            held[MODEL] = by_model(static, options=RunOptions())
        except EngineFailure:
            return scene, dict(runs)
    return static, held
