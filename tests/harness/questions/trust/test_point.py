"""The class of a point follows from a run's own answer, verdicts and horizon."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness import History, Outcome, Run, Scene, Verdict, compare
from harness.model import caution
from harness.questions import trust
from harness.questions.scene.scene_run import Result
from harness.questions.trust import STRETCHES, Kept, explained, path_of, said
from harness.records.base import part, plain
from harness.records.run import HorizonRecord
from harness.records.trust import CLASSES
from tests import doubles
from tests.scenes_for_tests import paestum

KNOWN: dict[str, Any] = {"numerical_uncertainty_rad": 1e-4, "slip_uncertainty_m": 1e-4, "reliable_until_s": 10.0}
FELL = {"outcome": Outcome.OVERTURNED_LEFT, "no_return_time_s": 8.0}
PARTED = doubles.parted(doubles.rocking(), 6.0, 0.01)


def run(name: str, history: Any = None, **fields: Any) -> Run:
    return doubles.run_of(history or doubles.rocking(), name, **{**KNOWN, **fields})


def result(*runs: Run, outcomes: tuple[Outcome, ...] = (Outcome.STANDS,), horizon_s: float = 10.0) -> Result:
    """A result of the analytic model and others, the model's perturbed starts ending in those outcomes."""
    good = [each for each in runs if not each.outcome.failed]
    scores = {f"{a.engine}_vs_{b.engine}": compare(a, b) for k, a in enumerate(good) for b in good[k + 1 :]}
    horizons = {"analytic": HorizonRecord(0.01, 10.0, (1e-9,), (horizon_s,), None, outcomes, 0, horizon_s)}
    return Result(paestum(), {each.engine: each for each in runs}, scores, [], 0.0, horizons)


STILL = {"history": doubles.rest()}
LEFT = {"validity": {"left_domain_s": 2.0, "left_domain_by": "statue_slides"}}
TIPS = {"validity": {"left_domain_s": 2.0, "left_domain_by": "pedestal_tips"}}
PLANE = {"motion_axes": ("x",), "history": doubles.parted(doubles.rocking(), 2.0, 0.01)}


@pytest.mark.parametrize(
    ("kind", "model", "engine"),
    [
        ("nothing_moves", STILL, STILL),
        ("confirmed", {}, {}),
        ("outcome_confirmed", {"history": PARTED, "reliable_until_s": 5.0}, {}),
        ("probability", {"history": PARTED, "reliable_until_s": 5.0} | FELL, {}),
        ("probability", {"outcome": Outcome.UNDECIDED}, {}),
        ("probability", {}, {"outcome": Outcome.UNDECIDED}),
        ("left_domain", {"history": PARTED} | LEFT, {}),
        ("left_domain", TIPS, {}),
        ("plane_left_out", PLANE, {"motion_axes": ("x", "y")}),
        ("refuted", {"history": doubles.raised(doubles.rocking(), 0.01)}, {}),
        ("no_answer", {}, {"outcome": Outcome.CRASHED}),
    ],
)
def test_each_class_is_what_the_answer_of_a_run_says(kind: str, model: dict[str, Any], engine: dict[str, Any]) -> None:
    found = said(result(run("analytic", **model), run("pymunk", **engine)))
    assert found.kind == kind
    assert found.kind in CLASSES


def test_a_motion_is_confirmed_to_the_end_by_one_engine_whose_error_is_bounded_so_long() -> None:
    short = run("pybullet", reliable_until_s=5.0)
    alone = said(result(run("analytic"), short))
    assert (alone.answer, alone.kind, alone.why) == ("agree", "outcome_confirmed", ["unbounded"])
    assert said(result(run("analytic"), run("pymunk"), short)).kind == "confirmed"


