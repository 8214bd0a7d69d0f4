"""The verdicts follow from the record, and from nothing else."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness import History, Outcome, Run, Verdict, compare
from harness.comparison.comparator import COVERAGE, left_domain, shares
from harness.records.run import STILL_RAD
from tests import doubles

U_RAD = 1e-4
U_M = 5e-5
NOT_GIVEN = ("motion_not_given", {"model": "plane", "axes": ["y"]})


def certain(history: History, name: str, until_s: float = 10.0, **fields: Any) -> Run:
    known = {"numerical_uncertainty_rad": U_RAD, "slip_uncertainty_m": U_M, "reliable_until_s": until_s}
    return doubles.run_of(history, name, **known | fields)


@pytest.mark.parametrize(("apart", "verdict"), [(0.99, Verdict.AGREE), (1.01, Verdict.MODEL)])
def test_the_limit_is_twice_the_joint_uncertainty(apart: float, verdict: Verdict) -> None:
    history = doubles.rocking()
    limit = COVERAGE * 2.0 * U_RAD
    scores = compare(certain(doubles.raised(history, apart * limit), "a"), certain(history, "b"))
    assert scores.verdict is verdict
    assert scores.evidence.limit_rad == pytest.approx(limit)


@pytest.mark.parametrize(("lean_rad", "verdict"), [(0.9, Verdict.AGREE), (1.1, Verdict.PLANE)])
def test_models_whose_statues_are_said_not_to_rock_are_not_said_to_differ(lean_rad: float, verdict: Verdict) -> None:
    """Certified to 1e-17 rad both: one leans by a hundredth of a millimetre at the top, in the plane or out of it."""
    exact: dict[str, Any] = {"numerical_uncertainty_rad": 1e-17, "slip_uncertainty_m": 1e-17}
    plane = certain(doubles.rest(), "plane", motion_axes=("x",), **exact)
    leans = doubles.scaled(doubles.rocking(slip_m=0.0), 10.0 * lean_rad * STILL_RAD)
    across = {"out_of_plane_rad": lean_rad * STILL_RAD}
    for history, validity in ((leans, {}), (doubles.rest(), across)):
        space = certain(history, "space", motion_axes=("x", "y"), validity=validity, **exact)
        assert compare(plane, space).verdict is verdict
    rocks = doubles.rocking()
    near = compare(certain(rocks, "a", **exact), certain(doubles.raised(rocks, 0.1 * STILL_RAD), "b", **exact))
    assert near.verdict is Verdict.MODEL, "of statues that rock every certified digit counts"


def test_apart_before_the_horizon_is_the_model() -> None:
    history = doubles.rocking()
    scores = compare(certain(doubles.parted(history, 2.0, 0.01), "a", 5.0), certain(history, "b"))
    assert scores.verdict is Verdict.MODEL
    assert scores.evidence.exceeded_s == pytest.approx(2.0 + 4.0 * U_RAD / 0.01)
    assert scores.evidence.horizon_s == 5.0
    near = compare(certain(doubles.parted(history, 2.0, 0.01), "a"), certain(history, "b"), horizons_s=(4.0, None))
    assert (near.verdict, near.evidence.horizon_s) == (Verdict.MODEL, 4.0)


def test_past_an_engine_s_bounded_error_is_not_beyond_the_horizon() -> None:
    """Two causes: the engine missed its target from 5 s on, or nobody could compute it further than the measured horizon."""
    history = doubles.rocking()
    a, b = certain(doubles.parted(history, 6.0, 0.01), "a", 5.0), certain(history, "b")
    missed = compare(a, b)
    assert missed.verdict is Verdict.UNBOUNDED
    said = missed.findings[0]
    assert (said.code, said.values["until_s"], said.values["unbounded"]) == ("pair_error_not_bounded", 5.0, ["a"])
    assert compare(a, b, horizons_s=(None, 9.0)).verdict is Verdict.UNBOUNDED
    unpredictable = compare(a, b, horizons_s=(None, 5.5))
    assert unpredictable.verdict is Verdict.HORIZON
    assert unpredictable.findings[0].code == "pair_beyond_horizon"


def test_a_robust_difference_of_a_planar_model_is_the_plane_left_out() -> None:
    """Only where the floor moved across the plane: with the same motion given to both it is their models."""
    history = doubles.rocking()
    b = certain(history, "space", motion_axes=("x", "y"))
    for axes, verdict in (("x",), Verdict.PLANE), (("x", "y"), Verdict.MODEL), (None, Verdict.MODEL):
        a = certain(doubles.parted(history, 2.0, 0.01), "plane", motion_axes=axes)
        scores = compare(a, b)
        assert scores.verdict is verdict
        told = NOT_GIVEN in [(each.code, each.values) for each in scores.findings]
        assert told is (verdict is Verdict.PLANE)
        assert scores.evidence.motion_not_given == ({"plane": ["y"]} if told else {})
    alike = compare(certain(history, "plane", motion_axes=("x",)), b)
    assert alike.verdict is Verdict.AGREE
    assert NOT_GIVEN in [(each.code, each.values) for each in alike.findings]


def test_a_fall_across_the_plane_parts_two_models_of_the_same_rotation() -> None:
    history = doubles.rocking()
    fields: dict[str, Any] = {"outcome": Outcome.OVERTURNED_FRONT, "no_return_time_s": 3.0}
    plane = certain(history, "plane", motion_axes=("x",))
    space = certain(history, "space", motion_axes=("x", "y"), **fields)
    scores = compare(space, plane)
    assert scores.verdict is Verdict.PLANE
    assert scores.evidence.exceeded_s == 3.0
    assert compare(replace(space, motion_axes=("x",)), plane).verdict is Verdict.MODEL
    assert compare(replace(space, reliable_until_s=2.0), plane).verdict is Verdict.UNBOUNDED


def test_a_statue_that_ends_leaning_across_the_plane_flips_by_the_plane_left_out() -> None:
    history = doubles.rocking()
    rolling = replace(history, extra={"roll_rad": 2.0 * np.abs(history.theta_rad).max() * np.ones_like(history.t_s)})
    space = certain(rolling, "space", outcome=Outcome.UNDECIDED, motion_axes=("x", "y"))
    flat = certain(history, "flat", motion_axes=("x",))
    scores = compare(space, flat)
    assert scores.verdict is Verdict.PLANE
    assert doubles.codes(scores.findings) == ["pair_plane_left_out", "motion_not_given"]
    level = replace(history, extra={"roll_rad": np.zeros_like(history.t_s)})
    leaning = certain(level, "leaning", outcome=Outcome.UNDECIDED, motion_axes=("x", "y"))
    assert compare(leaning, flat).evidence.outcome_flips_within_uncertainty


def test_two_falls_to_different_sides_are_one_outcome() -> None:
    history = doubles.rocking()
    a, b = (
        certain(each, name, 5.0, outcome=outcome, no_return_time_s=6.0)
        for each, name, outcome in (
            (doubles.parted(history, 5.5, 0.01), "a", Outcome.OVERTURNED_LEFT),
            (history, "b", Outcome.OVERTURNED_RIGHT),
        )
    )
    scores = compare(a, b)
    assert (scores.outcome_agrees, scores.side_agrees) == (True, False)
    assert scores.evidence.outcome_flips_within_uncertainty is False
    assert scores.evidence.side_flips_within_uncertainty is True
    assert doubles.codes(scores.findings) == ["pair_error_not_bounded", "side_flips"]
    standing = compare(a, certain(history, "b"))
    assert (standing.outcome_agrees, standing.side_agrees) == (False, None)


def test_a_horizon_from_elsewhere_counts_as_well() -> None:
    history = doubles.rocking()
    a, b = certain(doubles.parted(history, 6.0, 0.01), "a"), certain(history, "b")
    assert compare(a, b).verdict is Verdict.MODEL
    assert compare(a, b, horizons_s=(None, 5.0)).verdict is Verdict.HORIZON


@pytest.mark.parametrize(
    ("left_s", "verdict"), [(1.9, Verdict.DOMAIN), (2.5, Verdict.MODEL)], ids=["left before", "left after"]
)
def test_leaving_the_domain_explains_only_what_follows(left_s: float, verdict: Verdict) -> None:
    history = doubles.rocking()
    validity = {"left_domain_s": left_s, "left_domain_by": "statue_slides"}
    a = certain(doubles.parted(history, 2.0, 0.01), "a", validity=validity)
    scores = compare(a, certain(history, "b"))
    assert scores.verdict is verdict
    assert (scores.findings[0].values.get("by") == "statue_slides") is (verdict is Verdict.DOMAIN)


def test_what_came_first_decides_between_horizon_and_domain() -> None:
    history = doubles.rocking()
    b = certain(history, "b")
    parted = doubles.parted(history, 6.0, 0.01)
    early = certain(parted, "a", 5.0, validity={"left_domain_s": 4.0})
    late = certain(parted, "a", 4.0, validity={"left_domain_s": 5.0})
    assert compare(early, b).verdict is Verdict.DOMAIN
    assert compare(late, b).verdict is Verdict.UNBOUNDED
    assert compare(late, b, horizons_s=(4.0, None)).verdict is Verdict.HORIZON


@pytest.mark.parametrize("outcome", [Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX])
def test_a_run_that_ends_outside_the_model_left_its_domain(outcome: Outcome) -> None:
    history = doubles.rocking()
    run = certain(doubles.truncated(history, 3.0), "a", outcome=outcome)
    assert left_domain(run) == (3.0, outcome.value)
    assert compare(run, certain(history, "b")).verdict is Verdict.DOMAIN


def test_an_outcome_that_flips_within_the_uncertainty_is_flagged() -> None:
    history = doubles.rocking()
    fell = certain(history, "a", outcome=Outcome.OVERTURNED_LEFT)
    scores = compare(fell, certain(history, "b"))
    assert scores.verdict is Verdict.AGREE
    assert scores.evidence.outcome_flips_within_uncertainty is True
    beyond = compare(certain(history, "a", 4.0, outcome=Outcome.OVERTURNED_LEFT), certain(history, "b"))
    assert beyond.verdict is Verdict.UNBOUNDED
    assert beyond.evidence.outcome_flips_within_uncertainty is True
    apart = compare(certain(doubles.scaled(history, 2.0), "a", outcome=Outcome.OVERTURNED_LEFT), certain(history, "b"))
    assert apart.verdict is Verdict.MODEL
    assert apart.evidence.outcome_flips_within_uncertainty is False


@pytest.mark.parametrize(("apart", "verdict"), [(0.99, Verdict.AGREE), (1.01, Verdict.MODEL)])
def test_slip_is_held_against_its_own_uncertainty(apart: float, verdict: Verdict) -> None:
    """Whatever the rotation's is: here a thousand times the slip's in rad, and a tenth of it."""
    limit_m = COVERAGE * 2.0 * U_M
    history, slid = doubles.rocking(slip_m=0.0), doubles.rocking(slip_m=apart * limit_m)
    for u_rad in (1e3 * U_M, 0.1 * U_M):
        known = {"numerical_uncertainty_rad": u_rad, "slip_uncertainty_m": U_M}
        scores = compare(certain(slid, "a", **known), certain(history, "b", **known))
        assert scores.verdict is verdict
        assert scores.evidence.slip_limit_m == pytest.approx(limit_m)
        assert scores.evidence.largest_slip_difference_m == pytest.approx(float(np.max(slid.slip_m)))
        assert scores.numerical_uncertainty["rms_slip_m"] == pytest.approx(2.0 * U_M)


def test_a_verdict_says_in_what_two_answers_differ() -> None:
    history, slid = doubles.rocking(slip_m=0.0), doubles.rocking(slip_m=0.02)
    scores = compare(certain(slid, "a"), certain(history, "b"))
    assert scores.verdict is Verdict.MODEL
    assert scores.evidence.differs_in == "slip"
    said = scores.findings[0]
    assert (said.code, said.values["differs_in"]) == ("pair_differs_by_model", "slip")
    assert said.values["slip_limit_m"] == pytest.approx(COVERAGE * 2.0 * U_M)
    turned = compare(certain(doubles.raised(history, 0.01), "a"), certain(history, "b"))
    assert turned.evidence.differs_in == "rotation"
    assert turned.findings[0].values["limit_rad"] == pytest.approx(COVERAGE * 2.0 * U_RAD)


def test_a_difference_that_may_be_an_error_that_is_not_stated_is_no_model_s() -> None:
    history, moved = doubles.rocking(slip_m=0.0), doubles.raised(doubles.rocking(slip_m=0.0), 0.01)
    bare = replace(certain(moved, "b"), numerical_uncertainty_rad=None, slip_uncertainty_m=None, reliable_until_s=None)
    one = compare(certain(history, "a"), bare)
    assert one.verdict is Verdict.UNBOUNDED
    assert one.findings[0].code == "pair_differs_unstated"
    assert one.findings[0].values["unstated"] == ["b"]
    assert compare(certain(history, "a"), replace(bare, history=history)).verdict is Verdict.AGREE


def test_a_verdict_says_which_engine_takes_the_static_coefficient_at_impacts() -> None:
    history = doubles.rocking()
    plain, model = certain(history, "pymunk:plain", settings={"floor_impact": "static"}), certain(history, "analytic")
    assert compare(model, plain).findings[0].values["static"] == ["pymunk:plain"]
    assert compare(model, model).findings[0].values["static"] == []


def test_a_slip_s_error_that_is_not_stated_is_said() -> None:
    history, slid = doubles.rocking(slip_m=0.0), doubles.rocking(slip_m=0.02)
    scores = compare(certain(slid, "a", slip_uncertainty_m=None), certain(history, "b"))
    (told,) = [each for each in scores.findings if each.code == "slip_error_not_stated"]
    assert told.values["models"] == ["a"]


def test_an_unstated_error_is_said() -> None:
    history = doubles.rocking()
    a = doubles.run_of(doubles.raised(history, 1e-3), "other")
    (told,) = [each for each in compare(a, certain(history, "b")).findings if each.code == "error_not_stated"]
    assert told.values["models"] == ["other"]


@pytest.mark.parametrize(
    ("peak_s", "verdict"), [(2.9, Verdict.MODEL), (3.1, Verdict.UNBOUNDED)], ids=["before", "after"]
)
def test_without_histories_the_larger_peak_s_time_tells_when_they_parted(peak_s: float, verdict: Verdict) -> None:
    """θ_b never exceeds its own peak, so where the larger peak is reached the two are apart by the difference of the peaks."""
    certain_to_3 = {"numerical_uncertainty_rad": U_RAD, "reliable_until_s": 3.0}
    a = doubles.run_of(None, "a", peak_theta_rad=0.2, peak_time_s=peak_s, **certain_to_3)
    b = doubles.run_of(None, "b", peak_theta_rad=0.1, peak_time_s=1.0, **certain_to_3)
    assert compare(a, b).verdict is verdict
    assert compare(b, a).verdict is verdict


def test_a_peak_yet_to_come_is_no_domain_left() -> None:
    """A fall that was ended early has no time of its peak: the side named first was said to leave its domain, at no time."""
    kept = {"numerical_uncertainty_rad": U_RAD, "slip_uncertainty_m": U_M}
    fell = doubles.run_of(None, "a", outcome=Outcome.OVERTURNED_RIGHT, peak_theta_rad=1.5, peak_time_s=None, **kept)
    scores = compare(fell, doubles.run_of(None, "b", peak_theta_rad=0.1, peak_time_s=2.0, **kept))
    assert scores.verdict is Verdict.MODEL
    assert scores.evidence.left_domain_s is None
    assert scores.evidence.left_domain == ""


def test_shares_of_all_verdicts_sum_to_one() -> None:
    found = shares([Verdict.AGREE, Verdict.AGREE, Verdict.MODEL, Verdict.HORIZON])
    assert found == {
        "agree within numerical error": 0.5,
        "differ: model": 0.25,
        "differ: beyond the horizon": 0.25,
        "differ: the model left its domain": 0.0,
        "differ: the plane left out": 0.0,
        "differ: numerical error not bounded": 0.0,
    }
    assert math.isclose(sum(found.values()), 1.0)
    assert set(shares([]).values()) == {0.0}
