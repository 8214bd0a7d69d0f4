"""Run one scene with several engines and write the result folder, whole or not at all."""

import itertools
import math
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from analytic import AnalyticInputError, ZeroExcitation
from harness import engines
from harness.accuracy.forecast import CERTIFIED_S, START_S, Range, first_settings, moving_s, run_s, worth_a_process
from harness.accuracy.horizon import horizon_of, settings_of
from harness.accuracy.refinement import DEFAULT_ACCURACY_RAD, RunTarget, check_target, failed, simulate, simulate_with
from harness.comparison.comparator import CODES, compare
from harness.comparison.scores import errors
from harness.engines.base import Engine, EngineFailure
from harness.input.files import read_files
from harness.model import (
    SKIPS,
    Answer,
    Finding,
    Outcome,
    Run,
    RunOptions,
    Say,
    Scene,
    caution,
    changes_answer,
    grouped,
    history_file,
    info,
    machine,
    must_be_scene,
    number,
    pair,
    require,
    versions,
    weighed,
)
from harness.questions.scene.witness import (
    BUDGET,
    decided_by,
    findings_of,
    findings_of_choice,
    finer_rad,
    finer_runs,
    plain_names,
    witnesses,
)
from harness.records.assess import Assessment
from harness.records.base import COMING, PAGES, RECORD, check_folder, check_inputs, option_words, write_whole
from harness.records.run import (
    PLAIN,
    STILL_RAD,
    DecidedBy,
    HorizonRecord,
    RunRecord,
    Witness,
    balance_share,
    has_answer,
    known_until_s,
    outcome_family,
    outside_domain,
    own_moves,
    peak_lean_rad,
    unconfirmed,
)
from harness.records.scene import SceneRecord, motion_of
from harness.records.scores import ROBUST, Evidence, Scores, Verdict
from harness.runs.progress import duration_words, forecast_words
from harness.runs.runner import kill_workers
from harness.runs.task import simulate_isolated
from harness.statics.plan import Step, plan
from harness.statics.standstill import standstill

ENDED: Final = "the run was ended before this engine had finished"
"""Why an engine has no answer in the result of a run that the user ended."""
KILLED_S: Final = 0.05
"""Between two looks whether a process that was killed is gone."""


@dataclass(frozen=True, eq=False)
class Result:
    """What all engines said of one scene, with the scores of each pair."""

    scene: Scene
    runs: Mapping[str, Run]
    scores: Mapping[str, Scores]
    plan: Sequence[Step]
    seconds: float
    horizons: Mapping[str, HorizonRecord] = field(default_factory=dict)
    assessment: Mapping[str, Assessment] = field(default_factory=dict)
    witness: Mapping[str, Witness] = field(default_factory=dict)
    decided_by: DecidedBy | None = None
    asked: Sequence[str] | None = None

    @property
    def failed(self) -> bool:
        """Whether any engine failed to give an answer."""
        return self.failed_but(())

    def failed_but(self, optional: Sequence[str]) -> bool:
        """Whether any engine failed, those of `optional` that are not installed here left aside."""
        runs = (run for run in self.runs.values() if run.outcome.failed)
        return any(run.outcome is not Outcome.UNAVAILABLE or run.engine not in optional for run in runs)

    def answer(self) -> Answer:
        """The headline."""
        decided = findings_of_choice(self.decided_by)
        return answer_of(self.scene, self.runs, self.scores, self.horizons, self.assessment, decided)

    def findings(self) -> list[Finding]:
        """All that is to be known of the result, by severity."""
        of_pairs: list[Finding] = []
        for found in (found for each in self.scores.values() for found in each.findings):
            # Every pair of a model says that it was not given a motion.
            if found.code != "motion_not_given" or found.values not in [each.values for each in of_pairs]:
                of_pairs.append(found)
        # What a pair says of a model's motion, its run says too.
        told = {found.values["model"] for found in of_pairs if found.code == "motion_not_given"}
        of_runs = [
            found.of(name)
            for name, run in self.runs.items()
            for found in run.findings
            if found.code != "motion_across_left_out" or name not in told
        ]
        silent = [
            caution("engine_failed", outcome=run.outcome.value, message=run.message).of(name)
            for name, run in self.runs.items()
            if run.outcome.failed
        ]
        return weighed(
            [
                *self.scene.findings,
                *silent,
                *_moves(self.runs),
                *of_runs,
                *of_pairs,
                *findings_of(self.witness),
                *findings_of_choice(self.decided_by),
            ]
        )

    def record(self) -> RunRecord:
        """The whole record as it stands in `result.json`, but for the list of what lies beside it."""
        return RunRecord(
            title=self.scene.title,
            scene=SceneRecord.of(self.scene),
            answer=self.answer(),
            asked=self.asked,
            findings=self.findings(),
            motion=motion_of(self.scene),
            runs=self.runs,
            histories=[name for name, run in self.runs.items() if run.history is not None],
            scores=self.scores,
            horizons=self.horizons,
            assessment=self.assessment,
            witness=self.witness,
            decided_by=self.decided_by,
            plan=self.plan,
            seconds=self.seconds,
            versions=versions(),
            machine=machine(),
        )


