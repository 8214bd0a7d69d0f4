"""What is not known of measured tests, fitted for each model on those of one share, and what the runs of models are worth."""

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats.qmc import Halton, LatinHypercube

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
from harness.questions.study.study_record import KeyedRow, score_sets
from harness.questions.validate.scenes import OF_BODY, Drawn, Inputs, Intensity, Model, Trial, TrialVariant, scene_of
from harness.records.base import same_fields
from harness.records.scores import Interval
from harness.records.study import CaseRun
from harness.records.validation import (
    BaselineRecord,
    BodyScores,
    ContourLine,
    ContourRecord,
    Curves,
    FallScores,
    Fitted,
    FittedInput,
    IntensityClass,
    MeasuredHistory,
    ModelRecord,
    PairScores,
    ProbabilityScores,
    Repeats,
)

# What the table does not know, fitted by the likelihood of what was observed.
#
# A test's probability of falling at one setting of the unknown inputs is the share of its draws there and nearby. What a body
# keeps from day to day is weighed by the tests of all its days, what was set up by those of its day. How wide draws scatter, and
# how many counts of either outcome are added to theirs, follows from how likely each test is by all the others of its body.

Answers = Mapping[tuple[str, TrialVariant], Drawn | CaseRun]
"""The runs of one model, by test and variant."""
Ask = Callable[[Sequence[tuple[Trial, TrialVariant]]], Answers]
"""Runs what is not known yet, and gives all answers so far."""

TRIED: Final = 64
"""Draws of each test in which a body's unknown inputs are tried, at other joint settings where there are so many, by at most"""
DRAWS: Final = 8
"""draws at one setting; they are the first so many of a test."""
NEAR: Final[Mapping[str, float]] = {"contact_tolerance_m": 2e-3, "inset_m": 2e-3, "friction": 0.05, "scale": 0.1}
"""Standard widths of the kernel by which an outcome at one value says something of another: what draws scatter by, or twice that.
Other inputs (a sign, a turn, a band) say nothing of each other. Of these a value at the end of its list says that the truth may
lie beyond."""
SETTINGS: Final = 500
"""Joint settings up to which all are weighed, those too that were not tried: of more only those that were."""
WIDTHS: Final = (0.5, 1.0, 2.0, 4.0)
"""Factors tried on the scatter of all draws, by at most"""
WIDTH_DRAWS: Final = 8
"""draws of each test: the share of its tests then says more of a width than its draws."""
COUNTS: Final = 0.25
"""Counts of either outcome that are added to those of the draws where nothing is fitted: what never fell in ten draws falls in
one of forty."""
COUNTS_TRIED: Final = np.geomspace(0.02, 5.0, 25)
OWN: Final = 2.0
"""How many bodies count as much as none of the others being alike, and"""
POOLINGS: Final = 3
"""rounds in which they hear of each other: the first already has most of it."""


@dataclass(frozen=True, eq=False)
class Weighed:
    """Settings of a body's unknown inputs, and how probable each is."""

    settings: Sequence[Inputs]
    weights: Array

    @property
    def best(self) -> Inputs:
        """The most probable one, the first of equals."""
        return self.settings[int(np.argmax(self.weights))]

    def drawn(self, count: int) -> list[Inputs]:
        """So many of them, each as often as it is probable, in an order that is no draw's scatter (`scenes.scene_of`)."""
        shares = Halton(1, scramble=False).random(count)[:, 0] + 0.5 / count
        places = np.searchsorted(np.cumsum(self.weights), np.mod(shares, 1.0) * self.weights.sum())
        return [self.settings[min(int(place), len(self.settings) - 1)] for place in places]


