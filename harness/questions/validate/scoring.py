"""What the runs of a validation are worth against what was measured, and two models beside each other."""

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.comparison.comparator import COVERAGE
from harness.comparison.statistics import (
    FELL,
    Prediction,
    area_under_curve,
    brier,
    brier_skill,
    fit_fragility,
    probit,
    reliability,
    score_outcomes,
    wilson,
)
from harness.model import Array, Outcome, grouped
from harness.questions.study.case_blocks import KeyedRow
from harness.questions.study.study_record import score_sets
from harness.questions.validate.fit import Answers, FittedInputs, counted, fitted
from harness.questions.validate.jobs import Drawn, Model
from harness.questions.validate.scenes import Intensity, TrialVariant, scene_of
from harness.questions.validate.table import Trial
from harness.records.scores import Interval
from harness.records.study import CaseRun
from harness.records.validation import (
    BaselineRecord,
    BodyScores,
    ContourLine,
    ContourRecord,
    Curves,
    FallScores,
    IntensityClass,
    MeasuredHistory,
    ModelRecord,
    PairScores,
    ProbabilityScores,
    Repeats,
)

BINS: Final = 3
"""Intensity classes of equal numbers of tests: weak, middle, strong."""
LIKELIER: Final = 0.5
"""From this probability on a fall is the likelier outcome."""
JOINT_DRAWS: Final = 2000
"""Draws of the outcomes of all tests together, of which the bands of the reliability diagram are quantiles."""
LEAST_OF_BODY: Final = 5
"""Tests of a body from which its own threshold is learnt: with fewer one odd test moves it to any place."""


def case_of(trial: Trial, variant: TrialVariant, answer: CaseRun) -> Prediction:
    """Prediction and observation of one test, and whether the prediction flips within its own numerical error."""
    observed = FELL if trial.observed == FELL else Outcome(trial.observed)
    return Prediction(answer.outcome, observed, _flips(trial, variant, answer))


def _flips(trial: Trial, variant: TrialVariant, answer: CaseRun) -> bool:
    """A fall that is decided after the run's reliable time, or a stand with its peak within 2u of the balance point."""
    uncertainty, until = answer.numerical_uncertainty_rad, answer.reliable_until_s
    if uncertainty is None:
        return False
    no_return = answer.no_return_time_s
    if answer.outcome.overturned:
        return until is not None and no_return is not None and no_return > until
    peak_rad, share = answer.peak_theta_rad, answer.validity.get("peak_over_slenderness")
    # The analytic model says to which side it leant so far.
    statue = scene_of(trial, variant).statue
    balances_rad = [peak_rad / share] if share else [statue.slenderness_rad(side) for side in (1, -1)]
    return any(abs(each - peak_rad) <= COVERAGE * uncertainty for each in balances_rad)


@dataclass(frozen=True, eq=False)
class ModelAnswers:
    """One model's answers to all tests: what was chosen of the unknown inputs, every run, and `samples` draws of each test.

    Tests that are not `asked` (None: all are) are another model's, whose boundary is nowhere near.
    """

    model: Model
    choice: FittedInputs
    answers: Answers
    samples: int
    asked: frozenset[str] | None = None

    def run(self, trial: Trial) -> CaseRun:
        """The nominal run of a test."""
        run = self.answers[trial.name, self.choice.nominal(trial)]
        assert isinstance(run, CaseRun)
        return run

    def drawn(self, trial: Trial) -> list[Drawn | CaseRun]:
        """The draws of a test."""
        return [self.answers[trial.name, each] for each in self.choice.draws(trial, self.samples)]

    def disagrees(self, trial: Trial) -> bool:
        """Whether a test's runs end differently: it is near the boundary."""
        return len({run.outcome.fell for run in (self.run(trial), *self.drawn(trial))}) > 1

    def probability(self, trial: Trial) -> float | None:
        """That a test falls, by its draws; without any by its nominal run alone. None where none says whether it fell."""
        if not self.samples:
            fell = self.run(trial).outcome.fell
            return None if fell is None else float(fell)
        return self.choice.probability(self.drawn(trial))

    def possible(self, trials: Sequence[Trial]) -> NDArray[np.bool_]:
        """Outcomes of tests together, (`JOINT_DRAWS`, tests), each falling as often as its probability says.

        A draw takes one setting of what is not known of a set-up for all its tests; what is known is another in each test. The
        counts that are added to a test's draws fall or stand by chance.
        """
        random = np.random.default_rng(0)
        found = np.empty((JOINT_DRAWS, len(trials)), dtype=np.bool_)
        settings: dict[tuple[str, str], Array] = {}
        for column, trial in enumerate(trials):
            runs, place = self.drawn(trial), random.random(JOINT_DRAWS)
            if trial.unknown:
                place = settings.setdefault((trial.body, trial.day), place)
            fell = np.array([run.outcome.fell for run in runs], dtype=np.float64)
            falls, known = counted(runs)
            drawn = fell[(place * len(runs)).astype(int)]
            # Of draws that say nothing, and of the added counts.
            chance = np.where(np.isnan(drawn), falls / known, 0.5)
            added = random.random(JOINT_DRAWS) < 2.0 * self.choice.counts / (known + 2.0 * self.choice.counts)
            found[:, column] = np.where(added | np.isnan(drawn), random.random(JOINT_DRAWS) < chance, drawn == 1.0)
        return found