class Ended(KeyboardInterrupt):
    """A run that the user ended: `result` holds what had finished, and that the other engines gave no answer."""

    def __init__(self, result: Result) -> None:
        super().__init__()
        self.result = result


def run_scene(
    scene: Scene,
    names: Sequence[str] | None = None,
    *,
    accuracy_rad: float | None = None,
    dt_s: float | None = None,
    options: RunOptions | None = None,
    on_progress: Callable[[str], None] = lambda text: None,
    iso: bool = False,
    horizon: bool = False,
    apart: bool = False,
    assess: bool = False,
    witness: bool = False,
    stored: Mapping[str, Run] | None = None,
    stored_horizons: Mapping[str, HorizonRecord] | None = None,
) -> Result:
    """Run a scene with the named engines and score every pair; `on_progress` hears which engine is at work.

    >>> result = harness.run_scene(scene, ["analytic", "pymunk"])
    >>> result.scores["analytic_vs_pymunk"].verdict

    `names` None: those that the scene needs (`engines.default_engines`).

    A model that certifies its own error also finds its horizon of prediction from its own perturbed starts (some twenty runs, of
    milliseconds each); with `horizon` every model does. `apart` runs three-dimensional engines beside the others in a process of
    their own where they take longer than its start; the results are the same. With `assess` the analytic model's probability of
    overturning is found from what the scene does not know. With `witness` unmodified engines are run beside those that locate
    events (`harness.questions.scene.witness`). `stored` are runs of this very scene and target, `stored_horizons` horizons of
    this very scene, that are there already. An interrupt after one of the engines has finished raises `Ended` with the result so
    far.
    """
    must_be_scene(scene, "run_scene")
    check_target(accuracy_rad, dt_s)
    options = options or RunOptions()
    loaded = [engines.load(name) for name in engines.asked(names, engines.default_engines(scene))]
    steps = plan(scene, loaded, options, engines.REGISTRY)
    start = time.perf_counter()
    target = RunTarget(accuracy_rad, dt_s, options)
    off = [name for name in SKIPS if name not in options.skips]
    asked = option_words(
        accuracy=accuracy_rad, dt=dt_s, no_skip=off if options.skips else "all", witness=witness, no_assess=not assess
    )
    runs, refined = dict(stored or {}), list[str]()
    horizons, scores = dict(stored_horizons or {}), dict[str, Scores]()
    assessment, witness_answers = dict[str, Assessment](), dict[str, Witness]()

    def known() -> dict[str, Run]:
        return {item.name: runs.get(item.name) or failed(item.name, Outcome.CRASHED, ENDED) for item in loaded}

    def result() -> Result:
        # Which engines were refined, and what a scene that nothing moves would take.
        again = [info("refined_for_comparison", accuracy_rad=finer_rad(target)).of(name) for name in refined]
        still = standstill(scene, answers_of(known()))
        told = replace(scene, findings=(*scene.findings, *again, *([] if still is None else [still])))
        seconds = time.perf_counter() - start
        choice = decided_by(scene, known())
        return Result(told, known(), scores, steps, seconds, horizons, assessment, witness_answers, choice, asked)

    try:
        _run_engines(scene, loaded, target, runs, on_progress, apart=apart)
        horizons |= _horizons(scene, answers_of(known()), horizons, on_progress, every=horizon)
        scores |= _scores(scene, known(), horizons, iso)
        taken = TakenAway(scene, target.target_rad)
        if target.dt_s is None:
            found = explained(known(), scores, taken)
            refinable = {
                item.name for item in loaded if not item.capabilities.certifies and item.name not in (stored or {})
            }
            open_ = [each for pair, each in scores.items() if pair not in found]
            names_refined, finer = finer_runs(scene, known(), open_, refinable, target, on_progress)
            refined += names_refined
            if finer:
                runs |= finer
                scores |= _scores(scene, known(), horizons, iso)
        scores |= with_reasons(known(), scores, taken)
        if witness:
            on_progress("witness")
            witness_answers |= witnesses(scene, known(), options)
        leaves_plane = any(each.verdict is Verdict.PLANE for each in scores.values())
        assessment |= _assessed(scene, on_progress, leaves_plane=leaves_plane) if assess else {}
    except KeyboardInterrupt as ending:
        if not answers_of(runs):
            raise
        scores |= {} if scores else _scores(scene, known(), horizons, iso)
        raise Ended(result()) from ending
    return result()


