"""Scores of a validation from given answers: fits, probabilities, classes of intensity; and what needs no model."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from scipy import stats

from harness.comparison.statistics import FELL
from harness.model import Outcome
from harness.questions.validate import scoring
from harness.questions.validate.scenes import (
    GRAVITY_M_S2,
    Inputs,
    Intensity,
    Trial,
    TrialVariant,
    parse_model,
    read_table,
)
from harness.questions.validate.scoring import (
    COUNTS,
    DRAWS,
    NEAR,
    OWN,
    TRIED,
    WIDTH_DRAWS,
    WIDTHS,
    Answers,
    Ask,
    FittedInputs,
    ModelAnswers,
    best_threshold,
    by_intensity,
    case_of,
    chances,
    choose,
    contour,
    curves,
    designed,
    fitted,
    planned,
    repeats_of,
    score_baseline,
    score_model,
)
from harness.records.study import CaseRun
from tests import doubles
from tests.budgets_compare import QUANTILE_SE
from tests.harness.questions.validate.experiments import listing, variant, write_experiments
from tests.scenes_for_tests import paestum

STANDS, FALLS = Outcome.STANDS.value, Outcome.OVERTURNED_RIGHT


def trial(name: str, fell: bool, *, body: str = "a", **columns: Any) -> Trial:
    lists = {name: columns.pop(name) for name in vars(Inputs()) if name in columns}
    return listing(Trial(name, 1, FELL if fell else STANDS, mesh=Path(body), **columns), **lists)


def answer(fell: bool, **fields: Any) -> CaseRun:
    return doubles.case_run(**{"outcome": FALLS if fell else Outcome.STANDS} | fields)


def says(right: Callable[[Trial, Inputs], bool]) -> Ask:
    """A model that is right in each draw of a test at the inputs that are said to be."""
    return answering(lambda each, one: answer(each.fell == right(each, one.inputs)))


def answering(of: Callable[[Trial, TrialVariant], CaseRun]) -> Ask:
    """Gives all answers so far."""
    answers: dict[tuple[str, TrialVariant], CaseRun] = {}

    def ask(pairs: Sequence[tuple[Trial, TrialVariant]]) -> Answers:
        answers.update({(each.name, one): of(each, one) for each, one in pairs})
        return answers

    return ask


LISTS: Final = {"azimuth_deg": (0.0, 30.0), "friction": (0.2, 0.4)}


def test_each_body_s_own_inputs_are_fitted() -> None:
    """Body a is right at 30° with a friction of 0.4, body b at 0° with 0.2."""
    truth = {"a": Inputs(azimuth_deg=30.0, friction=0.4), "b": Inputs(azimuth_deg=0.0, friction=0.2)}
    trials = [trial(f"{body}{k}", k % 2 == 0, body=body, **LISTS) for body in ("a", "b") for k in range(4)]
    found = choose(trials, says(lambda each, inputs: inputs == truth[each.body]), 0)
    assert {body: weighed.best for (body, _), weighed in found.of_set_up.items()} == truth
    # Four settings of eight tests.
    assert (found.fitted_on, found.runs, found.width) == (8, 4 * 4 * 2 * DRAWS, 1.0)
    known = trial("known", True, friction=(0.7,))
    assert found.nominal(known) == TrialVariant(Inputs(friction=0.7), stated=True)
    assert choose([], says(lambda each, inputs: True), 0).fitted_on == 0


def test_the_likelihood_weighs_what_the_tests_tell_apart_and_no_more() -> None:
    """Friction changes no outcome: both values stay as probable, and draws take both; the azimuth is as good as known."""
    trials = [trial(f"a{k}", k % 2 == 0, **LISTS) for k in range(8)]
    found = choose(trials, says(lambda each, inputs: inputs.azimuth_deg == 30.0), 0)
    rows = {each.input: each for each in fitted(trials, found).inputs}
    assert rows["friction"].weight == pytest.approx(0.5)
    assert (rows["azimuth_deg"].value, rows["azimuth_deg"].weight) == (30.0, pytest.approx(1.0, abs=1e-6))
    drawn = [each.inputs for each in found.draws(trial("other", True, **LISTS), 10)]
    assert {each.azimuth_deg for each in drawn} == {30.0}
    assert [each.friction for each in drawn].count(0.2) == 5


def test_a_body_of_which_little_is_known_is_taken_as_the_others_are() -> None:
    """Bodies a and b are worn, of c one test says nothing: OWN/2 + 2 against OWN/2."""
    lists = {"inset_m": (0.0, 0.01)}
    trials = [trial(f"{body}{k}", True, body=body, **lists) for body in "ab" for k in range(12)]
    trials.append(trial("c0", True, body="c", **lists))
    found = choose(trials, says(lambda each, inputs: each.body == "c" or inputs.inset_m == 0.01), 0)
    worn = (0.5 * OWN + 2.0) / (OWN + 2.0)
    assert found.of_set_up["c", ""].best.inset_m == 0.01
    assert found.of_set_up["c", ""].weights.max() == pytest.approx(worn, abs=1e-3)


def test_a_test_of_the_share_is_drawn_as_all_others_say() -> None:
    """One test alone tells the two apart: to itself both are as probable."""
    trials = [trial(f"a{k}", True, inset_m=(0.0, 0.01)) for k in range(3)]
    found = choose(trials, says(lambda each, inputs: each.name != "a0" or inputs.inset_m > 0.0), 0)
    assert found.of_set_up["a", ""].best.inset_m == 0.01
    assert found.of_others["a0"].weights == pytest.approx([0.5, 0.5])
    assert found.of_others["a1"].best.inset_m == 0.01


def test_days_share_what_the_body_keeps_and_have_their_own_set_up() -> None:
    """The worn edge is told by the second day alone; the sign changes from day to day."""
    lists = {"inset_m": (0.0, 0.01), "sign": (1, -1)}
    signs = {"one": -1, "two": 1}
    trials = [trial(f"{day}{k}", True, day=day, **lists) for day in signs for k in range(6)]

    def right(each: Trial, inputs: Inputs) -> bool:
        return inputs.sign == signs[each.day] and (each.day == "one" or inputs.inset_m == 0.01)

    found = choose(trials, says(right), 0)
    assert {day: weighed.best for (_, day), weighed in found.of_set_up.items()} == {
        day: Inputs(inset_m=0.01, sign=sign) for day, sign in signs.items()
    }
    assert all(weighed.weights.max() > 0.99 for weighed in found.of_set_up.values())


@pytest.mark.parametrize(("inset_m", "warned"), [(0.0, True), (0.01, False), (0.02, True)])
def test_a_value_at_the_end_of_its_list_is_told(inset_m: float, warned: bool) -> None:
    trials = [trial(f"a{k}", True, inset_m=(0.0, 0.01, 0.02)) for k in range(3)]
    found = choose(trials, says(lambda each, inputs: inputs.inset_m == inset_m), 0)
    assert [(each.value, each.at_end) for each in fitted(trials, found).inputs] == [(inset_m, warned)]


def test_of_two_values_none_is_told_to_be_an_end() -> None:
    trials = [trial(f"a{k}", True, inset_m=(0.0, 0.01)) for k in range(3)]
    found = choose(trials, says(lambda each, inputs: inputs.inset_m == 0.01), 0)
    assert [(each.value, each.at_end) for each in fitted(trials, found).inputs] == [(0.01, False)]


def test_the_scatter_is_as_wide_as_makes_the_tests_likeliest() -> None:
    """Narrow draws tell nothing, of wide ones seven in eight end as the test did."""
    trials = [trial(f"a{k}", k % 2 == 0) for k in range(40)]
    ask = answering(
        lambda each, one: answer(
            one.sample % 2 == 0 if one.width < 4.0 else each.fell == (one.sample % WIDTH_DRAWS > 0)
        )
    )
    found = choose(trials, ask, 20)
    assert found.width == WIDTHS[-1]
    assert fitted(trials, found).width_at_end
    assert found.counts < COUNTS
    assert found.log_score == pytest.approx(
        -math.log((WIDTH_DRAWS - 1 + found.counts) / (WIDTH_DRAWS + 2 * found.counts))
    )


def test_what_is_planned_is_what_is_run() -> None:
    lists = {"inset_m": (0.0, 0.01, 0.02), "scale": (0.8, 0.9, 1.0), "sign": (1, -1), "friction": (0.2, 0.4, 0.6)}
    share = [trial(f"a{k}", k % 2 == 0, body=body, **lists) for k, body in enumerate("aabbccaabb")]
    tests = [*share, *(trial(f"r{k}", True, body="b", **lists) for k in range(5))]
    model, ran = says(lambda each, inputs: inputs.sign == 1), set[tuple[str, TrialVariant]]()

    def ask(pairs: Sequence[tuple[Trial, TrialVariant]]) -> Answers:
        ran.update((each.name, one) for each, one in pairs)
        return model(pairs)

    choice = choose(share, ask, 6)
    ask([(each, one) for each in tests for one in (choice.nominal(each), *choice.draws(each, 6))])
    # A draw of width 1 may be one of those that were tried.
    assert 0.95 * planned(tests, share, 6) < len(ran) <= planned(tests, share, 6)


def test_probability_counts_the_runs_that_fall_and_failures_do_not_count() -> None:
    one = trial("t", True)
    outcomes = [answer(True), answer(True), answer(True), answer(False), answer(True, outcome=Outcome.CRASHED)]
    model, choice = parse_model("analytic"), FittedInputs(counts=0.5)

    def probability(runs: Sequence[CaseRun], samples: int) -> float | None:
        variants = [choice.nominal(one), *choice.draws(one, samples)]
        answers = {(one.name, each): run for each, run in zip(variants, runs, strict=True)}
        return ModelAnswers(model, choice, answers, samples).probability(one)

    assert probability(outcomes, 4) == (2 + 0.5) / (3 + 1)
    assert probability([*outcomes[:3], answer(True, outcome=Outcome.UNDECIDED), outcomes[4]], 4) == 2.5 / 3.0
    assert probability([answer(True, outcome=Outcome.CRASHED)], 0) is None
    assert probability([answer(True)], 0) == 1.0


def test_tests_of_one_set_up_fall_together_where_its_inputs_are_not_known() -> None:
    """Two bodies whose tests fall at one of two frictions, and a test of which all is known, which falls in half of its draws."""
    trials = [trial(f"{body}{k}", True, body=body, friction=(0.2, 0.4)) for body in "ab" for k in range(3)]
    trials += [trial(f"c{k}", True, body="c") for k in range(2)]
    model, choice, samples = parse_model("analytic"), FittedInputs(counts=0.5), 10
    answers: dict[tuple[str, TrialVariant], CaseRun] = {}
    for each in trials:
        for one in choice.draws(each, samples):
            fell = one.inputs.friction == 0.4 if each.unknown else one.sample % 2 == 0
            answers[each.name, one] = answer(fell, outcome=Outcome.CRASHED) if one.sample == 7 else answer(fell)
    answered = ModelAnswers(model, choice, answers, samples)
    possible = answered.possible(trials)
    said = [answered.probability(each) for each in trials]
    assert possible.mean(axis=0) == pytest.approx(np.array(said), abs=4.0 * 0.5 / math.sqrt(len(possible)))
    correlation = np.corrcoef(possible.T)
    assert correlation[:3, :3].min() > 0.6  # of ten draws one says nothing, and one count is added
    assert correlation[3:6, 3:6].min() > 0.6
    assert np.abs(correlation[:3, 3:]).max() < 0.1
    assert abs(correlation[6, 7]) < 0.1


def test_repeats_that_disagree_are_a_ceiling() -> None:
    """Of four repeats one stood, two repeats agree, one test is alone."""
    tests = [trial(f"a{k}", k > 0, motion=Path("m0")) for k in range(4)]
    tests += [trial(f"b{k}", True, motion=Path("m1")) for k in range(2)] + [trial("c", False, motion=Path("m2"))]
    found = repeats_of(tests)
    assert (found.tests, found.groups, found.disagreeing) == (6, 2, 1)
    assert found.best_accuracy == pytest.approx(6 / 7)
    # Of one probability for the four no other has less; a bare threshold on PGV was told to be better than the best.
    assert found.best_brier == pytest.approx(min((3 * (1 - p) ** 2 + p**2) / 7 for p in np.linspace(0.0, 1.0, 101)))
    assert repeats_of(tests[-1:]) is None
    # What is not known of a set-up may differ between days: such tests repeat none of another day.
    apart = [trial(f"d{k}", k > 0, day=str(k), scale=(0.9, 1.0)) for k in range(2)]
    assert repeats_of(apart) is None
    assert repeats_of([listing(each, scale=(1.0,)) for each in apart]) is not None


def test_a_share_of_two_tests_leaves_the_scatter_as_assumed() -> None:
    found = choose([trial("a", True), trial("b", False)], answering(lambda each, one: answer(each.fell)), 10)
    assert (found.width, found.counts) == (1.0, pytest.approx(COUNTS, rel=0.5))


@pytest.mark.parametrize(
    ("fields", "flips"),
    [
        ({"numerical_uncertainty_rad": None}, False),
        ({"numerical_uncertainty_rad": 1e-3, "reliable_until_s": 2.0, "no_return_time_s": 2.5}, True),
        ({"numerical_uncertainty_rad": 1e-3, "reliable_until_s": 3.0, "no_return_time_s": 2.5}, False),
    ],
)
def test_a_fall_decided_after_the_reliable_time_flips(fields: dict[str, Any], flips: bool) -> None:
    assert case_of(trial("t", True), TrialVariant(Inputs()), answer(True, **fields)).within_uncertainty is flips


@pytest.mark.parametrize(("below", "flips"), [(1.9, True), (2.1, False)])
def test_a_stand_within_twice_the_uncertainty_of_the_balance_point_flips(
    tmp_path: Path, below: float, flips: bool
) -> None:
    one = read_table(write_experiments(tmp_path, [3.0]))[0]
    from harness.questions.validate.scenes import scene_of

    statue = scene_of(one, variant(one)).statue
    limit = min(statue.slenderness_rad(1), statue.slenderness_rad(-1))
    run = answer(False, numerical_uncertainty_rad=1e-3, peak_theta_rad=limit - below * 1e-3)
    assert case_of(one, variant(one), run).within_uncertainty is flips


def test_a_stand_is_held_against_the_balance_angle_of_the_side_that_it_leans_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = paestum()
    monkeypatch.setattr(scoring, "scene_of", lambda *given: scene)
    left_rad, right_rad = (scene.statue.slenderness_rad(side) for side in (-1, 1))
    for validity, peak_rad, flips in (
        ({"peak_over_slenderness": 1.0}, right_rad, True),
        ({"peak_over_slenderness": right_rad / left_rad}, right_rad, False),
        ({}, right_rad, True),
        ({}, left_rad, True),
        ({}, 0.5 * left_rad, False),
    ):
        run = answer(False, numerical_uncertainty_rad=1e-3, peak_theta_rad=peak_rad, validity=validity)
        assert case_of(trial("t", False), TrialVariant(Inputs()), run).within_uncertainty is flips


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
    answers: dict[tuple[str, TrialVariant], CaseRun] = {}
    choice = FittedInputs(counts=0.0)
    for k, each in enumerate(trials):
        answers[each.name, choice.nominal(each)] = answer(k >= 5)
        for one in choice.draws(each, 2):
            answers[each.name, one] = answer(k >= 6 or (k == 5 and one.sample == 1))
    found = score_model(trials, trials, ModelAnswers(parse_model("analytic"), choice, answers, 2), shaking)
    assert found.outcomes.accuracy.value == pytest.approx(11 / 12)
    assert found.outcomes.confusion["stands"]["overturned_right"] == 1
    assert found.probability.brier == pytest.approx(0.25 / 12)
    # At P = 1/2 a fall is said: the same test is wrong. Above it all that fell, below it all that stood.
    assert found.by_probability.accuracy.value == pytest.approx(11 / 12)
    assert found.probability.area.value == 1.0
    assert [(item.cases, item.fell.value) for item in found.probability.reliability] == [(5, 0.0), (1, 0.0), (6, 1.0)]
    (body,) = found.by_body
    assert (body.body, body.tests, body.fell, body.brier) == ("a", 12, 6, found.probability.brier)
    assert body.accuracy == found.outcomes.accuracy
    assert body.by_probability == found.by_probability.accuracy
    assert found.fragility_pgv.separated
    assert found.contour is not None
    assert found.failed == 0


def test_the_baseline_is_fitted_on_its_share_or_on_the_others() -> None:
    trials = [trial(f"t{k}", k >= 6) for k in range(12)]
    # The strongest that stood is just below the middle of its neighbours.
    shaking = {each.name: Intensity(0.1, 0.1 * (k + 1) - 0.01 * (k == 5)) for k, each in enumerate(trials)}
    apart = score_baseline(trials[::2], trials[1::2], shaking)
    assert apart.threshold_m_s == pytest.approx(0.6)
    assert apart.outcomes.accuracy.value == 1.0
    assert {row.accuracy.value for row in apart.by_intensity if row.tests} == {1.0}
    alone = score_baseline([], trials, shaking)
    assert "all tests but" in alone.fitted_on
    # Left out, the weakest that fell leaves a threshold halfway between 0.59 and 0.8, just below its 0.7.
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
    # But for the two beside each threshold: without itself a test is predicted by the middle of its neighbours.
    assert found.outcomes.accuracy.value == pytest.approx(22 / 24)
    together = sum((shaking[each.name].pgv_m_s >= found.threshold_m_s) == each.fell for each in trials)
    assert together < 22


def test_no_test_helps_to_predict_itself() -> None:
    """A lone faller among the weak is not predicted by itself, nor by its own probability."""
    trials = [trial(f"t{k}", k in (0, 6, 7, 8)) for k in range(9)]
    shaking = {each.name: Intensity(0.1, 0.1 * (k + 1)) for k, each in enumerate(trials)}
    found = score_baseline([], trials, shaking)
    assert found.outcomes.recall.value == pytest.approx(3 / 4)
    others = score_baseline(trials[1:], trials[:1], shaking)
    assert others.probability.brier > 0.5


def test_inputs_that_explain_the_tests_together_alone_are_fitted() -> None:
    """Only one of the tolerances with one of the insets is right: of each alone no change is better."""
    tolerances, insets = ([3.0 * NEAR[name] * k for k in range(1, 7)] for name in ("contact_tolerance_m", "inset_m"))
    tests = [trial(f"t{k}", True, contact_tolerance_m=tuple(tolerances), inset_m=tuple(insets)) for k in range(3)]
    true = Inputs(contact_tolerance_m=tolerances[2], inset_m=insets[4])
    near = tolerances[1:3]
    found = choose(
        tests, says(lambda each, own: own == true or (each.name == "t0" and own.contact_tolerance_m in near)), 0
    )
    assert found.of_set_up["a", ""].best == true


def test_an_outcome_says_something_of_the_values_beside_its_own_and_nothing_of_another_sign() -> None:
    """Worn by 4 mm is right: 2 mm beside is likelier than 8 mm beside, and the other sign no more than by its own draws."""
    lists = {"inset_m": tuple(0.002 * k for k in range(10)), "sign": (1, -1)}
    tests = [trial(f"t{k}", k % 2 == 0, **lists) for k in range(6)]
    found = choose(tests, says(lambda each, own: own.sign == 1 and own.inset_m == 0.004), 0).of_set_up["a", ""]
    chance = {(each.inset_m, each.sign): w for each, w in zip(found.settings, found.weights.tolist(), strict=True)}
    assert found.best == Inputs(inset_m=0.004, sign=1)
    assert chance[0.006, 1] > 3.0 * chance[0.012, 1]
    assert chance[0.004, -1] == pytest.approx(chance[0.006, -1], rel=0.1)


def test_of_too_many_settings_those_are_weighed_that_were_tried() -> None:
    lists = {"azimuth_deg": tuple(map(float, range(90))), "sign": (1, -1), "friction": (0.2, 0.4, 0.6)}
    tests = [trial(f"t{k}", True, **lists) for k in range(4)]
    found = choose(tests, says(lambda each, own: own.sign == 1), 0).of_set_up["a", ""]
    assert len(found.settings) == TRIED
    assert found.best.sign == 1


def test_a_design_of_many_inputs_is_small_and_holds_every_value() -> None:
    lists = {"azimuth_deg": range(9), "contact_tolerance_m": range(3), "inset_m": range(4)}
    rows = designed(lists, TRIED)
    assert len(rows) == TRIED
    assert all({getattr(row, name) for row in rows} == set(values) for name, values in lists.items())
    every = designed({"azimuth_deg": range(4), "inset_m": range(5)}, 60)
    assert [every.count(each) for each in set(every)] == [3] * 20


@pytest.mark.parametrize(("insets", "times"), [(2, DRAWS), (20, TRIED // 20), (100, 0)])
def test_settings_are_tried_alike_and_in_each_test_by_other_draws(insets: int, times: int) -> None:
    lists = {"inset_m": tuple(0.001 * k for k in range(insets))}
    tests, ran = [trial(f"t{k}", k % 2 == 0, **lists) for k in range(DRAWS)], list[tuple[str, TrialVariant]]()
    model = says(lambda each, own: True)

    def ask(pairs: Sequence[tuple[Trial, TrialVariant]]) -> Answers:
        ran.extend((each.name, one) for each, one in pairs)
        return model(pairs)

    choose(tests, ask, 0)
    of_setting: dict[Inputs, list[tuple[str, int]]] = {}
    for name, one in ran:
        of_setting.setdefault(one.inputs, []).append((name, one.sample))
    for seen in of_setting.values():
        draws = {name: [sample for other, sample in seen if other == name] for name, _ in seen}
        assert times == 0 or {len(each) for each in draws.values()} == {times}
        assert all(len(set(each)) == len(each) for each in draws.values())
        assert len(set(map(tuple, draws.values()))) == len(draws) == DRAWS


def test_what_is_undecided_counts_neither_as_standing_nor_as_fallen() -> None:
    trials = [trial(f"stood{k}", False, inset_m=(0.0, 0.01)) for k in range(2)]
    undecided = answer(True, outcome=Outcome.UNDECIDED)
    found = choose(
        trials,
        answering(lambda each, one: answer(False) if one.inputs.inset_m else undecided),
        0,
    )
    assert found.of_set_up["a", ""].best.inset_m == 0.01
    shaken = {each.name: Intensity(0.3, 0.2 * (k + 1)) for k, each in enumerate(trials)}
    assert curves(trials, shaken, lambda each: None).fragility_pgv is None


@pytest.mark.parametrize(
    ("x", "fell", "threshold"),
    [
        ([1, 2, 3, 4], [0, 0, 1, 1], 2.5),
        ([4, 1, 3, 2], [1, 0, 1, 0], 2.5),
        ([1, 2, 3], [1, 1, 1], 1.0),
        ([1, 2, 3, 4, 5], [0, 1, 0, 1, 1], 1.5),
        ([1, 1, 2], [0, 1, 1], 1.0),
    ],
    ids=["parted", "in any order", "all fell", "first of equals", "ties are not parted"],
)
def test_the_best_threshold(x: list[float], fell: list[int], threshold: float) -> None:
    assert best_threshold(x, fell) == pytest.approx(threshold)


def test_nobody_fell_means_a_threshold_above_all() -> None:
    assert best_threshold([1.0, 2.0], [0, 0]) > 2.0


def test_the_best_threshold_is_the_best_of_all() -> None:
    rng = np.random.default_rng(5)
    x = rng.uniform(size=60)
    y = rng.uniform(size=60) < x
    right = max(int(np.sum((x >= t) == y)) for t in np.concatenate((x, [2.0])))
    assert int(np.sum((x >= best_threshold(x, y)) == y)) == right


def test_the_probability_by_intensity_is_that_of_the_curve_drawn_from() -> None:
    """Median 0.5, dispersion 0.4: with 4000 cases the share at the median is known to some 1/√4000; four of them."""
    rng = np.random.default_rng(3)
    x = rng.uniform(0.1, 1.5, 4000)
    y = rng.uniform(size=4000) < stats.norm.cdf(np.log(x / 0.5) / 0.4)
    asked = np.array([0.3, 0.5, 0.9])
    true = stats.norm.cdf(np.log(asked / 0.5) / 0.4)
    assert np.max(np.abs(chances(x, y, asked) - true)) <= QUANTILE_SE / np.sqrt(4000.0)


def test_without_a_rising_curve_the_share_that_fell_is_all_that_is_known() -> None:
    assert chances([1, 2, 3], [0, 0, 0], [2.0, 0.0]).tolist() == [pytest.approx(0.2), 0.0]
    assert chances([1, 2, 3, 4], [1, 0, 1, 0], [2.0])[0] == pytest.approx(0.5)
    assert chances([0, 0], [0, 0], [1.0])[0] == pytest.approx(0.25)


def drawn(count: int) -> tuple[list[Intensity], list[bool]]:
    rng = np.random.default_rng(9)
    pga, ratio = rng.uniform(0.1, 1.2, count), rng.uniform(0.05, 0.3, count)
    p = stats.norm.cdf(8.0 + 3.0 * np.log(pga) + 3.0 * np.log(ratio))
    shaken = [Intensity(a, a * GRAVITY_M_S2 * r) for a, r in zip(pga, ratio, strict=True)]
    return shaken, (rng.uniform(size=count) < p).tolist()


def test_a_known_contour_is_recovered() -> None:
    """Where P = 1/2 the curve's error is that of c₀, c₁, c₂: some 1/√n over the slope's 3; four of them."""
    found = contour(*drawn(4000))
    assert not found.separated
    line = found.contour_50
    expected = -(8.0 + 3.0 * np.log(line.ratio_s)) / 3.0
    assert np.log(line.pga_g) == pytest.approx(expected, abs=QUANTILE_SE * 3.0 / np.sqrt(4000))


def test_separated_classes_have_a_line_between_them() -> None:
    shaken = [Intensity(a, a * GRAVITY_M_S2 * 0.1 * (1 + k % 3)) for k, a in enumerate(np.linspace(0.1, 1.0, 20))]
    fell = [each.pga_g > 0.5 for each in shaken]
    found = contour(shaken, fell)
    assert found.separated
    line = found.contour_50
    above = [each.pga_g > np.interp(each.ratio_s, line.ratio_s, line.pga_g) for each in shaken]
    assert above == fell


def test_one_class_has_no_contour() -> None:
    shaken, _ = drawn(10)
    assert contour(shaken, [True] * 10) is None
