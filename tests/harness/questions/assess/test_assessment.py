"""The probability of overturning by the model: sweep and single runs alike, near what many draws gave."""

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from analytic import Harmonic, Pulse
from harness import InputError, Outcome, RunOptions, engines, load_scene
from harness.comparison.statistics import wilson
from harness.model import BaseExcitation, Pedestal, Scene, Wall
from harness.questions.assess.assessment import answer_of, assess, difference, findings_of
from harness.questions.assess.probability import (
    ModelDraws,
    Outside,
    assess_models,
    draw,
    draws_of,
    finding_of,
    fragility_of,
    jeffreys,
    model_draws,
    probability_of,
    row,
    uncertain_inputs,
    varied,
)
from harness.records.assess import Assessment, AssessRecord, NotAssessed
from harness.runs.runner import InlinePool
from reports.messages import ENGLISH
from reports.pages.assess_page import models_table
from reports.source import tone_of_answers
from tests import budgets_assess as budget
from tests.engines_for_tests import ready
from tests.scenes_for_tests import GRAVITY_M_S2, PAESTUM, SCENES, paestum, rectangle, scene

SINGLES = 40


def test_the_shipped_pedestal_scene_falls_in_two_of_five() -> None:
    """0.396 by 20 000 draws of another implementation with friction 15 %, strength 10 %, frequency 5 %, kinetic at impacts."""
    kinetic = load_scene(SCENES / "paestum_pedestal.toml", {"contact.floor_impact": "kinetic"})
    answers = assess_models(kinetic)
    assert list(answers) == ["analytic"]
    found = answers["analytic"]
    assert found.probability_overturned == pytest.approx(0.396, abs=budget.MODEL_OWN)
    assert found.low < found.probability_overturned < found.high
    assert found.draws == found.engine_runs == 10_000


def test_an_unknown_coefficient_at_impacts_is_part_of_the_probability() -> None:
    """4 000 draws of another implementation: 0.40 with the kinetic one, 0.50 with the static one; it lies between."""
    shipped = load_scene(SCENES / "paestum_pedestal.toml")
    found = assess_models(shipped)["analytic"]
    assert 0.396 + budget.MODEL_OWN < found.probability_overturned < 0.50 - budget.MODEL_OWN
    inputs = uncertain_inputs(shipped)
    static = {**draw(inputs, 4000, seed=1), "contact.floor_impact": np.ones(4000)}
    assert model_draws(shipped, static).probability == pytest.approx(0.50, abs=2.0 * budget.MODEL_OWN)


def test_the_sweep_says_of_every_draw_what_a_single_run_says() -> None:
    on = paestum(0.429, 3.0, duration_s=6.0)
    draws = draw(uncertain_inputs(on), SINGLES, seed=2)
    swept, model = model_draws(on, draws), engines.load("analytic")
    for k in range(SINGLES):
        single = varied(on, row(draws, k))
        outcome = model.simulate(single, model.refinement_levels(single)[0], RunOptions(history=False)).outcome
        assert outcome.overturned == swept.overturned[k]
    assert 0 < np.count_nonzero(swept.overturned) < SINGLES, "the draws should be of both kinds"


@pytest.mark.parametrize("wrong", [{"draws": 0}, {"draws": 0.5}, {"seed": -1}, {"most_runs": 0}])
def test_numbers_of_no_draws_are_refused_by_name(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=f"{next(iter(wrong))}: "):
        assess(paestum(0.3, 2.0), ["analytic"], **wrong)


@pytest.mark.parametrize("given", [{"half_width": 0.1}, {"most_runs": 30}])
def test_what_is_of_engine_runs_is_refused_without_any(given: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(given))):
        assess(paestum(0.3, 2.0), "analytic", draws=20, more_options=None, **given)


def test_a_scene_that_knows_everything_has_no_probability() -> None:
    assert assess_models(scene(PAESTUM, theta_rad=0.04, duration_s=1.0)) == {}


def test_an_assessment_holds_what_the_contract_names() -> None:
    names, shaken = ["analytic", "pymunk"], paestum(0.429, 3.0, duration_s=2.0)
    record = assess(shaken, names, draws=500, most_runs=48, more_options=None, pool=InlinePool()).record
    assert record.kind == "assess"
    for name in names:
        own = record.assessment[name]
        assert 0.0 <= own.low <= own.probability_overturned <= own.high <= 1.0
        assert own.draws == 500
    assert record.assessment["analytic"].engine_runs == 500
    assert 0 < record.assessment["pymunk"].engine_runs <= 48
    assert record.difference_from_model["pymunk"].low <= record.difference_from_model["pymunk"].high
    assert np.all(np.diff(record.fragility.factor) > 0.0)
    assert set(record.indices) <= {item.key for item in record.uncertainty}