def _run_engines(
    scene: Scene,
    loaded: Sequence[Engine],
    target: RunTarget,
    runs: dict[str, Run],
    on_progress: Callable[[str], None],
    *,
    apart: bool,
) -> None:
    """Run the engines that have no run in `runs` yet; each run stands there as soon as it has finished, whatever comes after.

    Those in three dimensions run in a process of their own each where that is worth it (none unless `apart`); an interrupt ends
    them.
    """
    left = [item for item in loaded if item.name not in runs]
    here = left if apart and len(left) > 1 else ()
    beside = [item for item in here if item.capabilities.dimensions == 3 and item.missing() is None]
    asked = scene, target.accuracy_rad, target.dt_s
    beside = [item for item in beside if worth_a_process(item.name, run_s(item.name, *asked, timed=False))]
    with ThreadPoolExecutor(max(len(beside), 1)) as threads:
        waiting = {item.name: threads.submit(simulate_isolated, scene, item.name, target) for item in beside}
        try:
            for engine in loaded:
                on_progress(engine.name)
                if engine.name not in waiting and engine.name not in runs:
                    runs[engine.name] = simulate_with(engine, scene, target)
            for engine in beside:
                future = waiting[engine.name]
                if not future.done():
                    on_progress(f"{engine.name}, {engine.awaited()}")
                runs[engine.name] = future.result()
        except BaseException:
            # What failed beside is raised as it is, once the others have been ended.
            ended = {name: future for name, future in waiting.items() if future.done() and future.exception() is None}
            runs |= {name: future.result() for name, future in ended.items()}
            _give_up(waiting.values())
            raise


def answers_of(runs: Mapping[str, Run]) -> list[Run]:
    """The runs that did not fail."""
    return [run for run in runs.values() if not run.outcome.failed]


def _moves(runs: Mapping[str, Run]) -> Iterator[Finding]:
    """By which models the statue moves on its support: neither rotation nor the pedestal's slip tells it."""
    own = own_moves(runs)
    for said in (caution("statue_slides"), caution("statue_hops"), caution("statue_turns")):
        if (models := own.get(said.code)) is not None:
            yield replace(said, values={"models": [*models], "most": [min(models.values()), max(models.values())]})


def _give_up(waiting: Iterable[Future[Run]]) -> None:
    """End what runs beside after an interrupt: else its threads would wait for the answer of a long or a stopped process."""
    while not all(future.cancel() or future.done() for future in waiting):
        kill_workers()
        time.sleep(KILLED_S)


def _assessed(scene: Scene, on_progress: Callable[[str], None], *, leaves_plane: bool) -> dict[str, Assessment]:
    from harness.questions.assess.probability import assess_models

    on_progress("probability")
    try:
        return assess_models(scene, leaves_plane=leaves_plane)
    except AnalyticInputError:  # the model refuses this scene; its own run says why
        return {}


def _scores(
    scene: Scene, runs: Mapping[str, Run], horizons: Mapping[str, HorizonRecord], iso: bool
) -> dict[str, Scores]:
    """The scores of each pair, up to their horizons."""
    until_s = {name: each.intrinsic_s for name, each in horizons.items()}
    found = {}
    for a, b in itertools.combinations(answers_of(runs), 2):
        both = (until_s.get(a.engine), until_s.get(b.engine))
        scores = compare(a, b, scene=scene, horizons_s=both, iso=iso)
        # Of runs by one step none states an error, and what parts them may be that.
        if scores.verdict is Verdict.MODEL and any(each.code == "pair_differs_unstated" for each in scores.findings):
            scores = replace(scores, verdict=Verdict.UNBOUNDED)
        found[f"{a.engine}_vs_{b.engine}"] = scores
    return found


def _horizons(
    scene: Scene,
    runs: Sequence[Run],
    found: Mapping[str, HorizonRecord],
    on_progress: Callable[[str], None],
    *,
    every: bool,
) -> dict[str, HorizonRecord]:
    """Horizons of these runs but those that are `found`."""
    horizons = {}
    for run in runs if len(runs) > 1 or every else ():
        engine = engines.load(run.engine)
        if run.engine in found or not (every or engine.capabilities.certifies):
            continue
        if every:
            on_progress(f"{run.engine}, horizon")
        try:
            horizons[run.engine] = horizon_of(engine, scene, settings_of(engine, scene, run))
        except EngineFailure as error:
            on_progress(f"{run.engine} has no horizon: {error}")
    return horizons


def check_writing(folder: Path, scene: Scene, names: Sequence[str]) -> None:
    """Raise `InputError` unless the result of these engines can be written into `folder` without a loss (see `check_folder`)."""
    written = [history_file(name) for name in names] + [*PAGES, RECORD, COMING, "statue.glb"]
    check_inputs(folder, written, read_files(scene.given, scene.source))
    check_folder(folder, ("run",), written if scene.statue.solid is not None else written[:-1])


