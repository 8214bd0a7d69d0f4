"""One call: read the table, run what is missing, score it, write the record; and one that scores every table of another kind."""

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from harness import engines
from harness.comparison.comparator import compare
from harness.comparison.scores import Measured
from harness.input.files import read_files
from harness.input.history_file import read_history
from harness.model import (
    Answer,
    Finding,
    Mistake,
    Say,
    caution,
    changes_answer,
    grouped,
    info,
    machine,
    read_each,
    refuse,
    require,
    versions,
)
from harness.questions.validate import drops, measured_set, tosses
from harness.questions.validate.measured_set import MeasuredSet, body_alone, header
from harness.questions.validate.scenes import (
    BATCH,
    BATCH_OTHERWISE,
    Drawn,
    Model,
    Trial,
    TrialVariant,
    asked_of,
    intensity_of,
    parse_model,
    read_table,
)
from harness.questions.validate.scoring import (
    Answers,
    Ask,
    ModelAnswers,
    choose,
    curves,
    planned,
    repeats_of,
    score_baseline,
    score_model,
    score_pairs,
)
from harness.records.base import COMING, PAGES, RECORD, RunCounts, check_folder, check_inputs, write_whole
from harness.records.scores import Interval
from harness.records.study import CaseRun
from harness.records.validation import (
    About,
    FitShare,
    MeasuredHistory,
    MeasuredRecord,
    ModelRecord,
    TestRow,
    ValidationRecord,
)
from harness.runs.execute import Campaign
from harness.runs.progress import progress
from harness.runs.runner import LocalPool
from harness.runs.store import STORE_NAME, Store, check_begun

# What a validation says: which models are right most often, and whether any beats a bare threshold on PGV.


def answer_of(record: ValidationRecord) -> Answer:
    """The models that are right most often, held against the threshold; its code says whether any is better."""
    known = {name: item.outcomes.accuracy for name, item in record.models.items() if item.outcomes.accuracy}
    if not known:
        return Answer("no_answer", [changes_answer("no_test_decided", tests=record.tests)])
    most, bare = max(item.value for item in known.values()), record.baseline.outcomes.accuracy
    # A bare count: the intervals of the best and of the next may overlap.
    best = [name for name, item in known.items() if item.value == most]
    found = [info("right_most_often", alone=len(best) == 1, models=best, right=_values(known[best[0]]))]
    if bare is None:
        return Answer("no_threshold", found)
    better = [name for name, item in known.items() if _shown_more(item, bare)]
    worse = [name for name, item in known.items() if _shown_more(bare, item)]
    shown = "better" if better else "worse" if worse else "alike"
    own = sorted(record.baseline.threshold_by_body_m_s.values()) or [record.baseline.threshold_m_s]
    values = {"models": better or worse or list(known), "right": _values(bare), "threshold_m_s": [own[0], own[-1]]}
    against = info("threshold", shown=shown, **values) if better else caution("threshold", shown=shown, **values)
    return Answer(shown, [*found, against])


def _shown_more(one: Interval, other: Interval) -> bool:
    """Whether a share is larger beyond the chance in both: the interval of their difference (Newcombe 1998) leaves zero out."""
    return one.value - other.value > math.hypot(one.value - one.low, other.high - other.value)


