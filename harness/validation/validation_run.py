"""One call: read the table, run what is missing, score it, write the record."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from harness import engines
from harness.campaign.campaign import Campaign
from harness.campaign.progress import progress
from harness.campaign.runner import LocalPool
from harness.campaign.store import STORE_NAME, Store
from harness.comparison.comparator import compare
from harness.input.history_file import read_history
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.records.base import as_file
from harness.records.result_folder import listing
from harness.records.validation import (
    FitShare,
    MeasuredHistory,
    ModelRecord,
    RunCounts,
    TestRow,
    ValidationRecord,
)
from harness.validation.jobs import BATCH, BATCH_OTHERWISE, Job, Model, jobs_of, parse_model
from harness.validation.pairs import score_pairs
from harness.validation.scenes import Intensity, Variant, intensity
from harness.validation.scoring import Answers, Choice, choose, curves, probability, score_baseline, score_model
from harness.validation.table import Trial, read_table

MAX_SAMPLES: Final = 1000
"""More perturbed runs of each test than this would measure the draws, not the model: their error is already 1.6 %."""


def validate(
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
) -> dict[str, Any]:
    """Run the models on a table of measured tests and score them; writes store.sqlite and result.json into `folder`.

    `models` are engines, each with a setting where wanted (`pymunk@accuracy=1e-4`, `pybullet@dt=5e-4`); `samples` perturbed
    runs of each test (azimuth, base, friction) give probabilities beside the nominal outcome; unknown inputs (lists in the
    table) are fitted on the tests of `fit_share` and scored on the others. Results already in the folder's store are not
    computed again. Raises `InputError` for a wrong table, model, file or number, or `resume` where there is nothing to go on.
    """
    start = time.perf_counter()
    _check(folder, samples, jobs, resume)
    chosen = [parse_model(text) for text in dict.fromkeys(models or engines.DEFAULT_ENGINES)]
    trials = read_table(experiments)
    intensities = _intensities(trials)
    wanted = jobs_of(trials, chosen, samples, seed)
    with Store(folder / STORE_NAME) as store:
        with progress(experiments.name, quiet) as on_progress, closing(LocalPool(jobs)) as pool:
            campaign = Campaign(store, pool, on_progress, BATCH, BATCH_OTHERWISE)
            campaign.run((job.task() for job in wanted), len(wanted))
        asked = {
            "title": f"Validation against {len(trials)} measured tests",
            "tests": len(trials),
            "bodies": len({trial.body for trial in trials}),
            "fit_share": FitShare(fit_share, sum(trial.share == fit_share for trial in trials)),
            "samples": samples,
            "unknown": sorted(_unknown(trials)),
            "experiments": experiments.name,
            "runs": RunCounts(len(wanted), campaign.computed),
            "seed": seed,
            "versions": record.versions(),
            "machine": record.machine(),
            "files": listing(()),
        }
        result = _record(store, trials, chosen, wanted, intensities, asked)
    plain = as_file(replace(result, seconds=time.perf_counter() - start))
    record.write_json(folder / "result.json", plain)
    return plain


def _check(folder: Path, samples: int, jobs: int | None, resume: bool) -> None:
    if not 0 <= samples <= MAX_SAMPLES:
        raise InputError(Mistake("--samples", "", f"a whole number from 0 to {MAX_SAMPLES}", str(samples)))
    if jobs is not None and jobs < 1:
        raise InputError(Mistake("--jobs", "", "a whole number of at least 1", str(jobs)))
    if resume and not (folder / STORE_NAME).is_file():
        wanted = f"a validation that was begun in {folder}"
        raise InputError(Mistake("--resume", "", wanted, "no store there", "leave --resume out to begin"))


def _intensities(trials: Sequence[Trial]) -> dict[str, Intensity]:
    """Intensities of all tests; this reads every scene, mesh and motion, so that all mistakes come before any run."""
    by_test: dict[str, Intensity] = {}
    mistakes: dict[str, Mistake] = {}
    for trial in trials:
        try:
            by_test[trial.name] = intensity(trial)
        except InputError as error:
            mistakes |= {str(mistake): mistake for mistake in error.mistakes}
    if mistakes:
        raise InputError(mistakes.values())
    return by_test


def _record(
    store: Store,
    trials: Sequence[Trial],
    models: Sequence[Model],
    wanted: Sequence[Job],
    intensities: Mapping[str, Intensity],
    asked: Mapping[str, Any],
) -> ValidationRecord:
    """Everything that a page shows of a validation; `asked` are the fields that are known without a run."""
    samples, fit_share = asked["samples"], asked["fit_share"].name
    answers = _answers(store, wanted)
    fitted = [trial for trial in trials if trial.share == fit_share]
    scored = [trial for trial in trials if trial.share != fit_share] or list(trials)
    choices = {model.name: choose(fitted, answers[model.name]) for model in models}
    keys = {(job.model.name, job.trial.name, job.variant): job.key for job in wanted}
    scores = {
        model.name: score_model(trials, scored, choices[model.name], answers[model.name], intensities, samples)
        for model in models
    }
    return ValidationRecord(
        unfitted=[] if fitted else asked["unknown"],
        seconds=0.0,
        models={
            model.name: ModelRecord(
                engine=model.engine,
                accuracy_rad=model.accuracy_rad,
                dt_s=model.dt_s,
                histories=_histories(store, trials, model, choices[model.name], keys),
                **vars(scores[model.name]),
            )
            for model in models
        },
        pairs=score_pairs(trials, models, choices, answers),
        observed=curves(trials, intensities, lambda trial: trial.fell),
        baseline=score_baseline(fitted if len(scored) < len(trials) else [], scored, intensities),
        rows=_rows(trials, choices, answers, intensities, samples),
        **asked,
    )


def _unknown(trials: Sequence[Trial]) -> set[str]:
    lists = (("azimuth_deg", "azimuths_deg"), ("friction", "frictions"))
    return {name for name, attribute in lists for trial in trials if len(getattr(trial, attribute)) > 1}


def _answers(store: Store, wanted: Sequence[Job]) -> dict[str, Answers]:
    answers: dict[str, dict[tuple[str, Variant], Mapping[str, Any]]] = defaultdict(dict)
    for job in wanted:
        row = store.get(job.key)
        if row is None:
            raise InputError(Mistake(str(store.path), job.key, "the result of every run", "none", "run again"))
        answers[job.model.name][job.trial.name, job.variant] = row.record
    return dict(answers)


def _histories(
    store: Store, trials: Sequence[Trial], model: Model, choice: Choice, keys: Mapping[Any, str]
) -> list[MeasuredHistory]:
    """Scores against each measured history, which is a history like any other, up to where the run's own error is stated."""
    histories = []
    for trial in trials:
        if trial.history is not None:
            computed = store.run(keys[model.name, trial.name, choice.variant(trial)])
            scores = None
            if computed is not None and not computed.outcome.failed:
                names = model.name, f"measured {trial.name}"
                scores = compare(computed, read_history(trial.history), names=names)
            histories.append(MeasuredHistory(trial.name, scores))
    return histories


def _rows(
    trials: Sequence[Trial],
    choices: Mapping[str, Choice],
    answers: Mapping[str, Answers],
    intensities: Mapping[str, Intensity],
    samples: int,
) -> list[TestRow]:
    return [
        TestRow(
            test=trial.name,
            body=Path(trial.body).name,
            share=trial.share,
            observed=trial.observed,
            pga_g=intensities[trial.name].pga_g,
            pgv_m_s=intensities[trial.name].pgv_m_s,
            predicted={
                name: str(known[trial.name, choices[name].variant(trial)]["outcome"]) for name, known in answers.items()
            },
            probability={name: probability(trial, choices[name], known, samples) for name, known in answers.items()},
        )
        for trial in trials
    ]
