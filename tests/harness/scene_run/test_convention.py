"""A choice between conventions that decided is named, with its instant; what else parts two answers is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from analytic import AnalyticInputError, Form
from harness.accuracy.simulation import simulate
from harness.comparison.comparator import compare
from harness.engines.analytic import chosen
from harness.input.scene_file import load_scene
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.scores import Verdict
from harness.scene_run.convention import WORDS, choice_between, with_conventions

PEDESTAL = Path(__file__).parents[3] / "scenes" / "paestum_pedestal.toml"
BREAKS_LOOSE_S = 0.4968
"""Of the paper's pedestal at 0.429 g and 3 Hz: the first impact that breaks it loose."""


def scene_of(*changes: str, amplitude_g: float = 0.429) -> Scene:
    return load_scene(PEDESTAL, [f"motion.x.amplitude_g={amplitude_g}", "motion.x.frequency_hz=3", *changes])


def verdict(scene: Scene, a: Run, b: Run) -> tuple[Verdict, str]:
    a, b = (replace(run, engine=name) for run, name in ((a, "a"), (b, "b")))
    scores = with_conventions(scene, {"a": a, "b": b}, {"a_vs_b": compare(a, b, scene=scene)})["a_vs_b"]
    return scores.verdict, scores.verdict_sentence


@pytest.fixture(scope="module")
def plain() -> Run:
    return simulate(scene_of("duration_s=0.9"), "pymunk:plain", dt_s=2e-4)


def test_the_model_with_the_other_choice_is_the_engine_as_it_comes(plain: Run) -> None:
    scene = scene_of("duration_s=0.9")
    model, other = chosen(scene, "stuck")[0], chosen(scene, "static_impact")[0]
    apart = [compare(run, plain).largest_difference_rad for run in (model, other)]
    assert apart[1] < 0.1 * apart[0]
    choice = choice_between(scene, model, plain, 0.8)
    assert choice is not None
    assert choice.at_s == pytest.approx(BREAKS_LOOSE_S, abs=1e-4)
    assert "two coefficients" in choice.words


def test_the_verdict_says_by_convention_at_its_instant_and_what_the_other_choice_gives() -> None:
    scene = scene_of("duration_s=2")
    model, (other, at_s) = simulate(scene, "analytic"), chosen(scene, "static_impact")
    kind, sentence = verdict(scene, model, other)
    assert kind is Verdict.CONVENTION
    assert f"differ by convention, at {at_s:.4g} s: which of the two coefficients acts" in sentence
    assert f"With the other choice the model says: {other.outcome.sentence}, after a peak of " in sentence
    assert at_s == pytest.approx(BREAKS_LOOSE_S, abs=1e-4)


@pytest.mark.parametrize(
    ("amplitude_g", "frequency_hz", "at_s"), [(0.429, 3, BREAKS_LOOSE_S), (0.334, 3, 0.5333), (0.429, 2, 0.7627)]
)
def test_answers_that_agree_say_what_they_share_by_convention(
    amplitude_g: float, frequency_hz: float, at_s: float
) -> None:
    """At 0.429 g and 3 Hz both say that the statue stands; with the static coefficient in one impact it falls."""
    scene = scene_of(f"motion.x.frequency_hz={frequency_hz}", amplitude_g=amplitude_g)
    model, (other, _) = simulate(scene, "analytic"), chosen(scene, "static_impact")
    kind, sentence = verdict(scene, model, model)
    assert kind is Verdict.AGREE
    assert f"By convention of both, at {at_s:g} s: which of the two coefficients acts" in sentence
    assert f"With the other choice the model says: {other.outcome.sentence}, after a peak of " in sentence
    assert "By convention" not in verdict(scene, other, other)[1], "it took the other choice"


def test_one_of_several_joint_states_is_named() -> None:
    scene = scene_of("duration_s=0.6", amplitude_g=0.334)
    model, (other, at_s) = simulate(scene, "analytic"), chosen(scene, "moving")
    assert at_s in [pytest.approx(t_s) for t_s in model.validity["several_joint_states_s"]]
    kind, sentence = verdict(scene, other, model)
    assert kind is Verdict.CONVENTION
    assert f"at {at_s:.4g} s: which of several joint states" in sentence


def test_one_coefficient_and_single_states_leave_no_choice() -> None:
    scene = scene_of("duration_s=2", "contact.floor_static=0.15")
    peak_rad = chosen(scene, "stuck")[0].peak_theta_rad
    for name in WORDS:
        other, parts_s = chosen(scene, name)
        assert parts_s is None
        assert other.peak_theta_rad == peak_rad
    model = simulate(scene, "analytic")
    assert "By convention" not in verdict(scene, model, model)[1]


@pytest.mark.parametrize(("inertia", "friction"), [(1.05, 1.0), (1.0, 1.05), (0.98, 1.0), (1.0, 0.97)])
def test_another_model_is_no_convention(inertia: float, friction: float) -> None:
    scene = scene_of("duration_s=1")
    statue = replace(scene.statue, inertia_kg_m2=inertia * scene.statue.inertia_kg_m2)
    floor = {"floor_static": friction * 0.20, "floor_kinetic": friction * 0.15}
    wrong = simulate(replace(scene, statue=statue, contact=replace(scene.contact, **floor)), "analytic")
    assert verdict(scene, simulate(scene, "analytic"), wrong)[0] is Verdict.MODEL


def test_a_scene_that_the_model_refuses_has_no_choice(plain: Run) -> None:
    refused = replace(scene_of("duration_s=0.9"), duration_s=-1.0)
    assert choice_between(refused, plain, replace(plain, engine="other"), 0.8) is None
    with pytest.raises(AnalyticInputError, match="choice"):
        Form(choice="none")  # type: ignore[arg-type]