def test_an_engine_none_of_whose_runs_ends_has_no_probability_but_a_reason() -> None:
    """The exact body knows no pedestal."""
    few = {"draws": 100, "most_runs": 30, "more_options": None, "pool": InlinePool()}
    record = assess(paestum(0.429, 3.0, duration_s=0.5), ["spatial"], **few).record
    none = record.assessment["spatial"]
    assert isinstance(none, NotAssessed)
    (reason,) = (each for each in record.findings if each.code == "no_run_ended")
    assert (reason.engine, reason.values) == ("spatial", {"runs": none.runs})
    assert 0 < none.runs <= 30
    assert set(record.answers) == {"analytic"}
    assert record.difference_from_model == {}


def test_a_push_across_the_plane_is_the_exact_bodys_to_answer_and_never_green() -> None:
    """Pushed across its plane alone, a block that the planar model never moves falls; on a pedestal nobody answers that."""
    push = Pulse("rectangular", 0.8 * 9.81, 0.5)
    given = scene(rectangle(0.4, 1.4, depth_m=0.3), mu_statue=0.6, duration_s=2.0)
    shaken = replace(given, base_excitation=BaseExcitation(y=push))
    answers = assess_models(shaken, draws=40)
    assert answers["analytic"].probability_overturned == 0.0
    assert answers["analytic"].plane_only
    assert answers["spatial"].probability_overturned > 0.9
    assert tone_of_answers({"analytic": answers["analytic"]}) == "differ"
    assert tone_of_answers(answers, "agree") == "failed"
    record = assess(shaken, ["analytic"], draws=40).record
    assert set(record.answers) == {"analytic", "spatial"}
    assert record.difference_from_model["spatial"].high < -0.5
    assert record.answer.findings[0].values["model"] == "spatial"
    assert not any(each.values.get("needed") is False for each in record.answer.findings)
    assert "assess_in_space" not in codes(record), "the exact body answers the other"
    on_pedestal = paestum(0.429, 3.0, duration_s=1.0)
    excitation = replace(on_pedestal.base_excitation, y=push)
    across = replace(on_pedestal, base_excitation=excitation)
    alone = assess_models(across, draws=20)
    assert list(alone) == ["analytic"]
    assert finding_of(alone).values["planar"] == ["in_plane"]
    mine = replace(record, assessment=alone, scene=replace(record.scene, file="my scene.toml"))
    (command,) = (each for each in findings_of(mine) if each.code == "assess_in_space")
    assert command.values == {"file": "'my scene.toml'"}, "as a shell takes it"


def test_a_difference_counts_what_the_models_own_draws_leave_open() -> None:
    """Half of the draws left the domain: what a sample of them says scatters, and those without an answer may fall."""
    own, other = Assessment(0.4, 0.3, 0.6, 0.9, 1000, 1000, 0.1), Assessment(0.5, 0.46, 0.54, 0.9, 1000, 300)
    told = difference(own, Outside(0.2, 0.17, 0.23, 0.1), other)
    assert (told.value, told.low, told.high) == pytest.approx((-0.1, -0.15, 0.05))
    alone = difference(own, Outside(0.0, 0.0, 0.0, 0.0), other)
    assert (alone.low, alone.high) == pytest.approx((-0.14, -0.06))


def test_a_contact_engine_that_was_asked_is_not_advised() -> None:
    record = assess(paestum(0.05, 3.0, duration_s=0.5), ["analytic"], draws=20, more_options=None).record
    open_ended = Assessment(0.03, 0.01, 0.7, 0.9, 20, 20, 0.6)
    for names, advised in ((["analytic"], True), (["analytic", "pymunk"], False)):
        mine = replace(record, assessment=dict.fromkeys(names, open_ended))
        assert ("assess_by_contact" in codes(mine)) is advised
    table = models_table(replace(record, assessment={"analytic": open_ended}), ENGLISH)
    assert table is not None
    assert table.rows[0][1] == "–"


def codes(record: AssessRecord) -> set[str]:
    """The codes of all that a record says."""
    return {each.code for each in (*answer_of(record).findings, *findings_of(record))}


def test_an_assumed_strength_is_the_files_own(tmp_path: Path) -> None:
    """`[motion] scale` is what is uncertain where nobody says otherwise, not one."""
    text = (SCENES / "paestum_block.toml").read_text().replace("[motion.x]", "[motion]\nscale = 0.2\n\n[motion.x]")
    (tmp_path / "weak.toml").write_text(text)
    weak = load_scene(tmp_path / "weak.toml")
    assert {item.key: item.value for item in uncertain_inputs(weak)}["motion.scale"] == 0.2
    assert assess_models(weak, draws=200)["analytic"].probability_overturned == 0.0


