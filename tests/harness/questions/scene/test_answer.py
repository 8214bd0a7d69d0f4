"""The headline of a run follows from its outcomes, scores, horizons and probability, and from nothing else."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness import Outcome, Run, Scene, compare
from harness.model import Finding, caution
from harness.questions.scene.scene_run import answer_of
from harness.records.assess import Assessment
from harness.records.run import HorizonRecord, has_answer
from tests import doubles
from tests.scenes_for_tests import paestum

SCENE: Scene = paestum()
KNOWN: dict[str, Any] = {"numerical_uncertainty_rad": 1e-4, "slip_uncertainty_m": 1e-4, "reliable_until_s": 10.0}


def run(name: str, history: Any = None, **fields: Any) -> Run:
    return doubles.run_of(history or doubles.rocking(), name, **{**KNOWN, **fields})


def told(*runs: Run, horizons: Any = None, assessment: Any = None) -> tuple[str, dict[str, Finding]]:
    """The answer's code, and its findings by code."""
    by_name = {each.engine: each for each in runs}
    good = [each for each in runs if not each.outcome.failed]
    scores = {f"{a.engine}_vs_{b.engine}": compare(a, b) for k, a in enumerate(good) for b in good[k + 1 :]}
    found = answer_of(SCENE, by_name, scores, horizons or {}, assessment or {})
    return found.code, {each.code: each for each in found.findings}


def test_models_that_agree_in_outcome_and_history_agree() -> None:
    code, said = told(run("a"), run("b"))
    assert code == "agree"
    assert list(said) == ["models_agree", "histories_agree"]
    assert said["models_agree"].values["outcome"] == "stands"
    least, most = said["models_agree"].values["lean_rad"]
    assert least == most == run("a").peak_theta_rad
    # What a contact engine gives at rest is no lean.
    still = replace(run("b"), peak_theta_rad=3e-14)
    assert told(run("a"), still)[1]["models_agree"].values["lean_rad"] == [0.0, most]


def test_how_near_it_came_to_its_balance_counts_the_side_that_bears_less() -> None:
    """It leans further to the left, where it bears 0.43 rad, and reaches more of the 0.09 rad that it bears to the right."""
    history = doubles.rocking(amplitude_rad=0.08)
    theta = np.where(history.theta_rad < 0.0, 3.0 * history.theta_rad, history.theta_rad)
    right_rad, left_rad = float(theta.max()), -float(theta.min())
    assert right_rad < left_rad
    assert right_rad / SCENE.statue.slenderness_rad(1) > left_rad / SCENE.statue.slenderness_rad(-1)
    _, said = told(run("a", replace(history, theta_rad=theta)))
    values = said["model_says"].values
    assert values["balance_share"] == pytest.approx(right_rad / SCENE.statue.slenderness_rad(1))
    # Samples a second apart show little of it; the model says what share its peak is.
    coarse = run("a", replace(history, theta_rad=0.1 * theta), validity={"peak_over_slenderness": 0.7})
    assert told(coarse)[1]["model_says"].values["balance_share"] == 0.7


def test_a_model_leans_as_far_as_it_does_within_its_domain() -> None:
    """It holds on its support a statue that slides from 0.4 s on, and lets it rock from 0.5 s on; alone that is all."""
    slides = run("a", validity={"left_domain_s": 0.4, "left_domain_by": "statue_slides", "peak_over_slenderness": 0.9})
    said = told(slides, run("b", doubles.rest()))[1]["models_agree"].values
    assert (said["lean_rad"], said["balance_share"], said["outcome"]) == ([0.0, 0.0], 0.0, "still")
    later = replace(slides, validity={**slides.validity, "left_domain_s": 0.52})
    least, most = told(later, run("b", doubles.rest()))[1]["models_agree"].values["lean_rad"]
    assert 0.0 == least < most < slides.peak_theta_rad
    assert told(slides)[1]["model_says"].values["lean_rad"] == [slides.peak_theta_rad] * 2


