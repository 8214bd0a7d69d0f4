"""What the table does not know, fitted for each model on the tests of one share: one friction for all, the rest by body."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from harness.records.study import CaseRun
from harness.records.validation import Fitted
from harness.validation.scenes import INPUTS, Variant
from harness.validation.table import UNKNOWN, Trial

Answers = Mapping[tuple[str, Variant], CaseRun]
"""The runs of one model, by test and variant."""
Ask = Callable[[Sequence[tuple[Trial, Variant]]], Answers]
"""Runs what is not known yet, and gives all answers so far."""

OF_BODY: Final[Mapping[str, str]] = {name: column for name, column in INPUTS.items() if name != "friction"}
"""What each body has of its own: the field of a variant, and the table's column."""
DESIGN: Final = 16
"""Joint settings of a body's own inputs that are tried with each friction: what a few tests of one share can tell apart."""
STARTS: Final = 2
"""Of the designed choices, those that are refined: the best, and one more where it was so by chance."""
PASSES: Final = 4
"""Passes over the unknown inputs; a choice that one pass leaves as it was is the last."""


@dataclass(frozen=True)
class Choice:
    """Which values of the unknown inputs are taken: one friction for all, the others by body (indices in the lists).

    `fitted_on` tests of the named share, with `accuracy` there; nothing was fitted where it is 0.
    """

    friction: int = 0
    bodies: Mapping[str, Variant] = field(default_factory=dict)
    fitted_on: int = 0
    accuracy: float | None = None
    runs: int = 0

    def variant(self, trial: Trial, sample: int = 0) -> Variant:
        """The chosen variant of a test; what its row knows stays as it says."""
        own = self.bodies.get(trial.body, Variant())
        known = {name: getattr(own, name) if _count(trial, name) > 1 else 0 for name in OF_BODY}
        return Variant(friction=self.friction if len(trial.frictions) > 1 else 0, sample=sample, **known)

    def with_body(self, body: str, **values: int) -> Choice:
        """The choice with other values of one body."""
        return replace(self, bodies={**self.bodies, body: replace(self.bodies.get(body, Variant()), **values)})


def _count(trial: Trial, name: str) -> int:
    return len(getattr(trial, UNKNOWN[OF_BODY[name]]))


def choose(trials: Sequence[Trial], ask: Ask) -> Choice:
    """Fit the unknown inputs on these tests: the most outcomes right, the first in the lists where several are as good.

    All inputs together first: with each friction every body has its best of a design of joint settings. From the best of these
    one input after another with the others held, until a pass changes nothing. Only these tests are run, and of joint settings
    no more than the design's for each friction.
    """
    if not trials:
        return Choice()
    asked = _Asked(trials, ask)

    def right(choice: Choice) -> int:
        return asked.right(choice, trials)

    designed = _designed(Choice(fitted_on=len(trials)), asked)
    # Sorting keeps the order of equals: the first friction of the list where several are as good.
    starts = sorted(designed, key=right, reverse=True)[:STARTS]
    choice = max((_refined(start, asked) for start in starts), key=right)
    return replace(choice, accuracy=right(choice) / len(trials), runs=asked.runs)


def _refined(choice: Choice, asked: _Asked) -> Choice:
    """One input after another, azimuth together with the friction first."""
    for _ in range(PASSES):
        before = choice
        choice = _with_friction(choice, asked)
        for name in ("tolerance", "inset", "azimuth"):
            choice = _input_by_body(choice, name, asked)
        if choice == before:
            break
    return choice


def _designed(choice: Choice, asked: _Asked) -> list[Choice]:
    """A choice for each friction, in which every body has its best of the joint settings of its own inputs."""
    settings = {body: design(counts) for body, counts in asked.counts.items()}
    return [_by_body(replace(choice, friction=k), settings, asked) for k in range(asked.frictions)]