def write_result(result: Result, folder: Path, say: Say = lambda finding: "") -> Path:
    """Write histories, the statue's mesh and `result.json`, which lists them with checksums, into `folder`, whole or not at all.

    `say` fills in the sentences.

    A killed write leaves the old result whole or files that one of both records lists. Raises `InputError` for a folder in which
    something else would be lost.
    """
    check_writing(folder, result.scene, list(result.runs))

    def write(fresh: Path) -> None:
        for name, run in result.runs.items():
            if run.history is not None:
                run.history.write_csv(fresh / history_file(name))
        if result.scene.statue.solid is not None:
            from meshes.solid import write_glb

            write_glb(result.scene.statue.solid, fresh / "statue.glb")

    write_whole(folder, result.record().texted(say), write)
    return folder / RECORD


# The headline of a run: what happens and whether the models agree, how probable a fall is, until when, and what decides.

Code = Literal[
    "agree",
    "agree_until",
    "outcome_differs",
    "plane_left_out",
    "differ_by_model",
    "unpredictable",
    "one_model",
    "no_answer",
]
LATE: Final = (Verdict.HORIZON, Verdict.UNBOUNDED, Verdict.DOMAIN)
"""Verdicts of histories that agree up to some instant, and part for a reason that is no model's."""
NOT_FOLLOWED: Final = (Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX)
"""Ends of a perturbed run that are none of the statue: it may fall or stand there as it does elsewhere."""


def answer_of(
    scene: Scene,
    runs: Mapping[str, Run],
    scores: Mapping[str, Scores],
    horizons: Mapping[str, HorizonRecord],
    assessment: Mapping[str, Assessment],
    decided: Sequence[Finding] = (),
) -> Answer:
    """The headline, in the order in which a validation asks; `decided`: laws whose choice decides the outcome."""
    known = {name: run for name, run in runs.items() if has_answer(run)}
    judged = [*counted(runs, scores).values()]
    parts = [_what(scene, known, runs)]
    if outside := unconfirmed(known):
        first = known[min(outside, key=lambda name: number(known[name].validity, "left_domain_s"))].validity
        left = {"at_s": first["left_domain_s"], "by": first["left_domain_by"]}
        parts.append(changes_answer("outcome_outside_domain", models=outside, **left))
    if assessment:
        from harness.questions.assess.probability import finding_of  # not for a run that asks for none

        # Whether two models end differently by what the plane leaves out.
        parted = any(
            outcome_family(runs[each.a].outcome) != outcome_family(runs[each.b].outcome)
            for each in judged
            if each.verdict is Verdict.PLANE
        )
        parts.append(finding_of(assessment, contradicted=parted))
    parts += _until(known, judged)
    parts += [*_plane(judged), *decided]
    flipping = [each for name, each in horizons.items() if name in known and len(_reached(each)) > 1]
    if flipping:
        # A small change of start or motion changes the outcome by one model itself.
        change = min((each.outcome_from for each in flipping if each.outcome_from is not None), default=None)
        outcomes = sorted(set().union(*map(_reached, flipping)))
        parts.append(changes_answer("outcome_not_predictable", outcomes=outcomes, change=change))
    return Answer(_code(known, judged), parts)


def _reached(horizon: HorizonRecord) -> set[str]:
    """What becomes of the statue in perturbed runs of one model."""
    reached = {outcome_family(end) for end in horizon.outcomes if end not in NOT_FOLLOWED}
    # What is undecided beside a fall still falls as the scene ends.
    return reached - {Outcome.UNDECIDED.value} if "overturned" in reached else reached


def counted(runs: Mapping[str, Run], scores: Mapping[str, Scores]) -> dict[str, Scores]:
    """The pairs that an answer rests on: of models that tell what becomes of the statue, and those that differ robustly while one
    of them still did.
    """
    return {
        pair: each
        for pair, each in scores.items()
        if each.verdict in ROBUST or (has_answer(runs[each.a]) and has_answer(runs[each.b]))
    }


def _code(known: Mapping[str, Run], scores: Sequence[Scores]) -> Code:
    verdicts = {each.verdict for each in scores}
    if not known:
        return "no_answer"
    if Verdict.MODEL in verdicts:
        return "differ_by_model"
    if Verdict.PLANE in verdicts:
        return "plane_left_out"
    if len(known) < 2:
        return "one_model"
    if len({outcome_family(run.outcome) for run in known.values()}) > 1:
        flips = all(each.verdict in LATE or each.evidence.outcome_flips_within_uncertainty for each in scores)
        return "unpredictable" if flips else "outcome_differs"
    return "agree_until" if verdicts & set(LATE) else "agree"


