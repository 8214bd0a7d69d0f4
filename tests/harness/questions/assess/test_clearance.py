"""The room needed: poses worked by hand, quantiles of weighted runs, directions that each model knows."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic import Pulse
from harness.engines.stepping.trajectory import statue_columns
from harness.model import BaseExcitation, Pedestal, Scene, Statue
from harness.questions.assess.assessment import CLEAR, answer_of, assess, without_clearance
from harness.questions.assess.assessment import clearance as clearance_finding
from harness.questions.assess.clearance import (
    AROUND_DEG,
    PARTS,
    PLANAR_DEG,
    clearance,
    clearance_by_model,
    reach_m,
    rest_outline_m,
)
from harness.questions.assess.probability import draw, model_draws, uncertain_inputs
from harness.records.assess import ClearanceByModel, ClearanceRecord
from harness.runs.runner import InlinePool
from reports.drawing.pictures import probable_plan
from tests import budgets_assess as budget
from tests.engines_for_tests import ready
from tests.scenes_for_tests import paestum, rectangle, scene

BLOCK = rectangle(0.4, 1.0)


def reach(theta: list[float], slip: list[float]) -> np.ndarray:
    return reach_m(scene(BLOCK), np.array(theta), np.array(slip), {})


def test_a_block_rotated_by_hand() -> None:
    """A block 0.4 by 1 m turned right by 0.1 rad: its top left corner goes farthest left at rest, its top right one right."""
    turn = 0.1
    middle = 0.2 - 0.2 * math.cos(turn) + math.sin(turn)
    expected = np.array([[math.sin(turn), 0.0], [middle, 0.0], [0.0, 0.0]])
    assert reach([0.0, turn], [0.0, 0.0]) == pytest.approx(expected, abs=budget.PLACE_M)
    assert reach([0.0, -turn], [0.0, 0.0]) == pytest.approx(expected[:, ::-1], abs=budget.PLACE_M)


def test_what_slides_needs_its_slip() -> None:
    assert reach([0.0] * 3, [0.0, 0.2, -0.05]) == pytest.approx(np.array([[0.2, 0.05]] * 3), abs=budget.PLACE_M)


def posed(statue: Statue, turn: np.ndarray, moved: tuple[float, float, float]) -> dict[str, np.ndarray]:
    """The columns of a history of two samples: at rest, and turned about the centroid and moved."""
    up = np.array([0.0, 0.0, statue.centroid_height_m])
    return statue_columns(statue, np.array([np.eye(3), turn]), np.array([up, up + moved]))


def test_a_pose_in_space_by_hand() -> None:
    """Moved and not turned, every point goes by the move's share of each direction; leant back, the top goes back alone."""
    still = np.zeros(2)
    ways = np.radians(AROUND_DEG)
    slid = reach_m(scene(BLOCK), still, still, posed(BLOCK, np.eye(3), (0.03, 0.04, 0.0)))
    by = np.maximum(0.03 * np.cos(ways) + 0.04 * np.sin(ways), 0.0)
    assert slid == pytest.approx(np.array([by, by, 0.0 * by]), abs=budget.PLACE_M)
    lean = 0.2
    back = np.array([[1.0, 0.0, 0.0], [0.0, math.cos(lean), math.sin(lean)], [0.0, -math.sin(lean), math.cos(lean)]])
    leant = reach_m(scene(BLOCK), still, still, posed(BLOCK, back, (0.0, 0.0, 0.0)))
    at = AROUND_DEG.index(90.0)
    # Half the depth and half the height, turned about the centroid.
    assert leant[0, at] == pytest.approx(0.25 * math.cos(lean) + 0.5 * math.sin(lean) - 0.25, abs=budget.PLACE_M)
    assert leant[1, at] == pytest.approx(0.5 * math.sin(lean), abs=budget.PLACE_M)
    assert leant[1, AROUND_DEG.index(270.0)] == leant[1, AROUND_DEG.index(0.0)] == 0.0


