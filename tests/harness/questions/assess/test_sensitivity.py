"""Which input matters: indices by ranks hold known ones; a factor on the motion costs no second reading of a drawn scene."""

import math
from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest

from harness.input.scene_file import load_scene
from harness.model import Uncertain, info
from harness.questions.assess.assessment import reserve
from harness.questions.assess.probability import (
    LEAST_INDEXED,
    ModelDraws,
    draw,
    fragility,
    fragility_of,
    indices,
    indices_of_draws,
    model_draws,
    sweepable,
    uncertain_inputs,
)
from reports.messages import ENGLISH
from tests import budgets_assess as budget
from tests.harness.questions.assess.measure_own_runs import SCENE

INPUTS = [Uncertain(key, "normal", 0.0, 1.0) for key in ("a", "b")]


@pytest.mark.parametrize("slope", [0.0, 0.5, 1.0, 3.0, 30.0])
@pytest.mark.parametrize("count", [LEAST_INDEXED, 400])
def test_an_index_by_ranks_holds_the_known_one_as_often_as_it_says(slope: float, count: int) -> None:
    """A fall at a x slope + b > 0: the share of the variance that a explains is that of Φ(slope a), four times."""
    own = NormalDist()
    truth = 4.0 * float(np.var([own.cdf(slope * own.inv_cdf((k + 0.5) / 2000)) for k in range(2000)]))
    held = {"first": 0, "total": 0}
    for seed in range(budget.ESTIMATES):
        a, b = np.random.default_rng(seed).standard_normal((2, count))
        answer = indices_of_draws(INPUTS, {"a": a, "b": b}, slope * a + b > 0.0)
        held["first"] += abs(answer["a"].first - truth) <= answer["a"].half_width
        # Of two inputs the total of one is what the other leaves.
        held["total"] += abs((answer["b"].total or 0.0) - (1.0 - truth)) <= answer["b"].half_width
    assert min(held.values()) >= budget.LEAST_OF_HUNDRED


def test_neighbours_in_three_inputs_tell_a_total_and_in_more_none() -> None:
    """A fall at 3 a + 2 b + c + d > 0 (a, b, c, d normal): totals of 0.69, 0.40, 0.19, 0.19 from two runs of each pair."""
    sizes, names = np.array([3.0, 2.0, 1.0, 1.0]), "abcd"
    first, again = np.random.default_rng(0).standard_normal((2, budget.DRAWS, 4))
    inputs = [replace(INPUTS[0], key=name) for name in names]
    random, fell, mean = np.random.default_rng(1), first @ sizes > 0.0, dict.fromkeys(names, 0.0)
    for _ in range(20):
        drawn = random.standard_normal((300, 4))
        answer = indices_of_draws(inputs, dict(zip(names, drawn.T, strict=True)), drawn @ sizes > 0.0)
        mean = {name: mean[name] + (answer[name].total or 0.0) / 20.0 for name in names}
    for k, name in enumerate(names):
        other = first.copy()
        other[:, k] = again[:, k]
        truth = 2.0 * float(np.mean((other @ sizes > 0.0) != fell))
        assert abs(mean[name] - truth) <= budget.TOTAL_BIAS
    more = {name: np.arange(300.0) for name in "abcde"}
    answer = indices_of_draws([replace(INPUTS[0], key=name) for name in "abcde"], more, np.arange(300) > 99)
    assert all(index.total is None for index in answer.values())


def test_too_few_draws_or_such_as_end_alike_or_inputs_that_hang_together_have_no_index() -> None:
    values = draw(INPUTS, 300, 0)
    fell = values["a"] > 0.0
    assert indices_of_draws(INPUTS, values, fell[: LEAST_INDEXED - 1]) == {}
    assert indices_of_draws(INPUTS, values, np.zeros(300, dtype=bool)) == {}
    linked = [INPUTS[0], replace(INPUTS[1], correlated_with="a", rho=0.5)]
    assert indices_of_draws(linked, values, fell) == {}


