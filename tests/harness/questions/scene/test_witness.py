"""What unmodified engines confirm of a run: until when, to what, and where a wrong model or a wrong layer is found out."""

import math
from dataclasses import replace

import pytest

from harness import Outcome, Run, RunOptions, Scene, engines, load_scene, simulate
from harness.questions.scene import witness
from harness.questions.scene.witness import BUDGET, CHECK_TIMES, TARGET_RAD, decided_by, findings_of, witnesses
from harness.records.run import Witness
from tests import doubles
from tests.doubles import codes
from tests.measures.random_scenes import GENERATORS
from tests.scenes_for_tests import SCENES

NAMES = ("analytic", "pymunk")


@pytest.fixture(scope="module")
def pedestal() -> Scene:
    return load_scene(SCENES / "paestum_pedestal.toml")


def witnessed(scene: Scene) -> tuple[Run, Witness]:
    """A run of pymunk, and what its unmodified engine says of it."""
    run = simulate(scene, "pymunk")
    return run, witnesses(scene, {"pymunk": run}, RunOptions())["pymunk:plain"]


def test_model_and_engine_are_confirmed_until_an_instant_within_what_the_run_bounds() -> None:
    floor = load_scene(SCENES / "paestum_floor.toml")
    runs = {name: simulate(floor, name) for name in NAMES}
    seen = witnesses(floor, runs, RunOptions())["pymunk:plain"]
    assert seen.agrees
    assert 0.5 < seen.until_s <= (runs["pymunk"].reliable_until_s or 0.0)
    assert set(seen.runs) == set(NAMES)
    assert seen.uncertainty_rad <= seen.to_rad
    (told,) = findings_of({seen.engine: seen})
    assert (told.code, told.values["models"]) == ("witness_confirms", ["analytic", "pymunk"])


def test_the_reason_why_no_further_is_the_one_that_came_first() -> None:
    """A witness whose own error grows before its steps are used up: it was computed further, and says so little."""
    scene = load_scene(SCENES / "free_rocking.toml")
    run, seen = witnessed(scene)
    assert seen.until_s < run.bounded_until_s
    assert [(each.code, each.values["from_s"]) for each in seen.reasons] == [("witness_not_bounded", seen.until_s)]


def test_a_witness_costs_no_more_than_its_budget(pedestal: Scene) -> None:
    run, seen = witnessed(pedestal)
    allowed = BUDGET * run.work["steps_of_all_runs"] / engines.load("pymunk:plain").step_cost(pedestal)
    # A step that only the end of a run makes whole is one more in each of the two.
    assert seen.steps <= (1.0 + CHECK_TIMES) * allowed + 3
    one = load_scene(SCENES / "paestum_pedestal.toml", ["contact.floor_static=0.15"])
    run, seen = witnessed(one)
    assert seen.agrees
    allowed = BUDGET * run.work["steps_of_all_runs"] / engines.load("pymunk:plain").step_cost(one)
    assert seen.steps <= allowed + 2, "nothing parts, and nothing is run again"


@pytest.mark.parametrize(("coarser_rad", "refuted"), [(0.05, False), (0.021, True)])
def test_a_difference_that_falls_with_the_plain_engine_s_step_refutes_nothing(
    coarser_rad: float, refuted: bool, pedestal: Scene
) -> None:
    """The finer plain run is 0.02 rad off from the run: its error where the coarser one is 0.05 rad off, no error at 0.021."""
    history = doubles.rocking()
    known = {"numerical_uncertainty_rad": 1e-4, "slip_uncertainty_m": 1e-4, "reliable_until_s": 10.0}
    run = doubles.run_of(history, "pymunk", **known)
    fine, coarse = (
        doubles.run_of(doubles.raised(history, off), "pymunk:plain", **known) for off in (0.02, coarser_rad)
    )
    assert witness._judged(pedestal, run, fine, coarse).agrees is not refuted


def test_a_budget_that_ends_before_the_run_is_told() -> None:
    scene = GENERATORS["random"](41007)
    run = simulate(scene, "pymunk")
    poor = replace(run, work={"steps_of_all_runs": 600})
    seen = witnesses(scene, {"pymunk": poor}, RunOptions())["pymunk:plain"]
    assert seen.until_s < 0.5 * (run.reliable_until_s or 0.0)
    assert codes(seen.reasons) == ["witness_budget"]


def test_what_a_plain_engine_takes_for_rest_at_all_its_steps_refutes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rocking by 1e-4 rad, which grows: to 0.025 ms the plain engine rests, at 0.011 ms it rocks as the model."""
    scene = GENERATORS["random"](3800002)
    runs = {name: simulate(scene, name) for name in NAMES}
    seen = witnesses(scene, runs, RunOptions())["pymunk:plain"]
    assert {(each.agrees, each.parts_s) for each in seen.runs.values()} == {(True, None)}
    assert 1.5 < seen.until_s < 2.1
    monkeypatch.setattr(witness, "outgrown_s", lambda *_: math.inf)
    assert not witnesses(scene, runs, RunOptions())["pymunk:plain"].agrees


@pytest.mark.parametrize(("seed", "budget"), [(41000, 15.0), (41003, 4.0), (41008, 4.0)])
def test_a_run_of_a_heavier_impact_is_not_confirmed(seed: int, budget: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The statue's inertia a fifth larger in the run than in the witness: they must part, and the sentence must say so."""
    monkeypatch.setattr(witness, "BUDGET", budget)
    drawn = GENERATORS["random"](seed)
    scene = replace(drawn, contact=replace(drawn.contact, floor_impact="static"))
    inertia, tensor = 1.2 * scene.statue.inertia_kg_m2, 1.2 * scene.statue.inertia_tensor_kg_m2
    heavy = replace(scene, statue=replace(scene.statue, inertia_kg_m2=inertia, inertia_tensor_kg_m2=tensor))
    run = simulate(heavy, "pymunk")
    seen = witnesses(scene, {"pymunk": run}, RunOptions())["pymunk:plain"]
    assert seen.agrees is False
    assert seen.runs["pymunk"].parts_s is not None
    assert codes(findings_of({seen.engine: seen})) == ["witness_parts"]