@dataclass(frozen=True, eq=False)
class FittedInputs:
    """How the unknown inputs of every test are taken: by body and day, and of a test of the share (`fitted_on`) by its name, as
    all other tests of its body say. Where nothing was fitted every value of a list is as probable as the others.
    """

    of_set_up: Mapping[tuple[str, str], Weighed] = field(default_factory=dict)
    of_others: Mapping[str, Weighed] = field(default_factory=dict)
    width: float = 1.0
    counts: float = COUNTS
    fitted_on: int = 0
    log_score: float | None = None
    runs: int = 0

    def nominal(self, trial: Trial) -> TrialVariant:
        """A test at the most probable values, its numerical error stated; at the first of each list where nothing is fitted."""
        known = self.of_set_up.get((trial.body, trial.day))
        return TrialVariant(trial.inputs(known.best if known else None), stated=True)

    def draws(self, trial: Trial, samples: int) -> list[TrialVariant]:
        """So many draws of a test."""
        if not samples:
            return []
        weighed = self.of_others.get(trial.name) or self.of_set_up.get((trial.body, trial.day))
        count = min(samples, WIDTH_DRAWS) if trial.name in self.of_others else samples
        settings = weighed.drawn(count) if weighed else designed(trial.unknown, count)
        return [TrialVariant(trial.inputs(each), k, self.width) for k, each in enumerate(settings, 1)]

    def probability(self, runs: Sequence[Drawn | CaseRun]) -> float | None:
        """That a test falls, by its draws; None where none says whether it did."""
        falls, known = counted(runs)
        return (falls + self.counts) / (known + 2.0 * self.counts) if known else None


def counted(runs: Sequence[Drawn | CaseRun]) -> tuple[int, int]:
    """How many fall, and of how many that is known."""
    falls = [fell for run in runs if (fell := run.outcome.fell) is not None]
    return sum(falls), len(falls)


def planned(trials: Sequence[Trial], share: Sequence[Trial], samples: int) -> int:
    """Runs of one model on tests of which those of the `share` are fitted on: as many, or few less where rows know more."""
    fitting = len(share) * len(WIDTHS) * min(samples, WIDTH_DRAWS)
    fitting += sum(len(own) * _count_tried(lists) for own, lists in _not_known(share).values())
    return fitting + len(trials) + (len(trials) - len(share)) * samples