def _what(scene: Scene, known: Mapping[str, Run], runs: Mapping[str, Run]) -> Finding:
    """What happens as given, and who says so."""
    if not known:
        ends = grouped((run.outcome.value, name) for name, run in runs.items() if not outside_domain(run))
        return changes_answer("no_answer", asked=len(runs), ends=ends)
    groups = grouped((outcome_family(run.outcome), name) for name, run in known.items())
    if len(groups) > 1:
        return changes_answer("models_disagree", groups=groups)
    family = next(iter(groups))
    lean = _lean(scene, known)
    still = family == "stands" and max(lean["lean_rad"]) < STILL_RAD
    values = {
        "models": list(known),
        "asked": len(runs),
        "silent": {
            name: "left_domain" if outside_domain(run) else run.outcome.value
            for name, run in runs.items()
            if name not in known
        },
        "outcome": "still" if still else family,
        **lean,
    }
    sides = sorted({run.outcome.value for run in known.values()})
    if family == "overturned":
        times = [run.no_return_time_s for run in known.values() if run.no_return_time_s is not None]
        values |= {"sides": sides, "first_s": min(times, default=None), "last_s": max(times, default=None)}
    return info("model_says" if len(known) == 1 else "models_agree", **values)


def _lean(scene: Scene, known: Mapping[str, Run]) -> dict[str, Any]:
    """The least and the largest of the models' largest leans, rad, and the largest as a share of the balance angle; of a model
    that left its domain those before, where another did not."""
    peaks, shares = [], []
    for name, until_s in known_until_s(known).items():
        run = known[name]
        theta_rad = np.array([run.peak_theta_rad]) if run.history is None else run.history.theta_rad
        if run.peaks_until_s > until_s:
            theta_rad = np.zeros(1) if run.history is None else run.history.until(until_s).theta_rad
            run = replace(run, peak_theta_rad=float(np.abs(theta_rad).max()), validity={})
        peaks.append(peak_lean_rad(run))
        shares.append(balance_share(run, theta_rad, scene.statue.slenderness_rad))
    # A contact engine at rest gives by less.
    leans = [each if each >= STILL_RAD else 0.0 for each in (min(peaks), max(peaks))]
    return {"lean_rad": leans, "balance_share": max(shares)}


def _until(known: Mapping[str, Run], scores: Sequence[Scores]) -> list[Finding]:
    """Until when the histories agree, and why not longer."""
    if not scores:
        return []
    parted = [each for each in scores if each.verdict is not Verdict.AGREE]
    if not parted:
        bounded = min((run.bounded_until_s for run in known.values()), default=0.0)
        if _fell_by(known, bounded):
            return [info("histories_agree_past_return", until_s=bounded)]
        if any(run.bounded_until_s < run.end_s for run in known.values()):
            return [info("histories_known_until", until_s=bounded)]
        return [info("histories_agree")]
    first = min(parted, key=_order)
    until_s, why = _agree_until_s(first), first.verdict
    if first.evidence.aside:
        return [info("histories_agree_in_plane", a=first.a, b=first.b)]
    if why in LATE and _fell_by(known, until_s):
        return [info("histories_agree_past_return", until_s=until_s)]
    return [info("histories_agree_until", until_s=until_s, why=why.name.lower(), a=first.a, b=first.b)]


def _order(scores: Scores) -> tuple[bool, bool, float]:
    """The place of a pair that parts: one that the answer rests on, before one that parts sooner for another reason."""
    return scores.verdict is not Verdict.MODEL, scores.verdict is not Verdict.PLANE, _agree_until_s(scores)


def _plane(scores: Sequence[Scores]) -> list[Finding]:
    """What of that which the plane leaves out makes the pair differ that is told of; else the cause of another pair, by name."""
    for place, parted in enumerate(sorted((each for each in scores if each.verdict is not Verdict.AGREE), key=_order)):
        if causes := [each.values["cause"] for each in parted.findings if each.code == "plane_cause"]:
            named = {"a": parted.a, "b": parted.b} if place else {}
            return [info("plane_decides", causes=causes, **named)]
    return []


def _fell_by(known: Mapping[str, Run], time_s: float) -> bool:
    """Whether every model's statue had passed the point of no return by then."""
    return all(run.no_return_time_s is not None and run.no_return_time_s <= time_s for run in known.values())


def _agree_until_s(scores: Scores) -> float:
    """Until when two answers are known to agree."""
    seen = scores.evidence
    times = [time for time in (seen.exceeded_s, seen.horizon_s) if time is not None]
    if scores.verdict is Verdict.DOMAIN and seen.left_domain_s is not None:
        times.append(seen.left_domain_s)
    return min(times, default=math.inf)