def cleared(scene: Scene, count: int) -> ClearanceByModel:
    """The model's clearance on so many draws."""
    values = draw(uncertain_inputs(scene), count, seed=0)
    return clearance_by_model(scene, values, model_draws(scene, values))


def test_draws_outside_the_models_domain_are_no_standing_ones() -> None:
    """A narrow pedestal tips with its statue; by a model that holds it upright that stands within some centimetres."""
    tips = paestum(0.429, 3.0, duration_s=3.0)
    narrow, contact = Pedestal(40.0, 0.45, 0.8, 0.9), tips.contact.with_floor(1.0, 1.0)
    tips = replace(tips, pedestal=narrow, contact=contact)
    answer = cleared(tips, 40)
    assert (answer.standing, answer.undecided) == (0, 40)


def test_quantiles_rise_and_a_calm_scene_needs_little() -> None:
    shaken = paestum(0.429, 3.0, duration_s=3.0)
    answer = cleared(shaken, 100)
    assert answer.draws == 100
    assert 20 < answer.standing < 100
    assert list(answer.share) == [0.5, 0.95], "of fewer than a hundred the 99 % quantile is not told"
    assert list(answer.direction_deg) == list(PLANAR_DEG)
    half, most = answer.outline_m
    assert half[0] < most[0]
    calm = paestum(0.02, 3.0, duration_s=1.0)
    quiet = cleared(calm, 50)
    assert quiet.standing == 50
    assert not np.any([quiet.outline_m, quiet.top_m, quiet.pedestal_m])


def test_too_few_standing_draws_have_no_quantile() -> None:
    fallen = paestum(2.0, 1.0, duration_s=3.0)
    answer = cleared(fallen, 30)
    assert answer.standing < 20
    assert not answer.outline_m


def test_draws_without_an_end_are_no_standing_ones() -> None:
    """Three seconds leave some draws leaning beyond the balance point."""
    cut = paestum(0.429, 3.0, duration_s=3.0)
    values = draw(uncertain_inputs(cut), 60, seed=0)
    model = model_draws(cut, values)
    answer = clearance_by_model(cut, values, model)
    assert answer.undecided > 0
    assert answer.undecided == int((~model.decided).sum())
    assert answer.standing == int((model.decided & ~model.overturned).sum())
    record = ClearanceRecord(1.46, rest_outline_m(cut.statue).tolist(), {"analytic": answer})
    (left_out,) = without_clearance(record)
    assert (left_out.code, left_out.engine) == ("clearance_undecided", "analytic")
    assert left_out.values == {"undecided": answer.undecided, "draws": 60}
    right_m, left_m = answer.at(CLEAR).values()
    told = clearance_finding(record).values
    assert (told["by"], told["right_m"], told["left_m"], told["height_m"]) == ("plane", right_m, left_m, 1.46)


def test_a_draw_that_falls_when_it_is_repeated_is_no_standing_one() -> None:
    """Past the horizon a run ends by rounding: here draws that fell are given out as standing."""
    shaken = paestum(0.429, 3.0, duration_s=10.0)
    values = draw(uncertain_inputs(shaken), 100, seed=0)
    model = model_draws(shaken, values)
    answer = clearance_by_model(shaken, values, model._replace(overturned=np.zeros_like(model.overturned)))
    assert answer.standing < int(model.decided.sum())
    assert np.max(answer.outline_m) < 0.5, "none of the statue's height"


def test_a_run_counts_for_what_it_stands_for() -> None:
    """Ninety runs of no reach for a tenth of the draws, ten of one metre for the rest: more than half need the metre."""
    reached = [np.zeros((len(PARTS), 2))] * 90 + [np.ones((len(PARTS), 2))] * 10
    equal = clearance(reached, np.ones(100), 100)
    drawn = clearance(reached, np.array([0.1 / 90] * 90 + [0.9 / 10] * 10), 100)
    assert np.array(equal.outline_m)[:, 0].tolist() == [0.0, 1.0, 1.0]
    assert np.array(drawn.outline_m)[:, 0].tolist() == [1.0, 1.0, 1.0]


