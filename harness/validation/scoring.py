"""What the runs of a validation are worth against what was measured, by model and by intensity."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Final

import numpy as np

from harness.comparison.statistics import fragility
from harness.comparison.statistics.distributions import wilson
from harness.comparison.statistics.outcomes import FELL, Case, brier, brier_skill, score_outcomes
from harness.comparison.verdict import COVERAGE
from harness.model.history import Outcome
from harness.records.validation import (
    BaselineOutcomes,
    BaselineRecord,
    Curves,
    Fitted,
    IntensityClass,
    ModelScores,
    ProbabilityScores,
)
from harness.validation import baseline
from harness.validation.scenes import Intensity, Variant, scene_of
from harness.validation.table import Trial

BINS: Final = 3
"""Intensity classes of equal numbers of tests: weak, middle, strong."""
CURVE_POINTS: Final = 60
"""Points of every curve that a page draws."""

Answers = Mapping[tuple[str, Variant], Mapping[str, Any]]
"""Records of the runs of one model, by test and variant."""


@dataclass(frozen=True)
class Choice:
    """Which values of the unknown inputs are taken: one friction for all, one azimuth for each body (indices in the lists).

    `fitted_on` tests of the named share, with `accuracy` there; nothing was fitted where it is 0.
    """

    friction: int
    azimuths: Mapping[str, int]
    fitted_on: int
    accuracy: float | None

    def variant(self, trial: Trial, sample: int = 0) -> Variant:
        """The chosen variant of a test."""
        azimuth = self.azimuths.get(trial.body, 0) if len(trial.azimuths_deg) > 1 else 0
        return Variant(azimuth, self.friction if len(trial.frictions) > 1 else 0, sample)


def choose(trials: Sequence[Trial], answers: Answers) -> Choice:
    """Fit the unknown inputs on these tests: the most outcomes right, the first in the lists where several are as good."""

    def right(trial: Trial, azimuth: int, friction: int) -> bool:
        variant = Variant(azimuth, friction if len(trial.frictions) > 1 else 0)
        return Outcome(answers[trial.name, variant]["outcome"]).fell is trial.fell

    best = Choice(0, {}, 0, None)
    bodies = {body: list(group) for body, group in itertools.groupby(sorted(trials, key=_body), key=_body)}
    for friction in range(max((len(trial.frictions) for trial in trials), default=0)):
        azimuths, hits = {}, 0
        for body, group in bodies.items():
            counts = [
                sum(right(trial, index if len(trial.azimuths_deg) > 1 else 0, friction) for trial in group)
                for index in range(max(len(trial.azimuths_deg) for trial in group))
            ]
            azimuths[body] = int(np.argmax(counts))
            hits += max(counts)
        if best.accuracy is None or hits / len(trials) > best.accuracy:
            best = Choice(friction, azimuths, len(trials), hits / len(trials))
    return best


def _body(trial: Trial) -> str:
    return trial.body


def case_of(trial: Trial, variant: Variant, answer: Mapping[str, Any]) -> Case:
    """Prediction and observation of one test, and whether the prediction flips within its own numerical error."""
    observed = FELL if trial.observed == FELL else Outcome(trial.observed)
    return Case(Outcome(answer["outcome"]), observed, _flips(trial, variant, answer))


def _flips(trial: Trial, variant: Variant, answer: Mapping[str, Any]) -> bool:
    """A fall that is decided after the run's reliable time, or a stand with its peak within 2u of the balance point."""
    uncertainty, until = answer["numerical_uncertainty_rad"], answer["reliable_until_s"]
    if uncertainty is None:
        return False
    no_return = answer["no_return_time_s"]
    if Outcome(answer["outcome"]).overturned:
        return until is not None and no_return is not None and no_return > until
    statue = scene_of(trial, variant).statue
    margin = min(statue.slenderness_rad(side) for side in (1, -1)) - abs(answer["peak_theta_rad"])
    return bool(abs(margin) <= COVERAGE * uncertainty)


def probability(trial: Trial, choice: Choice, answers: Answers, samples: int) -> float | None:
    """Share of the nominal and perturbed runs that overturn, over those that say whether it fell; None: none does."""
    outcomes = [Outcome(answers[trial.name, choice.variant(trial, k)]["outcome"]) for k in range(samples + 1)]
    known = [outcome.fell for outcome in outcomes if outcome.fell is not None]
    return sum(known) / len(known) if known else None


def score_model(
    trials: Sequence[Trial],
    scored: Sequence[Trial],
    choice: Choice,
    answers: Answers,
    intensities: Mapping[str, Intensity],
    samples: int,
) -> ModelScores:
    """All scores of one model on the `scored` tests; curves are over all `trials`."""
    nominal = {trial.name: answers[trial.name, choice.variant(trial)] for trial in trials}
    cases = {trial.name: case_of(trial, choice.variant(trial), nominal[trial.name]) for trial in scored}
    chances = {trial.name: probability(trial, choice, answers, samples) for trial in scored}
    sure = [(chance, trial.fell) for trial in scored if (chance := chances[trial.name]) is not None]
    drawn = curves(trials, intensities, lambda trial: Outcome(nominal[trial.name]["outcome"]).fell)
    return ModelScores(
        tests=len(scored),
        failed=sum(Outcome(nominal[trial.name]["outcome"]).failed for trial in scored),
        fitted=_fitted(trials, choice),
        outcomes=score_outcomes(list(cases.values())),
        probability=replace(_brier([chance for chance, _ in sure], [fell for _, fell in sure]), samples=samples),
        by_intensity=by_intensity(scored, intensities, lambda trial: _right(cases[trial.name])),
        fragility_pgv=drawn.fragility_pgv,
        contour=drawn.contour,
    )