def score_model(
    trials: Sequence[Trial],
    scored: Sequence[Trial],
    answered: ModelAnswers,
    intensities: Mapping[str, Intensity],
    histories: Sequence[MeasuredHistory] = (),
) -> ModelRecord:
    """All scores of one model on the `scored` tests; curves are over all `trials`."""
    cases = {trial.name: case_of(trial, answered.choice.nominal(trial), answered.run(trial)) for trial in scored}
    sure = {trial: chance for trial in scored if (chance := answered.probability(trial)) is not None}
    seen = [trial.fell for trial in sure]
    possible = answered.possible(list(sure)) if answered.samples else None
    drawn = curves(trials, intensities, lambda trial: answered.run(trial).outcome.fell)
    samples, model = answered.samples, answered.model
    return ModelRecord(
        engine=model.engine,
        accuracy_rad=model.accuracy_rad,
        dt_s=model.dt_s,
        near=model.near,
        asked=None if answered.asked is None else len(answered.asked),
        histories=histories,
        tests=len(scored),
        failed=sum(answered.run(trial).outcome.failed for trial in scored),
        fitted=fitted(trials, answered.choice),
        outcomes=score_outcomes(list(cases.values())),
        by_probability=_of_falls([p >= LIKELIER for p in sure.values()], seen) if samples else None,
        probability=replace(score_probabilities(list(sure.values()), seen, possible), samples=samples),
        by_intensity=by_intensity(scored, intensities, lambda trial: _right(cases[trial.name])),
        by_body=_by_body(scored, cases, sure if samples else {}),
        **vars(drawn),
    )


def _by_body(
    scored: Sequence[Trial], cases: Mapping[str, Prediction], chances: Mapping[Trial, float]
) -> list[BodyScores]:
    """The scores of each body's tests, in the table's order."""
    found = []
    for own in grouped((trial.body, trial) for trial in scored).values():
        p = {trial: chances[trial] for trial in own if trial in chances}
        found.append(
            BodyScores(
                own[0].body_name,
                len(own),
                sum(trial.fell for trial in own),
                _share(_right(cases[trial.name]) for trial in own),
                _share((chance >= LIKELIER) == trial.fell for trial, chance in p.items()),
                brier(list(p.values()), [trial.fell for trial in p]) if p else None,
            )
        )
    return found


def _share(right: Iterable[bool | None]) -> Interval | None:
    """The share that is right, with Wilson's interval, of those of which it is known."""
    known = [each for each in right if each is not None]
    return wilson(sum(known), len(known))


def repeats_of(trials: Sequence[Trial]) -> Repeats | None:
    """What disagreeing repeats leave to the best of predictions; None where no test is repeated.

    Of n repeats of which k fell one probability is told: k/n is the best, and misses them by k (n − k)/n in all.
    """
    # What is not known of a set-up may differ from day to day.
    alike = [
        replace(each, name="", row=0, observed="", share="", day=each.day if each.unknown else "", history=None)
        for each in trials
    ]
    groups = grouped(zip(alike, [trial.fell for trial in trials], strict=True))
    again = [seen for seen in groups.values() if len(seen) > 1]
    if not again:
        return None
    wrong = sum(min(sum(seen), len(seen) - sum(seen)) for seen in again)
    spread = sum(sum(seen) * (len(seen) - sum(seen)) / len(seen) for seen in again)
    return Repeats(
        sum(map(len, again)), len(again), sum(len(set(seen)) > 1 for seen in again),
        1.0 - wrong / len(trials), spread / len(trials),
    )  # fmt: skip