@pytest.mark.parametrize(("low", "high", "draws"), [(0.0, 0.03, [100]), (0.2, 0.4, [100]), (0.3, 0.6, [100, 500])])
def test_a_probability_takes_more_draws_where_few_leave_its_side_of_a_contour_open(
    low: float, high: float, draws: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def assess_models(scene: Scene, count: int) -> dict[str, Any]:
        asked.append(count)
        return {"analytic": SimpleNamespace(probability_overturned=0.5, low=low, high=high, level=0.95)}

    monkeypatch.setattr(trust, "assess_models", assess_models)
    found = trust.assess_point(trust.Question(paestum(), ("analytic",)))
    assert asked == draws
    assert found.record["interval"] == [0.5, low, high, 0.95]


def test_models_that_agree_tell_no_outcome_where_the_smallest_changes_have_another() -> None:
    both = run("analytic"), run("pymunk")
    found = said(result(*both, outcomes=(Outcome.STANDS, Outcome.OVERTURNED_LEFT)))
    assert (found.kind, found.alike[2], found.why) == ("probability", True, ["overturned", "stands"])
    assert said(result(*both)).kind == "confirmed"


def test_a_robust_difference_refutes_whatever_else_is_true() -> None:
    raised = run("analytic", doubles.raised(doubles.rocking(), 0.01), **LEFT | {"reliable_until_s": 10.0})
    found = said(result(raised, run("pymunk"), outcomes=(Outcome.STANDS, Outcome.OVERTURNED_LEFT)))
    assert (found.kind, found.answer) == ("refuted", "differ_by_model")
    assert found.why == ["analytic_vs_pymunk"]


def test_what_the_plane_leaves_out_is_named_by_its_cause() -> None:
    whole = result(run("analytic", doubles.raised(doubles.rocking(), 0.01)), run("pybullet"))
    pair, scores = next(iter(whole.scores.items()))
    cause = caution("plane_cause", cause="products_of_inertia", whole=True)
    judged = {pair: replace(scores, verdict=Verdict.PLANE, findings=[*scores.findings, cause])}
    found = said(replace(whole, scores=judged))
    assert (found.kind, found.why) == ("plane_left_out", ["products_of_inertia"])


def test_peaks_are_confirmed_where_they_are_as_near_as_a_prediction_is_asked_to_be() -> None:
    late = {"reliable_until_s": 0.1}
    near, far = (doubles.scaled(doubles.rocking(), by) for by in (1.05, 1.2))
    for history, confirmed in ((near, True), (far, False)):
        found = said(result(run("analytic", history, **late), run("pymunk", **late)))
        assert found.kind == "outcome_confirmed"
        assert found.peak_confirmed is confirmed
    assert said(result(run("analytic", far, **FELL), run("pymunk", **FELL, **late))).peak_confirmed


def test_a_model_that_holds_upright_a_pedestal_that_tips_has_no_outcome() -> None:
    ends = said(result(run("analytic", **TIPS), run("pymunk", **FELL))).outcomes
    assert ends == {"analytic": "left_domain", "pymunk": "overturned"}
    assert said(result(run("analytic", **LEFT))).outcomes == {"analytic": "stands"}


def test_the_model_alone_says_alike_what_ends_alike() -> None:
    stands, again = said(result(run("analytic"))), said(result(run("analytic", doubles.scaled(doubles.rocking(), 1.2))))
    assert stands.alike == again.alike
    others = [
        result(run("analytic", **FELL)),
        result(run("analytic", **STILL)),
        result(run("analytic", **LEFT)),
        result(run("analytic"), outcomes=(Outcome.STANDS, Outcome.OVERTURNED_LEFT)),
        result(run("analytic"), horizon_s=4.0),
    ]
    assert len({stands.alike, *(said(each).alike for each in others)}) == 6


def test_a_lean_is_told_as_a_share_of_the_balance_angle_of_its_own_side() -> None:
    """0.1 rad to the side that bears 0.43 rad is a quarter of its way; it was told as more than all of the weaker side's."""
    statue = paestum().statue
    for least_rad, most_rad, share in (
        (-0.10001, 0.01, 0.10001 / statue.slenderness_rad(-1)),
        (-0.1, 0.05, 0.05 / statue.slenderness_rad(1)),
    ):
        history = doubles.rest()
        history = replace(history, theta_rad=np.linspace(least_rad, most_rad, history.t_s.size))
        found = said(result(run("analytic", history), run("pymunk", history)))
        assert (found.peak_rad, found.balance_share) == (pytest.approx(-least_rad), pytest.approx(share))


def test_what_is_kept_of_a_point_says_what_its_runs_said() -> None:
    """Runs, scores and horizons are kept, the class is not: read back it is derived by the rules of today."""
    whole = result(run("analytic", PARTED, reliable_until_s=5.0), run("pymunk"))
    paths = {"analytic": path_of(PARTED)}
    kept = part(Kept, plain(Kept(whole.runs, whole.scores, whole.horizons, paths)), Path("store"))
    assert kept.said(whole.scene, ("analytic", "pymunk")) == said(whole)
    assert kept.said(whole.scene, ("analytic",)).kind == "no_answer"


@pytest.mark.parametrize(("stated_rad", "beside", "kind"), [
    (1e-4, "agrees", "refuted"), (8e-3, "agrees", "outcome_confirmed"), (8e-3, "raised", "refuted"),
])  # fmt: skip
def test_engines_that_share_a_layer_are_held_by_the_wider_of_their_statements(
    stated_rad: float, beside: str, kind: str
) -> None:
    """Both engines lean 0.01 rad further than the model: one states 1e-4 rad, and the other states more."""
    raised = doubles.raised(doubles.rocking(), 0.01)
    other = raised if beside == "agrees" else doubles.raised(doubles.rocking(), 0.05)
    runs = run("analytic"), run("pymunk", raised), run("pybullet", other, numerical_uncertainty_rad=stated_rad)
    whole = result(*runs)
    judged = {**whole.scores, **explained(whole.runs, whole.scores)}
    assert said(replace(whole, scores=judged)).kind == kind


def test_a_thinned_history_keeps_its_extremes_in_their_places() -> None:
    rocking = doubles.rocking()
    kept, whole = path_of(rocking), rocking.theta_rad
    assert kept.end_s == rocking.duration_s
    assert len(kept.theta_rad) == 2 * STRETCHES < whole.size
    for extreme in (np.argmax, np.argmin):
        there, here = int(extreme(whole)), int(extreme(kept.theta_rad))
        assert kept.theta_rad[here] == pytest.approx(whole[there], rel=5e-3)
        assert here / (2 * STRETCHES) == pytest.approx(there / whole.size, abs=1.0 / STRETCHES)
    few = History.from_arrays([0.0, 0.5, 1.0], [0.0, 0.01, 0.0])
    assert path_of(few).theta_rad == [0.0, 0.01, 0.0]
