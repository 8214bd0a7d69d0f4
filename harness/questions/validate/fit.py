"""What the table does not know, fitted for each model on the tests of one share by the likelihood of what was observed.

A test's probability of falling at one setting of the unknown inputs is the share of its draws there and nearby. What a body keeps
from day to day is weighed by the tests of all its days, what was set up by those of its day. How wide draws scatter, and how many
counts of either outcome are added to theirs, follows from how likely each test is by all the others of its body.
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.model import Array, grouped
from harness.questions.validate.jobs import Drawn
from harness.questions.validate.scenes import TrialVariant
from harness.questions.validate.table import OF_BODY, Inputs, Trial
from harness.records.study import CaseRun
from harness.records.validation import Fitted, FittedInput

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
        from scipy.stats.qmc import Halton

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
    from scipy.stats.qmc import LatinHypercube

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
            weight = float(weighed.weights[same].sum())
            told = list(best) if isinstance(best, tuple) else best
            rows.append(FittedInput(Path(body).name, day, name, told, weight, at_end))
    at_end = choice.log_score is not None and choice.width in (WIDTHS[0], WIDTHS[-1])
    return Fitted(choice.fitted_on, choice.log_score, choice.width, at_end, choice.counts, rows, choice.runs)