def _brier(p: Sequence[float], seen: Sequence[bool]) -> ProbabilityScores:
    known = len(p) > 0
    return ProbabilityScores(len(p), brier(p, seen) if known else None, brier_skill(p, seen) if known else None)


def _right(case: Case) -> bool | None:
    return None if not case.decided or case.within_uncertainty else case.predicted.overturned == case.fell


def _fitted(trials: Sequence[Trial], choice: Choice) -> Fitted:
    frictions = next((trial.frictions for trial in trials if len(trial.frictions) > 1), None)
    azimuths = next((trial.azimuths_deg for trial in trials if len(trial.azimuths_deg) > 1), None)
    return Fitted(
        choice.fitted_on,
        choice.accuracy,
        None if frictions is None else frictions[choice.friction],
        {} if azimuths is None else {body: azimuths[i] for body, i in choice.azimuths.items()},
    )


def by_intensity(
    trials: Sequence[Trial], intensities: Mapping[str, Intensity], right: Callable[[Trial], bool | None]
) -> list[IntensityClass]:
    """Accuracy in classes of PGV of equal size; tests of which nothing is known (None) are left out."""
    ordered = sorted(trials, key=lambda trial: intensities[trial.name].pgv_m_s)
    classes = []
    for part in np.array_split(np.arange(len(ordered)), BINS):
        group = [ordered[int(i)] for i in part]
        if group:
            known = [verdict for trial in group if (verdict := right(trial)) is not None]
            low, high = (intensities[trial.name].pgv_m_s for trial in (group[0], group[-1]))
            classes.append(IntensityClass(low, high, len(group), wilson(sum(known), len(known))))
    return classes


def curves(
    trials: Sequence[Trial], intensities: Mapping[str, Intensity], fell: Callable[[Trial], bool | None]
) -> Curves:
    """Fragility in PGV with its band, and the contour in PGA against PGV/PGA, of what is predicted or observed.

    Tests of which it is not known whether the body fell (None) are left out.
    """
    known = {
        trial: fall for trial in trials if intensities[trial.name].pga_g > 0.0 and (fall := fell(trial)) is not None
    }
    if not known:
        return Curves(None, None)
    each, fallen = [intensities[trial.name] for trial in known], list(known.values())
    pgv = np.array([one.pgv_m_s for one in each])
    ratio = np.array([one.ratio_s for one in each])
    contour = baseline.contour(each, fallen)
    return Curves(
        fragility.fit(pgv, fallen).curve(np.geomspace(pgv.min(), pgv.max(), CURVE_POINTS)),
        None if contour is None else contour.record(np.geomspace(ratio.min(), ratio.max(), CURVE_POINTS)),
    )


def score_baseline(
    fitted: Sequence[Trial], scored: Sequence[Trial], intensities: Mapping[str, Intensity]
) -> BaselineRecord:
    """The bare PGV threshold, and the probability by PGV alone.

    Fitted on their own share, or where there is none for each test on all others.
    """
    pgv = np.array([intensities[trial.name].pgv_m_s for trial in scored])
    seen = np.array([trial.fell for trial in scored], dtype=np.bool_)
    apart = bool(fitted) and len(fitted) < len(scored) + len(fitted) and fitted[0] not in scored
    if apart:
        on = np.array([intensities[trial.name].pgv_m_s for trial in fitted])
        taught = [trial.fell for trial in fitted]
        threshold = baseline.best_threshold(on, taught)
        predicted, likely = pgv >= threshold, baseline.chances(on, taught, pgv)
    elif pgv.size > 1:
        threshold = baseline.best_threshold(pgv, seen)
        predicted, likely = baseline.leave_one_out(pgv, seen), baseline.chances_left_out(pgv, seen)
    else:
        threshold = baseline.best_threshold(pgv, seen)
        predicted, likely = pgv >= threshold, np.full(1, 0.5)
    cases = [
        Case(Outcome.OVERTURNED_RIGHT if fall else Outcome.STANDS, FELL if fell else Outcome.STANDS)
        for fall, fell in zip(predicted, seen, strict=True)
    ]
    scores = score_outcomes(cases)
    right = dict(zip((trial.name for trial in scored), (predicted == seen).tolist(), strict=True))
    return BaselineRecord(
        rule="overturns when PGV reaches the threshold",
        threshold_m_s=threshold,
        fitted_on="the named share" if apart else "all tests but the one that is predicted",
        outcomes=BaselineOutcomes(**{item.name: getattr(scores, item.name) for item in fields(BaselineOutcomes)}),
        probability=_brier(likely.tolist(), seen.tolist()),
        by_intensity=by_intensity(scored, intensities, lambda trial: right[trial.name]),
    )