def score_probabilities(
    p: Sequence[float], seen: Sequence[bool], possible: NDArray[np.bool_] | None = None
) -> ProbabilityScores:
    """Brier's score and skill, the area under the curve and the reliability diagram of probabilities of falling.

    Its bands are by `possible` outcomes of all tests together (draws, tests), where these are given.
    """
    if not p:
        return ProbabilityScores(0, None, None)
    skill = brier_skill(p, seen)
    return ProbabilityScores(
        len(p),
        brier(p, seen),
        None if math.isnan(skill) else skill,
        area=area_under_curve(p, seen),
        reliability=reliability(p, seen, possible=possible),
    )


def _of_falls(predicted: Sequence[bool], seen: Sequence[bool]) -> FallScores:
    """Scores of falls, whichever way."""
    cases = [
        Prediction(Outcome.OVERTURNED_RIGHT if fall else Outcome.STANDS, FELL if fell else Outcome.STANDS)
        for fall, fell in zip(predicted, seen, strict=True)
    ]
    scores = score_outcomes(cases)
    return FallScores(**{item.name: getattr(scores, item.name) for item in fields(FallScores)})


def _right(case: Prediction) -> bool | None:
    return None if not case.decided or case.within_uncertainty else case.predicted.overturned == case.fell


def by_intensity(
    trials: Sequence[Trial], intensities: Mapping[str, Intensity], right: Callable[[Trial], bool | None]
) -> list[IntensityClass]:
    """Accuracy in classes of PGV of equal size; tests of which nothing is known (None) are left out."""
    ordered = sorted(trials, key=lambda trial: intensities[trial.name].pgv_m_s)
    places = [part for part in np.array_split(np.arange(len(ordered)), BINS) if part.size]
    classes = [[ordered[int(k)] for k in part] for part in places]
    ends = [[intensities[trial.name].pgv_m_s for trial in (each[0], each[-1])] for each in classes]
    return [
        IntensityClass(low, high, len(each), _share(map(right, each)))
        for (low, high), each in zip(ends, classes, strict=True)
    ]


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
    curve = fit_fragility(pgv, fallen).curve(np.geomspace(pgv.min(), pgv.max(), CURVE_POINTS))
    return Curves(curve, contour(each, fallen))


def score_baseline(
    fitted_on: Sequence[Trial], scored: Sequence[Trial], intensities: Mapping[str, Intensity]
) -> BaselineRecord:
    """Each body's bare PGV threshold, and the probability by its PGV alone.

    Fitted on their own share, or where there is none for each test on all others; a body of fewer than `LEAST_OF_BODY` tests to
    learn from takes those of all bodies.
    """
    taught = fitted_on or scored
    apart = bool(fitted_on)
    predicted, likely = [], []
    for trial in scored:
        others = [each for each in taught if each is not trial] or [trial]
        own = [each for each in others if each.body == trial.body]
        pgv, fell = _intensity_and_fall(own if len(own) >= LEAST_OF_BODY else others, intensities)
        strength = intensities[trial.name].pgv_m_s
        predicted.append(bool(strength >= best_threshold(pgv, fell)))
        likely.append(float(chances(pgv, fell, [strength])[0]))
    seen = [trial.fell for trial in scored]
    right = {trial.name: said == trial.fell for trial, said in zip(scored, predicted, strict=True)}
    by_body = {trial.body: [each for each in taught if each.body == trial.body] for trial in scored}
    return BaselineRecord(
        rule="overturns when PGV reaches its body's threshold",
        threshold_m_s=best_threshold(*_intensity_and_fall(taught, intensities)),
        fitted_on="the named share" if apart else "all tests but the one that is predicted",
        outcomes=_of_falls(predicted, seen),
        probability=score_probabilities(likely, seen),
        by_intensity=by_intensity(scored, intensities, lambda trial: right[trial.name]),
        threshold_by_body_m_s={
            Path(body).name: best_threshold(*_intensity_and_fall(own, intensities))
            for body, own in by_body.items()
            if len(own) >= LEAST_OF_BODY
        },
    )


def _intensity_and_fall(
    trials: Sequence[Trial], intensities: Mapping[str, Intensity]
) -> tuple[list[float], list[bool]]:
    return [intensities[trial.name].pgv_m_s for trial in trials], [trial.fell for trial in trials]