# Why a body in space leaves the planar model: each thing that the plane leaves out is taken away, and space asked again.

LEAST: Final = 1e-9
"""Share of the inertia's trace, or of the base's width, below which products or a skewed base are rounding."""
REMAINDER: Final = 0.25
"""Share of a difference that may stay without its cause, where it first passes its limit (of the shipped statue 2 to 14 % do).
What stays grows on from there, by itself and by the step of one run, whose error no second one bounds. And"""
MOSTLY: Final = 0.5
"""Share of a difference that may stay where the engine states its error without all that the plane leaves out, and still differs:
what stays is then less than the error that it stated with it."""
TOGETHER: Final = "together"
"""The cause where several are taken away at once."""
LITTLE: Final = 0.1
"""what of it is as good as none."""


def _without_products(scene: Scene) -> Scene | None:
    tensor = scene.statue.inertia_tensor_kg_m2
    diagonal = np.diag(np.diag(tensor))
    if np.max(np.abs(tensor - diagonal)) <= LEAST * np.trace(tensor):
        return None
    return replace(scene, statue=replace(scene.statue, inertia_tensor_kg_m2=diagonal))


def _along_the_plane(scene: Scene) -> Scene | None:
    if isinstance(scene.base_excitation.y, ZeroExcitation):
        return None
    return replace(scene, base_excitation=scene.base_excitation.in_plane())


def _on_edges(scene: Scene) -> Scene | None:
    """The statue on a rectangle between its two corners: their edges lie across the plane."""
    s = scene.statue
    left, right, half = -s.corner_left_m, s.corner_right_m, 0.5 * s.depth_m
    base = np.array([[left, -half, 0.0], [right, -half, 0.0], [right, half, 0.0], [left, half, 0.0]])
    mirrored = np.sort(np.round(s.footprint_m[:, [0, 2]] / s.depth_m, 9), axis=0)
    if len(s.footprint_m) == len(base) and np.allclose(
        mirrored, np.sort(base[:, [0, 2]] / s.depth_m, axis=0), atol=LEAST
    ):
        return None
    return replace(scene, statue=replace(s, footprint_m=base, solid=None))


TAKEN_AWAY: Final[Mapping[str, Callable[[Scene], Scene | None]]] = {
    "products_of_inertia": _without_products,
    "motion_across": _along_the_plane,
    "base_outline": _on_edges,
}
"""What the plane leaves out, and the scene without it; None where the scene has none of it."""


class TakenAway:
    """The runs of 3D engines again, without each thing that the scene has of what the plane leaves out; each is made once."""

    def __init__(self, scene: Scene, accuracy_rad: float = DEFAULT_ACCURACY_RAD) -> None:
        self.scene = scene
        self.runs = cache(partial(_without_each, scene))
        """The runs beside that of a 3D engine."""
        self.without_all = cache(partial(_without_all, scene, accuracy_rad))
        """A 3D engine's run until some time without any of it, its error stated."""


def explained(runs: Mapping[str, Run], scores: Mapping[str, Scores], taken: TakenAway) -> set[str]:
    """The pairs whose robust difference goes with what is taken away."""
    return {
        pair
        for pair, (plane, space) in _planar_and_spatial(runs, scores).items()
        if _judged(plane, space, scores[pair].evidence, taken)[0] is not Verdict.MODEL
    }


def with_reasons(runs: Mapping[str, Run], scores: Mapping[str, Scores], taken: TakenAway) -> dict[str, Scores]:
    """The scores of pairs; of each planar and 3D answer that differ robustly, found which of `TAKEN_AWAY` is why.

    Where one is, it is no longer two models that differ, but what one of them leaves out. They differ by their models where they
    do so by more than their errors in the scene without any of it, too.
    """
    judged = dict(scores)
    for name, (plane, space) in _planar_and_spatial(runs, scores).items():
        each = scores[name]
        verdict, reasons = _judged(plane, space, each.evidence, taken)
        found = [*each.findings, *(reason.of(name) for reason in reasons)]
        if verdict is Verdict.PLANE:
            found[0] = replace(found[0], code=CODES[verdict].code)
        elif verdict is Verdict.UNBOUNDED:
            found[0] = caution("pair_cause_not_shown", **found[0].values, space=space.engine).of(name)
        kept = each.verdict if verdict is Verdict.MODEL else verdict
        judged[name] = replace(each, verdict=kept, findings=found)
    return judged