def test_with_two_coefficients_the_model_with_the_static_one_at_impacts_is_confirmed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The paper's pedestal at 0.429 g and 3 Hz, where the kinetic one parts from the plain engine by 2.5e-2 rad."""
    shaking = ["motion.x.amplitude_g=0.429", "motion.x.frequency_hz=3", "duration_s=1.0"]
    scene = load_scene(SCENES / "paestum_pedestal.toml", shaking)
    monkeypatch.setattr(witness, "BUDGET", 60.0)
    runs = {name: simulate(scene, name) for name in NAMES}
    seen = witnesses(scene, runs, RunOptions())["pymunk:plain"]
    model, located = seen.runs["analytic"], seen.runs["pymunk"]
    assert (model.agrees, model.floor_impact) == (True, "static")
    told = findings_of({seen.engine: seen})
    assert {each.values["floor_impact"] for each in told} == {"static"}
    assert [(each.values["models"], each.values["until_s"]) for each in told] == [
        (["analytic"], model.until_s),
        (["pymunk"], located.until_s),
    ]
    assert model.until_s > 0.9
    assert model.to_rad < TARGET_RAD
    choice = decided_by(scene, runs)
    assert (located.agrees, located.floor_impact) == (True, "")
    assert located.until_s == choice.at_s < model.until_s
    # By another coefficient than the scene's the model is another history: held so, it is not confirmed.
    monkeypatch.setattr(witness, "under_static", lambda scene, runs: (scene, dict(runs)))
    assert not witnesses(scene, runs, RunOptions())["pymunk:plain"].runs["analytic"].agrees


def test_what_decides_the_outcome_is_told_with_what_each_choice_gives(pedestal: Scene) -> None:
    """The shipped scene: it stands with the kinetic coefficient at impacts and falls with the static one."""
    found = decided_by(pedestal, {"analytic": simulate(pedestal, "analytic")})
    assert (found.key, found.decides) == ("contact.floor_impact", True)
    assert {name: each.outcome.value for name, each in found.outcomes.items()} == {
        "kinetic": "stands",
        "static": "overturned_right",
    }
    assert [each.code for each in witness.findings_of_choice(found)] == ["floor_impact_decides"]
    assert found.at_s < found.outcomes["static"].end_s < found.outcomes["kinetic"].end_s
    static = replace(pedestal, contact=replace(pedestal.contact, floor_impact="static"))
    turned = decided_by(static, {"analytic": simulate(static, "analytic")})
    assert {name: each.outcome for name, each in turned.outcomes.items()} == {
        name: each.outcome for name, each in found.outcomes.items()
    }
    one = replace(pedestal, contact=replace(pedestal.contact, floor_static=0.15))
    assert decided_by(one, {"analytic": simulate(one, "analytic")}) is None
    # Where one still falls at the scene's end it has not ended otherwise.
    cut = replace(pedestal, duration_s=found.outcomes["static"].end_s - 0.1)
    still = decided_by(cut, {"analytic": simulate(cut, "analytic")})
    assert (still.outcomes["static"].outcome, still.decides) == (Outcome.UNDECIDED, False)
    assert witness.findings_of_choice(still) == []


def test_an_engine_that_bounds_nothing_has_no_witness(pedestal: Scene) -> None:
    run = replace(simulate(pedestal, "pymunk", dt_s=4e-3), reliable_until_s=0.0)
    seen = witnesses(pedestal, {"pymunk": run}, RunOptions())["pymunk:plain"]
    assert seen.agrees is None
    assert codes(findings_of({seen.engine: seen})) == ["witness_silent", "witness_of_nothing"]


def test_what_a_plain_engine_cannot_compute_is_its_reason() -> None:
    imposed = load_scene(SCENES / "paestum_pedestal.toml", ["contact.restitution=0.7"])
    _, seen = witnessed(imposed)
    assert seen.agrees is None
    assert codes(seen.reasons) == ["witness_failed"]


def test_a_witness_of_another_motion_says_that_it_saw_the_rocking_plane_alone() -> None:
    pytest.importorskip("pybullet", reason="pybullet is not installed here")
    shaken = load_scene(SCENES / "paestum_floor.toml", ["duration_s=0.5"])
    scene = replace(shaken, base_excitation=replace(shaken.base_excitation, y=shaken.base_excitation.x))
    names = ("analytic", "pybullet")
    reasons = [
        witnesses(each, {name: simulate(each, name) for name in names}, RunOptions())["pybullet:plain"].reasons
        for each in (scene, shaken)
    ]
    assert {each.code: each.values for each in reasons[0]}["witness_in_plane"] == {"models": ["analytic"]}
    assert "witness_in_plane" not in codes(reasons[1])