def test_both_ways_to_an_index_agree_on_the_shipped_scene() -> None:
    scene = load_scene(SCENE)
    inputs = uncertain_inputs(scene)
    values = draw(inputs, 2000, 5)
    ranked = indices_of_draws(inputs, values, model_draws(scene, values).overturned)
    drawn = indices(scene, inputs, 5)
    assert set(ranked) == set(drawn)
    for key, index in ranked.items():
        for by_neighbours, twice in ((index.first, drawn[key].first), (index.total, drawn[key].total)):
            assert abs(by_neighbours - twice) <= 2.0 * math.hypot(index.half_width, drawn[key].half_width)


def test_a_scene_read_again_for_each_draw_has_the_fragility_of_one_that_is_not() -> None:
    """A height of the pedestal that hardly varies makes each draw be read again, and changes nothing."""
    scene = load_scene(SCENE)
    inputs = uncertain_inputs(scene)
    slow = [*inputs, Uncertain("pedestal.height_m", "uniform", 0.2, 1e-9)]
    assert not sweepable(scene, draw(slow, 2, 0))
    expected, answer = (fragility(scene, each, 3, count=60) for each in (inputs, slow))
    assert answer.probability_overturned == pytest.approx(expected.probability_overturned, abs=1e-12)
    assert 0.0 < answer.probability_overturned[12] < 1.0


def answered(fell: int, open_: int, size: int) -> ModelDraws:
    """So many draws that fall, come to no end, and stand."""
    number = np.arange(size)
    none = np.zeros(size)
    return ModelDraws((number < fell) | (number >= fell + open_), number < fell, none, none, none > 0.0, none > 0.0)


def test_draws_without_an_end_stand_at_one_edge_of_the_fragility_and_fall_at_the_other() -> None:
    factors, falls = (0.5, 1.0, 2.0, 4.0), (0, 0, 400, 1000)
    decided, some_open = (
        fragility_of(factors, [answered(fell, open_, 1000) for fell, open_ in zip(falls, undecided, strict=True)])
        for undecided in ((0, 0, 0, 0), (0, 200, 300, 0))
    )
    assert some_open.probability_overturned == decided.probability_overturned
    assert (some_open.low, some_open.factor_at, some_open.latest_at) == (
        decided.low,
        decided.factor_at,
        decided.latest_at,
    )
    assert some_open.undecided == [0.0, 0.2, 0.3, 0.0]
    assert some_open.high[1] > 0.2 > decided.high[1]
    assert some_open.high[2] > 0.7
    for asked, soonest in some_open.soonest_at.items():
        assert soonest < (decided.soonest_at[asked] or 0.0)
    told, at = reserve(decided).values, decided.factor_at["0.05"]
    assert (told["kind"], told["undecided"]) == ("some", 0.0)
    assert told["factors"]["0.05"] == [decided.soonest_at["0.05"], at, decided.latest_at["0.05"], decided.factor[0]]
    factors = {"0.05": [0.25, 0.25, 0.3, 0.25], "0.50": [0.6, 0.7, 0.8, 0.25]}
    said = ENGLISH.say(
        info("reserve", kind="none", factors=factors, most=None, soonest=None, undecided=0.0, model="analytic")
    )
    assert "≤ 0.250 (≤ 0.250" in said, "the weakest shaking tried has it already: it was told as where it begins"
    assert "0.700 (0.600" in said
    told = reserve(some_open).values
    assert (told["kind"], told["undecided"]) == ("open", 0.3), "at today's strength a fifth of the draws may fall"
    assert reserve(decided, "plane").values["kind"] == "plane"


def test_what_no_strength_decides_is_no_reserve() -> None:
    never = fragility_of((1.0, 2.0), [answered(0, 0, 1000)] * 2)
    told = reserve(never).values
    assert (told["kind"], told["factors"], told["most"], told["soonest"]) == ("some", {}, 2.0, None)
    unknown = fragility_of((0.5, 1.0, 2.0), [answered(0, open_, 64) for open_ in (0, 30, 64)])
    told = reserve(unknown).values
    assert (told["kind"], told["factors"], told["most"]) == ("open", {}, None), "what may fall was told as under 5 %"
    assert told["soonest"] < 1.0
