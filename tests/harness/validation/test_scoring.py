"""Scores of a validation from given answers: fitting, probabilities, classes of intensity, the baseline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.comparison.statistics.outcomes import FELL
from harness.model.history import Outcome
from harness.records.study import CaseRun
from harness.validation.fit import DESIGN, Choice, choose, design
from harness.validation.jobs import parse_model
from harness.validation.motions import Intensity
from harness.validation.scenes import GRAVITY_M_S2, Variant
from harness.validation.scoring import Answered, by_intensity, case_of, curves, score_baseline, score_model
from harness.validation.table import Trial, read_table
from tests import doubles
from tests.harness.validation.experiments import write_experiments

STANDS, FALLS = Outcome.STANDS.value, Outcome.OVERTURNED_RIGHT


def trial(name: str, fell: bool, *, body: str = "a", azimuths: int = 1, frictions: int = 1) -> Trial:
    return Trial(
        name,
        1,
        FELL if fell else STANDS,
        mesh=Path(body),
        azimuths_deg=tuple(30.0 * k for k in range(azimuths)),
        frictions=tuple(0.2 * (k + 1) for k in range(frictions)),
    )


def answer(fell: bool, **fields: Any) -> CaseRun:
    return doubles.case_run(**{"outcome": FALLS if fell else Outcome.STANDS} | fields)


def test_each_body_s_azimuth_and_the_common_friction_are_fitted() -> None:
    """Body a is right at azimuth 1, body b at azimuth 0, both with friction 1 only."""
    trials = [
        trial(f"{body}{k}", k % 2 == 0, body=body, azimuths=2, frictions=2) for body in ("a", "b") for k in range(4)
    ]
    right = {"a": 1, "b": 0}
    answers = {
        (each.name, Variant(azimuth, friction)): answer(
            each.fell if (azimuth == right[each.body] and friction == 1) else not each.fell
        )
        for each in trials
        for azimuth in (0, 1)
        for friction in (0, 1)
    }
    found = choose(trials, lambda pairs: answers)
    assert found == Choice(1, {"a": Variant(1), "b": Variant(0)}, 8, 1.0, runs=32)
    assert found.variant(trials[0]) == Variant(1, 1)
    assert found.variant(trial("known", True)) == Variant(0, 0)
    assert choose([], lambda pairs: {}) == Choice(0, {}, 0, None)


def test_probability_is_the_share_of_runs_that_fall_and_failures_do_not_count() -> None:
    one = trial("t", True)
    outcomes = [answer(True), answer(False), answer(True), answer(True), answer(True, outcome=Outcome.CRASHED)]
    answers = {(one.name, Variant(sample=k)): outcome for k, outcome in enumerate(outcomes)}
    model, choice = parse_model("analytic"), Choice(0, {}, 0, None)
    assert Answered(model, choice, answers, 4).probability(one) == 0.75
    outcomes[1] = answer(True, outcome=Outcome.UNDECIDED)
    answers = {(one.name, Variant(sample=k)): outcome for k, outcome in enumerate(outcomes)}
    assert Answered(model, choice, answers, 4).probability(one) == 1.0
    crashed = {(one.name, Variant()): answer(True, outcome=Outcome.CRASHED)}
    assert Answered(model, choice, crashed, 0).probability(one) is None


@pytest.mark.parametrize(
    ("fields", "flips"),
    [
        ({"numerical_uncertainty_rad": None}, False),
        ({"numerical_uncertainty_rad": 1e-3, "reliable_until_s": 2.0, "no_return_time_s": 2.5}, True),
        ({"numerical_uncertainty_rad": 1e-3, "reliable_until_s": 3.0, "no_return_time_s": 2.5}, False),
    ],
)
def test_a_fall_decided_after_the_reliable_time_flips(fields: dict[str, Any], flips: bool) -> None:
    assert case_of(trial("t", True), Variant(), answer(True, **fields)).within_uncertainty is flips


@pytest.mark.parametrize(("below", "flips"), [(1.9, True), (2.1, False)])
def test_a_stand_within_twice_the_uncertainty_of_the_balance_point_flips(
    tmp_path: Path, below: float, flips: bool
) -> None:
    one = read_table(write_experiments(tmp_path, [3.0]))[0]
    from harness.validation.scenes import scene_of

    statue = scene_of(one, Variant()).statue
    limit = min(statue.slenderness_rad(1), statue.slenderness_rad(-1))
    run = answer(False, numerical_uncertainty_rad=1e-3, peak_theta_rad=limit - below * 1e-3)
    assert case_of(one, Variant(), run).within_uncertainty is flips


def test_classes_of_intensity_are_of_equal_size() -> None:
    trials = [trial(f"t{k}", k > 4) for k in range(9)]
    shaking = {each.name: Intensity(0.1, 0.1 * (k + 1)) for k, each in enumerate(trials)}
    found = by_intensity(trials, shaking, lambda each: each.name != "t4")
    assert [(row.tests, row.accuracy and row.accuracy.value) for row in found] == [
        (3, 1.0),
        (3, pytest.approx(2 / 3)),
        (3, 1.0),
    ]
    assert found[0].pgv_to_m_s < found[1].pgv_from_m_s


def test_a_model_is_scored_whole() -> None:
    trials = [trial(f"t{k}", k >= 6) for k in range(12)]
    # One wrong of twelve: the strongest that stood is said to fall, in half of its runs.
    shaking = {each.name: Intensity(0.1 * (k + 1), 0.01 * (k + 1) * GRAVITY_M_S2) for k, each in enumerate(trials)}
    answers: dict[tuple[str, Variant], CaseRun] = {}
    for k, each in enumerate(trials):
        answers[each.name, Variant()] = answer(k >= 5)
        answers[each.name, Variant(sample=1)] = answer(k >= 6)
    found = score_model(trials, trials, Answered(parse_model("analytic"), Choice(0, {}, 0, None), answers, 1), shaking)
    assert found.outcomes.accuracy is not None
    assert found.outcomes.accuracy.value == pytest.approx(11 / 12)
    assert found.outcomes.confusion["stands"]["overturned_right"] == 1
    assert found.probability.brier == pytest.approx(0.25 / 12)
    # At P = 1/2 a fall is said: the same test is wrong. Above it all that fell, below it all that stood.
    assert found.by_probability is not None
    assert found.by_probability.accuracy is not None
    assert found.by_probability.accuracy.value == pytest.approx(11 / 12)
    assert found.probability.area is not None
    assert found.probability.area.value == 1.0
    assert [(item.cases, item.fell.value) for item in found.probability.reliability] == [(5, 0.0), (1, 0.0), (6, 1.0)]
    assert found.fragility_pgv is not None
    assert found.fragility_pgv.separated
    assert found.contour is not None
    assert found.failed == 0


def test_the_baseline_is_fitted_on_its_share_or_on_the_others() -> None:
    trials = [trial(f"t{k}", k >= 6) for k in range(12)]
    # The strongest that stood is just below the middle of its neighbours.
    shaking = {each.name: Intensity(0.1, 0.1 * (k + 1) - 0.01 * (k == 5)) for k, each in enumerate(trials)}
    apart = score_baseline(trials[::2], trials[1::2], shaking)
    assert apart.threshold_m_s == pytest.approx(0.6)
    assert apart.outcomes.accuracy is not None
    assert apart.outcomes.accuracy.value == 1.0
    alone = score_baseline([], trials, shaking)
    assert "all tests but" in alone.fitted_on
    # Left out, the weakest that fell leaves a threshold halfway between 0.59 and 0.8, just below its 0.7.
    assert alone.outcomes.accuracy is not None
    assert alone.outcomes.accuracy.value == 1.0


def test_each_body_has_its_own_threshold() -> None:
    """Stone a falls from 0.3, stone b from 0.8: no one threshold is right of both."""
    strengths = [0.1 * (k + 1) for k in range(12)]
    trials = [
        trial(f"{body}{k}", v >= limit, body=body)
        for body, limit in (("a", 0.25), ("b", 0.75))
        for k, v in enumerate(strengths)
    ]
    shaking = {each.name: Intensity(0.1, strengths[int(each.name[1:])]) for each in trials}
    found = score_baseline([], trials, shaking)
    assert found.threshold_by_body_m_s == {"a": pytest.approx(0.25), "b": pytest.approx(0.75)}
    assert found.outcomes.accuracy is not None
    # But for the two beside each threshold: without itself a test is predicted by the middle of its neighbours.
    assert found.outcomes.accuracy.value == pytest.approx(22 / 24)
    together = sum((shaking[each.name].pgv_m_s >= found.threshold_m_s) == each.fell for each in trials)
    assert together < 22


def test_no_test_helps_to_predict_itself() -> None:
    """A lone faller among the weak is not predicted by itself, nor by its own probability."""
    trials = [trial(f"t{k}", k in (0, 6, 7, 8)) for k in range(9)]
    shaking = {each.name: Intensity(0.1, 0.1 * (k + 1)) for k, each in enumerate(trials)}
    found = score_baseline([], trials, shaking)
    assert found.outcomes.recall is not None
    assert found.outcomes.recall.value == pytest.approx(3 / 4)
    others = score_baseline(trials[1:], trials[:1], shaking)
    assert others.probability.brier is not None
    assert others.probability.brier > 0.5


def test_inputs_that_explain_the_tests_together_alone_are_fitted() -> None:
    """Only tolerance 1 with inset 1 is right: of each alone no change is better, so that one after another stays at the first."""
    tests = [replace(trial(f"t{k}", True), contact_tolerances_m=(1e-3, 2e-3), insets_m=(0.0, 0.01)) for k in range(3)]

    def ask(pairs: Sequence[tuple[Trial, Variant]]) -> dict[tuple[str, Variant], CaseRun]:
        return {(each.name, one): answer(one.tolerance == one.inset == 1) for each, one in pairs}

    found = choose(tests, ask)
    assert found.bodies["a"] == Variant(tolerance=1, inset=1)
    assert (found.accuracy, found.runs) == (1.0, 12)


def test_a_design_of_many_inputs_is_small_and_holds_every_value() -> None:
    counts = {"azimuth": 9, "tolerance": 3, "inset": 4}
    rows = design(counts)
    assert rows[0] == dict.fromkeys(counts, 0)
    assert len(rows) <= DESIGN
    assert all({row[name] for row in rows} == set(range(count)) for name, count in counts.items())
    assert len(design({"azimuth": 4, "tolerance": 4})) == DESIGN


def test_what_is_undecided_counts_neither_as_standing_nor_as_fallen() -> None:
    undecided = answer(True, outcome=Outcome.UNDECIDED)
    trials = [trial("stood", False, azimuths=2), trial("fell", True, azimuths=2)]
    answers = {(each.name, Variant(0)): undecided for each in trials}
    answers |= {(each.name, Variant(1)): answer(each.name == "fell") for each in trials}
    assert choose(trials, lambda pairs: answers) == Choice(0, {"a": Variant(1)}, 2, 1.0, runs=4)
    shaken = {each.name: Intensity(0.3, 0.2 * (k + 1)) for k, each in enumerate(trials)}
    assert curves(trials, shaken, lambda each: None).fragility_pgv is None