def test_an_outcome_that_only_a_model_outside_its_domain_tells_is_told_as_such() -> None:
    """It holds on its support a statue that slides from 0.4 s on, and lets it fall; what passed no return before had fallen."""
    left = {"left_domain_s": 0.4, "left_domain_by": "statue_slides"}
    falls = run("a", outcome=Outcome.OVERTURNED_LEFT, no_return_time_s=0.9, overturn_time_s=1.0, validity=left)
    for others in ((), (run("b"),)):
        found = told(falls, *others)[1]["outcome_outside_domain"].values
        assert found == {"models": ["a"], "at_s": 0.4, "by": "statue_slides"}
    inside = replace(falls, engine="b", validity={})
    assert "outcome_outside_domain" not in told(falls, inside)[1]
    assert "outcome_outside_domain" not in told(replace(falls, no_return_time_s=0.3))[1]


def test_runs_that_end_at_one_event_are_known_to_their_ends() -> None:
    """At a wall each ends at its own instant, its error stated up to rounding before it."""
    end_s = doubles.rocking().t_s[-1]
    wall = {"outcome": Outcome.TOUCHES_WALL, "end_s": end_s, "reliable_until_s": end_s * (1.0 - 1e-9)}
    later = replace(run("b", **wall), end_s=end_s * (1.0 + 1e-5), reliable_until_s=end_s * (1.0 + 1e-5))
    assert list(told(run("a", **wall), later)[1]) == ["models_agree", "histories_agree"]
    open_ = replace(later, reliable_until_s=0.9 * end_s)
    assert told(run("a", **wall), open_)[1]["histories_known_until"].values["until_s"] == 0.9 * end_s


def test_histories_that_part_late_agree_until_then_and_the_reason_is_told() -> None:
    parted = doubles.parted(doubles.rocking(), 6.0, 0.01)
    code, said = told(run("a", parted, reliable_until_s=5.0), run("b"))
    assert code == "agree_until"
    until = said["histories_agree_until"].values
    assert until["why"] == "unbounded"
    assert until["until_s"] == 5.0


def test_a_difference_of_models_is_the_answer_even_where_the_outcome_is_one() -> None:
    code, said = told(run("a", doubles.raised(doubles.rocking(), 0.01)), run("b"))
    assert code == "differ_by_model"
    assert said["histories_agree_until"].values["why"] == "model"


def test_the_headline_tells_of_the_pair_that_its_code_rests_on() -> None:
    raised = doubles.parted(doubles.rocking(), 6.0, 0.02)
    late = run("c", doubles.parted(doubles.rocking(), 2.0, 0.01), reliable_until_s=1.0)
    code, said = told(run("a", raised), run("b"), late)
    assert code == "differ_by_model"
    assert said["histories_agree_until"].values["why"] == "model"
    assert {said["histories_agree_until"].values[key] for key in "ab"} == {"a", "b"}


def test_what_the_plane_leaves_out_is_no_difference_of_models() -> None:
    flat = run("flat", doubles.parted(doubles.rocking(), 2.0, 0.01), motion_axes=("x",))
    assert told(flat, run("space", motion_axes=("x", "y")))[0] == "plane_left_out"


def test_a_cause_is_told_of_the_pair_that_has_it() -> None:
    """The first to part has none of its own: the cause of another pair is that pair's, by name."""
    parted = [doubles.parted(doubles.rocking(), at_s, 0.01) for at_s in (2.0, 4.0)]
    runs = {name: run(name, history, motion_axes=("x",)) for name, history in zip("ab", parted, strict=True)}
    runs["space"] = run("space", motion_axes=("x", "y"))
    scores = {f"{name}_vs_space": compare(runs[name], runs["space"]) for name in "ab"}

    def told_of(pair: str) -> dict[str, Any]:
        because = caution("plane_cause", cause="base_outline")
        found = scores | {pair: replace(scores[pair], findings=[because])}
        said = {each.code: each.values for each in answer_of(SCENE, runs, found, {}, {}).findings}
        assert (said["histories_agree_until"]["a"], said["histories_agree_until"]["why"]) == ("a", "plane")
        return said["plane_decides"]

    assert told_of("a_vs_space") == {"causes": ["base_outline"]}
    assert told_of("b_vs_space") == {"causes": ["base_outline"], "a": "b", "b": "space"}