def score_pairs(trials: Sequence[Trial], answered: Sequence[ModelAnswers]) -> list[PairScores]:
    """One entry for each two models, the later of the two against the earlier, over the tests that both were asked; none without.

    The verdicts take a numerical error that is not stated as zero. No histories are kept of a validation's runs: verdicts rest on
    the peaks and the times at which they are reached.
    """
    rows = {
        name: [
            KeyedRow(number=trial.row, engine=name, reason="", varied={}, run=item.run(trial), key=None)
            for trial in trials
            if item.asked is None or trial.name in item.asked
        ]
        for item in answered
        for name in [item.model.name]
    }
    pairs = []
    for b, a in itertools.combinations(rows, 2):
        if not {row.number for row in rows[a]} & {row.number for row in rows[b]}:
            continue
        scores = score_sets([*rows[b], *rows[a]], reference=b)[a]
        unstated = [
            name for name in (a, b) if any(row.run and row.run.numerical_uncertainty_rad is None for row in rows[name])
        ]
        pairs.append(PairScores(a=a, b=b, unstated=unstated, **vars(scores)))
    return pairs


# What needs no model: a bare PGV threshold and probability, and the fragility contour in PGA against PGV/PGA.

RIDGE: Final = 1e-6
"""Weight of the ridge that keeps the contour's Newton steps finite where the classes are separated: one case in a million."""
CURVE_POINTS: Final = 60
"""Points of every curve that a page draws."""


def best_threshold(intensity: ArrayLike, fell: ArrayLike) -> float:
    """The threshold t with the most cases (at least one) right under "falls when intensity ≥ t"; the lowest of equals."""
    x, y = np.asarray(intensity, dtype=np.float64), np.asarray(fell, dtype=np.bool_)
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    # With the threshold before case k, those below stand rightly and those from k on fall rightly.
    right = np.concatenate(([0], np.cumsum(~y))) + (y.sum() - np.concatenate(([0], np.cumsum(y))))
    # Equal intensities cannot be parted.
    right[1:-1][x[1:] == x[:-1]] = -1
    k = int(np.argmax(right))
    if k == 0:
        return float(x[0])
    return float(np.nextafter(x[-1], math.inf)) if k == x.size else float(0.5 * (x[k - 1] + x[k]))


def chances(intensity: ArrayLike, fell: ArrayLike, asked: ArrayLike) -> Array:
    """P(overturned) at the `asked` intensities by the lognormal curve fitted to the cases (`statistics.fit_fragility`).

    Where no rising curve fits (one outcome only, or no order in the intensity) it is the share of the cases that fell, after
    Laplace (fell + 1)/(cases + 2); a motion of no intensity overturns nothing.
    """
    x, y, at = (np.asarray(values, dtype=np.float64) for values in (intensity, fell, asked))
    shaken = x > 0.0
    p = np.full(at.shape, (y.sum() + 1.0) / (y.size + 2.0))
    if shaken.any():
        curve = fit_fragility(x[shaken], y[shaken])
        if curve.median is not None:
            p[at > 0.0] = curve.probability(at[at > 0.0])
    p[at <= 0.0] = 0.0
    return p


def contour(intensities: Sequence[Intensity], fell: Sequence[bool]) -> ContourRecord | None:
    """P(overturned) = Φ(c₀ + c₁ ln PGA + c₂ ln(PGV/PGA)), PGA in g and PGV/PGA in s, by maximum likelihood.

    `separated`: a line parts the cases that fell from those that stood; the likelihood then has no maximum, and the
    coefficients (from a ridge that keeps them finite) tell the line, not the spread. After Purvance, Anooshehpoor and Brune
    (Earthquake Engineering and Structural Dynamics 37, 2008). None where only one outcome occurs, or PGA does not raise the
    probability.
    """
    y = np.asarray(fell, dtype=np.float64)
    if y.size < 3 or y.sum() in (0, y.size):
        return None
    ratios = np.array([each.ratio_s for each in intensities])
    logs = np.log(np.column_stack(([each.pga_g for each in intensities], ratios)))
    middle = logs.mean(axis=0)
    design = np.column_stack((np.ones(y.size), logs - middle))
    beta, _ = probit(design, y, RIDGE)
    c1, c2 = float(beta[1]), float(beta[2])
    if c1 <= 0.0:
        return None
    coefficients = float(beta[0] - beta[1:] @ middle), c1, c2
    separated = bool(np.all((design @ beta > 0.0) == (y > 0.5)))
    asked = np.geomspace(ratios.min(), ratios.max(), CURVE_POINTS)
    # Where Φ is a half.
    pga_g = np.exp(-(coefficients[0] + c2 * np.log(asked)) / c1)
    return ContourRecord(y.size, int(y.sum()), coefficients, separated, ContourLine(asked.tolist(), pga_g.tolist()))