def _count_tried(unknown: Mapping[str, Sequence[Any]]) -> int:
    """In how many draws a body's unknown inputs are tried: each setting in as many, where there is room for all."""
    count = _count(unknown)
    return min(DRAWS, TRIED // count) * count if count <= TRIED else TRIED


def _count(unknown: Mapping[str, Sequence[Any]]) -> int:
    """How many joint settings there are."""
    return math.prod(len(values) for values in unknown.values())


def choose(trials: Sequence[Trial], ask: Ask, samples: int) -> FittedInputs:
    """Fit the unknown inputs on these tests, and with draws their scatter too; only these tests are run."""
    if not trials:
        return FittedInputs()
    seen: set[tuple[str, TrialVariant]] = set()

    def asked(pairs: Sequence[tuple[Trial, TrialVariant]]) -> Answers:
        seen.update((trial.name, variant) for trial, variant in pairs)
        return ask(pairs)

    bodies = [_Body(own, lists) for own, lists in _not_known(trials).values()]
    answers = asked([pair for body in bodies for pair in body.pairs()])
    for body in bodies:
        body.hear(answers)
    # Each body takes the values that the others have as the likelier ones, by input: one laboratory's tests are alike. It is the
    # predictive of a Dirichlet prior as strong as `OWN` bodies that are all different, and nothing where there is one body.
    for _ in range(POOLINGS):
        shares = [body.marginals() for body in bodies]
        for k, body in enumerate(bodies):
            body.learn(shares[:k] + shares[k + 1 :])
    choice = FittedInputs(
        {place: each for body in bodies for place, each in body.set_ups().items()},
        {name: each for body in bodies for name, each in body.others().items()},
        fitted_on=len(trials),
    )
    known = {trial.name: Weighed([trial.inputs()], np.ones(1)) for trial in trials}
    choice = replace(choice, of_others={**known, **choice.of_others})
    if samples:
        choice = _scattered(choice, trials, asked, samples)
    return replace(choice, runs=len(seen))


def _scattered(choice: FittedInputs, trials: Sequence[Trial], ask: Ask, samples: int) -> FittedInputs:
    """The choice with the scatter and the added counts by which the tests, each as the others say, are likeliest."""
    wide = {width: replace(choice, width=width) for width in WIDTHS}
    pairs = {width: [(trial, each.draws(trial, samples)) for trial in trials] for width, each in wide.items()}
    answers = ask([(trial, variant) for drawn in pairs.values() for trial, all_ in drawn for variant in all_])
    tried: list[tuple[float, FittedInputs]] = []
    for width, drawn in pairs.items():
        seen = [(trial.fell, *counted([answers[trial.name, variant] for variant in all_])) for trial, all_ in drawn]
        fell, falls, known = np.array([each for each in seen if each[2]]).reshape(-1, 3).T
        for counts in COUNTS_TRIED.tolist() if len(known) else ():
            p = (falls + counts) / (known + 2.0 * counts)
            missed = -float(np.log(np.where(fell, p, 1.0 - p)).sum())
            # Few tests do not tell: as assumed within a factor of two and of e, for what they say against it.
            own = 0.5 * (math.log2(width) ** 2 + math.log(counts / COUNTS) ** 2)
            tried.append((missed + own, replace(wide[width], counts=counts, log_score=missed / len(known))))
    return min(tried, key=lambda each: each[0], default=(0.0, choice))[1]


def _not_known(trials: Sequence[Trial]) -> dict[str, tuple[Sequence[Trial], Mapping[str, Sequence[Any]]]]:
    """By body of which something is not known: its tests, and the lists of values in their rows."""
    by_body = grouped((trial.body, trial) for trial in trials)
    every = {body: {key: each for trial in own for key, each in trial.unknown.items()} for body, own in by_body.items()}
    return {body: (by_body[body], lists) for body, lists in every.items() if lists}


def designed(unknown: Mapping[str, Sequence[Any]], count: int) -> list[Inputs]:
    """So many joint settings of lists: all of them, over again where they are fewer, or different ones of seeded Latin
    hypercubes, in which every value of a list comes as often as the others.
    """
    if _count(unknown) <= count:
        every = [Inputs(**dict(zip(unknown, each, strict=True))) for each in itertools.product(*unknown.values())]
        return [every[k % len(every)] for k in range(count)]
    random, found, counts = np.random.default_rng(0), dict[Inputs, None](), [len(values) for values in unknown.values()]
    while len(found) < count:
        for row in (LatinHypercube(len(counts), rng=random).random(count) * counts).astype(int).tolist():
            found[Inputs(**{name: values[k] for (name, values), k in zip(unknown.items(), row, strict=True)})] = None
    return list(found)[:count]


Marginals = Mapping[tuple[str, Any], float]
"""The probability of each value, by input."""


class _Body:
    """The tests of the share of one body, and how likely each setting makes them."""

    def __init__(self, trials: Sequence[Trial], unknown: Mapping[str, Sequence[Any]]) -> None:
        self._trials, self._unknown = trials, unknown
        self._days = list(dict.fromkeys(trial.day for trial in trials))
        count = _count(unknown)
        self._tried = designed(unknown, _count_tried(unknown))
        self._drawn = [(trial, self._variants(trial, place, count)) for place, trial in enumerate(trials)]
        self._settings = designed(unknown, count) if count <= SETTINGS else self._tried
        self._likely = np.empty((0, 0))
        self._prior = np.zeros(len(self._settings))

    def _variants(self, trial: Trial, place: int, count: int) -> list[TrialVariant]:
        """A test at each of the settings that are tried.

        The draws of a setting are others in each test: shared, what one draw adds would be taken for what its setting does.
        """
        samples = (1 + (k // count + k % count + place) % DRAWS for k in range(len(self._tried)))
        return [TrialVariant(trial.inputs(each), sample) for each, sample in zip(self._tried, samples, strict=True)]

    def pairs(self) -> list[tuple[Trial, TrialVariant]]:
        """The runs that are wanted: of each test as many draws as settings are tried, each at one of them."""
        return [(trial, variant) for trial, variants in self._drawn for variant in variants]

    def hear(self, answers: Answers) -> None:
        """How likely (ln) each setting makes each test, (tests, settings): by what falls in the draws near it."""
        falls = np.array(
            [[answers[trial.name, each].outcome.fell for each in variants] for trial, variants in self._drawn],
            dtype=np.float64,
        )
        known, near = np.isfinite(falls), self._nearness()
        p = (np.nan_to_num(falls) @ near + COUNTS) / (known @ near + 2.0 * COUNTS)
        fell = np.array([trial.fell for trial in self._trials])
        self._likely = np.log(np.where(fell[:, None], p, 1.0 - p))

    def _nearness(self) -> Array:
        """What a run at each setting that was tried says of each that is weighed, (tried, settings)."""
        near = np.ones((len(self._tried), len(self._settings)))
        for name in self._unknown:
            tried, weighed = ([getattr(each, name) for each in items] for items in (self._tried, self._settings))
            if name in NEAR:
                near *= np.exp(-0.5 * (np.subtract.outer(tried, weighed) / NEAR[name]) ** 2)
            else:
                near *= np.array([[one == other for other in weighed] for one in tried])
        return near

    def learn(self, others: Sequence[Marginals]) -> None:
        """Take what the other bodies have of each value as the prior (ln, by setting)."""
        self._prior = np.zeros(len(self._settings))
        for name, values in self._unknown.items():
            seen = {value: sum(each.get((name, value), 0.0) for each in others) for value in values}
            self._prior += [math.log(OWN / len(values) + seen[getattr(each, name)]) for each in self._settings]

    def marginals(self) -> Marginals:
        """The mean over its days of what this body has of each value."""
        weights = np.mean([self._weighed(day, self._likely).weights for day in self._days], axis=0)
        each = zip(self._settings, weights.tolist(), strict=True)
        shares = grouped(((name, getattr(one, name)), weight) for one, weight in each for name in self._unknown)
        return {value: sum(of_value) for value, of_value in shares.items()}

    def _weighed(self, day: str, likely: Array) -> Weighed:
        """The settings as the tests say, of which all others of this day share what was set up, those of other days what the body
        keeps."""
        own = np.array([trial.day == day for trial in self._trials])
        kept = [tuple(getattr(each, name) for name in OF_BODY) for each in self._settings]
        logs = self._prior + likely[own].sum(axis=0)
        for other in self._days:
            if other != day:
                at = likely[[trial.day == other for trial in self._trials]].sum(axis=0)
                means = {each: np.logaddexp.reduce(at[[one == each for one in kept]]) for each in set(kept)}
                logs = logs + [means[each] - math.log(kept.count(each)) for each in kept]
        weights = np.exp(logs - logs.max())
        return Weighed(self._settings, weights / weights.sum())

    def set_ups(self) -> dict[tuple[str, str], Weighed]:
        """By body and day."""
        return {(self._trials[0].body, day): self._weighed(day, self._likely) for day in self._days}

    def others(self) -> dict[str, Weighed]:
        """By test, as all others say."""
        every = zip(self._trials, 1.0 - np.eye(len(self._trials)), strict=True)
        return {trial.name: self._weighed(trial.day, others[:, None] * self._likely) for trial, others in every}


def fitted(trials: Sequence[Trial], choice: FittedInputs) -> Fitted:
    """What was chosen, as values of the table."""
    rows, not_known = [], _not_known(trials)
    for (body, day), weighed in choice.of_set_up.items():
        for name, values in not_known[body][1].items():
            best = getattr(weighed.best, name)
            same = [getattr(each, name) == best for each in weighed.settings]
            numbers = [value for value in values if isinstance(value, float)]
            at_end = name in NEAR and len(numbers) > 2 and best in (min(numbers), max(numbers))
            told = list(best) if isinstance(best, tuple) else best
            rows.append(FittedInput(Path(body).name, day, name, told, float(weighed.weights[same].sum()), at_end))
    at_end = choice.log_score is not None and choice.width in (WIDTHS[0], WIDTHS[-1])
    return Fitted(choice.fitted_on, choice.log_score, choice.width, at_end, choice.counts, rows, choice.runs)


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
    return FallScores(**same_fields(FallScores, score_outcomes(cases)))


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