def design(counts: Mapping[str, int]) -> list[dict[str, int]]:
    """Joint settings (an index by input) of lists of these lengths: all where they are few, else the first and a seeded Latin
    hypercube, in which every value of a list comes as often as the others.
    """
    if math.prod(counts.values()) <= DESIGN:
        return [dict(zip(counts, each, strict=True)) for each in itertools.product(*map(range, counts.values()))]
    from scipy.stats.qmc import LatinHypercube

    points = LatinHypercube(len(counts), rng=0).random(DESIGN - 1) * list(counts.values())
    rows = [[0] * len(counts), *points.astype(int).tolist()]
    return [dict(zip(counts, each, strict=True)) for each in dict.fromkeys(map(tuple, rows))]


class _Asked:
    """The tests of the share by body, and how many of them a choice gets right; counts runs of unknown inputs."""

    def __init__(self, trials: Sequence[Trial], ask: Ask) -> None:
        self.trials, self._ask, self._seen = trials, ask, set[tuple[str, Variant]]()
        self.bodies = {
            body: list(group)
            for body, group in itertools.groupby(sorted(trials, key=lambda trial: trial.body), lambda trial: trial.body)
        }
        self.counts = {
            body: {name: max(_count(trial, name) for trial in group) for name in OF_BODY}
            for body, group in self.bodies.items()
        }
        self.frictions = max(len(trial.frictions) for trial in trials)

    @property
    def runs(self) -> int:
        """Runs that the fit has asked for."""
        return len(self._seen)

    def best(self, choices: Sequence[Choice], trials: Sequence[Trial]) -> Choice:
        """The choice with which most of these tests come out as observed, the first of equals."""
        # All at once, so that all workers have something to do.
        self._answers([(trial, choice.variant(trial)) for choice in choices for trial in trials])
        return max(choices, key=lambda choice: self.right(choice, trials))

    def right(self, choice: Choice, trials: Sequence[Trial]) -> int:
        """How many of these tests come out as observed."""
        pairs = [(trial, choice.variant(trial)) for trial in trials]
        answers = self._answers(pairs)
        return sum(answers[trial.name, variant].outcome.fell is trial.fell for trial, variant in pairs)

    def _answers(self, pairs: Sequence[tuple[Trial, Variant]]) -> Answers:
        self._seen.update((trial.name, variant) for trial, variant in pairs)
        return self._ask(pairs)


def _with_friction(choice: Choice, asked: _Asked) -> Choice:
    """The common friction with which, each body's azimuth at its best, most tests are right."""
    if asked.frictions == 1:
        return choice
    turned = [_input_by_body(replace(choice, friction=k), "azimuth", asked) for k in range(asked.frictions)]
    return asked.best(turned, asked.trials)


def _input_by_body(choice: Choice, name: str, asked: _Asked) -> Choice:
    """Each body's best value of one input, the others held."""
    return _by_body(choice, {body: [{name: k} for k in range(n[name])] for body, n in asked.counts.items()}, asked)


def _by_body(choice: Choice, settings: Mapping[str, Sequence[Mapping[str, int]]], asked: _Asked) -> Choice:
    """The choice with each body's best of its settings; one body's say nothing of another's tests."""
    for body, group in asked.bodies.items():
        values = [choice.with_body(body, **setting) for setting in settings[body]]
        if len(values) > 1:
            choice = asked.best(values, group)
    return choice


def fitted(trials: Sequence[Trial], choice: Choice) -> Fitted:
    """What was chosen, as values of the table."""
    by_column = {
        column: {
            trial.body: getattr(trial, UNKNOWN[column])[getattr(choice.bodies[trial.body], name)]
            for trial in trials
            if trial.body in choice.bodies and _count(trial, name) > 1
        }
        for name, column in OF_BODY.items()
    }
    frictions = next((trial.frictions for trial in trials if len(trial.frictions) > 1), None)
    return Fitted(
        choice.fitted_on,
        choice.accuracy,
        None if frictions is None else frictions[choice.friction],
        **by_column,
        runs=choice.runs,
    )