def findings_of(record: ValidationRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    found = [each.of(name) for name, item in record.models.items() for each in _of_model(item)]
    if record.unexplained:
        found.append(caution("tests_unexplained", tests=list(record.unexplained)))
    if record.repeats is not None:
        found.append(info("repeats_disagree", **vars(record.repeats)))
    if record.unfitted:
        found.append(caution("not_fitted", keys=list(record.unfitted), fit_share=record.fit_share.name))
    return [*found, info("runs_computed", computed=record.runs.computed, wanted=record.runs.wanted)]


def _of_model(item: ModelRecord) -> Iterator[Finding]:
    """What a model leaves open, and where what it says of a fall is no true probability."""
    within = item.outcomes.within_uncertainty
    left = item.outcomes.undecided + within
    ends = grouped((fitted.input, fitted.body) for fitted in item.fitted.inputs if fitted.at_end)
    if ends:
        inputs = [f"{name} ({', '.join(dict.fromkeys(bodies))})" for name, bodies in sorted(ends.items())]
        yield caution("fitted_at_end", inputs=inputs)
    if item.fitted.width_at_end:
        yield caution("width_at_end", width=item.fitted.width)
    if item.near:
        yield info("asked_near", near=item.near, asked=item.asked)
    if left or item.failed:
        yield caution("tests_left_open", left=left, within=within, failed=item.failed)
    for each in item.probability.reliability:
        if not each.holds:
            values = {"from": each.low, "to": each.high, "fell": _values(each.fell), "cases": each.cases}
            yield caution("not_reliable", **values)


def _values(item: Interval) -> list[float]:
    return [item.value, item.low, item.high]


MAX_SAMPLES: Final = 1000
"""More perturbed runs of each test than this would measure the draws, not the model: their error is already 1.6 %."""


def run_validation(
    experiments: Path,
    folder: Path,
    *,
    models: Sequence[str] | None = None,
    samples: int = 0,
    fit_share: str = "fit",
    seed: int = 0,
    jobs: int | None = None,
    resume: bool = False,
    quiet: bool = False,
    say: Say = lambda finding: "",
) -> ValidationRecord:
    """Run the models on a table of measured tests and score them; writes store.sqlite and result.json into `folder`.

    `models` are engines, each with a setting where wanted (`pymunk@accuracy=1e-4`, `pybullet@dt=5e-4`). Unknown inputs (lists in
    the table) are fitted for each model on the tests of `fit_share` alone; then every test is run as given and with `samples`
    draws of the statue (azimuth, base, friction). Results already in the folder's store are not computed again. Raises
    `InputError` for a wrong table, model, file or number, or `resume` where there is nothing to go on.
    """
    start = time.perf_counter()
    chosen = [parse_model(text) for text in engines.asked(models, engines.DEFAULT_ENGINES)]
    _check(folder, samples, resume, chosen)
    trials = read_table(experiments)
    share = [trial for trial in trials if trial.share == fit_share]
    rest = [trial for trial in trials if trial.share != fit_share]
    with closing(LocalPool(jobs)) as pool, progress(experiments.name, quiet) as on_progress:
        known = sum(not each.near for each in chosen) * planned(trials, share, samples)
        on_progress(0, known)
        # This reads every scene, mesh and motion: all mistakes are told before any run.
        intensities = dict(zip([trial.name for trial in trials], read_each(intensity_of, trials), strict=True))
        with Store(folder / STORE_NAME, "validation") as store:

            def told(done: int, expected: int) -> None:
                """What is planned counts before a campaign hears of it; what the store has is not waited for."""
                on_progress(done, max(expected, known - sum(campaign.reused.values())))

            campaign = Campaign(store, pool, told, BATCH, BATCH_OTHERWISE)
            answered: list[ModelAnswers] = []
            for model in chosen:
                near = next((each for each in answered if each.model.name == model.near), None)
                answered.append(_answered(model, _asking(campaign, model, seed), trials, share, samples, near))
            on_progress(campaign.computed, campaign.computed)
            histories = {item.model.name: _histories(trials, item, store, seed) for item in answered}
    unknown = sorted({name for trial in trials for name in trial.unknown})
    result = ValidationRecord(
        title=f"Validation against {len(trials)} measured tests",
        tests=len(trials),
        bodies=len({trial.body for trial in trials}),
        fit_share=FitShare(fit_share, len(share)),
        samples=samples,
        unknown=unknown,
        unfitted=[] if share else unknown,
        # Where all tests belong to the share they are scored on what they were fitted on, each threshold on all others.
        models={
            item.model.name: score_model(trials, rest or trials, item, intensities, histories[item.model.name])
            for item in answered
        },
        pairs=score_pairs(trials, answered),
        observed=curves(trials, intensities, lambda trial: trial.fell),
        baseline=score_baseline(share if rest else [], rest or trials, intensities),
        rows=[
            TestRow(
                test=trial.name,
                body=trial.body_name,
                share=trial.share,
                observed=trial.observed,
                **vars(intensities[trial.name]),
                predicted={item.model.name: str(item.run(trial).outcome) for item in answered},
                probability={item.model.name: item.probability(trial) for item in answered},
            )
            for trial in trials
        ],
        unexplained=_unexplained(trials, answered) if samples else [],
        repeats=repeats_of(rest or trials),
        experiments=experiments.name,
        runs=RunCounts(campaign.computed + sum(campaign.reused.values()), campaign.computed),
        seed=seed,
        versions=versions(),
        machine=machine(),
        seconds=time.perf_counter() - start,
    )
    result = replace(result, answer=answer_of(result), findings=findings_of(result))
    return write_whole(folder, result.texted(say))


def _asking(campaign: Campaign, model: Model, seed: int) -> Ask:
    """What runs variants of tests by a model, those of which it heard before not again."""
    answers: dict[tuple[str, TrialVariant], CaseRun | Drawn] = {}

    def ask(pairs: Sequence[tuple[Trial, TrialVariant]]) -> Answers:
        wanted = [pair for pair in dict.fromkeys(pairs) if (pair[0].name, pair[1]) not in answers]
        # Those of one body side by side, and of one motion: a worker then makes each statue once, and hears each motion once.
        wanted.sort(key=lambda pair: (pair[0].body, str(pair[0].motion)))
        asked = asked_of(wanted, model, seed)
        for each, stored in zip(asked, campaign.ask([each.task for each in asked]), strict=True):
            assert stored is not None  # a worker that died has its answer, too
            answers.update(each.read(stored))
        return answers

    return ask


def _answered(
    model: Model, ask: Ask, trials: Sequence[Trial], share: Sequence[Trial], samples: int, near: ModelAnswers | None
) -> ModelAnswers:
    """Fit the model on its share, then run every test as given and in its draws.

    With another model `near` the choice is that one's, and only tests of which its draws disagree are run: others are as it says.
    """
    asked = trials if near is None else [trial for trial in trials if near.disagrees(trial)]
    choice = choose(share, ask, samples) if near is None else near.choice
    answers = ask([(trial, each) for trial in asked for each in (choice.nominal(trial), *choice.draws(trial, samples))])
    if near is None:
        return ModelAnswers(model, choice, answers, samples)
    return ModelAnswers(model, choice, {**near.answers, **answers}, samples, frozenset(trial.name for trial in asked))


def _unexplained(trials: Sequence[Trial], answered: Sequence[ModelAnswers]) -> list[str]:
    """Tests whose outcome no run of any model gives: not as fitted, in no draw, and at no value that was tried."""
    odd = {trial.name: trial for trial in trials}
    for item in answered:
        for (name, _), answer in item.answers.items():
            # A run that comes to no end excludes neither outcome.
            if name in odd and answer.outcome.fell in (odd[name].fell, None):
                del odd[name]
    return list(odd)


def _check(folder: Path, samples: int, resume: bool, models: Sequence[Model]) -> None:
    for place, model in enumerate(models):
        before = [each.name for each in models[:place] if not each.near]
        known = not model.near or model.near in before
        require(known, "--engine", "near= a model that is named before", model.name)
        drawn = not model.near or samples
        require(drawn, "--samples", f"draws, which tell what is near, for {model.name}", "0")
    require(0 <= samples <= MAX_SAMPLES, "--samples", f"a whole number from 0 to {MAX_SAMPLES}", str(samples))
    if resume:
        check_begun(folder, "a validation")


def _histories(trials: Sequence[Trial], item: ModelAnswers, store: Store, seed: int) -> list[MeasuredHistory]:
    """Scores against each measured history, which is a history like any other, up to where the run's own error is stated."""
    histories = []
    for trial in trials:
        if trial.history is not None and (item.asked is None or trial.name in item.asked):
            (nominal,) = asked_of([(trial, item.choice.nominal(trial))], item.model, seed)
            computed = store.run(nominal.task.key)
            scores = None
            if computed is not None and not computed.outcome.failed:
                names = item.model.name, f"measured {trial.name}"
                scores = compare(computed, read_history(trial.history), names=names, measured=_measured(trial, item))
            histories.append(MeasuredHistory(trial.name, scores))
    return histories


def _measured(trial: Trial, item: ModelAnswers) -> Measured | None:
    """The uncertainty of a test's history, where it is stated; of the inputs is the scatter of the draws' largest rotations."""
    if trial.history_uncertainty_rad is None:
        return None
    peaks = [abs(run.peak_theta_rad) for run in item.drawn(trial) if run.outcome.fell is False]
    return Measured(trial.history_uncertainty_rad, float(np.std(peaks, ddof=1)) if len(peaks) > 1 else 0.0)


# What a table of measurements holds, by its header: which options go with it, and one call that scores all but tests.

MEASURED: Final[Mapping[str, tuple[About, Sequence[str], Callable[[MeasuredSet], MeasuredRecord]]]] = {
    tosses.COLUMNS[0]: ("tosses", ("body", "engine"), tosses.scored_tosses),
    drops.COLUMNS[0]: ("drops", ("body", "engine", "samples"), drops.scored_drops),
    measured_set.RATIO_COLUMNS[0]: ("impact_ratios", (), measured_set.scored_ratios),
}
"""By the first column's name: the kind, the options that it takes beside those of every table, and what scores it."""
OF_TESTS: Final = ("engine", "samples", "resume", "fit_share")


def kind_of(table: Path, **options: object) -> str:
    """`tests`, `tosses`, `drops` or `impact_ratios`. Raises `InputError` for options of another kind, and a body that is wanted.

    An option that is not given is None or False; `samples` 0.
    """
    kind, taken, _ = MEASURED.get(header(table)[0], ("tests", OF_TESTS, None))
    mistakes = [
        Mistake(
            f"--{name.replace('_', '-')}", "", f"no such option with a table of {kind.replace('_', ' ')}", str(value)
        )
        for name, value in options.items()
        if value and name not in taken
    ]
    if "body" in taken and options.get("body") is None:
        mistakes.append(Mistake("--body", "", f"the scene whose statue was thrown in {table}", "nothing"))
    refuse(mistakes)
    return kind


def validate_measured(
    table: Path,
    folder: Path,
    *,
    body: Path | None = None,
    models: Sequence[str] | None = None,
    samples: int = 0,
    seed: int = 0,
    jobs: int | None = None,
    quiet: bool = False,
    say: Say = str,
) -> MeasuredRecord:
    """Hold models against a table of measured tosses, drops or impact ratios; writes result.json into `folder`.

    `body` is a scene file whose statue was thrown; what is fitted is fitted on a seeded third, and scored on the others. Raises
    `InputError` for a wrong table, scene, model or number.
    """
    start_s, (about, _, scored) = time.perf_counter(), MEASURED[header(table)[0]]
    base = None if body is None else body_alone(body)
    names = [RECORD, COMING, *PAGES]
    check_folder(folder, ("measured",), names)
    check_inputs(folder, names, [table, *([] if base is None else read_files(base.given, base.source))])
    with closing(LocalPool(jobs)) as pool, progress(table.name, quiet) as on_progress:
        told = partial(
            MeasuredRecord,
            about=about,
            source=table.name,
            body=None if body is None else body.name,
            seed=seed,
            versions=versions(),
            machine=machine(),
            seconds=0.0,
        )
        result = scored(MeasuredSet(table, base, models or (), samples, seed, pool, on_progress, told))
    result = replace(result, seconds=time.perf_counter() - start_s)
    return write_whole(folder, result.texted(say))
