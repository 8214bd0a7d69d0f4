"""One call: read the table, run what is missing, score it, write the record."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from harness import engines
from harness.campaign.executors import LocalPool
from harness.campaign.progress import progress
from harness.comparison.comparator import compare
from harness.input.history_file import read_history
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.model.run import SCHEMA_VERSION
from harness.records.result_folder import listing
from harness.studies.store import STORE_NAME, Store
from harness.validation.jobs import Job, Model, compute, jobs_of, parse_model
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
        with progress(experiments.name, quiet) as told:
            computed = compute(store, LocalPool(jobs), wanted, told)
        found = _record(store, trials, chosen, wanted, intensities, samples, fit_share)
    found |= {
        "experiments": experiments.name,
        "runs": {"wanted": len(wanted), "computed": computed},
        "seed": seed,
        "versions": record.versions(),
        "machine": record.machine(),
        "seconds": time.perf_counter() - start,
        "files": listing(()),
    }
    record.write_json(folder / "result.json", found)
    plain: dict[str, Any] = record.to_plain(found)
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
    found: dict[str, Intensity] = {}
    mistakes: dict[str, Mistake] = {}
    for trial in trials:
        try:
            found[trial.name] = intensity(trial)
        except InputError as error:
            mistakes |= {str(mistake): mistake for mistake in error.mistakes}
    if mistakes:
        raise InputError(mistakes.values())
    return found


def _record(
    store: Store,
    trials: Sequence[Trial],
    models: Sequence[Model],
    wanted: Sequence[Job],
    intensities: Mapping[str, Intensity],
    samples: int,
    fit_share: str,
) -> dict[str, Any]:
    """Everything that a page shows of a validation (kind "validation")."""
    answers = _answers(store, wanted)
    fitted = [trial for trial in trials if trial.share == fit_share]
    scored = [trial for trial in trials if trial.share != fit_share] or list(trials)
    choices = {model.name: choose(fitted, answers[model.name]) for model in models}
    keys = {(job.model.name, job.trial.name, job.variant): job.key for job in wanted}
    return {
        "schema_version": SCHEMA_VERSION,
        "kind": "validation",
        "tests": len(trials),
        "bodies": len({trial.body for trial in trials}),
        "fit_share": {"name": fit_share, "tests": len(fitted)},
        "samples": samples,
        "unknown": sorted(_unknown(trials)),
        "unfitted": sorted(_unknown(trials)) if not fitted else [],
        "models": {
            model.name: {
                "engine": model.engine,
                "accuracy_rad": model.accuracy_rad,
                "dt_s": model.dt_s,
                **score_model(trials, scored, choices[model.name], answers[model.name], intensities, samples),
                "histories": _histories(store, trials, model, choices[model.name], keys),
            }
            for model in models
        },
        "pairs": score_pairs(trials, models, choices, answers),
        "observed": curves(trials, intensities, lambda trial: trial.fell),
        "baseline": score_baseline(fitted if len(scored) < len(trials) else [], scored, intensities),
        "rows": _rows(trials, models, choices, answers, intensities, samples),
    }


def _unknown(trials: Sequence[Trial]) -> set[str]:
    lists = (("azimuth_deg", "azimuths_deg"), ("friction", "frictions"))
    return {name for name, attribute in lists for trial in trials if len(getattr(trial, attribute)) > 1}


def _answers(store: Store, wanted: Sequence[Job]) -> dict[str, Answers]:
    found: dict[str, dict[tuple[str, Variant], Mapping[str, Any]]] = defaultdict(dict)
    for job in wanted:
        row = store.get(job.key)
        if row is None:
            raise InputError(Mistake(str(store.path), job.key, "the result of every run", "none", "run again"))
        found[job.model.name][job.trial.name, job.variant] = row.record
    return dict(found)


def _histories(
    store: Store, trials: Sequence[Trial], model: Model, choice: Choice, keys: Mapping[Any, str]
) -> list[dict[str, Any]]:
    """Scores against each measured history, which is a history like any other, up to where the run's own error is stated."""
    found: list[dict[str, Any]] = []
    for trial in trials:
        if trial.history is None:
            continue
        computed = store.run(keys[model.name, trial.name, choice.variant(trial)])
        if computed is None or computed.outcome.failed:
            found.append({"test": trial.name, "scores": None})
            continue
        scores = compare(computed, read_history(trial.history), names=(model.name, f"measured {trial.name}"))
        found.append({"test": trial.name, "scores": record.to_plain(scores)})
    return found


def _rows(
    trials: Sequence[Trial],
    models: Sequence[Model],
    choices: Mapping[str, Choice],
    answers: Mapping[str, Answers],
    intensities: Mapping[str, Intensity],
    samples: int,
) -> list[dict[str, Any]]:
    rows = []
    for trial in trials:
        shaking = intensities[trial.name]
        row: dict[str, Any] = {
            "test": trial.name,
            "body": Path(trial.body).name,
            "share": trial.share,
            "observed": trial.observed,
            "pga_g": shaking.pga_g,
            "pgv_m_s": shaking.pgv_m_s,
            "predicted": {},
            "probability": {},
        }
        for model in models:
            choice, known = choices[model.name], answers[model.name]
            row["predicted"][model.name] = known[trial.name, choice.variant(trial)]["outcome"]
            row["probability"][model.name] = probability(trial, choice, known, samples)
        rows.append(row)
    return rows