@pytest.mark.parametrize(("axes", "code"), [(("x", "y"), "plane_left_out"), (("x",), "differ_by_model")])
def test_a_run_that_tells_no_outcome_counts_where_its_history_differs(axes: tuple[str, ...], code: str) -> None:
    """It still rocks at the end, eight times as far: the others' histories do not "agree throughout"."""
    rocks = run("space", doubles.scaled(doubles.rocking(), 8.0), outcome=Outcome.UNDECIDED, motion_axes=axes)
    found, said = told(run("a", motion_axes=("x",)), run("b", motion_axes=("x",)), rocks)
    assert found == code
    assert said["models_agree"].values["silent"] == {"space": "undecided"}
    assert "histories_agree" not in said
    assert told(run("a", motion_axes=("x",)), rocks)[0] == code
    still = run("space", outcome=Outcome.UNDECIDED)
    assert told(run("a"), run("b"), still)[0] == "agree"
    assert told(run("a"), still)[0] == "one_model"


def test_outcomes_that_numerical_error_flips_are_unpredictable_others_differ() -> None:
    fell = {"outcome": Outcome.OVERTURNED_LEFT, "no_return_time_s": 8.0}
    parted = doubles.parted(doubles.rocking(), 6.0, 0.01)
    assert told(run("a", parted, reliable_until_s=5.0, **fell), run("b"))[0] == "unpredictable"
    code, said = told(run("a", **fell), run("b"), run("c", **fell))
    assert code in ("unpredictable", "outcome_differs")
    assert said["models_disagree"].values["groups"] == {"overturned": ["a", "c"], "stands": ["b"]}


def test_histories_that_part_after_every_fall_agree_past_the_point_of_no_return() -> None:
    fell = {"outcome": Outcome.OVERTURNED_LEFT, "no_return_time_s": 5.0}
    parted = doubles.parted(doubles.rocking(), 6.0, 0.01)
    _, said = told(run("a", parted, reliable_until_s=6.5, **fell), run("b", reliable_until_s=5.5, **fell))
    assert said["histories_agree_past_return"].values["until_s"] >= 5.0
    _, said = told(run("a", parted, reliable_until_s=4.0, **fell), run("b", reliable_until_s=4.0, **fell))
    assert "histories_agree_past_return" not in said


def test_falls_to_different_sides_are_one_outcome() -> None:
    left, right = Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT
    _, said = told(run("a", outcome=left, no_return_time_s=3.0), run("b", outcome=right, no_return_time_s=4.0))
    assert said["models_agree"].values["outcome"] == "overturned"
    assert (said["models_agree"].values["first_s"], said["models_agree"].values["last_s"]) == (3.0, 4.0)


@pytest.mark.parametrize(
    ("fields", "known"),
    [
        ({"outcome": Outcome.CRASHED}, False),
        ({"outcome": Outcome.UNDECIDED}, False),
        ({"outcome": Outcome.FRICTION_PARADOX}, False),
        ({"validity": {"left_domain_s": 1.0, "left_domain_by": "pedestal_tips"}}, False),
        ({"validity": {"left_domain_s": 1.0, "left_domain_by": "statue_slides"}}, True),
        ({"outcome": Outcome.OVERTURNED_LEFT, "no_return_time_s": 0.5,
          "validity": {"left_domain_s": 1.0, "left_domain_by": "pedestal_tips"}}, True),
        ({}, True),
    ],
)  # fmt: skip
def test_a_run_that_tells_nothing_of_the_statue_is_not_counted(fields: dict[str, Any], known: bool) -> None:
    assert has_answer(run("a", **fields)) is known
    code, _ = told(run("a", **fields), run("b"))
    assert (code == "one_model") is not known
    assert told(run("a", outcome=Outcome.CRASHED))[0] == "no_answer"
    open_ = [run(name, outcome=Outcome.UNDECIDED) for name in "ab"]
    assert told(*open_)[1]["no_answer"].values == {"asked": 2, "ends": {"undecided": ["a", "b"]}}


def test_a_probability_of_a_run_is_about_and_undecided_draws_widen_it() -> None:
    _, said = told(run("a"), run("b"), assessment={"analytic": Assessment(0.4, 0.39, 0.41, 0.9, 10_000, 10_000)})
    assert said["probability"].values["share"] == 0.4
    open_ = Assessment(0.4, 0.39, 0.61, 0.9, 10_000, 10_000, undecided=0.2)
    _, said = told(run("a"), run("b"), assessment={"analytic": open_})
    between = said["probability_between"].values
    assert (between["low"], between["high"]) == (0.39, 0.61)
    mostly = Assessment(0.1, 0.09, 0.91, 0.9, 10_000, 10_000, undecided=0.8, plane_only=True)
    _, said = told(run("a"), run("b"), assessment={"analytic": mostly})
    assert "probability_open" in said
    assert said["probability_open"].values["planar"] == ["in_plane"]