def _judged(plane: Run, space: Run, evidence: Evidence, taken: TakenAway) -> tuple[Verdict, list[Finding]]:
    """Why a planar and a 3D run differ robustly, and what shows it.

    A single run's error may hide what the plane leaves out: where no cause is found by runs of the same step, the engine states
    its error in the scene without any of it.
    """
    reasons = _reason(plane, space, taken.runs(space), evidence)
    if _caused(reasons):
        return Verdict.PLANE, reasons
    every = [what for what, take in TAKEN_AWAY.items() if take(taken.scene) is not None]
    if not every or plane.numerical_uncertainty_rad is None or space.numerical_uncertainty_rad is None:
        return Verdict.MODEL, reasons
    until_s = _parted_s(plane, space, evidence)
    again = taken.without_all(space.engine, until_s)
    if again.outcome.failed:
        return Verdict.UNBOUNDED, reasons
    alone = compare(plane, again)
    parted_s = alone.evidence.exceeded_s
    differ = parted_s is not None and parted_s <= until_s and alone.verdict in ROBUST
    if not differ and _end_s(again) < until_s:
        return Verdict.UNBOUNDED, reasons
    cause = every[0] if len(every) == 1 else TOGETHER
    due = _reason(plane, space, {cause: again}, evidence, most=MOSTLY if differ else math.inf)
    return (Verdict.PLANE, due) if _caused(due) or not differ else (Verdict.MODEL, reasons)


def _caused(reasons: Sequence[Finding]) -> bool:
    return any(each.code == "plane_cause" for each in reasons)


def _planar_and_spatial(runs: Mapping[str, Run], scores: Mapping[str, Scores]) -> dict[str, tuple[Run, Run]]:
    """Of the pairs of a planar and a 3D answer that differ robustly the two runs."""
    pairs = {}
    for name, each in scores.items():
        sides = {engines.load(side).capabilities.dimensions: runs[side] for side in (each.a, each.b)}
        if each.verdict in ROBUST and each.evidence.differs_in and set(sides) == {2, 3}:
            pairs[name] = sides[2], sides[3]
    return pairs


def _without_each(scene: Scene, space: Run) -> dict[str, Run]:
    """The run of a 3D engine again, without each thing that the scene has of what the plane leaves out."""
    changed = {what: taken for what, take in TAKEN_AWAY.items() if (taken := take(scene)) is not None}
    again = {what: _again(taken, space, _end_s(space)) for what, taken in changed.items()}
    return {what: run for what, run in again.items() if run is not None}


def _without_all(scene: Scene, accuracy_rad: float, engine: str, until_s: float) -> Run:
    """The run of a 3D engine to an accuracy, without any of what the plane leaves out."""
    bare = scene
    for take in TAKEN_AWAY.values():
        bare = take(bare) or bare
    return simulate(replace(bare, duration_s=until_s), engine, accuracy_rad=accuracy_rad)


def _end_s(run: Run) -> float:
    return min(run.bounded_until_s, run.end_s)


def _parted_s(plane: Run, space: Run, evidence: Evidence) -> float:
    """When two that differ robustly, in their rotations or slips, first do so, or the end of what is known of both."""
    ends_s = [_end_s(plane), _end_s(space)]
    if plane.history is not None and space.history is not None:
        both = pair(plane.history, space.history)
        rotation, slip = np.abs(both.difference_rad), np.abs(both.slip_a_m - both.slip_b_m)
        parted = slip > evidence.slip_limit_m if evidence.differs_in == "slip" else rotation > evidence.limit_rad
        ends_s += both.t_s[parted].tolist()
    return min(ends_s)


def _reason(
    plane: Run, space: Run, again: Mapping[str, Run], evidence: Evidence, most: float = REMAINDER
) -> list[Finding]:
    """The cause without which the two are nearest, if at most a share of the difference is left; how far apart without each."""
    slips = evidence.differs_in == "slip"
    until_s = _parted_s(plane, space, evidence)

    def apart(run: Run) -> float:
        return errors(plane, run, until_s)[1 if slips else 0]

    with_all = apart(space)
    known = {what: value for what, run in again.items() if math.isfinite(value := apart(run))}
    if not (0.0 < with_all < math.inf and known):
        return []
    least = min(known, key=lambda what: known[what])
    shares = {what: value / with_all for what, value in known.items()}
    if known[least] > most * with_all:
        return [caution("plane_several_causes", until_s=until_s, share_without=shares)]
    return [caution("plane_cause", cause=least, whole=shares[least] <= LITTLE, until_s=until_s, share_without=shares)]


def _again(scene: Scene, run: Run, until_s: float) -> Run | None:
    """A scene computed by a run's engine with that run's step up to a time; None where it cannot."""
    if until_s <= 0.0:
        return None
    engine, shorter = engines.load(run.engine), replace(scene, duration_s=min(until_s, scene.duration_s))
    try:
        return engine.simulate(shorter, settings_of(engine, scene, run), RunOptions())
    except EngineFailure:
        return None


# What runs will take, told before they begin: processor time and memory; work without an end is refused.