def shaken_both_ways() -> Scene:
    """A block that no draw overturns, shaken much harder across its plane than in it."""
    along, across = (Pulse("one_sine", strength * 9.81, 0.4) for strength in (0.1, 0.6))
    return replace(
        scene(rectangle(0.6, 1.0, depth_m=0.5), mu_statue=0.7, duration_s=2.0),
        base_excitation=BaseExcitation(x=along, y=across),
    )


@pytest.mark.parametrize("engine", ["analytic", "pybullet"])
def test_a_scene_in_space_has_its_room_all_round(engine: str) -> None:
    ready(engine)
    few = {} if engine == "analytic" else {"most_runs": 30}
    record = assess(shaken_both_ways(), [engine], draws=60, more_options=None, pool=InlinePool(), **few).record
    answered = record.clearance.answered
    name = "spatial" if engine == "analytic" else engine
    assert next(iter(answered)) == name, "the model that knows all directions comes first"
    assert list(answered[name].direction_deg) == list(AROUND_DEG)
    beyond = answered[name].at(0.95)
    assert beyond[90.0] > 0.05
    assert beyond[270.0] > 0.02
    assert beyond[90.0] > 3.0 * beyond[0.0]
    assert answered["analytic"].at(0.95) == {0.0: 0.0, 180.0: 0.0}
    plan = probable_plan(record.clearance, 0.95)
    assert plan.moved_m[:, 1].max() == pytest.approx(0.25 + beyond[90.0], abs=budget.PLACE_M)
    assert plan.moved_m[:, 0].min() == pytest.approx(-0.3 - beyond[180.0], abs=budget.PLACE_M)


def test_a_fall_from_a_pedestal_needs_the_tops_height_above_the_floor() -> None:
    shaken = paestum(0.02, 3.0, duration_s=1.0)
    record = assess(shaken, ["analytic"], draws=30, more_options=None, pool=InlinePool()).record
    assert record.clearance.height_m == pytest.approx(shaken.statue.height_m + shaken.pedestal.height_m)


def test_a_model_that_leaves_a_part_of_the_shaking_out_clears_no_room_where_another_knows_all() -> None:
    """It stands in every draw by 0 mm, by the exact body in 12 of 10 000: 0 mm on its right were to be kept free."""
    record = assess(
        paestum(0.02, 3.0, duration_s=1.0), ["analytic"], draws=30, more_options=None, pool=InlinePool()
    ).record
    fallen, own = cleared(paestum(2.0, 1.0, duration_s=3.0), 30), record.answers["analytic"]
    room = replace(record.clearance, by_model={**record.clearance.by_model, "spatial": fallen})
    for plane_only, by in ((True, "none"), (False, "plane")):
        answers = {"analytic": replace(own, plane_only=plane_only), "spatial": own}
        said = answer_of(replace(record, assessment=answers, clearance=room)).findings
        assert [each.values["by"] for each in said if each.code == "clearance"] == [by]
    alone = {"analytic": replace(own, plane_only=True)}
    assert answer_of(replace(record, assessment=alone)).findings[-1].values["by"] == "plane"


def test_a_plane_s_plan_is_the_outline_moved_to_both_sides() -> None:
    answer = clearance([np.array([[0.2, 0.1], [0.0, 0.0], [0.0, 0.0]])] * 30, np.ones(30), 30)
    plan = probable_plan(ClearanceRecord(1.0, rest_outline_m(BLOCK).tolist(), {"analytic": answer}), 0.95)
    assert np.ptp(plan.moved_m, axis=0) == pytest.approx([0.4 + 0.3, 0.5], abs=budget.PLACE_M)
    assert set(plan.room_m) == {"left", "right"}