def test_the_probability_told_is_of_the_model_that_knows_all_of_the_shaking_where_it_tells() -> None:
    few = Assessment(0.0, 0.0, 0.073, 0.9, 10_000, 10_000, plane_only=True, left_domain=0.88, sampler="b", sampled=22)
    space = Assessment(0.052, 0.038, 0.0705, 0.9, 519, 519)
    more, open_ = replace(few, probability_overturned=0.96, high=0.97), replace(space, undecided=0.9, high=0.98)
    whole = replace(few, plane_only=False)
    for planar, exact, model in (
        (few, space, "spatial"),
        (more, space, "spatial"),
        (more, open_, "analytic"),
        # Where both know all of it: of the one by which more draws fall, not of the wider interval.
        (whole, space, "spatial"),
        (replace(whole, undecided=0.06, high=0.13), space, "analytic"),
    ):
        _, said = told(run("a"), run("b"), assessment={"analytic": planar, "spatial": exact})
        assert {each.values["model"] for code, each in said.items() if code.startswith("probability")} == {model}


@pytest.mark.parametrize(
    ("outcome", "told_of"), [(Outcome.OVERTURNED_BACK, "contradicted_in_space"), (Outcome.STANDS, "in_plane")]
)
def test_a_probability_in_the_plane_is_contradicted_by_a_fall_in_space(outcome: Outcome, told_of: str) -> None:
    """It stands in the plane in all draws, and falls over its back as given: 0 % was told of it, in the plane."""
    planar = Assessment(0.001, 0.0, 0.034, 0.9, 1000, 1000, 0.017, plane_only=True)
    flat = run("flat", doubles.parted(doubles.rocking(), 2.0, 0.01), motion_axes=("x",))
    falls = {"no_return_time_s": 3.0} if outcome.overturned else {}
    space = run("space", motion_axes=("x", "y"), outcome=outcome, **falls)
    said = told(flat, space, assessment={"analytic": planar})[1]
    assert said["probability_between"].values["planar"] == [told_of]
    whole = told(flat, space, assessment={"analytic": replace(planar, plane_only=False)})[1]
    assert whole["probability_between"].values["planar"] == []


def test_perturbed_runs_that_end_otherwise_make_the_outcome_unpredictable() -> None:
    ends = (Outcome.STANDS, Outcome.OVERTURNED_LEFT)
    horizon = HorizonRecord(0.01, 10.0, (1e-9, 1e-3), (5.0, 4.0), 4.0, ends, 0, 5.0, 1e-3)
    _, said = told(run("analytic"), run("b"), horizons={"analytic": horizon})
    assert said["outcome_not_predictable"].values == {"outcomes": ["overturned", "stands"], "change": 1e-3}


def test_models_that_each_keep_to_an_outcome_of_their_own_leave_none_to_chance() -> None:
    stands = HorizonRecord(0.01, 10.0, (1e-3,), (5.0,), 4.0, (Outcome.STANDS,), 0, 5.0)
    horizons = {"analytic": stands, "b": replace(stands, outcomes=(Outcome.OVERTURNED_LEFT,))}
    _, said = told(run("analytic"), run("b", outcome=Outcome.OVERTURNED_LEFT), horizons=horizons)
    assert "outcome_not_predictable" not in said


@pytest.mark.parametrize("end", [Outcome.LIFT_OFF, Outcome.UNDECIDED])
def test_a_perturbed_run_that_loses_contact_or_still_falls_is_no_other_outcome_of_the_statue(end: Outcome) -> None:
    horizon = HorizonRecord(0.01, 10.0, (1e-3,), (5.0,), 4.0, (end, Outcome.OVERTURNED_LEFT), 0, 5.0)
    fell = run("analytic", outcome=Outcome.OVERTURNED_LEFT)
    _, said = told(fell, run("b"), horizons={"analytic": horizon})
    assert "outcome_not_predictable" not in said