TALL: Final = scene(
    rectangle(0.25, 1.0),
    Harmonic(0.24 * GRAVITY_M_S2, 1.2),
    pedestal=Pedestal(80.0, 0.35, 0.35, 1.1),
    mu=0.6,
    duration_s=2.0,
)
"""The model holds its pedestal upright: of what the statue does on one that tips it knows nothing, fall or stand."""


def test_draws_outside_the_models_domain_are_open_where_no_engine_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(type(engines.load("pymunk")), "missing", lambda self: "pymunk is not installed")
    found = assess_models(TALL)["analytic"]
    assert found.undecided == pytest.approx(found.left_domain)
    assert found.left_domain > 0.99
    assert (found.low, found.high, found.sampled) == (0.0, 1.0, 0)
    assert not found.tells
    assert finding_of({"analytic": found}).code == "probability_open"
    low = assess_models(replace(TALL, pedestal=Pedestal(80.0, 1.0, 1.0, 0.2)))["analytic"]
    assert low.tells


def test_an_engine_answers_draws_outside_the_models_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    ready("pymunk")
    monkeypatch.setattr("harness.questions.assess.probability.MOST_SAMPLED", 12)
    # Of the stronger draws one in six ends past its balance, at steps of 4 ms as of 0.05 ms, and by pybullet.
    assert assess_models(TALL, draws=500)["analytic"].undecided == pytest.approx(2 / 12)
    calm = replace(TALL, base_excitation=BaseExcitation(x=Harmonic(0.22 * GRAVITY_M_S2, 1.5)))
    found = assess_models(calm, draws=500)["analytic"]
    assert (found.sampler, found.sampled) == ("pymunk", 12)
    assert found.undecided == 0.0
    assert found.tells
    own = wilson(0, 500, 0.9)
    assert (found.low, found.high) == pytest.approx((0.0, np.hypot(own.high, found.left_domain * jeffreys(0, 12)[2])))


def test_a_statue_that_slips_on_its_support_is_no_fall_of_the_model(monkeypatch: pytest.MonkeyPatch) -> None:
    """At a friction of 0.1 a slender block is pushed along the floor; the model, which knows no slip, overturns it."""
    ready("pymunk")
    monkeypatch.setattr("harness.questions.assess.probability.MOST_SAMPLED", 12)
    slips = scene(rectangle(0.25, 1.0), Pulse("one_sine", 0.8 * GRAVITY_M_S2, 1.0), mu_statue=0.1, duration_s=2.0)
    found = assess_models(slips, draws=500)["analytic"]
    assert found.left_domain > 0.9
    assert found.high < 0.3
    rough = assess_models(replace(slips, contact=replace(slips.contact, statue=5.0)), draws=500)["analytic"]
    assert rough.left_domain == 0.0
    assert rough.low > 0.9


def test_a_statue_that_slips_as_it_falls_falls_by_the_model_after_its_motion_too() -> None:
    """Its point of no return is passed at 0.38 s, it slips from 0.71 s, the blow ends at 0.9 s."""
    falls = scene(rectangle(0.36, 2.0), Pulse("one_sine", 0.8 * GRAVITY_M_S2, 0.9), mu_statue=0.5, duration_s=6.0)
    single = engines.load("analytic").simulate(
        falls, engines.load("analytic").settings_for_dt(falls, 1e-3), RunOptions()
    )
    assert single.no_return_time_s is not None
    assert single.no_return_time_s < single.validity["left_domain_s"] < 0.9
    model = model_draws(falls, {"motion.scale": np.ones(1)})
    assert (model.overturned.item(), model.left.item()) == (True, False)


def test_a_fall_told_by_energy_past_the_domain_is_not_the_models() -> None:
    """Its point of no return is passed later: of each draw a single run says that the statue slips, long before."""
    slips = scene(rectangle(0.245, 1.0), Pulse("one_sine", 0.68 * GRAVITY_M_S2, 0.41), mu_statue=0.2, duration_s=4.0)
    model = model_draws(slips, draw(uncertain_inputs(slips), 200, seed=0))
    assert not model.overturned[~model.left].any()
    assert model.left.mean() > 0.9