HORIZON_RUNS: Final = 17
"""Runs by which a model's horizon is found: of four sizes four perturbations each."""
RESULT_S: Final = 2.2
"""To score the pairs, to write the result and its pages."""
CAUSE_SHARE: Final = 0.3
"""Of a climb in space its last run once more, up to where it is known: so much for each thing that the plane leaves out, where
a difference is found."""
LONGEST_S: Final = 24 * 3600.0
"""Longer work is refused, or begun only when that is asked for."""
REPORTED_FROM_S: Final = 20.0
"""Work that takes less at most is not announced."""
COLUMNS: Final = {2: 5, 3: 16}
"""Columns of a history by an engine's dimensions."""
NUMBER_S: Final = 2.5e-6
NUMBER_BYTES: Final = 200
"""Each number of a history, from the engine to the page: 1.6 to 3.4 µs, and 200 bytes."""


def check_work(
    scene: Scene,
    dimensions: Mapping[str, int],
    where: str,
    accuracy_rad: float | None = None,
    dt_s: float | None = None,
    memory_bytes: float | None = None,
    *,
    assess: bool = False,
    witness: bool = False,
    horizon: bool = False,
    spent_s: float = 0.0,
) -> str:
    """What a run with engines (`dimensions` by their names) will take, in words; empty where that is not worth a word.

    `spent_s` of processor time are spent already. Counted are also the probability, the witness and the horizons that are asked,
    and the runs that find what the plane leaves out; a finer run is not, for few scenes need one.
    Raises `InputError` naming the key of what would take more than a day, or more memory than there is (`memory_bytes`, by
    default this machine's).
    """
    wanted = scene.duration_s / scene.output_dt_s * sum(COLUMNS[each] for each in dimensions.values())
    there = _memory_bytes() if memory_bytes is None else memory_bytes
    require(
        wanted * NUMBER_BYTES <= there,
        where,
        f"histories that the memory here holds ({there / 1e9:.2g} GB)",
        f"{scene.output_dt_s:g}: {scene.duration_s / scene.output_dt_s:.2g} samples of each model, "
        f"about {wanted * NUMBER_BYTES / 1e9:.2g} GB",
        "a longer step, a shorter duration_s, fewer engines",
        key="output.dt_s",
    )
    runs = {name: run_s(name, scene, accuracy_rad, dt_s) for name in dimensions}
    in_space = {name for name, each in dimensions.items() if each == 3 and len(dimensions) > 1}
    beside = {name for name in in_space if worth_a_process(name, runs[name])}
    apart = [each.and_also(START_S) for name, each in runs.items() if name in beside]
    asked = [
        BUDGET * each.least for name, each in runs.items() if witness and name + PLAIN in plain_names(list(dimensions))
    ]
    asked += [
        HORIZON_RUNS * (run_s(name, scene, dt_s=first_settings(name, scene, accuracy_rad, dt_s).dt_s).least)
        for name in dimensions
        if horizon and name not in CERTIFIED_S
    ]
    asked += [HORIZON_RUNS * runs[name].least for name in dimensions if name in CERTIFIED_S and len(dimensions) > 1]
    stepped = in_space - CERTIFIED_S.keys() if 2 in dimensions.values() else ()
    causes = sum(take(scene) is not None for take in TAKEN_AWAY.values()) if stepped else 0
    known = [Range(0.0, CAUSE_SHARE * causes * runs[name].most) for name in stepped]
    if assess:
        from harness.questions.assess.probability import assessed_s  # else not loaded

        asked.append(assessed_s(scene))
    written = Range(*moving_s(scene)).times(NUMBER_S * wanted / scene.duration_s)
    own = written.and_also(
        spent_s, RESULT_S, *asked, *known, *(each for name, each in runs.items() if name not in beside)
    )
    total = own.and_also(*apart)
    require(
        total.middle <= LONGEST_S,
        where,
        f"work of at most {duration_words(LONGEST_S)}",
        forecast_words(*total),
        "a shorter motion, a coarser --accuracy or --dt, or fewer engines",
        key="duration_s" if dt_s is None else "--dt",
    )
    if total.most < REPORTED_FROM_S:
        return ""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    longest = Range(*map(max, zip(own, *apart, strict=True))) if apart else own
    clock = longest if cores > len(apart) else Range(*(max(a / cores, b) for a, b in zip(total, longest, strict=True)))
    return (
        f"this takes {forecast_words(*total)} of processor time, {forecast_words(*clock)} by the clock (cores: {cores})"
    )


def _memory_bytes() -> float:
    """This machine's memory, or what its container leaves of it."""
    memory_b = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    try:
        return min(memory_b, float(Path("/sys/fs/cgroup/memory.max").read_text(encoding="ascii")))
    except (OSError, ValueError):  # no such limit, or "max"
        return memory_b
