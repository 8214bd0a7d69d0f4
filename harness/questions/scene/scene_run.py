"""Run one scene with several engines and write the result folder, whole or not at all."""

import itertools
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from harness import engines
from harness.accuracy.forecast import run_s, worth_a_process
from harness.accuracy.horizon import horizon_of, settings_of
from harness.accuracy.refinement import RunTarget, check_target, failed, simulate_with
from harness.comparison.comparator import compare
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
    history_file,
    info,
    machine,
    must_be_scene,
    versions,
    weighed,
)
from harness.questions.scene.answer import answer_of
from harness.questions.scene.left_out import TakenAway, explained, with_reasons
from harness.questions.scene.witness import (
    decided_by,
    findings_of,
    findings_of_choice,
    finer_rad,
    finer_runs,
    witnesses,
)
from harness.records.assess import Assessment
from harness.records.base import COMING, PAGES, RECORD, check_folder, check_inputs, option_words, write_whole
from harness.records.run import DecidedBy, HorizonRecord, RunRecord, Witness, own_moves
from harness.records.scene import SceneRecord, motion_of
from harness.records.scores import Scores, Verdict
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
        waiting = {item.name: threads.submit(_isolated, item.name, scene, target) for item in beside}
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


def _isolated(name: str, scene: Scene, target: RunTarget) -> Run:
    from harness.runs.task import simulate_isolated

    return simulate_isolated(scene, name, target)


def _give_up(waiting: Iterable[Future[Run]]) -> None:
    """End what runs beside after an interrupt: else its threads would wait for the answer of a long or a stopped process."""
    from harness.runs.runner import kill_workers

    while not all(future.cancel() or future.done() for future in waiting):
        kill_workers()
        time.sleep(KILLED_S)


def _assessed(scene: Scene, on_progress: Callable[[str], None], *, leaves_plane: bool) -> dict[str, Assessment]:
    from analytic import AnalyticInputError
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
