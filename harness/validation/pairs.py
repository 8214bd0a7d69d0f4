"""The models of a validation beside each other: on which tests their outcomes differ, and why."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

from harness.records.validation import PairScores
from harness.studies.ensembles import score_sets
from harness.studies.rows import KeyedRow
from harness.validation.fit import Answers, Choice
from harness.validation.jobs import Model
from harness.validation.table import Trial


def score_pairs(
    trials: Sequence[Trial],
    models: Sequence[Model],
    choices: Mapping[str, Choice],
    answers: Mapping[str, Answers],
) -> list[PairScores]:
    """One entry for each two models, the later of the two against the earlier, over the tests that both answered.

    The verdicts take a numerical error that is not stated as zero. No histories are kept of a validation's runs: verdicts rest on
    the peaks and the times at which they are reached.
    """
    rows = {model.name: [_row(trial, model, choices, answers) for trial in trials] for model in models}
    pairs = []
    for b, a in itertools.combinations(rows, 2):
        scores = score_sets([*rows[b], *rows[a]], reference=b)[a]
        unstated = [
            name for name in (a, b) if any(row.run and row.run.numerical_uncertainty_rad is None for row in rows[name])
        ]
        pairs.append(PairScores(a=a, b=b, unstated=unstated, **vars(scores)))
    return pairs


def _row(trial: Trial, model: Model, choices: Mapping[str, Choice], answers: Mapping[str, Answers]) -> KeyedRow:
    run = answers[model.name][trial.name, choices[model.name].variant(trial)]
    return KeyedRow(number=trial.row, engine=model.name, reason="", varied={}, run=run, key=None)