def test_the_interval_holds_open_draws_either_way() -> None:
    """Ten fall, 60 stand, 20 left the domain, 10 are open; of the 20 the engine ran 8: 3 fell, 4 stood, one came to no end."""
    kind = np.repeat(np.arange(4), (10, 60, 20, 10))
    model = ModelDraws(kind < 2, kind == 0, np.ones(100), np.zeros(100), kind == 2, np.zeros(100, bool))
    fell = dict(zip(range(70, 78), (True, True, True, False, False, False, False, None), strict=True))
    none, some = probability_of(model), probability_of(model, fell)
    own, every, sample = wilson(10, 100, 0.9), wilson(40, 100, 0.9), jeffreys(3, 7)
    assert (none.probability_overturned, none.undecided, none.sampled) == pytest.approx((0.1, 0.3, 0))
    assert (none.low, none.high) == pytest.approx((own.low, every.high))
    answered = 0.2 * 7 / 8
    assert some.undecided == pytest.approx(0.3 - answered)
    assert some.probability_overturned == pytest.approx(0.1 + answered * 3 / 7)
    below = np.hypot(0.1 - own.low, answered * (sample[0] - sample[1]))
    may_fall = wilson(10 + round(30 - 100 * answered), 100, 0.9)
    above = np.hypot(may_fall.high - may_fall.value, answered * (sample[2] - sample[0])) + some.undecided
    assert (some.low, some.high) == pytest.approx(
        (some.probability_overturned - below, some.probability_overturned + above)
    )


def test_an_assessment_s_interval_is_its_fragility_s_at_factor_1() -> None:
    kind = np.repeat(np.arange(3), (10, 60, 30))
    model = ModelDraws(kind < 2, kind == 0, np.ones(100), np.zeros(100), *np.zeros((2, 100), bool))
    found, curve = probability_of(model), fragility_of((1.0,), [model])
    assert (found.low, found.high) == pytest.approx((curve.low[0], curve.high[0]))


def test_an_engine_s_draws_that_touch_the_wall_are_told_apart_from_those_without_an_answer() -> None:
    """Ten touch it by the model, 40 of the 80 outside its domain by an engine's half; what follows is open in all of them."""
    kind = np.repeat(np.arange(3), (10, 10, 80))
    model = ModelDraws(kind == 0, np.zeros(100, bool), np.ones(100), np.zeros(100), kind == 2, kind == 1)
    found = probability_of(model, {20: Outcome.TOUCHES_WALL, 21: Outcome.TOUCHES_WALL, 22: False, 23: None})
    assert found.touches_wall == pytest.approx(0.1 + 0.8 / 2)
    assert found.undecided == pytest.approx(found.touches_wall + 0.8 / 4)
    assert found.probability_overturned == 0.0


def test_draws_that_an_engine_all_answers_leave_nothing_undecided() -> None:
    """Shares of 8433 and 10000 in double precision differ by rounding, which was told as 1e-14 % of the draws."""
    left = np.arange(10000) < 8433
    model = ModelDraws(~left, ~left, np.ones(10000), np.zeros(10000), left, np.zeros(10000, bool))
    found = probability_of(model, dict.fromkeys(range(50), False))
    assert found.undecided == 0.0


def test_the_domain_of_an_ensemble_is_that_of_single_runs() -> None:
    on = scene(rectangle(0.25, 1.0), Harmonic(0.24 * GRAVITY_M_S2, 1.2), pedestal=Pedestal(80.0, 0.5, 0.5, 0.7), mu=0.6)
    on, model = replace(on, duration_s=2.0), engines.load("analytic")
    draws = draw(uncertain_inputs(on), SINGLES, seed=3)
    swept, left = model_draws(on, draws), 0
    for k in range(SINGLES):
        single = varied(on, row(draws, k))
        run = model.simulate(single, model.refinement_levels(single)[0], RunOptions(history=False))
        known = run.validity["left_domain_s"] is None
        left += not known
        assert swept.decided[k] is np.bool_(known and run.outcome.fell is not None)
    assert 0 < left < SINGLES, "the draws should be of both kinds"


def test_draws_that_touch_the_wall_are_told_as_such() -> None:
    """A statue that falls against a wall falls no more by this model, and does not stand: the share that touches is told."""
    walled = replace(paestum(0.429, 3.0, pedestal=False, duration_s=4.0), wall=Wall("right", 0.3))
    found = assess_models(walled, draws=300)["analytic"]
    ends = analytic_outcomes(walled, 300)
    assert 0.9 < found.touches_wall == ends.count("touches_wall") / len(ends)
    assert found.undecided >= found.touches_wall
    open_ = finding_of({"analytic": found})
    assert open_.code == "probability_open"
    assert open_.values["touches_wall"] == found.touches_wall
    assert open_.values["undecided"] == pytest.approx(found.undecided - found.touches_wall)
    assert assess_models(replace(walled, wall=None), draws=300)["analytic"].touches_wall == 0.0


def analytic_outcomes(on: Scene, draws: int) -> list[str]:
    """How each draw ends as a run of its own."""
    values = draws_of(on, uncertain_inputs(on), draws, seed=0)
    model = engines.load("analytic")
    scenes = (varied(on, row(values, number)) for number in range(draws))
    return [model.simulate(each, model.settings_for_dt(each, 1e-3), RunOptions()).outcome.value for each in scenes]
